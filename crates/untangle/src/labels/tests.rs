//! Labels of sheets that pass through each other, at several resolutions.

use std::collections::BTreeMap;

use super::{Labeller, VertexLabel};
use crate::{
    analysis::analyse,
    frame::Frame,
    mesh::{Mesh, MeshDescription, VertexId},
    paths::{IntersectionPaths, PairType},
    settings::Settings,
};

/// Sheets put together from grids.
#[derive(Default)]
struct Sheets {
    description: MeshDescription,
    positions: Vec<[f64; 3]>,
}

impl Sheets {
    /// Adds a grid of `[columns, rows]` squares over the unit square; returns its vertices.
    fn add(&mut self, [columns, rows]: [u32; 2], at: impl Fn(f64, f64) -> [f64; 3]) -> std::ops::Range<u32> {
        let first = u32::try_from(self.positions.len()).unwrap();
        for row in 0..=rows {
            for column in 0..=columns {
                self.positions.push(at(f64::from(column) / f64::from(columns), f64::from(row) / f64::from(rows)));
                if row < rows && column < columns {
                    let a = first + row * (columns + 1) + column;
                    let c = a + columns + 1;
                    self.description.faces.extend([[a, a + 1, c], [c, a + 1, c + 1]]);
                }
            }
        }
        self.description.num_vertices = self.positions.len();
        first..u32::try_from(self.positions.len()).unwrap()
    }

    fn labels(&self, settings: &Settings) -> Labels {
        let mesh = Mesh::new(self.description.clone()).unwrap();
        let frame = Frame::new(&mesh, &self.positions).unwrap();
        let analysis = analyse(&mesh, &frame);
        let (mut labeller, mut labels) = (Labeller::default(), Vec::new());
        labeller.find(&mesh, &frame, &analysis, settings, &mut labels);
        let found = labels.clone();
        labeller.find(&mesh, &frame, &analysis, settings, &mut labels);
        assert_eq!(labels, found, "labels depend on an earlier frame");
        assert!(labels.windows(2).all(|two| {
            let key = |label: VertexLabel| (label.vertex, label.pair());
            key(two[0]) < key(two[1]) && (1..=3).contains(&two[0].side())
        }));
        let mut by_vertex: BTreeMap<u32, Vec<VertexLabel>> = BTreeMap::new();
        labels.iter().for_each(|&label| by_vertex.entry(label.vertex.0).or_default().push(label));
        Labels { paths: analysis.paths, inside: analysis.regions.vertices, by_vertex }
    }
}

struct Labels {
    paths: IntersectionPaths,
    inside: Vec<VertexId>,
    by_vertex: BTreeMap<u32, Vec<VertexLabel>>,
}

impl Labels {
    fn of(&self, vertex: u32) -> &[VertexLabel] {
        self.by_vertex.get(&vertex).map_or(&[], Vec::as_slice)
    }

    /// Whether a contact of two vertices is off.
    fn is_off(&self, a: u32, b: u32) -> bool {
        let opposite = |a: &VertexLabel, b: &VertexLabel| a.pair() == b.pair() && a.side() | b.side() == 3;
        self.of(a).iter().any(|a| self.of(b).iter().any(|b| opposite(a, b)))
    }
}

/// A level sheet of 1 m and another 0.05 m above it, which dips through it by 0.1 m in the middle; edges of `1 / n` m.
fn dip(n: u32) -> (Sheets, [std::ops::Range<u32>; 2]) {
    let mut sheets = Sheets::default();
    let below = sheets.add([n, n], |x, y| [x, y, 0.003 * (9.0 * x + 4.0 * y).sin()]);
    let above = sheets.add([n, n], |x, y| {
        let squared = (x - 0.49).powi(2) + (y - 0.53).powi(2);
        [x + 0.0013, y + 0.0017, 0.05 - 0.15 * (-squared / 0.02).exp()]
    });
    (sheets, [below, above])
}

#[test]
fn labels_of_a_dip_switch_off_the_sheets_inside_and_nowhere_far_from_it() {
    let (sheets, [below, above]) = dip(40);
    let labels = sheets.labels(&Settings::default());
    assert_eq!(labels.paths.pairs.len(), 1);
    assert_eq!(labels.paths.pairs[0].pair_type, PairType::Closed);
    let place = |vertex: u32| sheets.positions[vertex as usize];
    for vertex in below.clone() {
        // The vertex of the other sheet over or under this one.
        let other = above.start + (vertex - below.start);
        let is_inside = labels.inside.contains(&VertexId(vertex)) && labels.inside.contains(&VertexId(other));
        let [x, y, _] = place(vertex);
        let radius = (x - 0.49).hypot(y - 0.53);
        assert!(!is_inside || labels.is_off(vertex, other), "inside, vertex {vertex}");
        assert!(radius < 0.24 || !labels.is_off(vertex, other), "outside, vertex {vertex}, radius {radius}");
        assert!(!labels.is_off(vertex, vertex) && !labels.is_off(other, other), "a sheet stays off itself");
    }
}

#[test]
fn labels_within_reach_of_both_sheets_leave_their_contacts_on() {
    let (sheets, [below, above]) = dip(40);
    let labels = sheets.labels(&Settings::default());
    let mut num_leaning = 0;
    for (vertex, other) in below.zip(above) {
        let is_within_reach = |vertex: u32| labels.of(vertex).len() == 1;
        if is_within_reach(vertex) && is_within_reach(other) {
            num_leaning += 1;
            assert!(!labels.is_off(vertex, other));
        }
    }
    assert!(num_leaning > 100, "{num_leaning} vertices of each sheet");
    let inside_above =
        labels.inside.iter().map(|vertex| vertex.0).filter(|&vertex| vertex >= 41 * 41).collect::<Vec<_>>();
    let first_within_reach = (0..41 * 41).find(|&vertex| labels.of(vertex).len() == 1).unwrap();
    assert!(inside_above.iter().all(|&inside| labels.is_off(inside, first_within_reach)));
}

#[test]
fn labels_of_a_finer_mesh_are_as_wide_in_metres() {
    let widths = [20, 40, 80].map(|n| {
        let (sheets, [below, above]) = dip(n);
        let labels = sheets.labels(&Settings::default());
        [below, above].map(|sheet| {
            let radius = |vertex: u32| {
                let [x, y, _] = sheets.positions[vertex as usize];
                (x - 0.49).hypot(y - 0.53)
            };
            sheet.filter(|&vertex| !labels.of(vertex).is_empty()).map(radius).fold(0.0, f64::max)
        })
    });
    println!("{widths:?}");
    for finer in &widths[1..] {
        for (fine, coarse) in finer.iter().zip(widths[0]) {
            assert!((fine - coarse).abs() < 1.5 / 20.0, "{widths:?}");
        }
    }
}

#[test]
fn labels_of_a_third_sheet_that_leans_on_a_tangle_are_none() {
    let (mut sheets, [_, above]) = dip(40);
    let leaning = sheets.add([40, 40], |x, y| {
        let squared = (x - 0.49).powi(2) + (y - 0.53).powi(2);
        [x, y, 0.06 - 0.15 * (-squared / 0.02).exp()]
    });
    let labels = sheets.labels(&Settings::default());
    assert!(leaning.clone().any(|vertex| !labels.of(vertex).is_empty()), "it is tangled with the lowest sheet too");
    for (vertex, over) in above.zip(leaning) {
        assert!(!labels.is_off(vertex, over), "it lies on the middle sheet");
    }
}

#[test]
fn labels_of_a_fold_through_itself_are_of_both_sides() {
    let mut sheets = Sheets::default();
    let all = sheets.add([40, 40], |x, y| {
        let u = 2.0 * x - 1.0;
        let height = 0.1 - 0.2 * (-((u * u - 0.05).powi(2) + (y - 0.5).powi(2)) / 0.02).exp();
        [u * u, y, 0.3 * (u / 0.3).tanh() * height]
    });
    let labels = sheets.labels(&Settings::default());
    assert!(labels.paths.copies.iter().any(|copy| labels.paths.copies[copy.partner] == *copy), "{:?}", labels.paths);
    assert!(all.clone().any(|vertex| labels.is_off(vertex, vertex)));
    assert!(all.filter(|&vertex| labels.is_off(vertex, vertex)).count() < 41 * 41 / 4);
}
