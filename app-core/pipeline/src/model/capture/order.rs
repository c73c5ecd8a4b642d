//! The order of the capture path's steps: the same list is planned and run.

use crate::model::capture::estimate;
use crate::model::capture::fit::{Subject, Task};
use crate::model::capture::{detail, lit, withhold};
use crate::model::lighting;
use crate::model::plan::Plan;
use crate::plan::Change;

/// Rounds in which plate and light are estimated from one another.
const N_ESTIMATE_ROUNDS: u32 = 3;

/// One step of the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Step {
    /// Resets the scene state.
    Forget,
    /// Resets the sums of fits and lit colours.
    ForgetSums,
    /// Visibility of the lights in the physical pose.
    Lighting(lighting::Step),
    Gbuffer,
    Validity,
    Plate,
    Withhold,
    Lit,
    FillLit,
    Estimate,
    Fit(Task),
    Residual {
        is_first: bool,
    },
    FillResidual,
    Detail,
    Tint,
    TintFill,
    Appearance,
}

impl Step {
    /// The passes that it runs, in order.
    pub(crate) fn passes(self) -> &'static [&'static str] {
        match self {
            Self::Forget | Self::ForgetSums => &[],
            Self::Lighting(step) => step.passes(),
            Self::Gbuffer => &["gbuffer"],
            Self::Validity => &["validity"],
            Self::Plate => &["plate"],
            Self::Withhold => &["withhold"],
            Self::Lit => &["lit"],
            Self::FillLit | Self::FillResidual => &["fill"],
            Self::Estimate => &["estimate"],
            Self::Fit(_) => &["fit", "fit_solve"],
            Self::Residual { .. } => &["residual"],
            Self::Detail => &["detail"],
            Self::Tint => &["tint"],
            Self::TintFill => &["tint_fill"],
            Self::Appearance => &["appearance"],
        }
    }

    /// Whether it runs for a new picture of a known view after so many: the two means over several pictures take turns.
    pub(crate) fn is_due(self, n_before: u32) -> bool {
        match self {
            Self::Residual { .. } | Self::FillResidual => n_before.is_multiple_of(2),
            Self::Tint | Self::TintFill => !n_before.is_multiple_of(2),
            _ => true,
        }
    }
}

/// The steps that run for `change`.
pub(crate) fn order(plan: &Plan, change: Change) -> Vec<Step> {
    let mut steps = Vec::new();
    match change {
        Change::Pose => return steps,
        Change::Picture => steps.push(fit_intensities(plan, false)),
        Change::View => {
            add_view(&mut steps, plan);
            add_if(&mut steps, withhold::is_needed(plan), [Step::Withhold]);
            steps.push(fit_intensities(plan, estimate::is_needed(plan)));
            add_light(&mut steps, plan, false);
            add_rest_of_fits(&mut steps, plan, false);
        }
        Change::Scene => {
            steps.push(Step::Forget);
            add_view(&mut steps, plan);
            add_light(&mut steps, plan, true);
            if estimate::is_needed(plan) {
                // The first estimate was pooled with the prior's direct fractions.
                for _ in 1..N_ESTIMATE_ROUNDS {
                    steps.push(Step::ForgetSums);
                    add_light(&mut steps, plan, true);
                }
            }
            // The first fits need the real shadow.
            add_if(&mut steps, withhold::is_needed(plan), [Step::Withhold]);
            add_rest_of_fits(&mut steps, plan, true);
        }
    }
    let is_first = change >= Change::Scene;
    steps.extend([Step::Residual { is_first }, Step::FillResidual]);
    add_if(&mut steps, detail::is_needed(plan), [Step::Detail]);
    steps.extend([Step::Tint, Step::TintFill]);
    add_if(&mut steps, change >= Change::View, [Step::Appearance]);
    steps
}

/// Inputs of the fits: geometry of the physical pose, and the plate.
fn add_view(steps: &mut Vec<Step>, plan: &Plan) {
    steps.extend([
        Step::Lighting(lighting::Step::SelfShadow),
        Step::Gbuffer,
        Step::Validity,
    ]);
    steps.extend(lighting::Step::visibilities(plan).map(Step::Lighting));
    steps.push(Step::Plate);
}

/// Fits each receiver in turn, the first as prior of the others; before it, what they look like in the light where plates are
/// missing.
fn add_light(steps: &mut Vec<Step>, plan: &Plan, is_first: bool) {
    add_if(steps, lit::is_needed(plan), [Step::Lit, Step::FillLit]);
    let fit = |receiver| fit(plan, Subject::Receiver, receiver, is_first);
    steps.extend((0..plan.n_receivers).map(fit));
}

/// Steps that need the receivers' fits: the estimate, and the light on the toy.
fn add_rest_of_fits(steps: &mut Vec<Step>, plan: &Plan, is_first: bool) {
    add_if(steps, estimate::is_needed(plan), [Step::Estimate]);
    steps.push(fit(plan, Subject::Toy, 0, is_first));
}

/// Fits exposure and intensities of this picture. A jump of the exposure makes every pixel an outlier, so that
/// weights start anew.
fn fit_intensities(plan: &Plan, completes_plate: bool) -> Step {
    Step::Fit(Task {
        subject: Subject::Intensities,
        receiver: 0,
        n_steps: plan.n_intensity_steps,
        is_refinement: false,
        completes_plate,
    })
}

fn fit(plan: &Plan, subject: Subject, receiver: u32, is_first: bool) -> Step {
    Step::Fit(Task {
        subject,
        receiver,
        n_steps: if is_first {
            plan.n_fit_steps
        } else {
            plan.n_refine_steps
        },
        is_refinement: !is_first,
        completes_plate: subject == Subject::Receiver && estimate::is_needed(plan),
    })
}

fn add_if<const N: usize>(steps: &mut Vec<Step>, is_needed: bool, more: [Step; N]) {
    if is_needed {
        steps.extend(more);
    }
}
