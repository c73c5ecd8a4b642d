//! Conversion of Android's touches and screen to those of the interface.

use app_core::interface::{Insets, Screen, Touch, TouchPhase};

/// Density at which a pixel is a point, in dots per inch.
const POINT_DPI: f64 = 160.0;

/// The back key: only a press and a release in front of the app count.
///
/// Android cancels a press when the window loses the focus. android-activity 0.6 does not pass the
/// flag of a cancelled key on, so the loss itself counts.
#[derive(Clone, Copy, Debug, Default)]
pub struct BackKey {
    is_down: bool,
}

impl BackKey {
    /// The key goes down.
    pub fn press(&mut self) {
        self.is_down = true;
    }

    /// The window has lost the focus, or is not visible.
    pub fn cancel(&mut self) {
        self.is_down = false;
    }

    /// The key goes up; returns whether it was pressed here.
    #[must_use]
    pub fn release(&mut self) -> bool {
        std::mem::take(&mut self.is_down)
    }
}

/// Kind of a motion event.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Motion {
    /// The finger with this index in the list came down.
    Down(usize),
    /// Any finger may have moved.
    Moved,
    /// The finger with this index in the list goes up.
    Up(usize),
    /// All touches are cancelled.
    Cancelled,
}

/// A finger of a motion event.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finger {
    /// Identifier of the finger while it is down.
    pub id: i32,
    /// Position from the window's top left corner, in physical pixels.
    pub at_px: [f32; 2],
}

/// The touches of a motion event.
#[must_use]
pub fn touches(motion: Motion, fingers: &[Finger]) -> Vec<Touch> {
    let (phase, only) = match motion {
        Motion::Down(index) => (TouchPhase::Began, Some(index)),
        Motion::Moved => (TouchPhase::Moved, None),
        Motion::Up(index) => (TouchPhase::Ended, Some(index)),
        Motion::Cancelled => (TouchPhase::Cancelled, None),
    };
    let meant = |index: usize| only.is_none_or(|only| only == index);
    let touches = (0..).zip(fingers).filter(|(index, _)| meant(*index));
    touches
        .filter_map(|(_, finger)| {
            Some(Touch {
                // Android counts from 0.
                id: finger.id.try_into().ok()?,
                phase,
                at_px: finger.at_px.map(f64::from),
            })
        })
        .collect()
}

/// The screen of a window of this size.
///
/// `insets_px` are the widths covered by bars and cut-outs at the left, the top, the right and the
/// bottom; `None` before Android reports them. Then `content_px` is used, the part left free by
/// bars: left, top, right and bottom from the window's top left corner; an empty one is ignored. In
/// a window that extends below the bars, as every one does since Android 15, it is the whole
/// window. Letters are `text_scale` times as large as usual, or of the usual size if that is not a
/// valid scale.
#[must_use]
pub fn screen(
    size_px: [u32; 2],
    density_dpi: Option<u32>,
    insets_px: Option<[i32; 4]>,
    content_px: [i32; 4],
    text_scale: f32,
) -> Screen {
    let [left, top, right, bottom] = content_px.map(f64::from);
    let [width, height] = size_px.map(f64::from);
    let insets = if let Some(insets) = insets_px {
        let [left_px, top_px, right_px, bottom_px] = insets.map(|inset| f64::from(inset.max(0)));
        Insets {
            left_px,
            top_px,
            right_px,
            bottom_px,
        }
    } else if right > left && bottom > top {
        Insets {
            left_px: left.max(0.0),
            top_px: top.max(0.0),
            right_px: (width - right).max(0.0),
            bottom_px: (height - bottom).max(0.0),
        }
    } else {
        Insets::default()
    };
    Screen {
        size_px,
        pixels_per_point: density_dpi.map_or(1.0, |dpi| f64::from(dpi) / POINT_DPI),
        insets,
        text_scale: if text_scale.is_finite() && text_scale > 0.0 {
            text_scale.into()
        } else {
            1.0
        },
    }
}
