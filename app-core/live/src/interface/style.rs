//! Colours and sizes.

use std::sync::Arc;

use egui::{
    Color32, Context, CornerRadius, FontId, Frame, Margin, Shadow, Stroke, TextStyle, Theme, Vec2, Visuals,
};

/// Smallest height of a touch target, in points, as both platforms recommend.
pub(super) const TOUCH_POINTS: f32 = 44.0;
/// Largest width of a sheet.
pub(super) const SHEET_POINTS: f32 = 460.0;
/// Range of its width at the right of a wide screen.
pub(super) const NARROW_POINTS: [f32; 2] = [220.0, 300.0];
/// The button for the next step.
pub(super) const ACCENT: Color32 = Color32::from_rgb(255, 190, 60);
/// Letters on that button.
pub(super) const ON_ACCENT: Color32 = Color32::from_rgb(40, 26, 0);
/// Less important text.
pub(super) const MUTED: Color32 = Color32::from_rgb(190, 194, 204);
/// The line below a slider's knob.
pub(super) const TRACK: Color32 = Color32::from_rgb(92, 97, 112);
/// The contour of the ghost.
pub(super) const GHOST: Color32 = Color32::from_rgb(255, 214, 120);

pub(super) fn apply(context: &Context, font: &'static [u8]) {
    context.set_fonts(fonts(font));
    context.set_theme(Theme::Dark);
    context.all_styles_mut(|style| {
        style.text_styles = [
            (TextStyle::Heading, FontId::proportional(22.0)),
            (TextStyle::Body, FontId::proportional(16.0)),
            (TextStyle::Button, FontId::proportional(17.0)),
            (TextStyle::Small, FontId::proportional(13.0)),
            (TextStyle::Monospace, FontId::monospace(13.0)),
        ]
        .into();
        style.spacing.interact_size = Vec2::splat(TOUCH_POINTS);
        style.spacing.button_padding = Vec2::new(14.0, 8.0);
        style.spacing.item_spacing = Vec2::new(8.0, 8.0);
        style.interaction.selectable_labels = false;
        style.visuals = Visuals::dark();
        style.visuals.override_text_color = Some(Color32::WHITE);
        for widget in [
            &mut style.visuals.widgets.inactive,
            &mut style.visuals.widgets.hovered,
            &mut style.visuals.widgets.active,
            &mut style.visuals.widgets.open,
        ] {
            widget.corner_radius = CornerRadius::same(12);
        }
        style.visuals.widgets.inactive.weak_bg_fill = Color32::from_rgb(62, 66, 78);
    });
}

/// A sheet or a card over the picture.
pub(super) fn card() -> Frame {
    Frame {
        inner_margin: Margin::same(16),
        fill: Color32::from_rgba_unmultiplied(18, 20, 26, 225),
        corner_radius: CornerRadius::same(18),
        stroke: Stroke::NONE,
        shadow: Shadow::NONE,
        ..Frame::default()
    }
}

/// Fonts of the interface, from bytes that are compiled in.
fn fonts(font: &'static [u8]) -> egui::FontDefinitions {
    let mut fonts = egui::FontDefinitions::empty();
    let name = "roboto".to_owned();
    fonts
        .font_data
        .insert(name.clone(), Arc::new(egui::FontData::from_static(font)));
    for family in [egui::FontFamily::Proportional, egui::FontFamily::Monospace] {
        fonts.families.insert(family, vec![name.clone()]);
    }
    fonts
}
