//! Every word of the interface, in one place.

use crate::app::{
    App, LensFailure, Notice, Obstacle, PhoneQuestion, PlateRefusal, PlateStep, Recorded, Saved, Simplified,
    Step, Verdict,
};
use app_pipeline::core::CoreError;
use app_pipeline::gpu::GpuError;
use app_scene::camera_frame::Tracking;
use app_session::recording::{Ending, RecordingOutcome};

/// What a person is about to do, and how.
pub(super) fn of_step(app: &App) -> (&'static str, String) {
    let (title, hint) = match app.step() {
        Step::Welcome => (
            "Bring your toy to life",
            "Put a toy on a table and look at it through the camera: it moves, and its own real shadow with it. The picture never leaves this device.",
        ),
        Step::FindTable if app.sees_card() => (
            "The card is seen",
            "Take the toy off the table, then tap the place where it will stand.",
        ),
        Step::FindTable => (
            "Show the table",
            "Take the toy off the table. Move the phone slowly, then tap the place where the toy will stand.",
        ),
        Step::TakePlate => ("Keep still", "The empty place is being photographed."),
        Step::PlaceToy if app.is_taking_lens() => {
            ("Keep still", "The lens on the card is being photographed.")
        }
        Step::PlaceToy => (
            "Put the toy there",
            "Put the toy on the table. Drag the yellow outline onto it, and turn it with two fingers.",
        ),
        Step::Align => ("One moment", "The outline is being fitted to the toy."),
        Step::Play => ("", ""),
    };
    (title, hint.to_owned())
}

/// What is in the way, and what helps.
pub(super) fn of_obstacle(obstacle: Obstacle) -> (&'static str, &'static str) {
    match obstacle {
        Obstacle::NoAr => (
            "This phone has no AR",
            "Its system cannot follow the camera, which this app needs.",
        ),
        Obstacle::CameraDenied => (
            "The camera is needed",
            "Without its picture there is nothing to animate. Nothing is sent anywhere.",
        ),
        Obstacle::CameraBarred => (
            "The camera is not allowed",
            "Allow it in the system's settings, then come back.",
        ),
        Obstacle::TooHot => ("The phone is too hot", "Let it cool down. It goes on by itself."),
        Obstacle::Installing => ("One moment", "What this phone needs for AR is looked for."),
        Obstacle::Interrupted => (
            "The camera is in use elsewhere",
            "It goes on here when that has ended.",
        ),
        Obstacle::ArFailed => ("Tracking has stopped", "Start over from the table."),
        Obstacle::Preparing => ("Getting ready", "Graphics are being prepared."),
        Obstacle::Tracking(tracking) => match tracking {
            Tracking::Starting | Tracking::Normal => ("Look around", "Move the phone slowly over the table."),
            Tracking::TooFast => ("Slower", "The phone moves too fast to be followed."),
            Tracking::TooPlain => (
                "Too little to hold on to",
                "Show more of the surroundings, or lay something patterned beside the toy.",
            ),
            Tracking::TooDark => ("Too dark", "Switch on a lamp."),
            Tracking::Relocalising => ("Where were we?", "Point the phone at the place where it was."),
        },
    }
}

pub(super) fn of_notice(notice: &Notice) -> String {
    match notice {
        Notice::NoTableThere => "No table was found there yet. Show more of it, then tap again.".to_owned(),
        Notice::ToyMissed {
            outline_px: Some(outline_px),
        } => format!("The outline is still {outline_px:.1} pixels off the toy. Put it nearer."),
        Notice::ToyMissed { outline_px: None } => {
            "The toy was not seen there. Put the outline over it.".to_owned()
        }
        Notice::LensTaken(1) => "The lens shows one light.".to_owned(),
        Notice::LensTaken(n_lights) => format!("The lens shows {n_lights} lights."),
        Notice::LensFailed(failure) => of_lens_failure(*failure).to_owned(),
        Notice::CardRefused => "This phone cannot look for the card. Go on without it.".to_owned(),
        Notice::ToyRefused(reason) => format!("This file is no toy for this app: {reason}"),
        Notice::WorldLost => "The phone has lost the place. Show the table again.".to_owned(),
        Notice::DeviceRestarted => "Graphics were set up again.".to_owned(),
        Notice::Restarted => {
            "Something went wrong inside the app, so it began anew. What was recorded is kept.".to_owned()
        }
        Notice::Saved(Saved::Done) => "Saved.".to_owned(),
        Notice::Saved(Saved::NoRoom) => "Not saved: there is no room left.".to_owned(),
        Notice::Saved(Saved::NotAllowed) => "Not saved: the system does not allow it.".to_owned(),
        Notice::Saved(Saved::Failed) => "Not saved: writing failed.".to_owned(),
        Notice::Recorded(recorded) => of_recorded(recorded),
        Notice::NothingRecorded => "Nothing was recorded: no frame came with a place.".to_owned(),
        Notice::RecordingDrops => "Writing is too slow: the recording lacks some frames.".to_owned(),
        Notice::NoRoomToRecord => "Nothing is recorded: there is too little room left.".to_owned(),
        Notice::PhoneChecked { n_yes } => {
            let n_asked = PhoneQuestion::ALL.len();
            format!("{n_yes} of {n_asked} are as they should be. The log has the answers.")
        }
        Notice::Simplified(simplified) => of_simplified(simplified),
        Notice::MemoryLow => "Memory is short: the recording was ended and saved.".to_owned(),
    }
}

fn of_lens_failure(failure: LensFailure) -> &'static str {
    match failure {
        LensFailure::NotDark => {
            "This camera cannot be darkened for the lens. Lights are found by the shadow."
        }
        LensFailure::NoLight => "No light is seen on the lens. Lights are found by the shadow.",
        LensFailure::NotSeen => "The lens is not in the picture. Show the whole card.",
    }
}

/// What the platform itself has to tell where nothing can be drawn: in two short lines.
#[must_use]
pub fn of_no_graphics(error: &CoreError) -> &'static str {
    match error {
        CoreError::Gpu(GpuError::KnownFault { .. }) => {
            "This app cannot run here: this phone's graphics driver has a known fault."
        }
        CoreError::Gpu(GpuError::NoAdapter { .. } | GpuError::NoDevice { .. }) => {
            "This app cannot run here: it needs graphics with Vulkan 1.1."
        }
        _ => "The app was closed: this phone's graphics failed.",
    }
}

/// The same where it ended by itself more than once.
pub const CLOSED: &str = "The app was closed: something went wrong again and again.";

/// Why the shadow is the simplest.
pub(super) fn of_simplified(simplified: &Simplified) -> String {
    match simplified {
        Simplified::FailedLaunches => {
            "The app ended unexpectedly, so it uses a simple shadow. The full one is in the menu.".to_owned()
        }
        Simplified::SelfTest(reason) => {
            format!(
                "This phone's graphics fail a test, so the shadow is a simple one: {reason}. The full one is in the menu."
            )
        }
    }
}

fn of_recorded(recorded: &Recorded) -> String {
    let RecordingOutcome {
        n_frames,
        n_dropped,
        ending,
        ..
    } = &recorded.outcome;
    let why = match ending {
        Ending::Asked => String::new(),
        Ending::NoRoom => "There is no room left. ".to_owned(),
        Ending::TooLarge => "It is as large as it may be. ".to_owned(),
        Ending::NotAllowed => "The system does not allow it. ".to_owned(),
        Ending::Failed(reason) => format!("It cannot be written: {reason}. "),
    };
    let lacks = match n_dropped {
        0 => String::new(),
        n_dropped => format!(", {n_dropped} are missing"),
    };
    format!("{why}{n_frames} frames are recorded{lacks}: {}", recorded.file)
}

/// How well the toy was found, and what is not known.
pub(super) fn of_verdict(verdict: &Verdict) -> String {
    match verdict {
        Verdict::Found {
            no_light: Some(reason),
            ..
        } => format!("The shadow is a guess: no light was found, since {reason}."),
        Verdict::Found {
            outline_px: Some(outline_px),
            ..
        } => format!("Fitted to {outline_px:.1} pixels"),
        Verdict::Found { outline_px: None, .. } => {
            "Too little of the toy is seen to check where it is.".to_owned()
        }
        Verdict::Missed { outline_px } => format!("Looking for the toy ({outline_px:.1} pixels off)"),
        Verdict::Failed(reason) => format!("It could not be fitted: {reason}"),
    }
}

/// What is asked of a new phone.
pub(super) fn of_question(question: PhoneQuestion) -> &'static str {
    match question {
        PhoneQuestion::Axes => {
            "Does green point up, do red and blue lie on the table, and do all stay in their place as you walk around them?"
        }
        PhoneQuestion::Turned => {
            "Turn the phone like a steering wheel, to the right and to the left. Do the arrows stay with the table?"
        }
        PhoneQuestion::Square => {
            "Look at the printed card. Does the white line lie on the edge of its pattern, in the middle of the picture and in each corner?"
        }
        PhoneQuestion::Greys => {
            "Hold white paper and something black beside the patches. Is the paper nearly as white, the other nearly as black, and neither tinted?"
        }
        PhoneQuestion::Colours => {
            "Hold something red, something green and something blue there. Do they look as in the phone's own camera app?"
        }
        PhoneQuestion::Upright => {
            "Is the picture upright, can letters be read, and is a cup seen from above as round as the circle?"
        }
        PhoneQuestion::Ruler => "Lay a ruler along the line. Is it 10 cm long, to a millimetre?",
        PhoneQuestion::Delay => {
            "Hold the phone before a mirror. In the mirror, is the same cell lit, or the one below it?"
        }
        PhoneQuestion::Held => {
            "Hold a white sheet into the picture, and take it away. Is the table as bright all the time?"
        }
        PhoneQuestion::Return => {
            "Lock the phone, or take a call, and come back. Is the picture there again, or a word on what to do?"
        }
    }
}

pub(super) const CHECK: &str = "Check this phone";
pub(super) const YES: &str = "Yes";
pub(super) const NO: &str = "No";
pub(super) const STOP: &str = "Enough";
pub(super) const ALLOW_CAMERA: &str = "Allow the camera";
pub(super) const BEGIN: &str = "Begin";
pub(super) const TRY_AGAIN: &str = "Try again";
pub(super) const LEAVE: &str = "To the first screen";
pub(super) const USE_CARD: &str = "I have the card";
pub(super) const NO_CARD: &str = "I have no card";
pub(super) const NO_AR: &str = "AR cannot begin";
pub(super) const OPEN_SETTINGS: &str = "Open settings";
pub(super) const SKIP_PLATE: &str = "The toy cannot be moved";
pub(super) const PLACED: &str = "It fits";
pub(super) const TAKE_LENS: &str = "Light from the lens";
pub(super) const BACK: &str = "Back";
pub(super) const START_OVER: &str = "Start over";
pub(super) const PLAY: &str = "Play";
pub(super) const PAUSE: &str = "Pause";
pub(super) const TIME: &str = "Time in the clip";
pub(super) const AUTHORED: &str = "Standing";
pub(super) const PHOTO: &str = "Photo";
pub(super) const VIDEO: &str = "Video";
pub(super) const END_VIDEO: &str = "End video";
pub(super) const MORE: &str = "More";
pub(super) const LESS: &str = "Close";
pub(super) const RECORD: &str = "Record the session";
pub(super) const END_RECORD: &str = "End the recording";
pub(super) const RECORDING: &str = "Recording";
pub(super) const PROFILE: &str = "Show times";
pub(super) const REPLACE: &str = "Move the outline";
pub(super) const RETAKE: &str = "Photograph the empty place";
pub(super) const PICK_TOY: &str = "Another toy";
pub(super) const WHERE_TOYS_ARE: &str =
    "Put toys of your own, as binary glTF files (.glb), into this app's folder, and they are listed here.";
pub(super) const SIMPLE: &str = "Simple shadow";
pub(super) const RESTORE: &str = "Full shadow";
pub(super) const SHARE: &str = "Share log and recording";

/// How far the photograph of the empty place is, from 0 to 1, and what helps.
pub(super) fn of_plate_step(step: &PlateStep) -> (Option<f32>, &'static str) {
    match step {
        PlateStep::Growing { n, n_needed } => {
            let part = f64::from(*n) / f64::from((*n_needed).max(1));
            (Some(super::input::narrowed(part)), "Good. Keep still.")
        }
        PlateStep::Taken { .. } => (Some(1.0), "Done."),
        PlateStep::Refused(refusal) => {
            let help = match refusal {
                PlateRefusal::NoPicture | PlateRefusal::NoCamera => "Waiting for the camera.",
                PlateRefusal::Moving => "Keep the phone still, or lean it on something.",
                PlateRefusal::Blurred => "The picture is not sharp yet.",
                PlateRefusal::Obstructed => "Something moves in the picture. Take your hand away.",
                PlateRefusal::Exposure => "The camera is still adapting to the light.",
            };
            (None, help)
        }
    }
}
