//! Events of an app, in arbitrary order.

use app_core::app::{ArSession, Filmed, GraphicsState, Permission, Saved, Thermal, UserAction, VideoEnding};
use app_core::camera_frame::Tracking;
use glam::DVec2;
use proptest::prelude::*;
use proptest::sample::select;

use crate::app::world;

/// An event.
#[derive(Clone, Debug)]
pub(crate) enum Happening {
    Permission(Permission),
    Foreground(bool),
    Surface(bool),
    Graphics(GraphicsState),
    ArSession(ArSession),
    /// A number of frames, 33 ms apart, 17 or 50.
    Frames(u8, i64, Tracking),
    /// The last frame again, or an older one.
    StaleFrame(bool),
    NewWorld,
    Thermal(Thermal),
    MemoryLow,
    Restarted,
    /// The alignment finds the toy at that distance in pixels from its drawn place, or sees too
    /// little of it.
    AlignmentEnds(Option<f64>),
    /// The alignment runs on a picture that shows no toy.
    AlignmentRuns,
    AlignmentDies,
    /// Other threads end their work, or end without a result.
    WorkEnds(bool),
    OtherToy(bool),
    Saved(Saved),
    Filmed(Filmed),
    PictureFails,
    /// The first or the last recording ends, on command or not.
    RecordingEnds(bool),
    FreeSpace(u64),
    User(UserAction),
}

pub(crate) fn happening() -> impl Strategy<Value = Happening> {
    let permission = select(vec![
        Permission::Unknown,
        Permission::Granted,
        Permission::Denied,
        Permission::Barred,
    ]);
    let device = select(vec![
        GraphicsState::Starting,
        GraphicsState::Ready,
        GraphicsState::Lost,
    ]);
    let ar_session = select(vec![
        ArSession::Able,
        ArSession::Installing,
        ArSession::Interrupted,
        ArSession::Failed,
        ArSession::Unsupported,
    ]);
    let tracking = prop_oneof![
        4 => Just(Tracking::Normal),
        1 => select(vec![Tracking::Starting, Tracking::TooFast, Tracking::Relocalising]),
    ];
    let thermal = select(vec![
        Thermal::Nominal,
        Thermal::Fair,
        Thermal::Serious,
        Thermal::Critical,
    ]);
    let saved = || select(vec![Saved::Done, Saved::NoRoom, Saved::NotAllowed, Saved::Failed]);
    let ending = select(vec![
        VideoEnding::Asked,
        VideoEnding::TooLarge,
        VideoEnding::Broken,
    ]);
    let filmed = (saved(), ending).prop_map(|(saved, ending)| Filmed { saved, ending });
    prop_oneof![
        1 => permission.prop_map(Happening::Permission),
        1 => any::<bool>().prop_map(Happening::Foreground),
        1 => any::<bool>().prop_map(Happening::Surface),
        1 => device.prop_map(Happening::Graphics),
        1 => ar_session.prop_map(Happening::ArSession),
        8 => (1_u8..20, select(vec![17_i64, 33, 50]), tracking).prop_map(|(n, ms, tracking)| Happening::Frames(n, ms, tracking)),
        1 => any::<bool>().prop_map(Happening::StaleFrame),
        1 => Just(Happening::NewWorld),
        1 => thermal.prop_map(Happening::Thermal),
        1 => Just(Happening::MemoryLow),
        1 => Just(Happening::Restarted),
        4 => select(vec![Some(0.1), Some(0.1), Some(1.9), None]).prop_map(Happening::AlignmentEnds),
        1 => Just(Happening::AlignmentRuns),
        1 => Just(Happening::AlignmentDies),
        4 => select(vec![true, true, true, false]).prop_map(Happening::WorkEnds),
        1 => any::<bool>().prop_map(Happening::OtherToy),
        1 => saved().prop_map(Happening::Saved),
        1 => filmed.prop_map(Happening::Filmed),
        1 => Just(Happening::PictureFails),
        1 => any::<bool>().prop_map(Happening::RecordingEnds),
        1 => select(vec![0, u64::MAX]).prop_map(Happening::FreeSpace),
        12 => action().prop_map(Happening::User),
    ]
}

fn action() -> impl Strategy<Value = UserAction> {
    let pixel = || (-10.0..80.0, -10.0..60.0).prop_map(|(x, y)| DVec2::new(x, y));
    let plain = vec![
        UserAction::Begin,
        UserAction::OpenSettings,
        UserAction::SkipPlate,
        UserAction::TapReticle,
        UserAction::ByHand,
        UserAction::LookAgain,
        UserAction::TakeLens,
        UserAction::Placed,
        UserAction::Placed,
        UserAction::Replace,
        UserAction::RetakePlate,
        UserAction::StartOver,
        UserAction::Leave,
        UserAction::TryAgain,
        UserAction::UseCard(true),
        UserAction::Choose(None),
        UserAction::Choose(world::toy().clip_ids().next()),
        UserAction::Play(false),
        UserAction::SavePhoto,
        UserAction::Video(true),
        UserAction::Video(false),
        UserAction::Record(true),
        UserAction::Record(false),
        UserAction::ShowProfile(true),
        UserAction::CheckPhone(true),
        UserAction::CheckPhone(false),
        UserAction::Answer(true),
        UserAction::Answer(true),
        UserAction::PickToy,
        UserAction::ChooseToy(Some(1)),
        UserAction::ChooseToy(None),
        UserAction::Share,
        UserAction::RestorePreset,
    ];
    prop_oneof![
        8 => select(plain),
        4 => Just(UserAction::Tap(DVec2::new(32.0, 24.0))),
        1 => pixel().prop_map(UserAction::Tap),
        1 => (pixel(), pixel()).prop_map(|(from_px, to_px)| UserAction::Drag { from_px, to_px }),
        1 => any::<f64>().prop_map(UserAction::Twist),
        1 => any::<f64>().prop_map(UserAction::Scrub),
    ]
}
