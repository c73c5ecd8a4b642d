//! One animated value over time: keys, and the interpolation between them.
//!
//! Source: glTF 2.0 specification, appendix C (interpolation).

use glam::DQuat;

use super::graph::unit_rotation;

/// Interpolation between keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Interpolation {
    Step,
    Linear,
    /// A Hermite spline; each key holds in-tangent, value and out-tangent.
    Cubic,
}

impl Interpolation {
    /// Values stored for each key.
    pub(super) fn values_per_key(self) -> usize {
        match self {
            Self::Step | Self::Linear => 1,
            Self::Cubic => 3,
        }
    }
}

/// Keys of one value of `width` numbers. Before the first and after the last key the value is
/// constant.
pub(super) struct Track {
    /// Strictly increasing; at least one.
    pub(super) times_secs: Vec<f64>,
    /// `times_secs.len() * interpolation.values_per_key() * width` finite numbers.
    pub(super) values: Vec<f32>,
    /// Numbers of one value; at least one.
    pub(super) width: usize,
    pub(super) interpolation: Interpolation,
}

/// Two neighbouring keys and the position between them; twice the same key outside the track.
struct Span {
    from: usize,
    to: usize,
    /// From 0 at `from` to 1 at `to`.
    fraction: f64,
    length_secs: f64,
}

impl Track {
    pub(super) fn end_secs(&self) -> f64 {
        self.times_secs.last().copied().unwrap_or(0.0)
    }

    /// Writes the value at a time, number by number.
    pub(super) fn sample(&self, time_secs: f64, out: &mut [f64]) {
        let span = self.span(time_secs);
        let [h00, h10, h01, h11] = match self.interpolation {
            Interpolation::Step => [1.0, 0.0, 0.0, 0.0],
            Interpolation::Linear => [1.0 - span.fraction, 0.0, span.fraction, 0.0],
            Interpolation::Cubic => hermite(span.fraction, span.length_secs),
        };
        let (from, to) = (self.key(span.from), self.key(span.to));
        for (i, out) in out.iter_mut().enumerate().take(self.width) {
            *out =
                h00 * from.value(i) + h10 * from.out_tangent(i) + h01 * to.value(i) + h11 * to.in_tangent(i);
        }
    }

    /// The rotation at a time; keys are (x, y, z, w). Linear tracks rotate along the shorter great
    /// circle.
    pub(super) fn sample_rotation(&self, time_secs: f64) -> DQuat {
        let span = self.span(time_secs);
        let from = self.key_rotation(span.from);
        match self.interpolation {
            Interpolation::Step => from,
            Interpolation::Linear => from.slerp(self.key_rotation(span.to), span.fraction),
            Interpolation::Cubic => {
                let mut xyzw = [0.0; 4];
                self.sample(time_secs, &mut xyzw);
                unit_rotation(xyzw).unwrap_or(from)
            }
        }
    }

    /// Replaces keys with zero rotations by the key before, or by the first valid one; returns
    /// their number.
    pub(super) fn repair_rotations(&mut self) -> usize {
        let n_keys = self.times_secs.len();
        let is_zero: Vec<bool> = (0..n_keys)
            .map(|key| unit_rotation(self.key_xyzw(key)).is_none())
            .collect();
        let first = is_zero.iter().position(|is_zero| !is_zero);
        let mut good = first.map_or([0.0, 0.0, 0.0, 1.0], |key| self.written_value(key));
        for (key, is_zero) in is_zero.iter().enumerate() {
            match is_zero {
                true => self.write_value(key, good),
                false => good = self.written_value(key),
            }
        }
        is_zero.iter().filter(|is_zero| **is_zero).count()
    }

    /// Index of a key's value among all numbers.
    fn value_at(&self, key: usize) -> usize {
        let per_key = self.interpolation.values_per_key();
        (key * per_key + per_key / 2) * self.width
    }

    fn written_value(&self, key: usize) -> [f32; 4] {
        let at = self.value_at(key);
        let written = self.values.get(at..).and_then(<[f32]>::first_chunk);
        written.copied().unwrap_or([0.0, 0.0, 0.0, 1.0])
    }

    fn write_value(&mut self, key: usize, value: [f32; 4]) {
        let at = self.value_at(key);
        if let Some(written) = self.values.get_mut(at..).and_then(<[f32]>::first_chunk_mut) {
            *written = value;
        }
    }

    fn key_rotation(&self, key: usize) -> DQuat {
        unit_rotation(self.key_xyzw(key)).unwrap_or(DQuat::IDENTITY)
    }

    fn key_xyzw(&self, key: usize) -> [f64; 4] {
        let key = self.key(key);
        [0, 1, 2, 3].map(|i| key.value(i))
    }

    fn span(&self, time_secs: f64) -> Span {
        let last = self.times_secs.len() - 1;
        let n_passed = self.times_secs.partition_point(|&key_secs| key_secs <= time_secs);
        let (from, to) = (n_passed.saturating_sub(1), n_passed.min(last));
        let length_secs = self.times_secs[to] - self.times_secs[from];
        let fraction = if length_secs > 0.0 {
            (time_secs - self.times_secs[from]) / length_secs
        } else {
            0.0
        };
        Span {
            from,
            to,
            fraction,
            length_secs,
        }
    }

    fn key(&self, key: usize) -> Key<'_> {
        let n_numbers = self.interpolation.values_per_key() * self.width;
        let numbers = &self.values[key * n_numbers..(key + 1) * n_numbers];
        Key {
            numbers,
            width: self.width,
            interpolation: self.interpolation,
        }
    }
}

/// Numbers stored for one key.
struct Key<'a> {
    numbers: &'a [f32],
    width: usize,
    interpolation: Interpolation,
}

impl Key<'_> {
    fn value(&self, i: usize) -> f64 {
        match self.interpolation {
            Interpolation::Cubic => f64::from(self.numbers[self.width + i]),
            Interpolation::Step | Interpolation::Linear => f64::from(self.numbers[i]),
        }
    }

    fn in_tangent(&self, i: usize) -> f64 {
        match self.interpolation {
            Interpolation::Cubic => f64::from(self.numbers[i]),
            Interpolation::Step | Interpolation::Linear => 0.0,
        }
    }

    fn out_tangent(&self, i: usize) -> f64 {
        match self.interpolation {
            Interpolation::Cubic => f64::from(self.numbers[2 * self.width + i]),
            Interpolation::Step | Interpolation::Linear => 0.0,
        }
    }
}

/// Weights of value and out-tangent of the first key, then value and in-tangent of the second.
fn hermite(t: f64, length_secs: f64) -> [f64; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [
        2.0 * t3 - 3.0 * t2 + 1.0,
        length_secs * (t3 - 2.0 * t2 + t),
        3.0 * t2 - 2.0 * t3,
        length_secs * (t3 - t2),
    ]
}
