//! Proofs in plain arithmetic against exact signs, where the signs are close.

use super::{
    boxes::WIDTH,
    broad::FaceTree,
    lanes::{Lanes, Portable, Task, dispatch},
    narrow::{Fan, contact},
    rings::Rings,
    separate::{are_apart, are_eight_apart},
    umbrella::Umbrella,
    umbrellas::are_open,
};
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

/// What a proof for eight at a time says, by all means that there are.
fn of_eight(proof: &dyn Fn(&dyn AnyLanes) -> u32) -> u32 {
    struct Run<'a>(&'a dyn Fn(&dyn AnyLanes) -> u32, &'a mut u32);
    impl Task for Run<'_> {
        fn run<L: Lanes>(self, lanes: L) {
            *self.1 = (self.0)(&lanes);
        }
    }
    let mut best = 0;
    dispatch(Run(proof, &mut best));
    assert_eq!(proof(&Portable), best);
    best
}

/// The proofs, by means that are not named.
trait AnyLanes {
    fn apart(&self, tree: &FaceTree, corners: &[[[u32; WIDTH]; 3]; 2]) -> u32;
    fn open(&self, tree: &FaceTree, eight: usize) -> u32;
}

impl<L: Lanes> AnyLanes for L {
    fn apart(&self, tree: &FaceTree, corners: &[[[u32; WIDTH]; 3]; 2]) -> u32 {
        are_eight_apart(self.eight(), tree.mapped(), corners, 0)
    }

    fn open(&self, tree: &FaceTree, eight: usize) -> u32 {
        are_open(self.eight(), tree.mapped(), &tree.rings().eight(eight))
    }
}

#[test]
fn mapped_triangles_proven_apart_do_not_intersect() {
    let faces: Vec<_> = (0..16).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]).collect();
    let mesh = Mesh::new(MeshDescription { num_vertices: 48, faces, ..Default::default() }).unwrap();
    let mut numbers = Numbers(3);
    let mut tree = FaceTree::default();
    let corners: [[[u32; WIDTH]; 3]; 2] = std::array::from_fn(|triangle| {
        std::array::from_fn(|corner| {
            std::array::from_fn(|pair| u32::try_from(3 * (2 * pair + triangle) + corner).unwrap())
        })
    });
    let mut counts = [0; 3];
    for round in 0..6_000 {
        // Where gaps are small beside the whole, single precision sees little of them.
        let size = [1.0, 1e-3, 1e-6][round % 3];
        let positions: Vec<[f64; 3]> =
            (0..48).map(|k| numbers.point().map(|x| if k == 0 { x } else { 1.0 + size * x })).collect();
        let frame = Frame::new(&mesh, &positions).unwrap();
        tree.prepare(&mesh, &frame);
        tree.fit(&frame);
        let apart = of_eight(&|lanes| lanes.apart(&tree, &corners));
        for pair in 0..8 {
            let faces = [2 * pair, 2 * pair + 1];
            let meets = contact(&mesh, &frame, faces.map(FaceId)).is_some();
            let is_proven = apart >> pair & 1 == 1;
            assert!(!(meets && is_proven), "{faces:?} {positions:?}");
            counts[if meets { 0 } else { 1 + usize::from(is_proven) }] += 1;
        }
    }
    assert!(counts.iter().all(|&count| count > 2_000), "{counts:?}");
}

#[test]
fn open_umbrellas_hold_no_crossing() {
    // Not proven or not there, proven in double precision, proven in single.
    let mut counts = [0; 4];
    let mut numbers = Numbers(2);
    for (num_spokes, closes) in
        [(4, true), (5, true), (6, true), (7, true), (9, true), (4, false), (6, false), (8, false)]
    {
        let num_vertices = num_spokes + 1;
        let mut faces = Vec::new();
        for centre in (0..8).map(|fan| fan * num_vertices) {
            faces.extend((1..num_spokes).map(|k| [centre, centre + k, centre + k + 1]));
            if closes {
                faces.push([centre, centre + num_spokes, centre + 1]);
            }
        }
        let mesh = Mesh::new(MeshDescription { num_vertices: 8 * num_vertices as usize, faces, ..Default::default() })
            .unwrap();
        let mut tree = FaceTree::default();
        let mut fans = |turns: f64| -> Vec<[f64; 3]> {
            (0..8 * num_vertices)
                .map(|k| {
                    let k = k % num_vertices;
                    if k == 0 || turns < 1.0 {
                        return numbers.point();
                    }
                    // Round the centre, off by so much that some fold over; or on a grid.
                    let angle = std::f64::consts::TAU * turns * f64::from(k) / f64::from(num_spokes);
                    let [x, y, z] = numbers.point();
                    [0.25 + 0.4 * angle.cos() + 0.6 * x, 0.25 + 0.4 * angle.sin() + 0.6 * y, z]
                })
                .collect()
        };
        for turns in [1.0, 1.0, 1.0, 2.0, 0.7] {
            for round in 0..300 {
                let mut positions = fans(turns);
                for position in &mut positions[1..] {
                    *position = position.map(|x| 1.0 + [1.0, 1e-6][round % 2] * x);
                }
                let frame = Frame::new(&mesh, &positions).unwrap();
                tree.prepare(&mesh, &frame);
                tree.fit(&frame);
                assert_eq!((tree.rings().len(), tree.rings().num_eights()), (8, usize::from(closes)));
                let open = if closes { of_eight(&|lanes| lanes.open(&tree, 0)) } else { 0 };
                let (mut umbrella, mut fan) = (Umbrella::default(), Fan::default());
                for number in 0..8 {
                    let ring = tree.rings().get(number);
                    assert_eq!(ring.around.len(), num_vertices as usize - usize::from(!closes));
                    let is_open = umbrella.room_m(&frame, ring) > 0.0;
                    let lane = |eight| tree.rings().eight(eight).numbers.iter().position(|&of| of as usize == number);
                    let is_open_in_single = closes && open >> lane(0).unwrap() & 1 == 1;
                    let mut meets = false;
                    fan.contacts(&mesh, &frame, ring.centre, &mut |_, _| meets = true);
                    assert!(!(meets && (is_open || is_open_in_single)), "{num_spokes} spokes, {number}: {positions:?}");
                    counts[if meets { 0 } else { 1 + usize::from(is_open) }] += 1;
                    counts[3] += usize::from(is_open_in_single);
                }
            }
        }
    }
    assert!(counts.iter().all(|&count| count > 2_000), "{counts:?}");
}

#[test]
fn every_ring_is_in_one_eight_or_among_the_others() {
    let sheet = crate::correspond::samples::sheet(20, 20, 0.1).0;
    let all: Vec<FaceId> = sheet.face_ids().collect();
    let rings = Rings::new(&sheet, &all);
    let mut numbers: Vec<u32> = rings.others().to_vec();
    for eight in 0..rings.num_eights() {
        let eight = rings.eight(eight);
        for (lane, &number) in eight.numbers.iter().enumerate() {
            let ring = rings.get(number as usize);
            assert_eq!(eight.centres[lane], ring.centre.0);
            let around: Vec<u32> = eight.around.iter().map(|row| row[lane]).collect();
            let expected: Vec<u32> = ring.around.iter().map(|vertex| vertex.0).collect();
            assert_eq!((&around[..], around[0]), expected.split_last().map(|(last, rest)| (rest, *last)).unwrap());
            numbers.push(number);
        }
    }
    numbers.sort_unstable();
    assert_eq!(numbers, (0..u32::try_from(rings.len()).unwrap()).collect::<Vec<_>>());
    assert!(rings.num_eights() > 40, "{}", rings.num_eights());
}
