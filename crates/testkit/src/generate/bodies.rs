//! Round bodies, and tubes that go round them.

use std::f64::consts::{PI, TAU};

use super::Sheet;

impl Sheet {
    /// Adds a closed surface round the third axis, whose `rings` rings lie at heights and radii that `profile` gives
    /// for numbers from 0 (the lowest point) to 1 (the highest); both ends must have no radius. Faces point outwards.
    pub fn add_round(&mut self, centre: [f64; 3], rings: u32, around: u32, profile: impl Fn(f64) -> [f64; 2]) {
        let first = u32::try_from(self.positions.len()).unwrap();
        let mut add = |at: f64, angle: f64| {
            let [height, radius] = profile(at);
            self.uvs.push([angle / TAU, at]);
            let offset = [radius * angle.cos(), radius * angle.sin(), height];
            self.positions.push([0, 1, 2].map(|axis| centre[axis] + offset[axis]));
        };
        add(0.0, 0.0);
        for ring in 1..rings {
            (0..around).for_each(|step| add(f64::from(ring) / f64::from(rings), angle_of(step, around)));
        }
        add(1.0, 0.0);
        let last = first + 1 + (rings - 1) * around;
        let at = |ring: u32, step: u32| first + 1 + (ring - 1) * around + step % around;
        for step in 0..around {
            self.faces.push([first, at(1, step + 1), at(1, step)]);
            self.faces.push([last, at(rings - 1, step), at(rings - 1, step + 1)]);
            for ring in 1..rings - 1 {
                self.faces.push([at(ring, step), at(ring, step + 1), at(ring + 1, step + 1)]);
                self.faces.push([at(ring, step), at(ring + 1, step + 1), at(ring + 1, step)]);
            }
        }
    }

    /// Adds a ball.
    pub fn add_ball(&mut self, centre: [f64; 3], radius: f64, rings: u32) {
        self.add_round(centre, rings, 2 * rings, |at| {
            // To the bit, so that the ends have no radius.
            [-radius * (PI * at).cos(), radius * (PI * at).sin()]
        });
    }

    /// Adds a capsule along the third axis: a cylinder from `-half` to `half`, and half a ball at each end.
    pub fn add_capsule(&mut self, radius: f64, half: f64, rings: u32, around: u32) {
        self.add_round([0.0; 3], rings, around, |at| {
            let length = 2.0 * half + PI * radius;
            let along = at * length - 0.5 * length;
            let beyond = (along.abs() - half).max(0.0) / radius;
            let height = along.clamp(-half, half) + along.signum() * radius * beyond.sin();
            [height, radius * beyond.cos()]
        });
    }

    /// Adds an open tube along the third axis between two heights, placed by `shift` after its angle and height.
    pub fn add_tube(
        &mut self,
        radius: f64,
        [low, high]: [f64; 2],
        [around, along]: [u32; 2],
        shift: impl Fn(f64, f64) -> [f64; 3],
    ) {
        let first = u32::try_from(self.positions.len()).unwrap();
        for row in 0..=along {
            let height = low + (high - low) * f64::from(row) / f64::from(along);
            for step in 0..around {
                let angle = angle_of(step, around);
                let shift = shift(angle, height);
                self.uvs.push([angle, height]);
                let place = [radius * angle.cos(), radius * angle.sin(), height];
                self.positions.push([0, 1, 2].map(|axis| place[axis] + shift[axis]));
            }
        }
        for row in 0..along {
            for step in 0..around {
                let at = |row: u32, step: u32| first + row * around + step % around;
                self.faces.push([at(row, step), at(row, step + 1), at(row + 1, step + 1)]);
                self.faces.push([at(row, step), at(row + 1, step + 1), at(row + 1, step)]);
            }
        }
    }
}

fn angle_of(step: u32, around: u32) -> f64 {
    TAU * f64::from(step) / f64::from(around)
}
