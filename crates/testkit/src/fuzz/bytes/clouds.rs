//! Small meshes of bytes: many coincidences, every degeneracy.

use untangle::mesh::MeshDescription;

/// A mesh and positions. Of bytes: number of vertices, of faces, scale, and [`Cloud::choices`]; the corners of faces;
/// the coordinates of vertices; then single coordinates that are off the lattice: which, and by how much.
#[derive(Clone, Debug, Default)]
pub(in crate::fuzz) struct Cloud {
    pub(in crate::fuzz) faces: Vec<[u32; 3]>,
    pub(in crate::fuzz) positions: Vec<[f64; 3]>,
    /// Bits that a target has a use for.
    pub(in crate::fuzz) choices: u8,
    /// Bytes that were not used.
    pub(in crate::fuzz) rest: Vec<u8>,
}

const HEAD: usize = 4;
const MOST_VERTICES: u8 = 12;
const MOST_FACES: u8 = 14;
/// Powers of ten; the middle is likeliest.
const SCALES: [i32; 8] = [0, 0, 0, -2, 3, -30, 30, -75];

impl Cloud {
    /// Whatever the bytes are, they make one; what is missing is zero.
    pub(in crate::fuzz) fn of(bytes: &[u8]) -> Self {
        let mut bytes = bytes.iter().copied();
        let mut next = || bytes.next().unwrap_or(0);
        let [vertices, faces, scale, choices] = std::array::from_fn::<_, HEAD, _>(|_| next());
        let (num_vertices, num_faces) = (3 + vertices % (MOST_VERTICES - 2), 1 + faces % MOST_FACES);
        let scale = 10f64.powi(SCALES[usize::from(scale % 8)]);
        let faces = (0..num_faces).map(|_| std::array::from_fn(|_| u32::from(next() % num_vertices))).collect();
        let mut positions: Vec<[f64; 3]> =
            (0..num_vertices).map(|_| std::array::from_fn(|_| f64::from(next().cast_signed()) / 8.0)).collect();
        let rest: Vec<u8> = bytes.collect();
        let (off, rest) = rest.as_chunks::<2>();
        let num_coordinates = 3 * positions.len();
        for &[which, by] in off.iter().take(8) {
            let at = usize::from(which) % num_coordinates;
            positions.as_flattened_mut()[at] += f64::from(by.cast_signed()) * 2f64.powi(-40);
        }
        positions.as_flattened_mut().iter_mut().for_each(|x| *x *= scale);
        let rest = off.iter().skip(8).flatten().chain(rest).copied().collect();
        Self { faces, positions, choices, rest }
    }

    pub(in crate::fuzz) fn description(&self) -> MeshDescription {
        MeshDescription { num_vertices: self.positions.len(), faces: self.faces.clone(), ..MeshDescription::default() }
    }

    /// The bytes of faces and places on the lattice of eighths; nothing where they are too many.
    pub(in crate::fuzz) fn bytes(faces: &[[u32; 3]], positions: &[[f64; 3]], choices: u8) -> Option<Vec<u8>> {
        let num_vertices = u8::try_from(positions.len()).ok().filter(|n| (3..=MOST_VERTICES).contains(n))?;
        let num_faces = u8::try_from(faces.len()).ok().filter(|n| (1..=MOST_FACES).contains(n))?;
        let mut bytes = vec![num_vertices - 3, num_faces - 1, 0, choices];
        bytes.extend(faces.as_flattened().iter().map(|&corner| corner as u8));
        bytes.extend(positions.as_flattened().iter().map(|x| ((x * 8.0) as i8).cast_unsigned()));
        Some(bytes)
    }
}

/// A place for each number, in a cube; no four of the first in a plane.
pub(in crate::fuzz) fn corner(number: u8) -> [f64; 3] {
    let x = f64::from(number);
    [0.31, 0.57, 0.83].map(|by| (x * by + x * x * 0.07 * by).fract())
}
