//! Touches from the platforms, converted for egui.

use egui::epaint::MarginF32;
use egui::{Event, Modifiers, PointerButton, Pos2, RawInput, Rect, TouchDeviceId, TouchId, Vec2, pos2, vec2};

/// Space at the screen's borders that is covered by notches and system bars, in physical pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Insets {
    /// From the left.
    pub left_px: f64,
    /// From the top.
    pub top_px: f64,
    /// From the right.
    pub right_px: f64,
    /// From the bottom.
    pub bottom_px: f64,
}

/// The screen, or the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Screen {
    /// Width and height in physical pixels.
    pub size_px: [u32; 2],
    /// Physical pixels per point of the platform.
    pub pixels_per_point: f64,
    /// Borders that must stay free.
    pub insets: Insets,
    /// Size of letters that the person wants, relative to the usual size.
    pub text_scale: f64,
}

impl Screen {
    /// Physical pixels per point of the interface: larger letters come with larger buttons.
    pub(super) fn pixels_per_unit(&self) -> f32 {
        let scale = self.pixels_per_point * self.text_scale.clamp(0.8, 2.0);
        narrowed(scale).clamp(0.5, 8.0)
    }

    fn size(&self) -> Vec2 {
        let [width, height] = self
            .size_px
            .map(|side| narrowed(f64::from(side)) / self.pixels_per_unit());
        vec2(width, height)
    }
}

/// Phase of a touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TouchPhase {
    /// It comes down.
    Began,
    /// It moves.
    Moved,
    /// It goes up.
    Ended,
    /// The platform cancels it.
    Cancelled,
}

/// A touch of a finger.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Identifier of the finger while it is down.
    pub id: u64,
    /// Phase of the touch.
    pub phase: TouchPhase,
    /// Physical pixels of the screen, from its top left corner.
    pub at_px: [f64; 2],
}

/// Touches since the last picture, and fingers that are down.
#[derive(Debug, Default)]
pub(super) struct Touches {
    waiting: Vec<Touch>,
    /// Identifier of the first finger that came down, which is also a pointer.
    pointer: Option<u64>,
    wheel_steps: f64,
}

impl Touches {
    pub(super) fn touch(&mut self, touch: Touch) {
        if touch.at_px.iter().all(|number| number.is_finite()) {
            self.waiting.push(touch);
        }
    }

    pub(super) fn wheel(&mut self, steps: f64) {
        self.wheel_steps += steps;
    }

    pub(super) fn take_wheel(&mut self) -> f64 {
        std::mem::take(&mut self.wheel_steps)
    }

    pub(super) fn input(&mut self, screen: &Screen, time_s: f64) -> RawInput {
        let pixels_per_unit = screen.pixels_per_unit();
        let mut events = Vec::new();
        for touch in std::mem::take(&mut self.waiting) {
            let [x, y] = touch.at_px.map(|px| narrowed(px) / pixels_per_unit);
            self.add(touch, pos2(x, y), &mut events);
        }
        let Insets {
            left_px,
            top_px,
            right_px,
            bottom_px,
        } = screen.insets;
        let [left, top, right, bottom] =
            [left_px, top_px, right_px, bottom_px].map(|px| narrowed(px) / pixels_per_unit);
        let mut input = RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, screen.size())),
            safe_area_insets: Some(egui::SafeAreaInsets(MarginF32 {
                left,
                right,
                top,
                bottom,
            })),
            time: Some(time_s),
            events,
            ..RawInput::default()
        };
        for viewport in input.viewports.values_mut() {
            viewport.native_pixels_per_point = Some(pixels_per_unit);
        }
        input
    }

    fn add(&mut self, touch: Touch, pos: Pos2, events: &mut Vec<Event>) {
        let phase = match touch.phase {
            TouchPhase::Began => egui::TouchPhase::Start,
            TouchPhase::Moved => egui::TouchPhase::Move,
            TouchPhase::Ended => egui::TouchPhase::End,
            TouchPhase::Cancelled => egui::TouchPhase::Cancel,
        };
        events.push(Event::Touch {
            device_id: TouchDeviceId(0),
            id: TouchId::from(touch.id),
            phase,
            pos,
            force: None,
        });
        if self.pointer.is_none() && touch.phase == TouchPhase::Began {
            self.pointer = Some(touch.id);
        }
        if self.pointer != Some(touch.id) {
            return;
        }
        let button = |pressed| Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        };
        events.push(Event::PointerMoved(pos));
        match touch.phase {
            TouchPhase::Began => events.push(button(true)),
            TouchPhase::Moved => {}
            TouchPhase::Ended => {
                events.extend([button(false), Event::PointerGone]);
                self.pointer = None;
            }
            TouchPhase::Cancelled => {
                events.push(Event::PointerGone);
                self.pointer = None;
            }
        }
    }
}

#[allow(clippy::cast_possible_truncation, reason = "places on a screen")]
pub(super) fn narrowed(number: f64) -> f32 {
    number as f32
}
