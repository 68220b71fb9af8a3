//! What is written of a glTF document with other positions.

use super::{INDICES, buffer, document, glb, read, write};
use crate::{Output, formats::gltf::container::Chunks};

#[test]
fn output_of_glb_with_bytes_beyond_its_stated_length_keeps_them() {
    let folder = tempfile::tempdir().unwrap();
    let mut source = glb(&document(12, INDICES, 54), &buffer([0, 1, 2]));
    let length = source.len();
    source.extend(b"beyond");
    let file = read(folder.path(), "a.glb", &source);
    let mut moved = file.positions().to_vec();
    moved[0][0] = 21.0;
    let written = write(&file, &folder.path().join("b.glb"), &moved);
    assert!(written.ends_with(b"beyond") && written[8..12] == u32::try_from(length - 4).unwrap().to_le_bytes());
    assert_eq!(read(folder.path(), "b.glb", &written).positions(), moved);
}

#[test]
fn output_of_moved_glb_changes_positions_and_bounds_only() {
    let folder = tempfile::tempdir().unwrap();
    let mut source = glb(&document(12, INDICES, 54), &buffer([0, 1, 2]));
    // A chunk of an unknown extension.
    source.extend(b"\x04\0\0\0MINEdata");
    let length = u32::try_from(source.len()).unwrap();
    source[8..12].copy_from_slice(&length.to_le_bytes());
    let file = read(folder.path(), "a.glb", &source);
    assert!(file.fixed_vertices().is_empty() && !file.is_single_precision());
    assert_eq!(write(&file, &folder.path().join("b.glb"), file.positions()), source);

    let mut moved = file.positions().to_vec();
    moved[3] = [23.0, 2.5, -0.25];
    let bytes = write(&file, &folder.path().join("b.glb"), &moved);
    let again = read(folder.path(), "b.glb", &bytes);
    Output::new(std::slice::from_ref(&file), &folder.path().join("b.glb"))
        .unwrap()
        .check_read_back(&moved, &again)
        .unwrap();
    // What a single under the transform of the node can't hold is rounded as the file does it.
    let mut odd = moved.clone();
    odd[2] = [0.1, 0.2, 0.3];
    let rounded = read(folder.path(), "d.glb", &write(&file, &folder.path().join("d.glb"), &odd));
    let output = Output::new(std::slice::from_ref(&file), &folder.path().join("d.glb")).unwrap();
    assert_ne!(rounded.positions(), odd);
    assert_eq!(output.stored_positions(&odd).unwrap(), rounded.positions());
    assert_eq!(again.positions(), moved);
    assert_eq!(again.faces(), file.faces());
    assert!(bytes.ends_with(b"\x04\0\0\0MINEdata"));
    let chunk = |bytes: &[u8]| {
        let chunks = Chunks::find(bytes).unwrap();
        let json = String::from_utf8(bytes[chunks.json].to_vec()).unwrap();
        (json.trim_end().to_owned(), bytes[chunks.binary.unwrap()].to_vec())
    };
    let ((json, binary), (new_json, new_binary)) = (chunk(&source), chunk(&bytes));
    let expected = json.replace("[0, 0, 0], \"max\": [1, 1, 0]", "[0,0,-0.125], \"max\": [1.5,1.25,0]");
    assert_eq!(new_json, expected);
    let different: Vec<usize> = (0..binary.len()).filter(|&at| binary[at] != new_binary[at]).collect();
    assert!(binary.len() == new_binary.len() && different.iter().all(|at| (36..48).contains(at)), "{different:?}");
    // Moved back, only the spelling of the bounds differs.
    let back = write(&again, &folder.path().join("c.glb"), file.positions());
    assert_eq!(chunk(&back).1, binary);
}

#[test]
fn output_embeds_linked_buffers_that_changed_or_would_be_lost() {
    let folder = tempfile::tempdir().unwrap();
    let elsewhere = folder.path().join("elsewhere");
    std::fs::create_dir(&elsewhere).unwrap();
    std::fs::write(folder.path().join("cloth 1.bin"), buffer([0, 1, 2])).unwrap();
    let text =
        document(12, INDICES, 54).replace("{\"byteLength\": 54}", "{\"uri\": \"cloth%201.bin\", \"byteLength\": 54}");
    let file = read(folder.path(), "a.gltf", text.as_bytes());
    let sources: Vec<_> = file.source_files().collect();
    assert_eq!(sources, [folder.path().join("a.gltf"), folder.path().join("cloth 1.bin")]);

    let path = folder.path().join("b.gltf");
    assert_eq!(write(&file, &path, file.positions()), text.as_bytes());
    let embedded = String::from_utf8(write(&file, &elsewhere.join("b.gltf"), file.positions())).unwrap();
    assert!(embedded.contains("\"uri\": \"data:application/octet-stream;base64,"), "{embedded}");
    assert_eq!(read(&elsewhere, "b.gltf", embedded.as_bytes()).positions(), file.positions());

    let mut moved = file.positions().to_vec();
    moved[0][1] = -8.0;
    let changed = String::from_utf8(write(&file, &path, &moved)).unwrap();
    assert!(changed.contains("\"min\": [0,-4,0]") && !changed.contains(".bin"), "{changed}");
    let again = read(folder.path(), "b.gltf", changed.as_bytes());
    assert_eq!(again.positions(), moved);
    assert_eq!(again.source_files().count(), 1);
    // An embedded buffer changes in the text.
    assert_eq!(write(&again, &path, &moved), changed.as_bytes());
    let twice = write(&again, &path, file.positions());
    assert_eq!(read(folder.path(), "c.gltf", &twice).positions(), file.positions());
    // The buffer of the input is unchanged.
    assert_eq!(std::fs::read(folder.path().join("cloth 1.bin")).unwrap(), buffer([0, 1, 2]));
}

#[test]
fn output_converts_gltf_to_glb_and_back() {
    let folder = tempfile::tempdir().unwrap();
    let source = glb(&document(12, INDICES, 54), &buffer([0, 1, 2]));
    let file = read(folder.path(), "a.glb", &source);
    let mut moved = file.positions().to_vec();
    moved[2][2] = 4.0;
    for positions in [file.positions(), &moved] {
        let text = write(&file, &folder.path().join("b.gltf"), positions);
        assert!(text.starts_with(b"{"));
        let as_text = read(folder.path(), "b.gltf", &text);
        assert_eq!(as_text.positions(), positions);
        let binary = write(&as_text, &folder.path().join("c.glb"), file.positions());
        assert!(binary.starts_with(b"glTF"));
        let back = read(folder.path(), "c.glb", &binary);
        assert_eq!((back.positions(), back.faces()), (file.positions(), file.faces()));
        let chunks = Chunks::find(&binary).unwrap();
        assert_eq!(binary[chunks.binary.unwrap()], source[Chunks::find(&source).unwrap().binary.unwrap()]);
        assert!(!String::from_utf8_lossy(&binary[chunks.json]).contains("uri"));
    }
}
