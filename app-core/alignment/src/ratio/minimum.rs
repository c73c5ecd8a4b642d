//! Minimises a smooth loss of one number, by parabolas through few trials.

/// A new trial must be farther from an earlier one than this fraction of their spacing.
const APART: f64 = 0.05;

/// A tried number, and its loss.
#[derive(Clone, Copy, Debug)]
struct Tried {
    at: f64,
    loss: f64,
}

/// The parabola through three tries.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parabola {
    /// Place of the minimum.
    pub(super) at: f64,
    /// Increase of the loss at a distance of 1 from there.
    pub(super) bend: f64,
    /// The smallest loss of the trials.
    pub(super) loss: f64,
}

impl Parabola {
    /// The middle one has the least loss; `None` if all three are equal.
    fn through([a, b, c]: [Tried; 3]) -> Option<Self> {
        let slope = |from: Tried, to: Tried| (to.loss - from.loss) / (to.at - from.at);
        let bend = (slope(b, c) - slope(a, b)) / (c.at - a.at);
        (bend > 0.0).then(|| Self {
            at: 0.5 * (a.at + b.at) - 0.5 * slope(a, b) / bend,
            bend,
            loss: b.loss,
        })
    }
}

/// The range of a search.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    /// First trial.
    pub(super) start: f64,
    /// Distance of the next trials from it.
    pub(super) step: f64,
    /// Largest absolute value to try.
    pub(super) most: f64,
    /// Number of trials at the minimum of a parabola.
    pub(super) n_finer: usize,
}

/// Minimises the loss; `Ok(None)` if there is no minimum within the range, an error if a loss is
/// unknown.
pub(super) fn least<E>(
    span: Span,
    mut loss: impl FnMut(f64) -> Result<f64, E>,
) -> Result<Option<Parabola>, E> {
    let mut tried: Vec<Tried> = Vec::new();
    for step in [0.0, -span.step, span.step] {
        add(&mut tried, span.start + step, &mut loss)?;
    }
    loop {
        let place = place_of_least(&tried);
        let at = tried[place].at;
        let beyond = if place == 0 {
            at - span.step
        } else if place + 1 == tried.len() {
            at + span.step
        } else {
            break;
        };
        if beyond.abs() > span.most {
            return Ok(None);
        }
        add(&mut tried, beyond, &mut loss)?;
    }
    let mut found = None;
    for round in 0..=span.n_finer {
        let place = place_of_least(&tried);
        let three = [tried[place - 1], tried[place], tried[place + 1]];
        found = Parabola::through(three);
        let Some(parabola) = found.filter(|_| round < span.n_finer) else {
            break;
        };
        let is_known = |other: &Tried| (parabola.at - other.at).abs() < APART * (three[2].at - three[0].at);
        if three.iter().any(is_known) {
            break;
        }
        add(&mut tried, parabola.at, &mut loss)?;
    }
    Ok(found)
}

fn add<E>(tried: &mut Vec<Tried>, at: f64, loss: &mut impl FnMut(f64) -> Result<f64, E>) -> Result<(), E> {
    let one = Tried { at, loss: loss(at)? };
    let place = tried.partition_point(|other| other.at < at);
    tried.insert(place, one);
    Ok(())
}

/// The first one of equal minima; of three or more trials.
fn place_of_least(tried: &[Tried]) -> usize {
    let least = tried
        .iter()
        .enumerate()
        .min_by(|(_, a), (_, b)| a.loss.total_cmp(&b.loss));
    least.map_or(0, |(place, _)| place)
}
