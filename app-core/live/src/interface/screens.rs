//! Sheets over the picture: instructions, obstacles and notices.

use egui::{Align2, Area, Id, Order, ProgressBar, Rect, RichText, ScrollArea, Ui, vec2};

use super::parts::{lead, other, words};
use super::text::{self, say};
use super::{check, play, style};
use crate::app::{App, Obstacle, Placing, Step, UserAction};

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
                let scrolled = ScrollArea::vertical()
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
    if let Some((title, hint)) = text::of_step(app) {
        words(ui, say(app, title), say(app, hint));
    }
    match app.step() {
        Step::Welcome => {
            if lead(ui, say(app, text::BEGIN)) {
                actions.push(UserAction::Begin);
            }
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
            if app.reticle().is_some() && lead(ui, say(app, text::HERE)) {
                actions.push(UserAction::TapReticle);
            }
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

/// The question about the toy's place: waiting, asking, or turning by hand.
fn place(ui: &mut Ui, app: &App, actions: &mut Vec<UserAction>) {
    let placing = app.placing();
    match placing {
        Placing::Waiting { .. } => {}
        Placing::Looking => {
            ui.spinner();
        }
        Placing::Asked { is_searching } => {
            if lead(ui, say(app, text::YES)) {
                actions.push(UserAction::Placed);
            }
            if is_searching {
                ui.spinner();
            }
        }
        Placing::ByHand => {
            if lead(ui, say(app, text::PLACED)) {
                actions.push(UserAction::Placed);
            }
        }
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
    ui.add(ProgressBar::new(part.unwrap_or(0.0)).desired_height(12.0));
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

/// The notice at the top, beside a sheet at the right; returns its rectangle.
pub(super) fn notice(ui: &Ui, app: &App) -> Option<Rect> {
    let notice = app.notice()?;
    let area = ui.ctx().content_rect();
    let taken = width_at_right(area).map_or(0.0, |width| width + 12.0);
    let width = (area.width() - taken - 24.0).min(style::SHEET_POINTS);
    let shown = Area::new(Id::unique("notice"))
        .order(Order::Foreground)
        .interactable(false)
        .anchor(Align2::CENTER_TOP, vec2(-0.5 * taken, 12.0))
        .show(ui.ctx(), |ui| {
            style::card().show(ui, |ui| {
                ui.set_max_width(width - 32.0);
                ui.label(text::of_notice(notice, app.language()));
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
