//! Widgets of the sheets.

use egui::accesskit::{Action, Role};
use egui::{Button, RichText, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};

use super::style;

/// Step of a screen reader over a slider's line.
const STEP: f64 = 0.05;
/// Radius of a slider's knob, and the least width of its line, in points.
const KNOB_POINTS: f32 = 11.0;
const LEAST_SLIDER_POINTS: f32 = 60.0;

/// A title and instructions.
pub(super) fn words(ui: &mut Ui, title: &str, hint: &str) {
    ui.label(RichText::new(title).heading());
    ui.label(RichText::new(hint).color(style::MUTED));
}

/// The button for the next step, as wide as the sheet.
pub(super) fn lead(ui: &mut Ui, label: &str) -> bool {
    let label = RichText::new(label).color(style::ON_ACCENT);
    let button = Button::new(label).fill(style::ACCENT);
    ui.add_sized(vec2(ui.available_width(), style::TOUCH_POINTS), button)
        .clicked()
}

/// A button for another action.
pub(super) fn other(ui: &mut Ui, label: &str) -> bool {
    ui.add(Button::new(label).min_size(vec2(style::TOUCH_POINTS, style::TOUCH_POINTS)))
        .clicked()
}

/// A knob on a line over the remaining width, at `value` of `most`; returns the part of the line to
/// which a person moves it. A screen reader reads `label`, and `value` unless that runs, since it
/// would be told of each change; it moves the knob by steps. egui's own slider includes fields of
/// numbers and of text.
pub(super) fn slider(ui: &mut Ui, [value, most]: [f64; 2], (label, runs): (&str, bool)) -> Option<f64> {
    let part = if most > 0.0 { value / most } else { 0.0 };
    let width = ui.available_width().max(LEAST_SLIDER_POINTS);
    let size = vec2(width, style::TOUCH_POINTS);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    response.widget_info(|| match runs {
        true => WidgetInfo::labeled(Role::Slider, true, label),
        false => WidgetInfo::slider(true, value, label),
    });
    ui.ctx().accesskit_node_builder(response.id, |node| {
        node.set_min_numeric_value(0.0);
        node.set_max_numeric_value(most);
        if !runs {
            node.set_value(format!("{value:.1}"));
        }
        node.add_action(Action::Increment);
        node.add_action(Action::Decrement);
    });
    let line = rect.shrink2(vec2(KNOB_POINTS, 0.0));
    let at = |part: f32| pos2(egui::lerp(line.x_range(), part), line.center().y);
    let known = super::input::narrowed(part).clamp(0.0, 1.0);
    let painter = ui.painter();
    painter.line_segment([at(0.0), at(1.0)], Stroke::new(4.0, style::TRACK));
    painter.line_segment([at(0.0), at(known)], Stroke::new(4.0, style::ACCENT));
    painter.circle_filled(at(known), KNOB_POINTS, style::ACCENT);
    let n_asked = |action| ui.input(|input| input.num_accesskit_action_requests(response.id, action));
    let [n_up, n_down] = [Action::Increment, Action::Decrement].map(n_asked);
    if n_up != n_down {
        let steps = n_up as f64 - n_down as f64;
        return Some((part + STEP * steps).clamp(0.0, 1.0));
    }
    let is_moved = response.dragged() || response.clicked();
    let to = response.interact_pointer_pos().filter(|_| is_moved)?;
    Some(f64::from((to.x - line.left()) / line.width().max(1.0)).clamp(0.0, 1.0))
}
