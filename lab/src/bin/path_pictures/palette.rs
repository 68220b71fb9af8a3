//! Pictures of few colours: a palette by median cut (Heckbert 1982), and PNG files that use it.

use std::{collections::BTreeMap, error::Error, fs::File, io::BufWriter, path::Path};

/// An 8-bit RGB picture, rows from the top.
pub(crate) struct Pixels {
    pub(crate) width: usize,
    pub(crate) rgb: Vec<u8>,
}

impl Pixels {
    /// Puts another picture of the same height to the right.
    pub(crate) fn beside(self, right: &Self) -> Self {
        let rows = self.rgb.chunks(3 * self.width).zip(right.rgb.chunks(3 * right.width));
        let rgb = rows.flat_map(|(left, right)| left.iter().chain(right)).copied().collect();
        Self { width: self.width + right.width, rgb }
    }

    /// Writes a PNG of at most `num_colours` colours.
    pub(crate) fn write_png(&self, path: &Path, num_colours: usize) -> Result<(), Box<dyn Error>> {
        let colours: Vec<[u8; 3]> = self.rgb.as_chunks().0.to_vec();
        let boxes = median_cut(&colours, num_colours);
        let mut index_of = BTreeMap::new();
        let mut palette = Vec::new();
        for (index, members) in boxes.iter().enumerate() {
            palette.extend(mean(members));
            for (colour, _) in members {
                index_of.insert(*colour, u8::try_from(index)?);
            }
        }
        let indices: Vec<u8> = colours.iter().map(|colour| index_of[colour]).collect();
        let [width, height] = [self.width, colours.len() / self.width].map(u32::try_from);
        let mut encoder = png::Encoder::new(BufWriter::new(File::create(path)?), width?, height?);
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_palette(palette);
        encoder.set_compression(png::Compression::High);
        encoder.set_filter(png::Filter::NoFilter);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&indices)?;
        Ok(writer.finish()?)
    }
}

/// Different colours, each with the number of its pixels.
type Members = Vec<([u8; 3], usize)>;

/// Divides the colours of a picture into at most `num_boxes` boxes: the box of the largest extent, weighted by its
/// pixels, is cut at its median.
fn median_cut(colours: &[[u8; 3]], num_boxes: usize) -> Vec<Members> {
    let mut counts = BTreeMap::new();
    for colour in colours {
        *counts.entry(*colour).or_insert(0) += 1;
    }
    let mut boxes: Vec<Members> = vec![counts.into_iter().collect()];
    while boxes.len() < num_boxes {
        let weight = |members: &Members| usize::from(widest(members).1).pow(2) * pixels(members).isqrt();
        let Some(worst) = (0..boxes.len()).max_by_key(|&k| weight(&boxes[k])).filter(|&k| weight(&boxes[k]) > 0) else {
            break;
        };
        let mut lower = boxes.swap_remove(worst);
        let (channel, _) = widest(&lower);
        lower.sort_unstable_by_key(|(colour, _)| (colour[channel], *colour));
        let half = pixels(&lower) / 2;
        let mut seen = 0;
        let cut = lower
            .iter()
            .take_while(|(_, count)| {
                seen += count;
                seen <= half
            })
            .count();
        let upper = lower.split_off(cut.clamp(1, lower.len() - 1));
        boxes.extend([lower, upper]);
    }
    boxes
}

/// The channel in which colours differ most, and by how much.
fn widest(members: &Members) -> (usize, u8) {
    let extent = |channel: usize| {
        let values = || members.iter().map(|(colour, _)| colour[channel]);
        values().max().unwrap_or(0) - values().min().unwrap_or(0)
    };
    (0..3).map(|channel| (channel, extent(channel))).max_by_key(|&(_, extent)| extent).unwrap_or((0, 0))
}

fn pixels(members: &Members) -> usize {
    members.iter().map(|(_, count)| count).sum()
}

fn mean(members: &Members) -> [u8; 3] {
    let total = pixels(members).max(1);
    [0, 1, 2].map(|channel| {
        let sum: usize = members.iter().map(|(colour, count)| usize::from(colour[channel]) * count).sum();
        u8::try_from((sum + total / 2) / total).unwrap_or(u8::MAX)
    })
}
