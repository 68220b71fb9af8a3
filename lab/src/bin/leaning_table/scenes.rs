//! Tangled cloth that other cloth leans on: towels, skirts, piles, layers over a line.

use std::f64::consts::PI;

use untangled_lab::gallery::{self, Gallery, bump, pinned, tube};
use untangled_publisher::{
    mesh::Vec3,
    scenes::{Pin, Sheet},
};

/// Distance of layers that lie on each other, in metres: more than the contact of the solver keeps.
const GAP_M: f64 = 0.012;

/// A scene, by the length of its edges in metres.
type Scene = fn(f64) -> Gallery;

/// The scenes by name.
pub(crate) const SCENES: [(&str, Scene); 9] = [
    ("towels: a bump through the next towel", |edge_m| towels(edge_m, 1.5)),
    ("towels: a bump through the next two", |edge_m| towels(edge_m, 3.4)),
    ("skirts on a body: a dent", |edge_m| skirts(edge_m, false)),
    ("skirts on a body: hems have changed places", |edge_m| skirts(edge_m, true)),
    ("pile on the ground", pile),
    ("two towels over a line: a corner through the rear layer", |edge_m| line(edge_m, false)),
    ("two towels over a line: a bump", |edge_m| line(edge_m, true)),
    ("three level sheets: a corner through the lowest", corner),
    ("a curtain through a level sheet", curtain),
];

/// A place on a layer that is folded at `x = 0` and runs back above itself: `u` from the middle of the fold.
fn folded(u: f64, radius_m: f64) -> [f64; 2] {
    let quarter = 0.5 * PI * radius_m;
    if u.abs() < quarter {
        let angle = u / radius_m;
        [-radius_m * angle.cos(), radius_m * (1.0 + angle.sin())]
    } else {
        [u.abs() - quarter, radius_m * (1.0 + u.signum())]
    }
}

/// Three towels, folded in half, on each other and on the ground. The upper layer of the lowest one has a bump of so
/// many gaps.
fn towels(edge_m: f64, gaps: f64) -> Gallery {
    let mut gallery = Gallery::default();
    gallery.add_ground(0.6, edge_m);
    for number in 0..3_u8 {
        let base = GAP_M * (0.8 + 2.0 * f64::from(number));
        let place = move |u: f64, v: f64| {
            let [x, z] = folded(u - 0.2, 0.5 * GAP_M);
            let height =
                if number == 0 && u > 0.2 { gaps * GAP_M * bump((x - 0.11).hypot(v - 0.08), 0.07) } else { 0.0 };
            let shift = 0.004 * f64::from(number);
            Vec3::new(x - 0.1 + shift, v - 0.1 + 0.7 * shift, base + z + height)
        };
        gallery.add(Sheet::new(0.4, 0.2, edge_m).build(7 + u64::from(number), place));
    }
    gallery
}

/// Two skirts over each other on a body with hips: the outer one is dented through the inner one where that lies on
/// the body, or both have changed places along a part of their hems.
fn skirts(edge_m: f64, at_hem: bool) -> Gallery {
    gallery::skirts(edge_m, GAP_M, |layer, angle, z| match (layer, at_hem) {
        (2, false) => 1.2 * GAP_M * bump((0.2 * (angle - 1.0)).hypot(z - 0.33), 0.06),
        (2, true) => 2.2 * GAP_M * bump((0.2 * (angle - 1.0)).hypot(z - 0.12), 0.08),
        _ => 0.0,
    })
}

/// Five sheets on the ground, turned and wavy, of which two are dented through the one below.
fn pile(edge_m: f64) -> Gallery {
    let mut gallery = Gallery::default();
    gallery.add_ground(0.8, edge_m);
    for number in 0..5_u8 {
        let (sine, cosine) = (0.7 * f64::from(number)).sin_cos();
        let base = GAP_M * (1.2 + f64::from(number));
        let dent = if number == 2 || number == 4 { 1.6 * GAP_M } else { 0.0 };
        let place = move |u: f64, v: f64| {
            let (u, v) = (u - 0.15, v - 0.12);
            let (x, y) = (cosine * u - sine * v, sine * u + cosine * v);
            let wave = 0.2 * GAP_M * (25.0 * x).sin() * (21.0 * y).cos();
            let at = 0.02 * f64::from(number);
            Vec3::new(x, y, base + wave - dent * bump((x - at).hypot(y + at), 0.06))
        };
        gallery.add(Sheet::new(0.3, 0.24, edge_m).build(31 + u64::from(number), place));
    }
    gallery
}

/// Two towels over each other over a rod. The front layer of the inner one goes through its own rear layer, with a
/// corner or with a bump.
fn line(edge_m: f64, with_bump: bool) -> Gallery {
    let rod_m = 0.012;
    let mut gallery = Gallery::default();
    let mut rod = tube([0.2, -0.2], edge_m, |_, _| rod_m);
    for position in &mut rod.positions {
        *position = Vec3::new(position.x, position.z, position.y);
    }
    gallery.add(pinned(rod));
    for number in 0..2_u8 {
        let radius_m = rod_m + 0.8 * GAP_M * f64::from(number + 1);
        let place = move |u: f64, v: f64| {
            let u = u - 0.25;
            let quarter = 0.5 * PI * radius_m;
            if u.abs() < quarter {
                let angle = u / radius_m;
                return Vec3::new(radius_m * angle.sin(), v - 0.15, radius_m * angle.cos());
            }
            let down = u.abs() - quarter;
            // Of the inner towel the front layer passes through the rear one, but not through the outer towel.
            let depth = match (number, u > 0.0, with_bump) {
                (0, true, true) => (2.0 * radius_m + 0.4 * GAP_M) * bump((down - 0.12).hypot(v - 0.15), 0.08),
                (0, true, false) => {
                    (2.0 * radius_m + 0.4 * GAP_M) * (((down - 0.08) + (v - 0.2)) / 0.1).clamp(0.0, 1.0)
                }
                _ => 0.0,
            };
            Vec3::new(u.signum() * radius_m - depth, v - 0.15, -down)
        };
        gallery.add(Sheet::new(0.5, 0.3, edge_m).build(51 + u64::from(number), place));
    }
    gallery
}

/// A level sheet that is held at its boundary, and two that lie on it. A corner of the lower one of these is bent down
/// through it.
fn corner(edge_m: f64) -> Gallery {
    let mut gallery = Gallery::default();
    gallery.add(Sheet::new(0.5, 0.5, edge_m).pinned(Pin::Boundary).build(71, |u, v| Vec3::new(u, v, 0.0)));
    for number in 1..=2_u8 {
        let height = GAP_M * f64::from(number);
        let depth = if number == 1 { 0.08 } else { 0.0 };
        let place = move |u: f64, v: f64| {
            let bent = ((u + v - 0.42) / 0.15).clamp(0.0, 1.0);
            Vec3::new(u + 0.1, v + 0.103, height - depth * bent * bent)
        };
        gallery.add(Sheet::new(0.3, 0.3, edge_m).build(71 + u64::from(number), place));
    }
    gallery
}

/// A level sheet that is held at its boundary, with another that lies on it, and a curtain that hangs through it.
fn curtain(edge_m: f64) -> Gallery {
    let mut gallery = Gallery::default();
    gallery.add(Sheet::new(0.5, 0.5, edge_m).pinned(Pin::Boundary).build(81, |u, v| Vec3::new(u, v, 0.0)));
    gallery.add(Sheet::new(0.2, 0.4, edge_m).build(82, |u, v| Vec3::new(u + 0.02, v + 0.05, GAP_M)));
    let hang = |u: f64, v: f64| Vec3::new(0.3 + 0.01 * (20.0 * u).sin(), u + 0.1, 0.2 - v);
    let mut hanging = Sheet::new(0.3, 0.28, edge_m).build(83, hang);
    hanging.pins = (0..).zip(&hanging.positions).filter(|(_, at)| at.z > 0.1999).map(|(vertex, _)| vertex).collect();
    gallery.add(hanging);
    gallery
}

#[cfg(test)]
mod tests {
    use untangled_checker::count_edge_face;

    use super::*;

    #[test]
    fn scenes_of_the_gallery_are_tangled() {
        for (name, build) in SCENES {
            let Gallery { cloth, piece } = build(0.025);
            assert_eq!(cloth.positions.len(), piece.len());
            let count = count_edge_face(&cloth.points(), &cloth.triangles).unwrap();
            println!("{name}: {} triangles, {count}", cloth.triangles.len());
            assert!((4..1000).contains(&count), "{name}: {count}");
        }
    }
}
