//! What sheets are made of.

use egui::{Button, RichText, Ui, vec2};

use super::style;

/// A title, and what to do.
pub(super) fn words(ui: &mut Ui, title: &str, hint: &str) {
    ui.label(RichText::new(title).heading());
    ui.label(RichText::new(hint).color(style::MUTED));
}

/// The button that leads on, as wide as the sheet.
pub(super) fn lead(ui: &mut Ui, label: &str) -> bool {
    let label = RichText::new(label).color(style::ON_ACCENT);
    let button = Button::new(label).fill(style::ACCENT);
    ui.add_sized(vec2(ui.available_width(), style::TOUCH_POINTS), button)
        .clicked()
}

/// A button that leads elsewhere.
pub(super) fn other(ui: &mut Ui, label: &str) -> bool {
    ui.add(Button::new(label).min_size(vec2(style::TOUCH_POINTS, style::TOUCH_POINTS)))
        .clicked()
}
