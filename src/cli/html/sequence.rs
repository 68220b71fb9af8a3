//! The frames of a shot, as a page goes through them.

use std::io::{self, Write};

use base64::{Engine, engine::general_purpose::STANDARD};
use flate2::{Compression, write::ZlibEncoder};
use serde::Serialize;
use serde_json::Value;

use untangle::analysis::Analysis;

use super::{
    change::stretches,
    numbers::single,
    state::{FoundData, StateData, centre_of},
};
use crate::cli::input::Input;

/// Most coordinates of one kind of state that a page takes.
pub(in crate::cli) const MOST_COORDINATES: u64 = 30_000_000;

/// Highest of the numbers that coordinates are kept as.
const STEPS: f32 = 65535.0;
/// Steps of the natural logarithm of a stretch: a twentieth of a percent.
const STRETCH_STEP: f64 = 0.0005;

/// The frames, with positions in steps of the box round all of them.
#[derive(Clone, Debug, Serialize)]
pub(in crate::cli) struct SequenceData {
    /// The lowest corner of the box, in metres, relative to the centre of the page.
    low: [f32; 3],
    /// In metres.
    step: [f32; 3],
    /// `num_frames x num_vertices x 3`, whole numbers of two bytes: each the difference to the frame before, all low
    /// bytes first, then all high bytes, in the format of zlib, as base64.
    before: String,
    /// The same, each the difference to `before`.
    #[serde(skip_serializing_if = "Option::is_none")]
    after: Option<String>,
    /// `num_frames x num_vertices`, packed in the same way: the stretch of each vertex (see [`stretches`]) on a
    /// logarithmic scale, in steps of [`STRETCH_STEP`] from 1, negative ones as the two's complement.
    #[serde(skip_serializing_if = "Option::is_none")]
    stretch: Option<String>,
    frames: Vec<FrameData>,
}

#[derive(Clone, Debug, Serialize)]
struct FrameData {
    frame: u64,
    /// The line of the frame, as it is printed.
    line: Value,
    states: Vec<FoundData>,
}

/// Takes frames in order, until all are there.
#[derive(Debug)]
pub(in crate::cli) struct FrameRecorder {
    names: &'static [&'static str],
    centre: [f64; 3],
    first: Vec<StateData>,
    /// For each kind of state the coordinates of all frames, relative to the centre.
    streams: Vec<Vec<f32>>,
    /// Of states before and after.
    stretch: Vec<u16>,
    frames: Vec<FrameData>,
}

impl FrameRecorder {
    /// For each frame states of these names will come.
    pub(in crate::cli) fn new(names: &'static [&'static str]) -> Self {
        let streams = vec![Vec::new(); names.len()];
        Self { names, centre: [0.0; 3], first: Vec::new(), streams, stretch: Vec::new(), frames: Vec::new() }
    }

    /// Takes the next frame: its states, each with what was found in it.
    pub(in crate::cli) fn push(&mut self, frame: u64, line: Value, states: &[(&Input, &Analysis)]) {
        if let Some((input, _)) = states.first().filter(|_| self.frames.is_empty()) {
            self.centre = centre_of(&input.positions);
            let first = self.names.iter().zip(states);
            let first = first.map(|(name, state)| StateData::new(name, state.0, state.1, self.centre, true));
            self.first = first.collect();
        }
        for (stream, (input, _)) in self.streams.iter_mut().zip(states) {
            let relative = |position: &[f64; 3]| [0, 1, 2].map(|axis| single(position[axis] - self.centre[axis]));
            stream.extend(input.positions.iter().flat_map(relative));
        }
        if let [(before, _), (after, _)] = states {
            self.stretch.extend(stretches(before, &after.positions).into_iter().map(stretch_in_steps));
        }
        let found = |state: &(&Input, &Analysis)| FoundData::new(state.0, state.1, self.centre, true);
        self.frames.push(FrameData { frame, line, states: states.iter().map(found).collect() });
    }

    /// The centre, the states of the first frame, and all frames.
    pub(in crate::cli) fn finish(self) -> ([f64; 3], Vec<StateData>, SequenceData) {
        let Self { centre, first, streams, stretch, frames, .. } = self;
        let [low, high] = bounds(&streams);
        let step = [0, 1, 2].map(|axis| ((high[axis] - low[axis]) / STEPS).max(f32::MIN_POSITIVE));
        let numbers: Vec<Vec<u16>> = streams.iter().map(|stream| in_steps(stream, low, step)).collect();
        let size = streams.first().map_or(0, Vec::len) / frames.len().max(1);
        let before = numbers.first().map_or_else(String::new, |own| packed(&differences(own, &shifted(own, size))));
        let after = numbers.get(1).map(|own| packed(&differences(own, &numbers[0])));
        let stretch = (!stretch.is_empty()).then(|| packed(&stretch));
        (centre, first, SequenceData { low, step, before, after, stretch, frames })
    }
}

/// The box round all coordinates.
fn bounds(streams: &[Vec<f32>]) -> [[f32; 3]; 2] {
    let mut ends = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
    for place in streams.iter().flat_map(|stream| stream.chunks_exact(3)) {
        for axis in 0..3 {
            ends[0][axis] = ends[0][axis].min(place[axis]);
            ends[1][axis] = ends[1][axis].max(place[axis]);
        }
    }
    ends
}

fn in_steps(stream: &[f32], low: [f32; 3], step: [f32; 3]) -> Vec<u16> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to its range")]
    let number = |value: f32, axis: usize| ((value - low[axis]) / step[axis]).round().clamp(0.0, STEPS) as u16;
    stream.iter().enumerate().map(|(at, &value)| number(value, at % 3)).collect()
}

/// A ratio on a logarithmic scale.
fn stretch_in_steps(ratio: f64) -> u16 {
    // An edge of no length has a ratio without end.
    let most = f64::from(i16::MAX);
    #[expect(clippy::cast_possible_truncation, reason = "clamped to its range")]
    let steps = (ratio.ln() / STRETCH_STEP).clamp(-most, most).round() as i16;
    steps.cast_unsigned()
}

/// The numbers of the frame before; zeros before the first.
fn shifted(numbers: &[u16], size: usize) -> Vec<u16> {
    let rest = numbers.len().saturating_sub(size);
    std::iter::repeat_n(0, size).chain(numbers[..rest].iter().copied()).collect()
}

fn differences(numbers: &[u16], from: &[u16]) -> Vec<u16> {
    numbers.iter().zip(from).map(|(number, from)| number.wrapping_sub(*from)).collect()
}

/// Small differences have high bytes of one kind only: these together take next to nothing.
fn packed(numbers: &[u16]) -> String {
    let pack = || -> io::Result<Vec<u8>> {
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
        for byte in [0, 1] {
            let plane: Vec<u8> = numbers.iter().map(|number| number.to_le_bytes()[byte]).collect();
            encoder.write_all(&plane)?;
        }
        encoder.finish()
    };
    STANDARD.encode(pack().unwrap_or_else(|error| unreachable!("memory can be written: {error}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_keep_their_ratio_within_a_step() {
        for ratio in [1e-6, 0.5, 0.999, 1.0, 1.01, 7.0, 1e6] {
            let read = (f64::from(stretch_in_steps(ratio).cast_signed()) * STRETCH_STEP).exp();
            assert!((read / ratio - 1.0).abs() < STRETCH_STEP, "{ratio}: {read}");
        }
        assert_eq!(stretch_in_steps(1.0), 0, "what did not change is zero, and takes no room");
        assert_eq!([0.0, f64::INFINITY].map(|ratio| stretch_in_steps(ratio).cast_signed()), [-i16::MAX, i16::MAX]);
    }
}
