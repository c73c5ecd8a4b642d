//! Selection of the texts for each state.

use super::words::Words;
use crate::app::{
    App, Language, LensFailure, Notice, Obstacle, PhoneQuestion, Placing, PlateRefusal, PlateStep, Recorded,
    RefusalKind, Saved, Simplified, Step, ToyRefusal, Verdict,
};
use app_alignment::NoLight;
use app_pipeline::core::CoreError;
use app_pipeline::gpu::GpuError;
use app_scene::camera_frame::Tracking;
use app_session::recording::{Ending, RecordingOutcome};

pub(super) use super::words::*;

/// Title and instructions of the current step.
pub(super) fn of_step(app: &App) -> Option<(Words, Words)> {
    Some(match app.step() {
        Step::Welcome => (WELCOME, WELCOME_HINT),
        Step::FindTable if app.sees_card() => (CARD_SEEN, CARD_SEEN_HINT),
        Step::FindTable if app.reticle().is_some() => (TABLE_FOUND, TABLE_FOUND_HINT),
        Step::FindTable => (SHOW_TABLE, SHOW_TABLE_HINT),
        Step::TakePlate => (KEEP_STILL, PLATE_HINT),
        Step::PlaceToy if app.is_taking_lens() => (KEEP_STILL, LENS_HINT),
        Step::PlaceToy => of_placing(app.placing()),
        Step::Align => (LOOKING, ALIGN_HINT),
        Step::Play => return None,
    })
}

/// Text in the language of the app.
pub(super) fn say(app: &App, words: Words) -> &'static str {
    words.in_language(app.language())
}

fn of_placing(placing: Placing) -> (Words, Words) {
    match placing {
        Placing::Waiting { is_long: false } => (PUT_TOY, PUT_TOY_HINT),
        Placing::Waiting { is_long: true } => (PUT_TOY, TAP_TOY_HINT),
        Placing::Looking => (LOOKING, LOOKING_HINT),
        Placing::Asked { is_searching: true } => (ASK, ASK_SEARCHING),
        Placing::Asked { is_searching: false } => (ASK, ASK_HINT),
        Placing::ByHand => (BY_HAND, BY_HAND_HINT),
    }
}

/// The obstacle and its remedy.
pub(super) fn of_obstacle(obstacle: Obstacle) -> (Words, Words) {
    match obstacle {
        Obstacle::NoAr => (NO_AR_HERE, NO_AR_HINT),
        Obstacle::CameraDenied => (CAMERA_NEEDED, CAMERA_NEEDED_HINT),
        Obstacle::CameraBarred => (CAMERA_BARRED, CAMERA_BARRED_HINT),
        Obstacle::TooHot => (TOO_HOT, TOO_HOT_HINT),
        Obstacle::Installing => (LOOKING, INSTALLING_HINT),
        Obstacle::Interrupted => (INTERRUPTED, INTERRUPTED_HINT),
        Obstacle::ArFailed => (AR_FAILED, AR_FAILED_HINT),
        Obstacle::Preparing => (PREPARING, PREPARING_HINT),
        Obstacle::Tracking(tracking) => match tracking {
            Tracking::Starting | Tracking::Normal => (LOOK_AROUND, LOOK_AROUND_HINT),
            Tracking::TooFast => (SLOWER, SLOWER_HINT),
            Tracking::TooPlain => (TOO_PLAIN, TOO_PLAIN_HINT),
            Tracking::TooDark => (TOO_DARK, TOO_DARK_HINT),
            Tracking::Relocalising => (RELOCALISING, RELOCALISING_HINT),
        },
    }
}

pub(super) fn of_notice(notice: &Notice, language: Language) -> String {
    let words = match notice {
        Notice::NoTableThere => NO_TABLE_THERE,
        Notice::ToyMissed(Verdict::Missed { .. }) => TOY_MISSED,
        Notice::ToyMissed(Verdict::Found { .. }) => TOY_CUT_OFF,
        Notice::ToyMissed(Verdict::Failed(_)) => NOT_FITTED,
        Notice::NoPlate => NO_PLATE,
        Notice::PictureFailed => PICTURE_FAILED,
        Notice::VideoTooLarge => VIDEO_TOO_LARGE,
        Notice::LensTaken(1) => ONE_LIGHT,
        Notice::LensTaken(n_lights) => return N_LIGHTS.filled(language, &[n_lights]),
        Notice::LensFailed(LensFailure::NotDark) => LENS_NOT_DARK,
        Notice::LensFailed(LensFailure::NoLight) => LENS_NO_LIGHT,
        Notice::LensFailed(LensFailure::NotSeen) => LENS_NOT_SEEN,
        Notice::CardRefused => CARD_REFUSED,
        Notice::ToyRefused(refusal) => return of_refusal(refusal, language),
        Notice::WorldLost => WORLD_LOST,
        Notice::DeviceRestarted => DEVICE_RESTARTED,
        Notice::Restarted => RESTARTED,
        Notice::Saved(Saved::Done) => SAVED,
        Notice::Saved(Saved::NoRoom) => SAVED_NO_ROOM,
        Notice::Saved(Saved::NotAllowed) => SAVED_NOT_ALLOWED,
        Notice::Saved(Saved::NotShared) => SAVED_NOT_SHARED,
        Notice::Saved(Saved::Failed) => SAVED_FAILED,
        Notice::Recorded(recorded) => return of_recorded(recorded, language),
        Notice::NothingRecorded => NOTHING_RECORDED,
        Notice::RecordingDrops => RECORDING_DROPS,
        Notice::NoRoomToRecord => NO_ROOM_TO_RECORD,
        Notice::PhoneChecked { n_yes } => {
            return PHONE_CHECKED.filled(language, &[n_yes, &PhoneQuestion::ALL.len()]);
        }
        Notice::Simplified(Simplified::FailedLaunches) => FAILED_LAUNCHES,
        Notice::Simplified(Simplified::SelfTest(_)) => SELF_TEST_FAILED,
        Notice::MemoryLow => MEMORY_LOW,
    };
    words.in_language(language).to_owned()
}

/// Text for the platform's own view if nothing can be drawn, in two short lines.
#[must_use]
pub fn of_no_graphics(error: &CoreError, language: Language) -> &'static str {
    let words = match error {
        CoreError::Gpu(GpuError::KnownFault { .. }) => DRIVER_FAULT,
        CoreError::Gpu(GpuError::NoAdapter { .. } | GpuError::NoDevice { .. }) => NO_VULKAN,
        _ => GRAPHICS_FAILED,
    };
    words.in_language(language)
}

/// The same if the app ended unexpectedly more than once.
#[must_use]
pub fn of_closed(language: Language) -> &'static str {
    CLOSED.in_language(language)
}

/// The same if the person can begin anew by a touch.
#[must_use]
pub fn of_stopped(language: Language) -> &'static str {
    STOPPED.in_language(language)
}

/// The file, the kind of the reason, and the way out; the log has the reason itself.
fn of_refusal(refusal: &ToyRefusal, language: Language) -> String {
    let file = &refusal.file;
    match &refusal.kind {
        RefusalKind::Unreadable => TOY_UNREADABLE.filled(language, &[file]),
        RefusalKind::TooLarge(most_mib) => TOY_TOO_LARGE.filled(language, &[file, most_mib]),
        RefusalKind::Foreign => TOY_FOREIGN.filled(language, &[file]),
        RefusalKind::Extension(name) => TOY_EXTENSION.filled(language, &[file, name]),
        RefusalKind::TooMany { field, found, limit } => {
            TOY_TOO_MANY.filled(language, &[file, field, found, limit])
        }
        RefusalKind::External => TOY_EXTERNAL.filled(language, &[file]),
        RefusalKind::NoTriangles => TOY_EMPTY.filled(language, &[file]),
        RefusalKind::Picture => TOY_PICTURE.filled(language, &[file]),
        RefusalKind::Damaged { field } => TOY_DAMAGED.filled(language, &[file, field]),
    }
}

fn of_recorded(recorded: &Recorded, language: Language) -> String {
    let RecordingOutcome {
        n_frames,
        n_dropped,
        ending,
        ..
    } = &recorded.outcome;
    let why = match ending {
        Ending::Asked | Ending::Died => String::new(),
        Ending::NoRoom => ENDED_NO_ROOM.filled(language, &[]),
        Ending::TooLarge => ENDED_TOO_LARGE.filled(language, &[]),
        Ending::NotAllowed => ENDED_NOT_ALLOWED.filled(language, &[]),
        // The log has the reason.
        Ending::Failed(_) => ENDED_FAILED.filled(language, &[]),
    };
    if *ending == Ending::Died {
        return RECORDING_DIED.filled(language, &[&recorded.file]);
    }
    let lacks = match n_dropped {
        0 => String::new(),
        n_dropped => RECORDED_LACKS.filled(language, &[n_dropped]),
    };
    match n_frames {
        1 => RECORDED_ONE.filled(language, &[&why, &lacks, &recorded.file]),
        n_frames => RECORDED.filled(language, &[&why, n_frames, &lacks, &recorded.file]),
    }
}

/// Accuracy of the toy's pose, and missing knowledge.
pub(super) fn of_verdict(verdict: &Verdict, language: Language) -> String {
    let tenths = |px: &f64| format!("{px:.1}");
    match verdict {
        Verdict::Found {
            no_light: Some(reason),
            ..
        } => GUESSED.filled(language, &[&of_no_light(*reason).in_language(language)]),
        Verdict::Found {
            outline_px: Some(outline_px),
            ..
        } => FITTED.filled(language, &[&tenths(outline_px)]),
        Verdict::Found { outline_px: None, .. } => LITTLE_SEEN.filled(language, &[]),
        Verdict::Missed { outline_px } => TOY_LOST.filled(language, &[&tenths(outline_px)]),
        Verdict::Failed(_) => NOT_FITTED.filled(language, &[]),
    }
}

fn of_no_light(reason: NoLight) -> Words {
    match reason {
        NoLight::PoseUnknown => POSE_UNKNOWN,
        NoLight::ReceiversUnseen => RECEIVERS_UNSEEN,
        _ => NO_LIGHT_STANDS_OUT,
    }
}

/// The question for a new phone.
pub(super) fn of_question(question: PhoneQuestion) -> Words {
    match question {
        PhoneQuestion::Axes => ASK_AXES,
        PhoneQuestion::Turned => ASK_TURNED,
        PhoneQuestion::Square => ASK_SQUARE,
        PhoneQuestion::Greys => ASK_GREYS,
        PhoneQuestion::Colours => ASK_COLOURS,
        PhoneQuestion::Upright => ASK_UPRIGHT,
        PhoneQuestion::Ruler => ASK_RULER,
        PhoneQuestion::Delay => ASK_DELAY,
        PhoneQuestion::Held => ASK_HELD,
        PhoneQuestion::Return => ASK_RETURN,
    }
}

/// Announcement for screen readers of a step, or of the question about the toy's place.
#[must_use]
pub fn announced(app: &App) -> String {
    let said = of_step(app);
    said.map_or_else(String::new, |(title, hint)| {
        let [title, hint] = [title, hint].map(|words| words.in_language(app.language()));
        format!("{title}. {hint}")
    })
}

/// Progress of the photograph of the empty place, from 0 to 1, and advice.
pub(super) fn of_plate_step(step: &PlateStep) -> (Option<f32>, Words) {
    match step {
        PlateStep::Growing { n, n_needed } => {
            let part = f64::from(*n) / f64::from((*n_needed).max(1));
            (Some(super::input::narrowed(part)), PLATE_GROWING)
        }
        PlateStep::Taken { .. } => (Some(1.0), PLATE_DONE),
        PlateStep::Refused(refusal) => {
            let help = match refusal {
                PlateRefusal::NoPicture | PlateRefusal::NoCamera => PLATE_WAITING,
                PlateRefusal::Moving => PLATE_MOVING,
                PlateRefusal::Blurred => PLATE_BLURRED,
                PlateRefusal::Obstructed => PLATE_OBSTRUCTED,
                PlateRefusal::Exposure => PLATE_EXPOSURE,
            };
            (None, help)
        }
    }
}
