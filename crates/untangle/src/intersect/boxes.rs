//! Eight boxes side by side, one coordinate after the other, so that one goes against eight at once.
//!
//! The functions are always inlined, for a caller that is compiled for what the processor at hand can do.

/// Boxes of one node.
pub(crate) const WIDTH: usize = 8;

/// Eight boxes. Unused places hold the empty box, which overlaps nothing.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Boxes {
    pub(crate) min: [[f32; WIDTH]; 3],
    pub(crate) max: [[f32; WIDTH]; 3],
}

/// One box: its lowest and its highest corner.
pub(crate) type Hull = ([f32; 3], [f32; 3]);

pub(crate) const EMPTY: Boxes = Boxes { min: [[f32::INFINITY; WIDTH]; 3], max: [[f32::NEG_INFINITY; WIDTH]; 3] };

impl Boxes {
    /// One of these boxes.
    #[inline(always)]
    pub(crate) fn get(&self, slot: usize) -> Hull {
        // No `map`: it takes the rows by value, and their copies cost more than what is done with them.
        let corner = |rows: &[[f32; WIDTH]; 3]| [rows[0][slot], rows[1][slot], rows[2][slot]];
        (corner(&self.min), corner(&self.max))
    }

    #[inline(always)]
    pub(crate) fn set(&mut self, slot: usize, (low, high): Hull) {
        for axis in 0..3 {
            self.min[axis][slot] = low[axis];
            self.max[axis][slot] = high[axis];
        }
    }

    /// The same boxes with `margin` more on every side.
    #[inline(always)]
    pub(crate) fn inflated(&self, margin: f32) -> Self {
        let mut boxes = *self;
        for axis in 0..3 {
            for slot in 0..WIDTH {
                boxes.min[axis][slot] -= margin;
                boxes.max[axis][slot] += margin;
            }
        }
        boxes
    }

    /// The box round all of them.
    #[inline(always)]
    pub(crate) fn hull(&self) -> Hull {
        // In halves: the order that the processor can follow.
        let least = |row: [f32; WIDTH]| {
            let half: [f32; 4] = std::array::from_fn(|lane| lower(row[lane], row[lane + 4]));
            lower(lower(half[0], half[2]), lower(half[1], half[3]))
        };
        let greatest = |row: [f32; WIDTH]| {
            let half: [f32; 4] = std::array::from_fn(|lane| higher(row[lane], row[lane + 4]));
            higher(higher(half[0], half[2]), higher(half[1], half[3]))
        };
        (self.min.map(least), self.max.map(greatest))
    }
}

/// The lower of two numbers, neither of which is NaN: one instruction, where `f32::min` takes several.
#[inline(always)]
pub(crate) fn lower(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The higher of two numbers, neither of which is NaN.
#[inline(always)]
pub(crate) fn higher(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}
