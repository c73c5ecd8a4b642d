//! The steps of a person, and the causes of a change between them.
//!
//! [`Anchor::OF_TOY`]: app_scene::camera_frame::Anchor::OF_TOY
//! [`Interface::accessibility_tree`]: crate::interface::Interface::accessibility_tree
//! [`Interface::request`]: crate::interface::Interface::request
//! [`Language`]: super::Language
//! [`LaunchHistory`]: super::LaunchHistory
//! [`Live::times`]: crate::live::Live::times
//! [`Obstacle`]: super::Obstacle
//! [`People`]: app_scene::people::People
//! [`PhoneQuestion`]: super::PhoneQuestion
//! [`Placing`]: super::Placing
//! [`PlateJob`]: super::PlateJob
//! [`PlateTaker`]: super::PlateTaker
//! [`RecordingJob`]: app_session::recording::RecordingJob
//! [`ShellEvent::FreeSpace`]: super::ShellEvent
//! [`ShellEvent::Recorded`]: super::ShellEvent
//! [`ShellEvent::ToyFiles`]: super::ShellEvent
//! [`StandingSearch`]: app_alignment::StandingSearch
//! [`ToyRefusal`]: super::ToyRefusal
//! [`Translated`]: super::Translated
//! [`WatchJob`]: super::WatchJob
//! [`WorkCommand::Record`]: super::WorkCommand
//! [`WorkCommand::Remember`]: super::WorkCommand
//! [`card`]: app_scene::card
//! [`probe`]: app_alignment::probe
//! [`self_test`]: crate::self_test
//!
#![doc = include_str!("../../../doc/app.md")]

/// The steps of a person.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Step {
    /// Read what this is, and allow the camera.
    #[default]
    Welcome,
    /// Show the table to the camera, and tap on it.
    FindTable,
    /// Keep still while the empty place is photographed.
    TakePlate,
    /// Put the toy there, and its ghost over it.
    PlaceToy,
    /// Wait for the ghost to be aligned with the toy.
    Align,
    /// Watch it move.
    Play,
}

/// Causes of a change from one step to another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Cause {
    /// A person began, and the camera is allowed.
    Begun,
    /// The camera is not allowed any longer.
    CameraDenied,
    /// A horizontal plane was tapped.
    TableChosen,
    /// The empty place was photographed.
    PlateTaken,
    /// It will not be photographed.
    PlateSkipped,
    /// The ghost stands where the toy does.
    ToyPlaced,
    /// The picture shows the toy at the ghost's place, or its pose was found.
    ToyFound,
    /// The picture does not show it there.
    ToyMissed,
    /// The ghost is requested again, or there is another toy.
    Replace,
    /// The toy was lifted away.
    RetakePlate,
    /// A restart from the table on is requested.
    StartOver,
    /// The tracker has begun another world.
    WorldLost,
    /// A person has left for the first screen.
    Left,
}

impl Cause {
    /// All causes.
    pub const ALL: [Self; 13] = [
        Self::Begun,
        Self::CameraDenied,
        Self::TableChosen,
        Self::PlateTaken,
        Self::PlateSkipped,
        Self::ToyPlaced,
        Self::ToyFound,
        Self::ToyMissed,
        Self::Replace,
        Self::RetakePlate,
        Self::StartOver,
        Self::WorldLost,
        Self::Left,
    ];
}

impl Step {
    /// All steps, in their order.
    pub const ALL: [Self; 6] = [
        Self::Welcome,
        Self::FindTable,
        Self::TakePlate,
        Self::PlaceToy,
        Self::Align,
        Self::Play,
    ];

    /// The step after a cause; the same step if the cause does not apply to it.
    #[must_use]
    pub fn after(self, cause: Cause) -> Self {
        match (self, cause) {
            (Self::Welcome, Cause::Begun) => Self::FindTable,
            (Self::Welcome, _) => Self::Welcome,
            (_, Cause::CameraDenied | Cause::Left) => Self::Welcome,
            (_, Cause::StartOver | Cause::WorldLost) | (Self::FindTable, Cause::Replace) => Self::FindTable,
            (Self::FindTable, Cause::TableChosen) => Self::TakePlate,
            (Self::TakePlate, Cause::PlateTaken | Cause::PlateSkipped) => Self::PlaceToy,
            (Self::PlaceToy, Cause::ToyPlaced) => Self::Align,
            (Self::Align, Cause::ToyFound) => Self::Play,
            (Self::Align, Cause::ToyMissed | Cause::Replace) | (Self::Play, Cause::Replace) => Self::PlaceToy,
            (Self::PlaceToy | Self::Align | Self::Play, Cause::RetakePlate) => Self::TakePlate,
            (step, _) => step,
        }
    }
}
