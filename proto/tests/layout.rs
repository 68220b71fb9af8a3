//! Pins size, alignment, offsets and type names of everything on the wire: a change here is a new protocol version.

use std::mem::{align_of, offset_of, size_of};

use iceoryx2_bb_elementary_traits::zero_copy_send::ZeroCopySend;
use untangled_proto::{
    CorrectionHeader, CorrectionKind, PositionF32, PositionF64, Precision, RegisterParams, RepairHeader, ReplyHeader,
    RequestHeader, RequestKind, SessionOptions, StateHeader, Status, VertexCorrection, VertexEntry, VertexLabel, flags,
    pair_type,
    paths::{PathPoint, PathRecord, PathsHeader},
    view::ViewHeader,
};

macro_rules! pin {
    ($type:ty, $name:expr, size $size:expr, align $align:expr, { $($field:ident @ $offset:expr),* $(,)? }) => {
        assert_eq!((size_of::<$type>(), align_of::<$type>()), ($size, $align), stringify!($type));
        $(assert_eq!(offset_of!($type, $field), $offset, concat!(stringify!($type), "::", stringify!($field)));)*
        // SAFETY: the name is only compared.
        assert_eq!(unsafe { <$type as ZeroCopySend>::type_name() }, $name);
    };
}

#[test]
fn headers_keep_layout_and_type_name() {
    pin!(RequestHeader, "untangled.control.RequestHeader", size 64, align 8, {
        protocol_version @ 0, kind @ 4, session @ 8, num_sections @ 16, flags @ 20, token @ 24, reserved @ 40,
    });
    pin!(ReplyHeader, "untangled.control.ReplyHeader", size 64, align 8, {
        protocol_version @ 0, status @ 4, instance @ 8, session @ 16, token @ 24,
        num_body_vertices @ 40, num_places @ 48, num_bytes @ 56,
    });
    pin!(StateHeader, "untangled.v1.StateHeader", size 64, align 8, {
        frame @ 0, simulated_s @ 8, dt_s @ 16, num_vertices @ 24, flags @ 28, progress @ 32,
        repair_deadline_us @ 48, reserved @ 56,
    });
    pin!(CorrectionHeader, "untangled.v1.CorrectionHeader", size 320, align 8, {
        frame @ 0, simulated_s @ 8, dt_s @ 16, status @ 24, kind @ 28, flags @ 32, num_vertices @ 36, fault_index @ 40,
        fault_value @ 48, num_edge_face_intersections @ 56, num_face_pairs @ 64, contour_length_m @ 72,
        num_inside @ 80, max_displacement_m @ 88, net_force_n @ 96, net_torque_nm @ 120, num_pairs @ 144,
        stage_ns @ 208, num_skipped_frames @ 272, num_pairs_left_out @ 280, length_left_out_m @ 288, num_values @ 296,
        num_labels @ 300, progress @ 304,
    });
    pin!(RepairHeader, "untangled.v1.RepairHeader", size 192, align 8, {
        frame @ 0, simulated_s @ 8, status @ 16, flags @ 20, num_vertices @ 24, num_moved @ 28, fault_index @ 32,
        fault_value @ 40, num_edge_face_intersections @ 48, num_crossings @ 56, num_pairs @ 64, contour_length_m @ 72,
        mean_displacement_m @ 80, max_displacement_m @ 88, min_edge_ratio @ 96, max_edge_ratio @ 104,
        min_area_ratio @ 112, num_iterations @ 120, waited_ns @ 128, repair_ns @ 136, num_replaced @ 144,
        num_inside_body @ 152, num_behind @ 160, reserved @ 168,
    });
    pin!(ViewHeader, "untangled.v1.ViewHeader", size 384, align 8, {
        correction @ 0, num_frames @ 320, sent_ns @ 328, num_paths @ 336, num_points @ 340, num_entries @ 344,
        num_positions @ 348, num_inside @ 352, num_depths @ 356, reserved @ 360,
    });
    pin!(PathsHeader, "untangled.v1.PathsHeader", size 64, align 8, {
        frame @ 0, num_paths @ 8, num_points @ 12, reserved @ 16,
    });
}

#[test]
fn elements_keep_layout_and_type_name() {
    pin!(PositionF32, "untangled.v1.PositionF32", size 12, align 4, {});
    pin!(PositionF64, "untangled.v1.PositionF64", size 24, align 8, {});
    pin!(VertexCorrection, "untangled.v1.VertexCorrection", size 16, align 4, { value @ 0, flags @ 12 });
}

#[test]
fn sparse_elements_keep_layout() {
    assert_eq!((size_of::<VertexEntry>(), align_of::<VertexEntry>()), (20, 4));
    assert_eq!([offset_of!(VertexEntry, vertex), offset_of!(VertexEntry, value)], [0, 4]);
    assert_eq!(offset_of!(VertexEntry, flags), 16);
    assert_eq!((size_of::<VertexLabel>(), align_of::<VertexLabel>()), (8, 4));
    assert_eq!([offset_of!(VertexLabel, vertex), offset_of!(VertexLabel, label)], [0, 4]);
    let entry = VertexEntry { vertex: 7, value: [1.0, -2.0, 0.5], flags: 3 };
    assert_eq!(entry.to_words(), [7, 0x3f80_0000, 0xc000_0000, 0x3f00_0000, 3]);
}

#[test]
fn options_keep_their_bits_and_unknown_bits_are_none() {
    let all = [SessionOptions::SPARSE, SessionOptions::LABELS, SessionOptions::REPAIR, SessionOptions::WELD];
    assert_eq!(all.map(SessionOptions::bits), [1, 2, 4, 8]);
    for bits in 0..16 {
        let options = SessionOptions::from_bits(bits).unwrap();
        assert_eq!((options.bits(), options.is_sparse(), options.has_labels()), (bits, bits & 3 != 0, bits & 2 != 0));
        assert_eq!(options.has_repairs(), bits & 4 != 0);
    }
    for unknown in [16, 1 << 31, 17] {
        assert_eq!(SessionOptions::from_bits(unknown), None, "{unknown}");
    }
}

#[test]
fn params_and_paths_encode_little_endian() {
    let params = RegisterParams { num_vertices: 0x0102, precision: 1, correction: 2, reserved: [0; 2] };
    let bytes = params.to_bytes();
    assert_eq!(bytes[..16], [2, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]);
    assert_eq!(RegisterParams::from_bytes(&bytes), Some(params));
    assert_eq!(RegisterParams::from_bytes(&bytes[..31]), None);
    let record = PathRecord {
        pair: 1,
        pair_type: 2,
        path_type: 3,
        partner: 4,
        closed: 5,
        first_point: 6,
        num_points: 7,
        state: 8,
    };
    let words: Vec<u8> = record.to_bytes().chunks(4).map(|word| word[0]).collect();
    assert_eq!(words, [1, 2, 3, 4, 5, 6, 7, 8]);
    let point = PathPoint { position_m: [1.0, -2.0, 0.5], faces: [9, 8] }.to_bytes();
    assert_eq!(point[8..16], (-2.0f64).to_le_bytes());
    assert_eq!(point[24..], [9, 0, 0, 0, 8, 0, 0, 0]);
}

#[test]
fn codes_keep_their_numbers() {
    assert_eq!([flags::INSIDE, flags::NEAR_PATH, flags::CLAMPED, flags::PINNED], [1, 2, 4, 8]);
    assert_eq!(pair_type::NAMES[pair_type::BI_BI], "BI/BI");
    for code in 0..=12 {
        assert_eq!(Status::from_code(code).unwrap().code(), code);
    }
    assert_eq!(Status::from_code(13), None);
    let kinds = [
        RequestKind::Hello,
        RequestKind::Register,
        RequestKind::UpdateSettings,
        RequestKind::Close,
        RequestKind::Status,
        RequestKind::Observe,
    ];
    assert_eq!(kinds.map(|kind| kind as u32), [1, 2, 3, 4, 5, 6]);
    assert_eq!([Precision::F32 as u32, Precision::F64 as u32], [0, 1]);
    let kinds = [
        CorrectionKind::Force,
        CorrectionKind::Acceleration,
        CorrectionKind::VelocityChange,
        CorrectionKind::Displacement,
    ];
    assert_eq!(kinds.map(|kind| kind as u32), [0, 1, 2, 3]);
}
