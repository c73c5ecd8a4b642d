//! The questions of a new phone: each a picture over the camera's, and two buttons.

use egui::{Color32, Pos2, Rect, RichText, Stroke, Ui, vec2};
use glam::DVec2;

use super::parts::{lead, other};
use super::style;
use super::text::{self, say};
use crate::app::{App, CheckInk, PhoneQuestion, UserAction};

/// Side of a patch, in points.
const PATCH_POINTS: f32 = 64.0;
/// Expected colours of white paper and black card in a camera picture.
const GREYS: [Color32; 2] = [Color32::from_gray(242), Color32::from_gray(16)];
const COLOURS: [Color32; 3] = [
    Color32::from_rgb(200, 30, 30),
    Color32::from_rgb(30, 140, 50),
    Color32::from_rgb(30, 60, 180),
];
/// Cells of the clock that is visible in a mirror: each is lit for a tenth of a second.
const N_CELLS: u16 = 10;
const CELL_POINTS: [f32; 2] = [64.0, 18.0];

/// The question, its number, and the possible answers.
pub(super) fn sheet(ui: &mut Ui, app: &App, actions: &mut Vec<UserAction>) {
    let Some((question, number)) = app.phone_question() else {
        return;
    };
    let title = text::N_OF.filled(app.language(), &[&number, &PhoneQuestion::ALL.len()]);
    ui.label(RichText::new(title).small().color(style::MUTED));
    ui.label(say(app, text::of_question(question)));
    if lead(ui, say(app, text::YES)) {
        actions.push(UserAction::Answer(true));
    }
    ui.horizontal_wrapped(|ui| {
        if other(ui, say(app, text::NO)) {
            actions.push(UserAction::Answer(false));
        }
        if other(ui, say(app, text::STOP)) {
            actions.push(UserAction::CheckPhone(false));
        }
    });
}

/// The object of the question; `at` maps a pixel of the camera's picture to the screen.
pub(super) fn picture(ui: &Ui, app: &App, at: impl Fn(DVec2) -> Pos2) {
    let Some((question, _)) = app.phone_question() else {
        return;
    };
    for (ink, [from, to]) in app.check_lines_px() {
        ui.painter()
            .line_segment([at(from), at(to)], Stroke::new(3.0, colour(ink)));
    }
    match question {
        PhoneQuestion::Greys => patches(ui, &GREYS),
        PhoneQuestion::Colours => patches(ui, &COLOURS),
        PhoneQuestion::Upright => circle(ui),
        PhoneQuestion::Delay => clock(ui),
        _ => {}
    }
}

fn colour(ink: CheckInk) -> Color32 {
    match ink {
        CheckInk::X => Color32::from_rgb(255, 70, 70),
        CheckInk::Y => Color32::from_rgb(80, 230, 90),
        CheckInk::Z => Color32::from_rgb(90, 140, 255),
        CheckInk::Measure => Color32::WHITE,
    }
}

/// The centre of the left third, which no sheet covers on a wide screen, or a place at the top of a
/// narrow one.
fn free_place(ui: &Ui) -> Pos2 {
    let area = ui.ctx().content_rect();
    let part = if area.width() > area.height() {
        vec2(0.3, 0.5)
    } else {
        vec2(0.5, 0.3)
    };
    area.left_top() + part * area.size()
}

/// Patches of these colours, one below the other.
fn patches(ui: &Ui, colours: &[Color32]) {
    let n = colours.len() as f32;
    let mut middle = free_place(ui) - vec2(0.0, 0.5 * (n - 1.0) * PATCH_POINTS);
    for colour in colours {
        let patch = Rect::from_center_size(middle, vec2(PATCH_POINTS, PATCH_POINTS));
        ui.painter().rect_filled(patch, 0.0, *colour);
        middle.y += PATCH_POINTS;
    }
}

fn circle(ui: &Ui) {
    let area = ui.ctx().content_rect();
    let radius = 0.2 * area.width().min(area.height());
    let stroke = Stroke::new(3.0, colour(CheckInk::Measure));
    ui.painter().circle_stroke(free_place(ui), radius, stroke);
}

/// A column of cells, which a mirror does not reverse: the lit one climbs.
fn clock(ui: &Ui) {
    let [width, height] = CELL_POINTS;
    let tenths = (10.0 * ui.input(|input| input.time)).rem_euclid(f64::from(N_CELLS));
    let bottom = free_place(ui) + vec2(0.0, 0.5 * height * f32::from(N_CELLS - 1));
    for cell in 0..N_CELLS {
        let middle = bottom - vec2(0.0, height * f32::from(cell));
        let is_lit = (f64::from(cell)..f64::from(cell + 1)).contains(&tenths);
        let fill = if is_lit { Color32::WHITE } else { Color32::BLACK };
        let rect = Rect::from_center_size(middle, vec2(width, height - 2.0));
        ui.painter().rect_filled(rect, 0.0, fill);
    }
    ui.ctx().request_repaint();
}
