//! Intersection paths and inside regions in a picture.

use nalgebra::{Point3, Vector2};

use untangle::{analysis::Analysis, mesh::Mesh};

use super::{
    canvas::{Canvas, centre, samples},
    theme::{self, Colour},
    view::View,
};

/// For each vertex the colour of the type of the first path that it is inside of, if any.
pub(super) fn inside_tints(mesh: &Mesh, analysis: &Analysis) -> Vec<Option<Colour>> {
    let mut tints = vec![None; mesh.num_vertices()];
    for (index, copy) in analysis.paths.copies.iter().enumerate().take(analysis.regions.by_copy.len()) {
        let colour = theme::path(analysis.paths.pairs[copy.pair].pair_type);
        for vertex in analysis.regions.vertices_of(index) {
            tints[vertex.index()].get_or_insert(colour);
        }
    }
    tints
}

/// Draws all paths, opaque where they are visible and faint where cloth hides them.
pub(super) fn draw(canvas: &mut Canvas, view: &View, analysis: &Analysis, samples: usize) {
    #[expect(clippy::cast_precision_loss, reason = "a handful of samples")]
    let scale = samples as f64;
    let mut covered = Stroke::new(canvas.size());
    for pair in &analysis.paths.pairs {
        let colour = theme::path(pair.pair_type);
        covered.clear();
        for copy in &analysis.paths.copies[pair.copies.clone()] {
            let points = &analysis.paths.points[copy.points.clone()];
            for ends in points.windows(2) {
                let [p, q] = [&ends[0], &ends[1]].map(|point| view.project(point.position, samples));
                covered.segment(p, q, 1.9 * scale);
            }
        }
        for &(x, y, nearness) in &covered.samples {
            let visible = f64::from(canvas.nearness(x, y)) <= nearness + 4.0 * scale;
            canvas.blend(x, y, colour, if visible { 0.95 } else { 0.40 });
        }
    }
}

/// The samples under a polyline, each once, so that none is blended twice.
#[derive(Debug)]
struct Stroke {
    size: [usize; 2],
    is_marked: Vec<bool>,
    samples: Vec<(usize, usize, f64)>,
}

impl Stroke {
    fn new(size: [usize; 2]) -> Self {
        Self { size, is_marked: vec![false; size[0] * size[1]], samples: Vec::new() }
    }

    fn clear(&mut self) {
        for (x, y, _) in self.samples.drain(..) {
            self.is_marked[y * self.size[0] + x] = false;
        }
    }

    /// Marks the samples within `radius` of a segment.
    fn segment(&mut self, p: Point3<f64>, q: Point3<f64>, radius: f64) {
        let (start, along) = (p.coords.xy(), (q - p).xy());
        let length = along.norm_squared();
        for y in samples(p.y.min(q.y) - radius, p.y.max(q.y) + radius, self.size[1]) {
            for x in samples(p.x.min(q.x) - radius, p.x.max(q.x) + radius, self.size[0]) {
                let centre = Vector2::new(centre(x), centre(y));
                let t = if length > 0.0 { ((centre - start).dot(&along) / length).clamp(0.0, 1.0) } else { 0.0 };
                let index = y * self.size[0] + x;
                if (centre - start - along * t).norm() <= radius && !self.is_marked[index] {
                    self.is_marked[index] = true;
                    self.samples.push((x, y, p.z + (q.z - p.z) * t));
                }
            }
        }
    }
}
