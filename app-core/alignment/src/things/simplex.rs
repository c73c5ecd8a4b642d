//! Minimises a loss of three numbers, of which the first ones are free, by the downhill simplex.
//!
//! Source: Nelder and Mead 1965.

/// Loss and place of the best try. The simplex begins at a start, with one step along each free
/// number.
pub(super) fn descend(
    (start, step): ([f64; 3], f64),
    n_free: usize,
    n_tries: usize,
    mut loss: impl FnMut(&[f64; 3]) -> f64,
) -> (f64, [f64; 3]) {
    let stepped = |number: usize| {
        let mut to = start;
        to[number] += step;
        to
    };
    let mut corners: Vec<(f64, [f64; 3])> = std::iter::once(start)
        .chain((0..n_free).map(stepped))
        .map(|at| (loss(&at), at))
        .collect();
    let mut n_left = n_tries.saturating_sub(corners.len());
    while n_left > 0 {
        corners.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (worst, others) = match corners.split_last() {
            Some((worst, others)) if !others.is_empty() => (*worst, others),
            _ => break,
        };
        let middle = [0, 1, 2].map(|i| others.iter().map(|(_, at)| at[i]).sum::<f64>() / others.len() as f64);
        let along = |by: f64| [0, 1, 2].map(|i| middle[i] + by * (worst.1[i] - middle[i]));
        let second_worst = others[others.len() - 1].0;
        let mut tried = |by: f64| {
            let at = along(by);
            (loss(&at), at)
        };
        let reflected = tried(-1.0);
        n_left -= 1;
        let next = if reflected.0 < corners[0].0 {
            n_left = n_left.saturating_sub(1);
            let farther = tried(-2.0);
            Some(if farther.0 < reflected.0 {
                farther
            } else {
                reflected
            })
        } else if reflected.0 < second_worst {
            Some(reflected)
        } else {
            n_left = n_left.saturating_sub(1);
            let nearer = tried(if reflected.0 < worst.0 { -0.5 } else { 0.5 });
            (nearer.0 < worst.0.min(reflected.0)).then_some(nearer)
        };
        let last = corners.len() - 1;
        if let Some(next) = next {
            corners[last] = next;
            continue;
        }
        let best = corners[0].1;
        for corner in &mut corners[1..] {
            let at = [0, 1, 2].map(|i| 0.5 * (corner.1[i] + best[i]));
            *corner = (loss(&at), at);
        }
        n_left = n_left.saturating_sub(last);
    }
    let best = corners.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
    best.unwrap_or((f64::INFINITY, start))
}
