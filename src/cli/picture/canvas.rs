//! The samples of a picture, with a depth buffer.

use super::theme::{self, Colour};

/// Colour and nearness of every sample, rows from the top.
#[derive(Clone, Debug)]
pub(super) struct Canvas {
    width: usize,
    height: usize,
    colours: Vec<Colour>,
    /// Minus infinity where nothing is drawn.
    nearness: Vec<f32>,
}

impl Canvas {
    pub(super) fn new(width: usize, height: usize) -> Self {
        let samples = width * height;
        Self { width, height, colours: vec![Colour::zeros(); samples], nearness: vec![f32::NEG_INFINITY; samples] }
    }

    pub(super) fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// The colour of a sample, if anything is drawn there.
    pub(super) fn sample(&self, x: usize, y: usize) -> Option<Colour> {
        let index = y * self.width + x;
        (self.nearness[index] > f32::NEG_INFINITY).then(|| self.colours[index])
    }

    pub(super) fn nearness(&self, x: usize, y: usize) -> f32 {
        self.nearness[y * self.width + x]
    }

    /// Sets the colour of a sample if it is nearer than what is drawn there.
    pub(super) fn draw(&mut self, x: usize, y: usize, nearness: f32, colour: impl FnOnce() -> Colour) {
        let index = y * self.width + x;
        if nearness <= self.nearness[index] {
            return;
        }
        self.nearness[index] = nearness;
        self.colours[index] = colour();
    }

    /// Multiplies the colour of a sample.
    pub(super) fn shade(&mut self, x: usize, y: usize, factor: f32) {
        self.colours[y * self.width + x] *= factor;
    }

    /// Blends a colour over a sample, or over the background where nothing is drawn.
    pub(super) fn blend(&mut self, x: usize, y: usize, colour: Colour, opacity: f32) {
        let index = y * self.width + x;
        let below = self.sample(x, y).unwrap_or_else(|| theme::background(y, self.height));
        self.colours[index] = below.lerp(&colour, opacity);
        self.nearness[index] = self.nearness[index].max(f32::MIN);
    }
}

/// Samples, of `count` along an axis, whose centres may lie between two places.
pub(super) fn samples(low: f64, high: f64, count: usize) -> std::ops::Range<usize> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates; limited to the picture")]
    let limit = |place: f64| (place.max(0.0) as usize).min(count);
    limit(low)..limit(high + 1.0)
}

/// The place of the centre of a sample.
#[expect(clippy::cast_precision_loss, reason = "pictures have some thousand samples a side")]
pub(super) fn centre(sample: usize) -> f64 {
    sample as f64 + 0.5
}
