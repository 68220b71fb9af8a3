//! Proofs in double arithmetic against exact signs, where the signs are close.

use super::{narrow::Fan, narrow::contact, rings::Rings, separate::are_apart, umbrella::Umbrella};
use crate::{
    frame::Frame,
    mesh::{FaceId, Mesh, MeshDescription},
};

/// Numbers on a coarse grid, some of them off it by very little, so that much is degenerate or nearly so.
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, limit: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % limit
    }

    #[allow(clippy::cast_precision_loss, reason = "small numbers")]
    fn coordinate(&mut self) -> f64 {
        let on_grid = 0.1 * self.below(6) as f64;
        if self.below(3) == 0 { on_grid * (1.0 + f64::EPSILON * self.below(4) as f64) } else { on_grid }
    }

    fn point(&mut self) -> [f64; 3] {
        std::array::from_fn(|_| self.coordinate())
    }
}

#[test]
fn triangles_proven_apart_do_not_intersect() {
    let faces = vec![[0, 1, 2], [3, 4, 5]];
    let mesh = Mesh::new(MeshDescription { num_vertices: 6, faces, ..Default::default() }).unwrap();
    let mut numbers = Numbers(1);
    let mut counts = [0; 3];
    for _ in 0..50_000 {
        let positions: Vec<_> = (0..6).map(|_| numbers.point()).collect();
        let frame = Frame::new(&mesh, &positions).unwrap();
        let (a, b) = ([0, 1, 2].map(|k| positions[k]), [3, 4, 5].map(|k| positions[k]));
        let meets = contact(&mesh, &frame, [FaceId(0), FaceId(1)]).is_some();
        let is_proven = are_apart(&a, &b);
        assert!(!(meets && is_proven), "{positions:?}");
        counts[if meets { 0 } else { 1 + usize::from(is_proven) }] += 1;
    }
    // Or nothing was proven, or all was easy.
    assert!(counts.iter().all(|&count| count > 2_000), "{counts:?}");
}

#[test]
fn open_umbrellas_hold_no_crossing() {
    let mut counts = [0; 3];
    let mut numbers = Numbers(2);
    for (num_spokes, closes) in
        [(4, true), (5, true), (6, true), (7, true), (9, true), (4, false), (6, false), (8, false)]
    {
        let mut faces: Vec<[u32; 3]> = (1..num_spokes).map(|k| [0, k, k + 1]).collect();
        if closes {
            faces.push([0, num_spokes, 1]);
        }
        let num_vertices = num_spokes as usize + 1;
        let mesh = Mesh::new(MeshDescription { num_vertices, faces, ..Default::default() }).unwrap();
        let all: Vec<FaceId> = mesh.face_ids().collect();
        let rings = Rings::new(&mesh, &all);
        assert_eq!(rings.len(), 1);
        assert_eq!(rings.get(0).around.len(), num_vertices - usize::from(!closes));
        let (mut umbrella, mut fan) = (Umbrella::default(), Fan::default());
        for turns in [1.0, 1.0, 1.0, 2.0, 0.7] {
            for _ in 0..1_000 {
                // Round the centre, off by so much that some fold over; or on a grid.
                let positions: Vec<[f64; 3]> = (0..num_vertices)
                    .map(|k| {
                        if k == 0 || turns < 1.0 {
                            return numbers.point();
                        }
                        #[allow(clippy::cast_precision_loss, reason = "small numbers")]
                        let angle = std::f64::consts::TAU * turns * k as f64 / f64::from(num_spokes);
                        let [x, y, z] = numbers.point();
                        [0.25 + 0.4 * angle.cos() + 0.6 * x, 0.25 + 0.4 * angle.sin() + 0.6 * y, z]
                    })
                    .collect();
                let frame = Frame::new(&mesh, &positions).unwrap();
                let is_open = umbrella.room_m(&frame, rings.get(0)) > 0.0;
                let mut meets = false;
                fan.contacts(&mesh, &frame, rings.get(0).centre, &mut |_, _| meets = true);
                assert!(!(meets && is_open), "{num_spokes} spokes: {positions:?}");
                counts[if meets { 0 } else { 1 + usize::from(is_open) }] += 1;
            }
        }
    }
    assert!(counts.iter().all(|&count| count > 2_000), "{counts:?}");
}
