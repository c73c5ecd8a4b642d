//! Faults around an app, to be tried on a desktop.

use app_core::app::{ArSession, GraphicsState, Permission, ShellEvent, Thermal};
use app_core::camera_frame::Tracking;
use clap::ValueEnum;

use super::feed::Feed;

/// A fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, ValueEnum)]
pub enum Fault {
    /// The camera is not allowed
    Denied,
    /// The camera is not allowed, and only the system's settings change that
    Barred,
    /// The device has no AR
    NoAr,
    /// Something else has the camera
    Interrupted,
    /// The AR session ended by itself
    ArFailed,
    /// The camera moves too fast
    TooFast,
    /// Too little texture is in view
    TooPlain,
    /// It is too dark
    TooDark,
    /// The place is being searched
    Relocalising,
    /// The tracker begins another world
    NewWorld,
    /// The graphics device is lost
    DeviceLost,
    /// The device is too hot
    Hot,
    /// Memory is short
    MemoryLow,
    /// The app goes to the background
    Background,
}

impl Fault {
    /// The event at the beginning of the fault; the camera feed changes if it shows the fault.
    #[must_use]
    pub fn strikes(self, feed: &mut Feed) -> Option<ShellEvent> {
        let tracking = |feed: &mut Feed, tracking| {
            feed.tracking = tracking;
            None
        };
        match self {
            Self::Denied => Some(ShellEvent::Permission(Permission::Denied)),
            Self::Barred => Some(ShellEvent::Permission(Permission::Barred)),
            Self::NoAr => Some(ShellEvent::ArSession(ArSession::Unsupported)),
            Self::Interrupted => Some(ShellEvent::ArSession(ArSession::Interrupted)),
            Self::ArFailed => Some(ShellEvent::ArSession(ArSession::Failed)),
            Self::TooFast => tracking(feed, Tracking::TooFast),
            Self::TooPlain => tracking(feed, Tracking::TooPlain),
            Self::TooDark => tracking(feed, Tracking::TooDark),
            Self::Relocalising => tracking(feed, Tracking::Relocalising),
            Self::NewWorld => {
                feed.world_epoch += 1;
                None
            }
            Self::DeviceLost => Some(ShellEvent::Graphics(GraphicsState::Lost)),
            Self::Hot => Some(ShellEvent::Thermal(Thermal::Critical)),
            Self::MemoryLow => Some(ShellEvent::MemoryLow),
            Self::Background => Some(ShellEvent::Foreground(false)),
        }
    }

    /// The event at the end of the fault.
    #[must_use]
    pub fn passes(self, feed: &mut Feed) -> Option<ShellEvent> {
        match self {
            Self::Denied | Self::Barred => Some(ShellEvent::Permission(Permission::Granted)),
            Self::NoAr | Self::Interrupted | Self::ArFailed => Some(ShellEvent::ArSession(ArSession::Able)),
            Self::TooFast | Self::TooPlain | Self::TooDark | Self::Relocalising => {
                feed.tracking = Tracking::Normal;
                None
            }
            Self::NewWorld | Self::MemoryLow => None,
            Self::DeviceLost => Some(ShellEvent::Graphics(GraphicsState::Ready)),
            Self::Hot => Some(ShellEvent::Thermal(Thermal::Nominal)),
            Self::Background => Some(ShellEvent::Foreground(true)),
        }
    }
}
