//! Sessions whose cloth is in layers, each of which belongs outside of those further in.

use std::time::Duration;

use untangled_checker::{vertices_behind_layers, vertices_inside};
use untangled_client::{Precision, Registration, Repair, Session};
use untangled_testkit::{
    generate::{
        Sheet,
        outfits::{Outfit, Pose},
    },
    process::{Daemon, STEP, TestDomain},
};

use super::cloth::Tangle;

/// Long enough on any machine.
const LONG: Duration = Duration::from_secs(600);

/// Two layers that nothing intersects; their faces point outwards.
struct Layered {
    all: Tangle,
    numbers: Vec<u32>,
}

impl Layered {
    /// Two tubes round each other, the first of the inner layer.
    fn tubes(inner: f64, outer: f64) -> Self {
        let mut sheet = Sheet::default();
        sheet.add_tube(inner, [-0.3, 0.3], [28, 14], |_, _| [0.0; 3]);
        let num_inner = sheet.positions.len();
        sheet.add_tube(outer, [-0.28, 0.32], [31, 14], |_, _| [0.0; 3]);
        Self::of(sheet, num_inner)
    }

    /// Two square sheets over each other, rolled up by an angle so that the outer one comes to lie within.
    fn rolled(turn: f64) -> Self {
        let mut sheet = Sheet::default();
        for height in [0.0, 0.05] {
            sheet.add_grid([0.0, 1.0], [0.0, 1.0], [12; 2], |u, v| {
                let (angle, radius) = (turn * (u - 0.5), 1.0 / turn - height);
                [radius * angle.sin(), v, 1.0 / turn - radius * angle.cos()]
            });
        }
        let num_inner = sheet.positions.len() / 2;
        Self::of(sheet, num_inner)
    }

    fn of(sheet: Sheet, num_inner: usize) -> Self {
        let numbers = (0..sheet.positions.len()).map(|vertex| u32::from(vertex >= num_inner)).collect();
        let all = Tangle { positions: sheet.positions, triangles: sheet.faces, pins: Vec::new() };
        assert_eq!(all.num_crossings(&all.positions), 0);
        Self { all, numbers }
    }

    fn registration(&self, precision: Precision) -> Registration {
        Registration { layers: Some(self.numbers.clone()), ..self.all.registration(precision) }
    }

    fn repair(&self, session: &mut Session, precision: Precision) -> Repair {
        match precision {
            Precision::F32 => session.repair(STEP, LONG, |slots| slots.copy_from_slice(&self.all.positions_f32())),
            Precision::F64 => session.repair_f64(STEP, LONG, |slots| slots.copy_from_slice(&self.all.positions)),
        }
        .unwrap()
    }

    /// Vertices behind the inner layer, by the judge.
    fn num_behind(&self, positions: &[[f64; 3]]) -> u64 {
        let are_outwards = vec![true; self.all.triangles.len()];
        vertices_behind_layers(positions, &self.all.triangles, &self.numbers, &are_outwards).unwrap().len() as u64
    }
}

#[test]
fn repair_of_layers_in_the_wrong_order_that_nothing_intersects_is_certified_in_order_only() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let client = domain.connect();
    let swapped = Layered::tubes(0.35, 0.31);
    let num_vertices = u32::try_from(swapped.numbers.len()).unwrap();
    assert!(swapped.num_behind(&swapped.all.positions) > 300);
    for precision in [Precision::F32, Precision::F64] {
        let mut session = client.register(swapped.registration(precision)).unwrap();
        let repair = swapped.repair(&mut session, precision);
        let header = *repair.header();
        assert!(repair.is_certified() && header.num_moved > 0 && header.num_behind == 0, "{header:?}");
        let repaired = swapped.all.repaired(&repair);
        assert_eq!((swapped.num_behind(&repaired), swapped.all.num_crossings(&repaired)), (0, 0));
        drop(repair);
        // As it is sent, it has no certificate: where everything is held, that is what the repair leads to.
        let held = Registration { pins: (0..num_vertices).collect(), ..swapped.registration(precision) };
        let mut session = client.register(held).unwrap();
        let repair = swapped.repair(&mut session, precision);
        let header = *repair.header();
        assert!(!repair.is_certified() && header.num_moved == 0, "{header:?}");
        assert_eq!((header.num_edge_face_intersections, header.num_crossings), (0, 0));
        assert_eq!(header.num_behind, swapped.num_behind(&swapped.all.positions));
        drop(repair);
        // In order it is certified as it is.
        let ordered = Layered::tubes(0.31, 0.35);
        let mut session = client.register(ordered.registration(precision)).unwrap();
        let repair = ordered.repair(&mut session, precision);
        assert!(repair.is_certified() && repair.header().num_moved == 0, "{:?}", repair.header());
        // Cloth that is in no layers has no order.
        let mut session = client.register(swapped.all.registration(precision)).unwrap();
        let repair = swapped.repair(&mut session, precision);
        assert!(repair.is_certified() && repair.header().num_moved == 0, "{:?}", repair.header());
    }
}

#[test]
fn rest_positions_decide_what_is_outwards_for_all_frames_and_else_each_frame_does() {
    let (rest, rolled) = (Layered::rolled(0.1), Layered::rolled(3.5));
    let precision = Precision::F64;
    let by_rest = Registration { rest_positions: Some(rest.all.positions.clone()), ..rolled.registration(precision) };
    let mut answers = Vec::new();
    for has_history in [false, true] {
        // Another daemon, as after a restart.
        let domain = TestDomain::new();
        let _daemon = Daemon::start(&domain);
        let client = domain.connect();
        let mut session = client.register(by_rest.clone()).unwrap();
        let repair = rolled.repair(&mut session, precision);
        assert!(repair.is_certified() && repair.header().num_moved == 0, "{:?}", repair.header());
        drop(repair);
        // Without rest positions the inner sheet winds round the outer one, and that is what is seen.
        let mut session = client.register(rolled.registration(precision)).unwrap();
        if has_history {
            assert_eq!(rest.repair(&mut session, precision).header().num_moved, 0);
        }
        let repair = rolled.repair(&mut session, precision);
        assert!(repair.header().num_moved > 0 || !repair.is_certified(), "{:?}", repair.header());
        answers.push((repair.header().flags, repair.displacements_f64().unwrap().to_vec()));
    }
    assert!(answers[0] == answers[1], "a frame hangs on the one before");
}

#[test]
fn repairs_of_an_outfit_on_a_body_that_moves_are_certified_from_a_tangled_first_frame_on() {
    let domain = TestDomain::new();
    let _daemon = Daemon::start(&domain);
    let client = domain.connect();
    // Arms and legs of the body go apart, and carry the cloth.
    let pose = |frame: u32| {
        let turn = 0.02 * f64::from(frame);
        Pose { arms: [0.8 + turn, 0.6 + turn], legs: [0.1 + turn, turn] }
    };
    let (world, start) = Outfit::new(pose(0), 20).world();
    let cloth = 0..world.body[0];
    let is_cloth = |corners: &&[u32; 3]| corners.iter().all(|corner| cloth.contains(corner));
    let garments: Vec<[u32; 3]> = world.faces.iter().filter(is_cloth).copied().collect();
    let body = &world.faces[garments.len()..];
    let numbers = world.layers.clone().unwrap();
    let are_outwards = vec![true; garments.len()];
    let wrong = |positions: &[[f64; 3]]| {
        let num_behind = vertices_behind_layers(positions, &garments, &numbers, &are_outwards).unwrap().len();
        (num_behind, vertices_inside(positions, cloth.clone(), body).unwrap().len())
    };
    let registration = Registration {
        num_vertices: world.num_vertices,
        triangles: world.faces.clone(),
        layers: world.layers.clone(),
        body: world.body.clone(),
        precision: Precision::F64,
        repairs: true,
        ..Registration::default()
    };
    let mut session = client.register(registration).unwrap();
    let (mut positions, mut carried) = (start.clone(), start.clone());
    assert!(wrong(&start).0 > 20);
    for frame in 0..4 {
        let next = Outfit::cut_for(pose(0), pose(frame), 20).world().1;
        for (at, (from, to)) in positions.iter_mut().zip(carried.iter().zip(&next)) {
            *at = std::array::from_fn(|k| at[k] + (to[k] - from[k]));
        }
        carried = next;
        let repair = session.repair_f64(STEP, LONG, |slots| slots.copy_from_slice(&positions)).unwrap();
        assert!(repair.is_certified(), "{frame}: {:?}", repair.header());
        for (at, step) in positions.iter_mut().zip(repair.displacements_f64().unwrap()) {
            *at = std::array::from_fn(|k| at[k] + step[k]);
        }
        drop(repair);
        assert_eq!(wrong(&positions), (0, 0), "{frame}");
    }
}
