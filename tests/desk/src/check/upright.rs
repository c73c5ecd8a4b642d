//! The check for a toy whose file has another up axis than glTF: it lies on its back, and
//! alignment, which searches near the given pose, fails. This check turns it about each axis in
//! quarter turns.

use app_core::alignment::{Aligner, AlignmentWarning};
use app_core::session::{Session, SessionFrame};
use glam::{DMat4, DQuat, DVec3};

use crate::alignment::{Alignments, Asked};

/// A turn is suggested only if the toy needs no larger rotation in addition, in radians.
const MOST_BESIDE: f64 = 0.35;

/// A turn with which the toy fits.
struct Fitting {
    words: &'static str,
    world_from_object: DMat4,
    outline_px: f64,
}

/// The suggestion for a toy that does not fit as given in a frame: the turn with which it does, if
/// one of the likely ones does.
pub(super) fn offered(session: &dyn Session, index: usize, asked: Asked) -> Option<String> {
    let frame = session.frame(index).ok()?;
    let turns = [
        (
            "by -90 degrees about its x axis, as a file with Z up needs",
            DVec3::NEG_X,
            1.0,
        ),
        ("by 90 degrees about its x axis", DVec3::X, 1.0),
        ("by 90 degrees about its z axis", DVec3::Z, 1.0),
        ("by -90 degrees about its z axis", DVec3::NEG_Z, 1.0),
        ("by 90 degrees about its y axis", DVec3::Y, 1.0),
        ("by -90 degrees about its y axis", DVec3::NEG_Y, 1.0),
        ("by 180 degrees about its x axis", DVec3::X, 2.0),
        ("by 180 degrees about its y axis", DVec3::Y, 2.0),
    ];
    let tried = turns.into_iter().filter_map(|(words, axis, quarters)| {
        let turn = DQuat::from_axis_angle(axis, quarters * std::f64::consts::FRAC_PI_2);
        let world_from_object = frame.world_from_object * DMat4::from_quat(turn);
        fitting(session, &frame, (words, world_from_object), asked)
    });
    let best = tried.min_by(|one, other| one.outline_px.total_cmp(&other.outline_px))?;
    let numbers = best
        .world_from_object
        .to_cols_array()
        .map(|number| format!("{number:.6}"));
    Some(format!(
        "frames[{index}]: turned {} the toy fits, its outline within {:.2} px: give toy.world_from_object [{}], and delete any world_from_object of frames, or turn the model upright and export it again",
        best.words,
        best.outline_px,
        numbers.join(", ")
    ))
}

fn fitting(
    session: &dyn Session,
    frame: &SessionFrame,
    (words, world_from_object): (&'static str, DMat4),
    asked: Asked,
) -> Option<Fitting> {
    let scene = asked.lights.known(session.scene());
    let mut aligner = Aligner::new(scene.with_world_from_object(world_from_object));
    let turned = SessionFrame {
        world_from_object,
        ..frame.clone()
    };
    let found = aligner.align(&asked.lights.input(&turned)).ok()?;
    let does_not_fit = |warning: &AlignmentWarning| {
        matches!(
            warning,
            AlignmentWarning::Misaligned { .. } | AlignmentWarning::ListUnexplained { .. }
        )
    };
    let pose = found.report.pose.as_ref()?;
    let is_it = pose.turned_rad <= MOST_BESIDE && !found.warnings.iter().any(does_not_fit);
    is_it.then_some(Fitting {
        words,
        world_from_object,
        outline_px: pose.outline_px,
    })
}

/// Whether the toy of a frame does not fit the picture in its given pose.
pub(super) fn is_misaligned(alignments: &Alignments, index: usize) -> bool {
    let warnings = alignments.of(index).map(|aligned| &aligned.alignment.warnings);
    warnings
        .into_iter()
        .flatten()
        .any(|warning| matches!(warning, AlignmentWarning::Misaligned { .. }))
}
