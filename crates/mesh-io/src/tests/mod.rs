//! Files as a user has them: read, refused, and written back.

mod caches;
mod damage;
mod gltf;
mod obj;
mod parts;
mod ply;
mod several;
mod stl;
mod usd;

use std::fs;

use crate::{MeshFile, ReadError, read_mesh};

fn read(name: &str, content: &[u8]) -> Result<MeshFile, ReadError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, content).unwrap();
    read_mesh(&path)
}

/// The message, from the file's name on.
fn refusal(name: &str, content: &[u8]) -> String {
    let message = read(name, content).unwrap_err().to_string();
    message[message.find(name).unwrap()..].to_string()
}

fn written(mesh: &MeshFile, positions: &[[f64; 3]]) -> Vec<u8> {
    let mut out = Vec::new();
    mesh.write_with_positions(positions, &mut out).unwrap();
    out
}

/// Everything that the format allows and exporters write.
const ODD_OBJ: &[u8] = b"\xef\xbb\xbf# C:\\models\\\r\nmtllib a.mtl\r\nv 0 0 0\r\nv  1.50\t0 0 1.0\r\n\
v 1 1 0 0.5 0.5 0.5 # red\r\n\
v 0 1 0\r\nvt 0 0\r\nvt 1 0\r\nvt 1 1\r\nvn 0 0 1\r\ng front back\r\ns off\r\nusemtl caf\xe9\r\n\
f 1/1 2/2/1 \\\r\n  3/3 4/1/1\r\n\
f -4/-3 -3/-2/-1 -1/-1\r\nl 1 2\r\nf 5/1 1/2 2/3\r\nv 2e0 -.5 +1.25e-1";

const ASCII_PLY: &str = "ply\nformat ascii 1.0\ncomment odd\nelement vertex 4\nproperty uchar red\nproperty double y\n\
property double x\nproperty double z\nproperty list uchar int bones\nelement material 1\n\
property float shine\nelement face 2\n\
property list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n\
255 0 0 0 2 7 8\n255 0 1.50 0 0\n\
255 1 1 0 1 3\n255 1 0 0.1 0\n0.5\n4 0 1 2 3 8 0 0 1 0 1 1 0 1\n3 0 1 2 6 0 0 1 0 1 1\n";

/// A triangle in either byte order, with a list and a colour round the coordinates, and texture coordinates by vertex.
fn binary_ply(big: bool, scalar: &str) -> Vec<u8> {
    let order = if big { "big" } else { "little" };
    let mut file = format!(
        "ply\r\nformat binary_{order}_endian 1.0\r\nelement vertex 3\r\nproperty list uchar short tags\r\n\
property {scalar} x\r\n\
property {scalar} y\r\nproperty {scalar} z\r\nproperty float s\r\nproperty float t\r\nelement face 1\r\n\
property list uchar uint vertex_index\r\nend_header\r\n"
    )
    .into_bytes();
    let mut push = |mut bytes: Vec<u8>| {
        if big {
            bytes.reverse();
        }
        file.extend(bytes);
    };
    for (vertex, [x, y]) in [[0., 0.], [1., 0.], [0., 1.]].into_iter().enumerate() {
        push(vec![u8::try_from(vertex).unwrap()]);
        for _ in 0..vertex {
            push(vec![1, 2]);
        }
        for value in [x, y, 0.1] {
            #[expect(clippy::cast_possible_truncation)]
            push(if scalar == "double" {
                f64::to_le_bytes(value).to_vec()
            } else {
                (value as f32).to_le_bytes().to_vec()
            });
        }
        for value in [x, y] {
            #[expect(clippy::cast_possible_truncation)]
            push((value as f32).to_le_bytes().to_vec());
        }
    }
    push(vec![3]);
    for corner in 0u32..3 {
        push(corner.to_le_bytes().to_vec());
    }
    file
}
