//! Structural similarity as a map of the picture's own size.
//!
//! Gaussian window of 11 taps and the constants of the paper; beyond the border the picture is
//! mirrored, outermost pixel included (`d c b a | a b c d`). Scores are averaged over regions, so
//! the map must cover the border too. No library crate offers this definition.
//!
//! Source: Wang, Bovik, Sheikh, Simoncelli, "Image quality assessment: from error visibility to
//! structural similarity", IEEE Transactions on Image Processing 13(4), 2004, equation 13.

const WINDOW_SIGMA_PX: f64 = 1.5;
/// 3.5 sigma, rounded.
const WINDOW_RADIUS_PX: usize = 5;
/// (0.01 * 255)^2 and (0.03 * 255)^2: keep SSIM steady where a picture is black or flat.
const C1: f64 = 6.5025;
const C2: f64 = 58.5225;

/// Weights of the taps along one axis, from -5 to 5 pixels.
type Window = [f64; 2 * WINDOW_RADIUS_PX + 1];

/// The four local means in SSIM. Its two variances occur only as their sum, which is stored.
type Moments<T> = [T; 4];

/// Structural similarity around every pixel.
pub(super) fn map(a: &[f64], b: &[f64], width: usize) -> Vec<f64> {
    let window = window();
    let means = average_rows(a, b, width, &window);
    let height = a.len() / width;
    let mut similarities = Vec::with_capacity(a.len());
    let mut row: Moments<Vec<f64>> = std::array::from_fn(|_| vec![0.0; width]);
    for y in 0..height {
        for (row, means) in row.iter_mut().zip(&means) {
            average(row, &window, |tap| &means[reflect(y, tap, height) * width..]);
        }
        let [a, b, squares, product] = &row;
        similarities.extend((0..width).map(|x| similarity([a[x], b[x], squares[x], product[x]])));
    }
    similarities
}

fn similarity([a, b, squares, product]: Moments<f64>) -> f64 {
    let of_means = a * a + b * b;
    let variances = squares - of_means;
    let covariance = product - a * b;
    (2.0 * a * b + C1) * (2.0 * covariance + C2) / ((of_means + C1) * (variances + C2))
}

/// Averages a, b, a^2 + b^2 and a b along the rows.
fn average_rows(a: &[f64], b: &[f64], width: usize, window: &Window) -> Moments<Vec<f64>> {
    let columns = (0..width + 2 * WINDOW_RADIUS_PX)
        .map(|x| reflect(x, 0, width))
        .collect::<Vec<_>>();
    let terms: Moments<fn(f64, f64) -> f64> = [|a, _| a, |_, b| b, |a, b| a * a + b * b, |a, b| a * b];
    terms.map(|term| {
        let mut means = vec![0.0; a.len()];
        let mut padded = vec![0.0; columns.len()];
        let rows = a.chunks_exact(width).zip(b.chunks_exact(width));
        for ((a, b), means) in rows.zip(means.chunks_exact_mut(width)) {
            for (value, &x) in padded.iter_mut().zip(&columns) {
                *value = term(a[x], b[x]);
            }
            average(means, window, |tap| &padded[tap..]);
        }
        means
    })
}

/// Fills a row with the average, weighted by the window, of the rows that its taps read.
fn average<'rows>(row: &mut [f64], window: &Window, row_at_tap: impl Fn(usize) -> &'rows [f64]) {
    row.fill(0.0);
    for (tap, weight) in window.iter().enumerate() {
        for (sum, value) in row.iter_mut().zip(row_at_tap(tap)) {
            *sum += weight * value;
        }
    }
}

/// Weights of the Gaussian window; they add up to one.
fn window() -> Window {
    let weights = std::array::from_fn(|tap| {
        let offset = tap.abs_diff(WINDOW_RADIUS_PX) as f64 / WINDOW_SIGMA_PX;
        (-0.5 * offset * offset).exp()
    });
    let sum: f64 = weights.iter().sum();
    weights.map(|weight: f64| weight / sum)
}

/// The index that tap number `tap` of the window around `center` reads, folded back into `0..n`.
fn reflect(center: usize, tap: usize, n: usize) -> usize {
    // Adding whole periods of 2 n keeps the position above zero.
    let position = (center + tap + 2 * n * WINDOW_RADIUS_PX - WINDOW_RADIUS_PX) % (2 * n);
    position.min(2 * n - 1 - position)
}
