//! The reach of noise, measured within blocks.

/// Side of a block of pixels in which noise is separated from texture.
pub(super) const BLOCK_PX: u32 = 8;
/// Pixels along a side of a block.
const SIDE: usize = BLOCK_PX as usize;
/// Pixels of a block.
const N: f64 = (BLOCK_PX * BLOCK_PX) as f64;
/// Number of halvings of the step in the search of the weights, of which the last is 1 / 256.
const N_HALVINGS: i32 = 7;

/// Noise that is white noise, averaged along rows and columns with a weight of 1 at the pixel itself
/// and these one and two pixels from it.
#[derive(Clone, Copy)]
pub(super) struct Reach {
    weights: [f64; 2],
}

impl Reach {
    /// From the covariances of pixels one and two apart around the means of blocks, over the
    /// variance around them: the nearest that weights from 0 to 1 can give. Two pairs of weights have
    /// nearly the same covariances; the one that falls no faster farther out is taken, as a
    /// denoiser's does.
    pub(super) fn of(measured: [f64; 2]) -> Self {
        let misfit = |reach: &Self| {
            let expected = reach.around_means();
            (expected[0] - measured[0]).powi(2) + (expected[1] - measured[1]).powi(2)
        };
        let reach = |[far, peaked]: [f64; 2]| Self {
            weights: [0.5 * peaked * (1.0 + far), far],
        };
        let mut best = [0.5; 2];
        for halving in 2..2 + N_HALVINGS {
            let step = 0.5_f64.powi(halving);
            let middle = best;
            for k in 0..25 {
                let at = [k % 5, k / 5].map(|k| f64::from(k - 2) * step);
                let tried = [0, 1].map(|axis| (middle[axis] + at[axis]).clamp(0.0, 1.0));
                if misfit(&reach(tried)) < misfit(&reach(best)) {
                    best = tried;
                }
            }
        }
        reach(best)
    }

    pub(super) fn weights(self) -> [f32; 2] {
        #[allow(clippy::cast_possible_truncation, reason = "from 0 to 1")]
        self.weights.map(|weight| weight as f32)
    }

    /// Variance of the noise over the median of blocks' variances with N - 1 degrees of freedom: a
    /// block's mean has a part of the noise, and the median of few independent pixels is less than
    /// their mean. Source: Wilson and Hilferty 1931.
    pub(super) fn whole(self) -> f32 {
        let of_mean = self.of_mean_along();
        let n_free = N / self.squared_along().powi(2);
        let of_median = (1.0 - 2.0 / (9.0 * n_free)).powi(3);
        #[allow(clippy::cast_possible_truncation, reason = "a factor near 1")]
        let whole = ((1.0 - 1.0 / N) / ((1.0 - of_mean * of_mean) * of_median)) as f32;
        whole
    }

    /// Correlation of pixels this far apart along a row or column.
    fn correlation(self, apart: usize) -> f64 {
        let [near, far] = self.weights;
        let weights = [far, near, 1.0, near, far];
        let of = |apart: usize| -> f64 {
            let pairs = weights.iter().zip(weights.iter().skip(apart));
            pairs.map(|(a, b)| a * b).sum()
        };
        of(apart) / of(0)
    }

    /// Mean correlation of a place along a block with all of them.
    fn along(self, place: usize) -> f64 {
        (0..SIDE)
            .map(|other| self.correlation(place.abs_diff(other)))
            .sum::<f64>()
            / SIDE as f64
    }

    /// Variance of the mean along a block.
    fn of_mean_along(self) -> f64 {
        (0..SIDE).map(|place| self.along(place)).sum::<f64>() / SIDE as f64
    }

    /// Sum of squared correlations along a block, per place.
    fn squared_along(self) -> f64 {
        let pairs = (0..SIDE * SIDE).map(|k| (k % SIDE).abs_diff(k / SIDE));
        pairs.map(|apart| self.correlation(apart).powi(2)).sum::<f64>() / SIDE as f64
    }

    /// Covariances of pixels one and two apart around the means of blocks, over the variance there.
    fn around_means(self) -> [f64; 2] {
        let of_mean = self.of_mean_along();
        [1, 2].map(|apart| {
            let n_pairs = SIDE - apart;
            let ends = (0..n_pairs).map(|place| self.along(place) + self.along(place + apart));
            let with_mean = of_mean * ends.sum::<f64>() / n_pairs as f64;
            let around = self.correlation(apart) - with_mean + of_mean * of_mean;
            around / (1.0 - of_mean * of_mean)
        })
    }
}
