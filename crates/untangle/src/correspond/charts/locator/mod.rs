//! Point location in a chart: the face under a point, or the nearest place on the chart's outline.

mod grid;

use nalgebra::Point2;

use self::grid::{Grid, as_float};
use crate::mesh::Csr;

/// Triangles for each cell of the grid, on the mean.
const TRIANGLES_PER_CELL: usize = 4;
/// Of no more triangles than this each is looked at: a grid would take longer to make.
const FEW_TRIANGLES: usize = 64;
/// Outlines of no more sides than this are searched one by one: few points lie outside, and each side in a grid costs
/// its insertion.
const SHORT_OUTLINE: usize = 64;

/// Triangles of the plane, found through a grid.
#[derive(Debug, Default)]
pub(super) struct Locator {
    triangles: Vec<[Point2<f64>; 3]>,
    faces: Vec<u32>,
    outline: Vec<OutlineSide>,
    grid: Grid,
    /// For each cell the triangles and the parts of the outline whose boxes meet it, ascending.
    triangles_in: Csr<u32>,
    outline_in: Csr<u32>,
    /// Scratch: cells with what lies in them.
    pairs: Vec<(usize, u32)>,
}

/// A side of a triangle that belongs to the outline.
#[derive(Clone, Copy, Debug)]
struct OutlineSide {
    triangle: u32,
    side: u8,
}

/// A place in a chart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    /// Number of the face, as it was given.
    pub(super) face: usize,
    /// One coordinate for each corner; not negative, and they sum to 1.
    pub(super) barycentric: [f64; 3],
}

impl Locator {
    /// Removes all faces.
    pub(super) fn start(&mut self) {
        self.triangles.clear();
        self.faces.clear();
        self.outline.clear();
    }

    /// Adds a face and says which of its sides belong to the outline.
    pub(super) fn add(&mut self, face: usize, triangle: [Point2<f64>; 3], is_outline: [bool; 3]) {
        let number = narrow(self.triangles.len());
        self.triangles.push(triangle);
        self.faces.push(narrow(face));
        for (side, _) in (0u8..).zip(is_outline).filter(|&(_, is_outline)| is_outline) {
            self.outline.push(OutlineSide { triangle: number, side });
        }
    }

    /// Builds the grid over all triangles added. Cells hold a few triangles each, since far fewer points are looked for
    /// than there are faces.
    pub(super) fn finish(&mut self) {
        let Self { triangles, outline, pairs, .. } = self;
        let has_few = triangles.len() <= FEW_TRIANGLES;
        if has_few && outline.len() <= SHORT_OUTLINE {
            return;
        }
        let grid = Grid::over(triangles.iter().flatten(), triangles.len() / TRIANGLES_PER_CELL);
        if !has_few {
            pairs.clear();
            for (number, [a, b, c]) in (0u32..).zip(&*triangles) {
                grid.for_cells(a.inf(b).inf(c), a.sup(b).sup(c), |cell| pairs.push((cell, number)));
            }
            self.triangles_in.fill(grid.num_cells(), pairs.iter().copied());
        }
        if outline.len() > SHORT_OUTLINE {
            pairs.clear();
            for (number, side) in (0u32..).zip(&*outline) {
                let [a, b] = side.ends(triangles);
                grid.for_cells(a.inf(&b), a.sup(&b), |cell| pairs.push((cell, number)));
            }
            self.outline_in.fill(grid.num_cells(), pairs.iter().copied());
        }
        self.grid = grid;
    }

    /// The face that holds a point; of several, the one added first.
    pub(super) fn within(&self, point: Point2<f64>) -> Option<Place> {
        let in_triangle = |number: usize| {
            let barycentric = inside(&self.triangles[number], point)?;
            Some(Place { face: self.faces[number] as usize, barycentric })
        };
        if self.triangles.len() <= FEW_TRIANGLES {
            return (0..self.triangles.len()).find_map(in_triangle);
        }
        self.triangles_in.row(self.grid.cell_of(point)).iter().find_map(|&number| in_triangle(number as usize))
    }

    /// The nearest place on the outline, and the square of its distance; of several, the one added first. Nothing where
    /// there are no faces.
    ///
    /// Cost: that of the cells that are no farther from the point than the outline.
    pub(super) fn nearest_on_outline(&self, point: Point2<f64>) -> Option<(f64, Place)> {
        if self.outline.is_empty() || !(point.x.is_finite() && point.y.is_finite()) {
            return None;
        }
        let mut nearest: Option<(f64, u32, f64)> = None;
        let mut look_at = |number: u32| {
            let (distance, parameter) = self.outline[number as usize].nearest(&self.triangles, point);
            if nearest.is_none_or(|(least, first, _)| (distance, number) < (least, first)) {
                nearest = Some((distance, number, parameter));
            }
            nearest
        };
        if self.outline.len() <= SHORT_OUTLINE {
            for (number, _) in (0..).zip(&self.outline) {
                look_at(number);
            }
        } else {
            // All of the outline lies in the grid's box: it is at least as far as the box, and from there as far as the
            // cells between.
            let to_box = self.grid.offset_from_box(point).norm_squared();
            let mut best: Option<(f64, u32, f64)> = None;
            for ring in 0..self.grid.num_rings() {
                let between = self.grid.cell * as_float(ring.saturating_sub(1));
                if best.is_some_and(|(least, ..)| least < to_box + between * between) {
                    break;
                }
                for &number in self.grid.ring(self.grid.place(point), ring).flat_map(|cell| self.outline_in.row(cell)) {
                    best = look_at(number);
                }
            }
        }
        nearest.map(|(distance, number, parameter)| {
            let OutlineSide { triangle, side } = self.outline[number as usize];
            let mut barycentric = [0.0; 3];
            barycentric[usize::from(side)] = 1.0 - parameter;
            barycentric[(usize::from(side) + 1) % 3] = parameter;
            (distance, Place { face: self.faces[triangle as usize] as usize, barycentric })
        })
    }
}

impl OutlineSide {
    fn ends(self, triangles: &[[Point2<f64>; 3]]) -> [Point2<f64>; 2] {
        let triangle = &triangles[self.triangle as usize];
        [triangle[usize::from(self.side)], triangle[(usize::from(self.side) + 1) % 3]]
    }

    /// The square of the distance of a point, and how far along the nearest place lies.
    fn nearest(self, triangles: &[[Point2<f64>; 3]], point: Point2<f64>) -> (f64, f64) {
        let [a, b] = self.ends(triangles);
        let edge = b - a;
        let squared = edge.norm_squared();
        let parameter = if squared > 0.0 { ((point - a).dot(&edge) / squared).clamp(0.0, 1.0) } else { 0.0 };
        ((a + edge * parameter - point).norm_squared(), parameter)
    }
}

/// Barycentric coordinates of a point in a triangle of either winding, if it lies in it.
fn inside([a, b, c]: &[Point2<f64>; 3], point: Point2<f64>) -> Option<[f64; 3]> {
    let area = (b - a).perp(&(c - a));
    let weights = [(b - point).perp(&(c - point)), (c - point).perp(&(a - point)), (a - point).perp(&(b - point))];
    // Rounding may leave a point on an edge to neither face: a margin of rounding belongs to both.
    let margin = -1e-12 * area.abs();
    if area == 0.0 || weights.iter().any(|weight| weight * area.signum() < margin) {
        return None;
    }
    let weights = weights.map(|weight| (weight / area).max(0.0));
    let sum: f64 = weights.iter().sum();
    Some(weights.map(|weight| weight / sum))
}

fn narrow(index: usize) -> u32 {
    u32::try_from(index).expect("a chart has no more elements than its mesh, whose indices fit 31 bits")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correspond::samples::sheet;

    fn locator(columns: u32, rows: u32) -> (Locator, Vec<[Point2<f64>; 3]>) {
        let (mesh, flat) = sheet(columns, rows, 0.1);
        let mut locator = Locator::default();
        let mut triangles = Vec::new();
        locator.start();
        for face in mesh.face_ids() {
            let triangle = mesh.face(face).map(|vertex| flat[vertex.index()]);
            let edges = mesh.face_edges(face).unwrap();
            locator.add(face.index(), triangle, edges.map(|edge| mesh.is_boundary_edge(edge)));
            triangles.push(triangle);
        }
        locator.finish();
        (locator, triangles)
    }

    fn at(triangles: &[[Point2<f64>; 3]], place: &Place) -> Point2<f64> {
        let [a, b, c] = triangles[place.face];
        let [wa, wb, wc] = place.barycentric;
        Point2::from(a.coords * wa + b.coords * wb + c.coords * wc)
    }

    #[test]
    fn locator_within_sheet_finds_every_point() {
        let (locator, triangles) = locator(5, 4);
        for i in 0..=100 {
            for j in 0..=80 {
                let point = Point2::new(f64::from(i) * 0.005, f64::from(j) * 0.005);
                let place = locator.within(point);
                assert!(place.is_some() || i == 100 || j == 80 || i == 0 || j == 0);
                let place = place.or_else(|| Some(locator.nearest_on_outline(point)?.1)).unwrap();
                assert!((at(&triangles, &place) - point).norm() < 1e-12, "{point} {place:?}");
            }
        }
    }

    #[test]
    fn locator_nearest_on_short_and_long_outlines_is_that_of_brute_force() {
        // A short outline, and one that gets a grid.
        for (columns, rows, is_short) in [(5, 4, true), (20, 16, false)] {
            let (locator, triangles) = locator(columns, rows);
            assert_eq!(locator.outline.len() <= SHORT_OUTLINE, is_short);
            let size = f64::from(columns) / 5.0;
            for i in -40i32..140 {
                for j in -30i32..110 {
                    let point = Point2::new(f64::from(i) * 0.00513 * size, f64::from(j) * 0.00497 * size);
                    let (squared, place) = locator.nearest_on_outline(point).unwrap();
                    let all = locator.outline.iter().map(|side| side.nearest(&triangles, point).0);
                    assert!(squared <= all.fold(f64::INFINITY, f64::min));
                    assert!((squared - (at(&triangles, &place) - point).norm_squared()).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn locator_of_point_outside_finds_nearest_place_of_outline() {
        let (locator, triangles) = locator(5, 4);
        for (point, expected) in [((0.23, -3.0), (0.23, 0.0)), ((0.9, 0.9), (0.5, 0.4)), ((-0.1, 0.33), (0.0, 0.33))] {
            let point = Point2::new(point.0, point.1);
            assert_eq!(locator.within(point), None);
            let (squared, place) = locator.nearest_on_outline(point).unwrap();
            assert!((squared - (at(&triangles, &place) - point).norm_squared()).abs() < 1e-12);
            assert!((at(&triangles, &place) - Point2::new(expected.0, expected.1)).norm() < 1e-12);
        }
    }

    #[test]
    fn locator_without_faces_finds_nothing() {
        let mut empty = Locator::default();
        empty.finish();
        assert_eq!((empty.within(Point2::origin()), empty.nearest_on_outline(Point2::origin())), (None, None));
    }
}
