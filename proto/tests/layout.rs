//! Pins size, alignment, offsets and type names of everything on the wire: a change here is a new protocol version.

use std::mem::{align_of, offset_of, size_of};

use iceoryx2_bb_elementary_traits::zero_copy_send::ZeroCopySend;
use untangled_proto::{
    CorrectionHeader, CorrectionKind, PositionF32, PositionF64, Precision, RegisterParams, ReplyHeader, RequestHeader,
    RequestKind, StateHeader, Status, VertexCorrection, flags, pair_type,
    paths::{PathPoint, PathRecord, PathsHeader},
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
        protocol_version @ 0, status @ 4, instance @ 8, session @ 16, token @ 24, reserved @ 40,
    });
    pin!(StateHeader, "untangled.v1.StateHeader", size 64, align 8, {
        frame @ 0, simulated_s @ 8, dt_s @ 16, num_vertices @ 24, flags @ 28, reserved @ 32,
    });
    pin!(CorrectionHeader, "untangled.v1.CorrectionHeader", size 320, align 8, {
        frame @ 0, simulated_s @ 8, dt_s @ 16, status @ 24, kind @ 28, flags @ 32, num_vertices @ 36, fault_index @ 40,
        fault_value @ 48, num_edge_face_intersections @ 56, num_face_pairs @ 64, contour_length_m @ 72,
        num_inside @ 80, max_displacement_m @ 88, net_force_n @ 96, net_torque_nm @ 120, num_pairs @ 144,
        stage_ns @ 208, num_skipped_frames @ 272, num_pairs_left_out @ 280, length_left_out_m @ 288, reserved @ 296,
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
        reserved: 0,
    };
    let words: Vec<u8> = record.to_bytes().chunks(4).map(|word| word[0]).collect();
    assert_eq!(words, [1, 2, 3, 4, 5, 6, 7, 0]);
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
    ];
    assert_eq!(kinds.map(|kind| kind as u32), [1, 2, 3, 4, 5]);
    assert_eq!([Precision::F32 as u32, Precision::F64 as u32], [0, 1]);
    let kinds = [
        CorrectionKind::Force,
        CorrectionKind::Acceleration,
        CorrectionKind::VelocityChange,
        CorrectionKind::Displacement,
    ];
    assert_eq!(kinds.map(|kind| kind as u32), [0, 1, 2, 3]);
}
