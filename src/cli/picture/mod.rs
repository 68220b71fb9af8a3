//! Pictures of a cloth and its intersections, drawn in software: no GPU, no window.
//!
//! The cloth is shaded on both sides, inside regions are tinted, and intersection paths (contours) are drawn on top,
//! each in the colour of its type, faint where cloth hides them. One [`View`] serves for several states, so that
//! pictures of before and after can be compared pixel by pixel.
//!
//! Each module uses those above it in this table only.
//!
//! | module | purpose |
//! |---|---|
//! | `theme`, `font`, `view` | colours, letters, projection |
//! | `canvas` | samples with a depth buffer |
//! | `light` | shading |
//! | `raster`, `occlusion`, `paths` | triangles, contact shadows, intersection paths |

mod canvas;
mod font;
mod light;
mod occlusion;
mod paths;
mod raster;
mod theme;
mod view;

use std::{fs::File, io::BufWriter, path::Path};

use nalgebra::{Point3, Vector3};

use untangle::{analysis::Analysis, frame::Frame, mesh::Mesh};

pub use view::View;

use super::wording::count_path_pairs;
use canvas::Canvas;
use raster::Corner;
use theme::Colour;

/// Samples along each side of a pixel.
const SUPERSAMPLING: usize = 3;

/// A finished picture, 8 bits per channel, rows from the top.
#[derive(Clone, Debug)]
pub struct Picture {
    width: usize,
    height: usize,
    rgb: Vec<u8>,
}

impl Picture {
    /// Draws one state of a cloth.
    ///
    /// Cost: proportional to the number of triangles and pixels.
    #[must_use]
    pub fn draw(view: &View, mesh: &Mesh, frame: &Frame, analysis: &Analysis, title: &str) -> Self {
        let mut canvas = Canvas::new(view.width() * SUPERSAMPLING, view.height() * SUPERSAMPLING);
        let screen: Vec<Point3<f64>> =
            frame.positions().iter().map(|&position| view.project(position, SUPERSAMPLING)).collect();
        let normals = vertex_normals(mesh, frame);
        let tints = paths::inside_tints(mesh, analysis);
        for face in mesh.face_ids().filter(|&face| mesh.face_edges(face).is_some()) {
            let base = theme::cloth(mesh.piece(face).map_or(0, |piece| piece.index()));
            let vertices = mesh.face(face);
            let tint = vertices.iter().find_map(|vertex| tints[vertex.index()]).unwrap_or(base);
            let corners = vertices.map(|vertex| Corner {
                screen: screen[vertex.index()],
                normal: view.turn(normals[vertex.index()]),
                inside: f64::from(u8::from(tints[vertex.index()].is_some())),
            });
            raster::triangle(&mut canvas, corners, [base, base.lerp(&tint, 0.62)]);
        }
        occlusion::occlude(&mut canvas, SUPERSAMPLING);
        paths::draw(&mut canvas, view, analysis, SUPERSAMPLING);
        let mut picture = Self::resolved(&canvas, view);
        picture.legend(analysis, title);
        picture
    }

    /// Red, green and blue of each pixel, `height x width x 3`, rows from the top.
    #[must_use]
    pub fn rgb(&self) -> &[u8] {
        &self.rgb
    }

    /// Writes the picture as PNG.
    ///
    /// # Errors
    /// The error of the system or of the encoder.
    pub fn write_png(&self, path: &Path) -> Result<(), png::EncodingError> {
        let dimension = |length: usize| u32::try_from(length).map_err(|_| png::EncodingError::LimitsExceeded);
        let file = BufWriter::new(File::create(path)?);
        let mut encoder = png::Encoder::new(file, dimension(self.width)?, dimension(self.height)?);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.rgb)?;
        writer.finish()
    }

    /// Averages the samples of each pixel, with the background where nothing is drawn.
    fn resolved(canvas: &Canvas, view: &View) -> Self {
        let (width, height) = (view.width(), view.height());
        let mut rgb = Vec::with_capacity(width * height * 3);
        for y in 0..height {
            for x in 0..width {
                let background = theme::background(y, height);
                let mut sum = Colour::zeros();
                for dy in 0..SUPERSAMPLING {
                    for dx in 0..SUPERSAMPLING {
                        let sample = canvas.sample(x * SUPERSAMPLING + dx, y * SUPERSAMPLING + dy);
                        sum += sample.unwrap_or(background);
                    }
                }
                #[expect(clippy::cast_precision_loss, reason = "a handful of samples")]
                let mean = sum / (SUPERSAMPLING * SUPERSAMPLING) as f32;
                rgb.extend(theme::to_bytes(mean));
            }
        }
        Self { width, height, rgb }
    }

    /// Draws the title and, for each type that occurs, its colour, name and count.
    fn legend(&mut self, analysis: &Analysis, title: &str) {
        const MARGIN: usize = 24;
        const LINE: usize = 30;
        self.text(MARGIN, MARGIN, title, theme::INK);
        let mut y = MARGIN + LINE + 8;
        for (pair_type, count) in count_path_pairs(analysis) {
            let colour = theme::path(pair_type);
            self.rectangle(MARGIN, y + 4, 28, 8, colour);
            self.text(MARGIN + 40, y, &format!("{} x {count}", pair_type.name()), theme::INK);
            y += LINE;
        }
    }

    fn text(&mut self, x: usize, y: usize, text: &str, colour: Colour) {
        const SCALE: usize = 2;
        for (column, row) in font::pixels(text) {
            self.rectangle(x + column * SCALE, y + row * SCALE, SCALE, SCALE, colour);
        }
    }

    fn rectangle(&mut self, x: usize, y: usize, width: usize, height: usize, colour: Colour) {
        let bytes = theme::to_bytes(colour);
        for row in y..(y + height).min(self.height) {
            for column in x..(x + width).min(self.width) {
                let start = (row * self.width + column) * 3;
                self.rgb[start..start + 3].copy_from_slice(&bytes);
            }
        }
    }
}

/// Area-weighted unit normals, one for each vertex; zero at a vertex without a face of positive area.
fn vertex_normals(mesh: &Mesh, frame: &Frame) -> Vec<Vector3<f64>> {
    let mut normals = vec![Vector3::zeros(); mesh.num_vertices()];
    for face in mesh.face_ids() {
        let vertices = mesh.face(face);
        let [a, b, c] = vertices.map(|vertex| frame.position(vertex));
        let normal = (b - a).cross(&(c - a));
        for vertex in vertices {
            normals[vertex.index()] += normal;
        }
    }
    for normal in &mut normals {
        *normal = normal.try_normalize(0.0).unwrap_or_default();
    }
    normals
}
