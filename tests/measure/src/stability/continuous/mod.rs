//! Small changes of a parameter must cause small changes of the picture.
//!
//! If the real world changes, it is photographed for each step, and a step of the picture is
//! compared with the truth's. If only the core's input changes, the photographs stay, and a step is
//! compared with the median one.

mod camera;
mod light;
mod pixels;
mod time;
mod toy;

use app_core::scene::Image;

use super::case::{Case, Scope};
use super::gap::Gap;
use super::lab::{Lab, Label, Made};
use super::row::{Bound, Findings, Row, Sweep};
use crate::median::median;
use crate::photographer::{Shot, World};
use desk::metrics::score;

/// Ratio to the truth's step at the same place, or to the sweep's median if that is larger.
const JUMP: Bound = Bound {
    limit: 4.0,
    unit: "times",
    meaning: "largest step (RMS) over that of the truth",
};
/// The same for an unchanged or missing truth.
const UNEVEN: Bound = Bound {
    limit: 4.0,
    unit: "times",
    meaning: "largest step (RMS) over the median step",
};
/// RMS in codes up to which a step is rounding.
const ROUNDING_CODES: f64 = 0.1;
const GROUP: &str = "continuous";

/// The group's cases.
pub(super) const CASES: &[Case] = &[
    Case::new(GROUP, "time", Scope::Whole, time::through_a_clip),
    Case::new(GROUP, "time-at-keys", Scope::Quick, time::at_keys),
    Case::new(GROUP, "light-elevation", Scope::Whole, light::elevation),
    Case::new(GROUP, "light-distance", Scope::Whole, light::distance),
    Case::new(GROUP, "light-radius-small", Scope::Quick, light::small_radius),
    Case::new(GROUP, "light-radius-large", Scope::Whole, light::large_radius),
    Case::new(GROUP, "light-radius-told", Scope::Whole, light::told_radius),
    Case::new(GROUP, "camera-edge-on", Scope::Whole, camera::edge_on),
    Case::new(GROUP, "toy-height", Scope::Whole, toy::height),
    Case::new(GROUP, "brightness", Scope::Whole, pixels::brightness),
    Case::new(GROUP, "noise", Scope::Whole, pixels::noise),
];

/// One moment of a sweep.
struct Moment {
    at: f64,
    made: Made,
    truth: Option<Image>,
    /// RMSE of toy and shadow against the truth.
    errors: Option<[f64; 2]>,
}

/// Two neighbouring moments of a sweep.
struct Step {
    at: f64,
    made: Gap,
    truth: Option<Gap>,
}

/// Photographs and renders each world of a sweep.
fn photographed(
    lab: &mut Lab,
    worlds: impl IntoIterator<Item = (f64, World)>,
) -> anyhow::Result<Vec<Moment>> {
    let mut moments = Vec::new();
    for (at, world) in worlds {
        let shot = Shot::of(&world)?;
        moments.push(moment(lab, at, &shot)?);
    }
    Ok(moments)
}

fn moment(lab: &mut Lab, at: f64, shot: &Shot) -> anyhow::Result<Moment> {
    let made = lab.picture(shot);
    let errors = match &made {
        Ok(picture) => {
            let scores = score(picture, &shot.truth)?;
            Some([scores.toy.rmse, scores.shadow.rmse])
        }
        Err(_) => None,
    };
    Ok(Moment {
        at,
        made,
        truth: Some(shot.truth.image.clone()),
        errors,
    })
}

/// Rows and drawings of a sweep. `also` is an optional bound of the largest difference of a colour
/// in one step.
fn findings(
    label: Label,
    along: &'static str,
    moments: Vec<Moment>,
    also: Option<Bound>,
) -> anyhow::Result<Findings> {
    let mut rows = Vec::new();
    let mut kept = Vec::new();
    for moment in moments {
        match moment.made {
            Ok(picture) => kept.push((moment.at, picture, moment.truth, moment.errors)),
            Err(error) => rows.push(label.refused(format!("{along}: {:.6}", moment.at), JUMP, error)?),
        }
    }
    let steps: Vec<Step> = kept
        .windows(2)
        .map(|pair| Step {
            at: pair[1].0,
            made: Gap::between(&pair[0].1, &pair[1].1),
            truth: pair[0]
                .2
                .as_ref()
                .zip(pair[1].2.as_ref())
                .map(|(a, b)| Gap::between(a, b)),
        })
        .collect();
    rows.extend(worst_jump(label, along, &steps));
    if let Some(bound) = also {
        rows.extend(largest_difference(label, along, &steps, bound));
    }
    let errors = |index: usize| {
        let points = kept
            .iter()
            .filter_map(|(at, _, _, errors)| Some([*at, (*errors)?[index]]));
        points.collect::<Vec<_>>()
    };
    let of_steps = |value: fn(&Step) -> Option<f64>| {
        let points = steps.iter().filter_map(|step| Some([step.at, value(step)?]));
        points.collect::<Vec<_>>()
    };
    let mut sweeps = vec![Sweep {
        name: label.case.to_owned(),
        along,
        measure: "change in a step, codes",
        lines: vec![
            ("RMS", of_steps(|step| Some(step.made.rms))),
            ("RMS of the truth", of_steps(|step| step.truth.map(|gap| gap.rms))),
            ("99.9 %", of_steps(|step| Some(step.made.p999))),
            (
                "99.9 % of the truth",
                of_steps(|step| step.truth.map(|gap| gap.p999)),
            ),
        ],
    }];
    if !errors(0).is_empty() {
        sweeps.push(Sweep {
            name: format!("{}-errors", label.case),
            along,
            measure: "RMSE, codes",
            lines: vec![("toy", errors(0)), ("shadow", errors(1))],
        });
    }
    Ok(Findings { rows, sweeps })
}

fn worst_jump(label: Label, along: &str, steps: &[Step]) -> Option<Row> {
    let median_of = |value: fn(&Step) -> f64| median(steps.iter().map(value).collect()).unwrap_or(0.0);
    let is_photographed = steps
        .iter()
        .all(|step| step.truth.is_some_and(|gap| gap.rms > 0.0));
    let median = if is_photographed {
        median_of(|step| step.truth.map_or(0.0, |gap| gap.rms))
    } else {
        median_of(|step| step.made.rms)
    };
    let expected = |step: &Step| {
        let truth = step.truth.map_or(0.0, |gap| gap.rms);
        truth.max(median).max(ROUNDING_CODES)
    };
    let worst = steps.iter().max_by(|a, b| {
        let [a, b] = [a, b].map(|step| step.made.rms / expected(step));
        a.total_cmp(&b)
    })?;
    let bound = if is_photographed { JUMP } else { UNEVEN };
    let parameter = format!("{along}: worst at {:.6}", worst.at);
    let mut row = label.row(parameter, bound, worst.made.rms / expected(worst));
    row.note = format!(
        "RMS {:.3}, 99.9 % {}, most {} codes; median {median:.3}",
        worst.made.rms, worst.made.p999, worst.made.max
    );
    if let Some(truth) = worst.truth {
        row.note += &format!("; truth's own RMS {:.3}, 99.9 % {}", truth.rms, truth.p999);
    }
    Some(row)
}

fn largest_difference(label: Label, along: &str, steps: &[Step], bound: Bound) -> Option<Row> {
    let worst = steps.iter().max_by(|a, b| a.made.max.total_cmp(&b.made.max))?;
    let parameter = format!("{along}: worst at {:.6}", worst.at);
    let mut row = label.row(parameter, bound, worst.made.max);
    row.note = format!("RMS {:.3}, 99.9 % {} codes", worst.made.rms, worst.made.p999);
    if let Some(truth) = worst.truth {
        row.note += &format!("; most of the truth {}", truth.max);
    }
    Some(row)
}

/// Numbers from `from` to `to`, ends included, evenly spaced.
fn evenly(n: u32, from: f64, to: f64) -> impl Iterator<Item = f64> {
    (0..n).map(move |i| from + (to - from) * f64::from(i) / f64::from(n - 1))
}
