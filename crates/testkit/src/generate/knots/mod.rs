//! Knots: closed tubes along knotted curves, thicker than the strands of the curve leave room for.

use nalgebra::{Rotation3, Unit, Vector3};

/// A closed curve in space, by its name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Knot {
    /// Winds so often around the axis of a torus and so often around its core; both have no common divisor.
    Torus(f64, f64),
    /// The knot of four crossings.
    FigureEight,
}

/// Ten knots with names.
pub const KNOTS: [(&str, Knot); 10] = [
    ("trefoil", Knot::Torus(2.0, 3.0)),
    ("cinquefoil", Knot::Torus(2.0, 5.0)),
    ("septafoil", Knot::Torus(2.0, 7.0)),
    ("nonafoil", Knot::Torus(2.0, 9.0)),
    ("torus_2_11", Knot::Torus(2.0, 11.0)),
    ("torus_3_4", Knot::Torus(3.0, 4.0)),
    ("torus_3_5", Knot::Torus(3.0, 5.0)),
    ("torus_3_7", Knot::Torus(3.0, 7.0)),
    ("torus_4_5", Knot::Torus(4.0, 5.0)),
    ("figure_eight", Knot::FigureEight),
];

/// Points along the curve at which its own nearness is looked for.
const NUM_SAMPLES: usize = 900;

impl Knot {
    /// The point at a parameter that runs from 0 to 1.
    fn at(self, t: f64) -> Vector3<f64> {
        let angle = std::f64::consts::TAU * t;
        match self {
            Self::Torus(p, q) => {
                let radius = 2.0 + (q * angle).cos();
                Vector3::new(radius * (p * angle).cos(), radius * (p * angle).sin(), -(q * angle).sin())
            }
            Self::FigureEight => {
                let radius = 2.0 + (2.0 * angle).cos();
                Vector3::new(radius * (3.0 * angle).cos(), radius * (3.0 * angle).sin(), (4.0 * angle).sin())
            }
        }
    }

    /// The curve's length, and the least distance of two of its strands.
    fn length_and_room(self) -> (f64, f64) {
        #[expect(clippy::cast_precision_loss, reason = "a small number")]
        let points: Vec<_> = (0..NUM_SAMPLES).map(|k| self.at(k as f64 / NUM_SAMPLES as f64)).collect();
        let steps = (0..NUM_SAMPLES).map(|k| (points[(k + 1) % NUM_SAMPLES] - points[k]).norm());
        let mut arcs = vec![0.0];
        arcs.extend(steps.scan(0.0, |sum, step| {
            *sum += step;
            Some(*sum)
        }));
        let length = arcs[NUM_SAMPLES];
        let mut room = f64::INFINITY;
        for a in 0..NUM_SAMPLES {
            for b in 0..a {
                let arc = (arcs[a] - arcs[b]).min(length - arcs[a] + arcs[b]);
                let distance = (points[a] - points[b]).norm();
                // Points of one strand are as far from each other along it as through space.
                if distance < 0.4 * arc {
                    room = room.min(distance);
                }
            }
        }
        (length, room)
    }

    /// A tube of `around` vertices in each ring, whose diameter is `1 + overlap` times the room between the strands.
    /// The faces are about as long as wide.
    pub fn tube(self, around: u32, overlap: f64) -> (Vec<[u32; 3]>, Vec<[f64; 3]>) {
        let (length, room) = self.length_and_room();
        let radius = 0.5 * room * (1.0 + overlap);
        let side = std::f64::consts::TAU * radius / f64::from(around);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small positive number")]
        let rings = (length / side).round() as u32;
        let frames = self.frames(rings);
        let mut positions = Vec::new();
        for (centre, normal, binormal) in frames {
            for k in 0..around {
                let angle = std::f64::consts::TAU * f64::from(k) / f64::from(around);
                positions.push((centre + radius * (angle.cos() * normal + angle.sin() * binormal)).into());
            }
        }
        (quads(rings, around), positions)
    }

    /// Centre and two directions across the curve at each ring, turned evenly so that the last fits to the first.
    fn frames(self, rings: u32) -> Vec<(Vector3<f64>, Vector3<f64>, Vector3<f64>)> {
        let parameter = |ring: u32| f64::from(ring) / f64::from(rings);
        let tangent = |t: f64| Unit::new_normalize(self.at(t + 1e-5) - self.at(t - 1e-5));
        let first = tangent(0.0);
        let mut normal = first.cross(&Vector3::new(0.3, 0.5, 0.8)).normalize();
        let start = normal;
        let mut normals = Vec::new();
        for ring in 0..rings {
            normals.push(normal);
            let [now, next] = [parameter(ring), parameter(ring + 1)].map(tangent);
            let turn = Rotation3::rotation_between(&now, &next).unwrap_or_else(Rotation3::identity);
            normal = (turn * normal).normalize();
        }
        // Carried once around, the direction has turned by this.
        let twist = normal.cross(&start).dot(&first).atan2(normal.dot(&start));
        let turned = normals.into_iter().zip(0..).map(|(normal, ring)| {
            let tangent = tangent(parameter(ring));
            let normal = Rotation3::from_axis_angle(&tangent, twist * parameter(ring)) * normal;
            (self.at(parameter(ring)), normal, tangent.cross(&normal))
        });
        turned.collect()
    }
}

/// The faces of rings that close in both directions.
fn quads(rings: u32, around: u32) -> Vec<[u32; 3]> {
    let vertex = |ring: u32, k: u32| (ring % rings) * around + k % around;
    let mut faces = Vec::new();
    for ring in 0..rings {
        for k in 0..around {
            let [a, b] = [vertex(ring, k), vertex(ring, k + 1)];
            let [c, d] = [vertex(ring + 1, k), vertex(ring + 1, k + 1)];
            faces.extend([[a, b, c], [c, b, d]]);
        }
    }
    faces
}

#[cfg(test)]
mod tests {
    use untangle::mesh::{Mesh, MeshDescription};
    use untangled_checker::count_edge_face;

    use super::*;

    #[test]
    fn tubes_of_knots_are_closed_and_intersect_just_where_they_are_too_thick() {
        for (name, knot) in KNOTS {
            let count = |overlap: f64| {
                let (faces, positions) = knot.tube(10, overlap);
                let count = count_edge_face(&positions, &faces).unwrap();
                let mesh = Mesh::new(MeshDescription { num_vertices: positions.len(), faces, ..Default::default() });
                assert_eq!(mesh.unwrap().num_boundary_edges(), 0, "{name}");
                count
            };
            assert_eq!(count(-0.1), 0, "{name}");
            assert!(count(0.2) > 0, "{name}");
        }
    }
}
