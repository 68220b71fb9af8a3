//! Where in a chart a point lies: its face, or the nearest place on the chart's outline.

use nalgebra::{Point2, Vector2};

/// Triangles of the plane, found through a grid.
#[derive(Debug, Default)]
pub(crate) struct Locator {
    triangles: Vec<[Point2<f64>; 3]>,
    faces: Vec<u32>,
    outline: Vec<Rim>,
    origin: Point2<f64>,
    cell: f64,
    columns: usize,
    rows: usize,
    starts: Vec<u32>,
    items: Vec<u32>,
}

/// A side of a triangle that no other triangle shares: side `side` of triangle `triangle`.
#[derive(Clone, Copy, Debug)]
struct Rim {
    triangle: u32,
    side: u8,
}

/// A place in a chart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Place {
    /// Number of the face, as it was given.
    pub(crate) face: usize,
    /// One coordinate for each corner; not negative, and they sum to 1.
    pub(crate) barycentric: [f64; 3],
}

impl Locator {
    /// Begins anew.
    pub(crate) fn start(&mut self) {
        self.triangles.clear();
        self.faces.clear();
        self.outline.clear();
    }

    /// Adds a face and says which of its sides belong to the outline.
    pub(crate) fn add(&mut self, face: usize, triangle: [Point2<f64>; 3], rim: [bool; 3]) {
        let number = narrow(self.triangles.len());
        self.triangles.push(triangle);
        self.faces.push(narrow(face));
        for (side, _) in (0u8..).zip(rim).filter(|&(_, rim)| rim) {
            self.outline.push(Rim { triangle: number, side });
        }
    }

    /// Builds the grid over all triangles added: about one cell for each.
    pub(crate) fn finish(&mut self) {
        let mut low = Point2::new(f64::INFINITY, f64::INFINITY);
        let mut high = Point2::new(f64::NEG_INFINITY, f64::NEG_INFINITY);
        for point in self.triangles.iter().flatten() {
            low = low.inf(point);
            high = high.sup(point);
        }
        let extent = if self.triangles.is_empty() { Vector2::zeros() } else { high - low };
        #[expect(clippy::cast_precision_loss, reason = "a count of faces")]
        let count = self.triangles.len().max(1) as f64;
        let side = extent.x.max(extent.y);
        self.cell = (extent.x * extent.y / count).sqrt().max(side / count).max(f64::MIN_POSITIVE);
        self.origin = if self.triangles.is_empty() { Point2::origin() } else { low };
        self.columns = whole(extent.x / self.cell) + 1;
        self.rows = whole(extent.y / self.cell) + 1;
        self.starts.clear();
        self.starts.resize(self.columns * self.rows + 1, 0);
        for number in 0..self.triangles.len() {
            self.for_each_cell(number, |starts, cell| starts[cell + 1] += 1);
        }
        for cell in 1..self.starts.len() {
            self.starts[cell] += self.starts[cell - 1];
        }
        self.items.clear();
        self.items.resize(self.starts[self.starts.len() - 1] as usize, 0);
        let mut items = std::mem::take(&mut self.items);
        // Filled from behind, so that each cell lists its triangles in ascending order once the starts have moved down.
        for number in (0..self.triangles.len()).rev() {
            self.for_each_cell(number, |starts, cell| {
                starts[cell + 1] -= 1;
                items[starts[cell + 1] as usize] = narrow(number);
            });
        }
        self.items = items;
    }

    fn for_each_cell(&mut self, number: usize, mut act: impl FnMut(&mut [u32], usize)) {
        let [a, b, c] = self.triangles[number];
        let (low, high) = (self.cell_of(a.inf(&b).inf(&c)), self.cell_of(a.sup(&b).sup(&c)));
        for row in low.1..=high.1 {
            for column in low.0..=high.0 {
                act(&mut self.starts, row * self.columns + column);
            }
        }
    }

    fn cell_of(&self, point: Point2<f64>) -> (usize, usize) {
        let at = (point - self.origin) / self.cell;
        (whole(at.x).min(self.columns - 1), whole(at.y).min(self.rows - 1))
    }

    /// The face over a point; of several, the one added first.
    pub(crate) fn within(&self, point: Point2<f64>) -> Option<Place> {
        let cell = self.cell_of(point);
        let cell = cell.1 * self.columns + cell.0;
        // After filling, cell k starts where entry k + 1 says.
        let end = self.starts.get(cell + 2).copied().unwrap_or(narrow(self.items.len()));
        for &number in &self.items[self.starts[cell + 1] as usize..end as usize] {
            if let Some(barycentric) = inside(&self.triangles[number as usize], point) {
                return Some(Place { face: self.faces[number as usize] as usize, barycentric });
            }
        }
        None
    }

    /// The nearest place on the outline, and the square of its distance. Nothing where there are no faces.
    pub(crate) fn nearest_on_outline(&self, point: Point2<f64>) -> Option<(f64, Place)> {
        let mut nearest: Option<(f64, Place)> = None;
        for rim in &self.outline {
            let triangle = &self.triangles[rim.triangle as usize];
            let (a, b) = (usize::from(rim.side), (usize::from(rim.side) + 1) % 3);
            let edge = triangle[b] - triangle[a];
            let squared = edge.norm_squared();
            let parameter =
                if squared > 0.0 { ((point - triangle[a]).dot(&edge) / squared).clamp(0.0, 1.0) } else { 0.0 };
            let distance = (triangle[a] + edge * parameter - point).norm_squared();
            if nearest.as_ref().is_none_or(|&(least, _)| distance < least) {
                let mut barycentric = [0.0; 3];
                barycentric[a] = 1.0 - parameter;
                barycentric[b] = parameter;
                let face = self.faces[rim.triangle as usize] as usize;
                nearest = Some((distance, Place { face, barycentric }));
            }
        }
        nearest
    }
}

/// Barycentric coordinates of a point in a triangle of either winding, if it lies in it.
fn inside([a, b, c]: &[Point2<f64>; 3], point: Point2<f64>) -> Option<[f64; 3]> {
    let area = (b - a).perp(&(c - a));
    let weights = [(b - point).perp(&(c - point)), (c - point).perp(&(a - point)), (a - point).perp(&(b - point))];
    // On an edge rounding may leave the point to neither face: a hair's breadth belongs to both.
    let hair = -1e-12 * area.abs();
    if area == 0.0 || weights.iter().any(|weight| weight * area.signum() < hair) {
        return None;
    }
    let weights = weights.map(|weight| (weight / area).max(0.0));
    let sum: f64 = weights.iter().sum();
    Some(weights.map(|weight| weight / sum))
}

fn narrow(index: usize) -> u32 {
    u32::try_from(index).expect("a chart has no more elements than its mesh, whose indices fit 31 bits")
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates, which is what is wanted")]
fn whole(value: f64) -> usize {
    value.max(0.0) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correspond::samples::sheet;

    fn locator() -> (Locator, Vec<[Point2<f64>; 3]>) {
        let (mesh, flat) = sheet(5, 4, 0.1);
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
    fn finds_every_point_of_a_sheet() {
        let (locator, triangles) = locator();
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
    fn a_point_outside_goes_to_the_nearest_place_of_the_outline() {
        let (locator, triangles) = locator();
        for (point, expected) in [((0.23, -3.0), (0.23, 0.0)), ((0.9, 0.9), (0.5, 0.4)), ((-0.1, 0.33), (0.0, 0.33))] {
            let point = Point2::new(point.0, point.1);
            assert_eq!(locator.within(point), None);
            let (squared, place) = locator.nearest_on_outline(point).unwrap();
            assert!((squared - (at(&triangles, &place) - point).norm_squared()).abs() < 1e-12);
            assert!((at(&triangles, &place) - Point2::new(expected.0, expected.1)).norm() < 1e-12);
        }
        let mut empty = Locator::default();
        empty.finish();
        assert_eq!((empty.within(Point2::origin()), empty.nearest_on_outline(Point2::origin())), (None, None));
    }
}
