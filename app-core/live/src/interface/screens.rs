//! Sheets over the picture: instructions, obstacles and notices.

use egui::accesskit::Live;
use egui::{Align2, Area, Id, Order, ProgressBar, Rect, RichText, ScrollArea, Ui, vec2};

use super::parts::{lead, other, words};
use super::text::{self, say};
use super::words::Words;
use super::{check, play, style};
use crate::app::{App, Obstacle, Placing, Step, UserAction};

/// Height of a screen below which a sheet is low.
const LOW_POINTS: f32 = 300.0;

/// The sheet at the bottom, or at the right of a wide screen; the toy is mostly in the middle.
pub(super) fn sheet(ui: &mut Ui, app: &App, is_menu_open: &mut bool, actions: &mut Vec<UserAction>) {
    let area = ui.ctx().content_rect();
    let (align, offset, width) = if let Some(width) = width_at_right(area) {
        (Align2::RIGHT_CENTER, vec2(-12.0, 0.0), width)
    } else {
        let width = (area.width() - 24.0).min(style::SHEET_POINTS);
        (Align2::CENTER_BOTTOM, vec2(0.0, -12.0), width)
    };
    Area::new(Id::unique("sheet"))
        .order(Order::Foreground)
        .anchor(align, offset)
        .show(ui.ctx(), |ui| {
            style::card().show(ui, |ui| {
                ui.set_width(width - 32.0);
                // 16 points of margin within, 12 without, on either side.
                let tallest = area.height() - 56.0;
                // Without a minimum height a sheet would stay as low as the previous one.
                // A new sheet begins at its top.
                let shown = format!(
                    "{:?} {:?} {:?} {:?}",
                    app.step(),
                    app.obstacle(),
                    app.phone_question(),
                    app.toy_files().is_some()
                );
                let scrolled = ScrollArea::vertical()
                    .id_salt(shown)
                    .max_height(tallest)
                    .min_scrolled_height(tallest);
                scrolled.show(ui, |ui| match app.obstacle() {
                    Some(obstacle) => in_the_way(ui, app, obstacle, actions),
                    None if app.phone_question().is_some() => check::sheet(ui, app, actions),
                    None if app.toy_files().is_some() => toys(ui, app, actions),
                    None if app.step() == Step::Play => play::show(ui, app, is_menu_open, actions),
                    None => step(ui, app, actions),
                });
            });
        });
}

fn step(ui: &mut Ui, app: &App, actions: &mut Vec<UserAction>) {
    if let Some(told) = text::of_step(app) {
        head(ui, app, told, actions);
    }
    match app.step() {
        Step::Welcome => {
            if let Some(disclosure) = app.disclosure() {
                ui.label(RichText::new(disclosure).small().color(style::MUTED));
            }
        }
        Step::TakePlate => {
            plate_step(ui, app);
            if other(ui, say(app, text::SKIP_PLATE)) {
                actions.push(UserAction::SkipPlate);
            }
            if other(ui, say(app, text::START_OVER)) {
                actions.push(UserAction::StartOver);
            }
        }
        Step::PlaceToy if app.is_taking_lens() => {
            ui.spinner();
        }
        Step::PlaceToy => place(ui, app, actions),
        Step::Align => {
            ui.spinner();
            if other(ui, say(app, text::BACK)) {
                actions.push(UserAction::Replace);
            }
        }
        Step::FindTable => {
            let words = if app.uses_card() {
                text::NO_CARD
            } else {
                text::USE_CARD
            };
            ui.horizontal_wrapped(|ui| {
                if other(ui, say(app, words)) {
                    actions.push(UserAction::UseCard(!app.uses_card()));
                }
                if other(ui, say(app, text::CHECK)) {
                    actions.push(UserAction::CheckPhone(true));
                }
            });
        }
        Step::Play => {}
    }
}

/// Title and instructions of a step, and the button for the next one: a low sheet, as with large
/// letters, has the button before the instructions, so that it needs no scrolling.
fn head(ui: &mut Ui, app: &App, (title, hint): (Words, Words), actions: &mut Vec<UserAction>) {
    let is_low = ui.ctx().content_rect().height() < LOW_POINTS;
    ui.label(RichText::new(say(app, title)).heading());
    let mut next = |ui: &mut Ui, is_here: bool| {
        if let Some((label, action)) = next_step(app).filter(|_| is_here)
            && lead(ui, say(app, label))
        {
            actions.push(action);
        }
    };
    next(ui, is_low);
    ui.label(RichText::new(say(app, hint)).color(style::MUTED));
    next(ui, !is_low);
}

/// The button for the next step, if a button leads there.
fn next_step(app: &App) -> Option<(Words, UserAction)> {
    match app.step() {
        Step::Welcome => Some((text::BEGIN, UserAction::Begin)),
        Step::FindTable => app.reticle().map(|_| (text::HERE, UserAction::TapReticle)),
        Step::PlaceToy if !app.is_taking_lens() => match app.placing() {
            Placing::Asked { .. } => Some((text::YES, UserAction::Placed)),
            Placing::ByHand => Some((text::PLACED, UserAction::Placed)),
            Placing::Waiting { .. } | Placing::Looking => None,
        },
        _ => None,
    }
}

/// The question about the toy's place: waiting, asking, or turning by hand.
fn place(ui: &mut Ui, app: &App, actions: &mut Vec<UserAction>) {
    let placing = app.placing();
    if matches!(placing, Placing::Looking | Placing::Asked { is_searching: true }) {
        ui.spinner();
    }
    let by_hand = match placing {
        Placing::Asked { .. } => Some((text::TURN, UserAction::ByHand)),
        Placing::ByHand => Some((text::LOOK_AGAIN, UserAction::LookAgain)),
        _ => None,
    };
    let lens = (app.sees_card()).then_some((text::TAKE_LENS, UserAction::TakeLens));
    let others = [
        by_hand,
        lens,
        Some((text::PICK_TOY, UserAction::PickToy)),
        Some((text::START_OVER, UserAction::StartOver)),
    ];
    ui.horizontal_wrapped(|ui| {
        for (label, action) in others.into_iter().flatten() {
            if other(ui, say(app, label)) {
                actions.push(action);
            }
        }
    });
}

/// The list of toys.
fn toys(ui: &mut Ui, app: &App, actions: &mut Vec<UserAction>) {
    words(ui, say(app, text::PICK_TOY), say(app, text::WHERE_TOYS_ARE));
    for (index, name) in app.toy_files().unwrap_or_default().iter().enumerate() {
        if other(ui, name) {
            actions.push(UserAction::ChooseToy(Some(index)));
        }
    }
    if other(ui, say(app, text::BACK)) {
        actions.push(UserAction::ChooseToy(None));
    }
}

fn plate_step(ui: &mut Ui, app: &App) {
    let Some(step) = app.plate_step() else { return };
    let (part, help) = text::of_plate_step(step);
    let bar = ProgressBar::new(part.unwrap_or(0.0)).fill(style::ACCENT);
    ui.add(bar.desired_height(12.0));
    ui.label(say(app, help));
}

fn in_the_way(ui: &mut Ui, app: &App, obstacle: Obstacle, actions: &mut Vec<UserAction>) {
    let (title, hint) = text::of_obstacle(obstacle);
    let is_of_ar = matches!(
        obstacle,
        Obstacle::NoAr | Obstacle::ArFailed | Obstacle::Installing | Obstacle::Interrupted
    );
    let said = app.ar_words().filter(|_| is_of_ar);
    let title = match (obstacle, said) {
        // The platform may report that its app is too old, or lacks a part.
        (Obstacle::NoAr, Some(_)) => text::NO_AR,
        _ => title,
    };
    words(ui, say(app, title), said.unwrap_or(say(app, hint)));
    let way_back = match obstacle {
        Obstacle::CameraDenied => lead(ui, say(app, text::ALLOW_CAMERA)).then_some(UserAction::Begin),
        Obstacle::CameraBarred => lead(ui, say(app, text::OPEN_SETTINGS)).then_some(UserAction::OpenSettings),
        Obstacle::ArFailed => lead(ui, say(app, text::START_OVER)).then_some(UserAction::StartOver),
        Obstacle::Tracking(_) => other(ui, say(app, text::START_OVER)).then_some(UserAction::StartOver),
        Obstacle::NoAr => lead(ui, say(app, text::TRY_AGAIN)).then_some(UserAction::TryAgain),
        // The first screen itself is below it.
        _ if app.step() == Step::Welcome => None,
        Obstacle::Installing | Obstacle::Interrupted | Obstacle::TooHot | Obstacle::Preparing => {
            other(ui, say(app, text::LEAVE)).then_some(UserAction::Leave)
        }
    };
    actions.extend(way_back);
}

/// Width of a sheet at the right of a wide screen.
fn width_at_right(area: Rect) -> Option<f32> {
    let width = (0.4 * area.width()).clamp(style::NARROW_POINTS[0], style::NARROW_POINTS[1]);
    (area.width() > 1.2 * area.height()).then_some(width)
}

/// The notice at the top, in the corner of a wide screen, where it covers no toy; returns its
/// rectangle.
pub(super) fn notice(ui: &Ui, app: &App) -> Option<Rect> {
    let notice = app.notice()?;
    let area = ui.ctx().content_rect();
    let sheet = width_at_right(area);
    let taken = sheet.map_or(0.0, |width| width + 12.0);
    let width = (area.width() - taken - 24.0).min(style::SHEET_POINTS);
    let (align, offset) = match sheet {
        Some(_) => (Align2::LEFT_TOP, vec2(12.0, 12.0)),
        None => (Align2::CENTER_TOP, vec2(0.0, 12.0)),
    };
    let shown = Area::new(Id::unique("notice"))
        .order(Order::Foreground)
        .interactable(false)
        .anchor(align, offset)
        .show(ui.ctx(), |ui| {
            style::card().show(ui, |ui| {
                ui.set_max_width(width - 32.0);
                let notice = ui.label(text::of_notice(notice, app.language()));
                ui.ctx()
                    .accesskit_node_builder(notice.id, |node| node.set_live(Live::Polite));
            });
        });
    Some(shown.response.rect)
}

/// Times in the top left corner, or below a notice that would cover them.
pub(super) fn profile(ui: &Ui, lines: &str, notice: Option<Rect>) {
    let id = Id::unique("profile");
    let area = ui.ctx().content_rect();
    // The width is that of the previous picture; at first there is none.
    let right = ui
        .ctx()
        .memory(|memory| memory.area_rect(id))
        .map(|rect| rect.right());
    let is_below = |notice: &Rect| right.unwrap_or(f32::INFINITY) + 8.0 > notice.left();
    let top = notice
        .filter(is_below)
        .map_or(0.0, |notice| notice.bottom() - area.top());
    Area::new(id)
        .order(Order::Middle)
        .interactable(false)
        .anchor(Align2::LEFT_TOP, vec2(8.0, 8.0 + top))
        .show(ui.ctx(), |ui| {
            style::card().show(ui, |ui| {
                ui.set_max_width((area.width() - 48.0).min(style::SHEET_POINTS));
                ui.label(RichText::new(lines).small());
            });
        });
}
