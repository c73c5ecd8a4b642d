//! The sheet while the toy moves: clip, time, photo, video, and a button for the other actions.

use egui::{ComboBox, Ui};

use super::parts::{other, slider};
use super::style;
use super::text::{self, say};
use super::words::Words;
use crate::app::{App, UserAction};

pub(super) fn show(ui: &mut Ui, app: &App, is_menu_open: &mut bool, actions: &mut Vec<UserAction>) {
    if let Some(verdict) = app.verdict() {
        let words = egui::RichText::new(text::of_verdict(verdict, app.language()));
        ui.label(words.small().color(style::MUTED));
    }
    if app.simplified().is_some() {
        ui.label(egui::RichText::new(say(app, text::SIMPLE)).small());
    }
    if app.is_recording() {
        ui.label(egui::RichText::new(say(app, text::RECORDING)).small());
    }
    clip(ui, app, actions);
    ui.horizontal_wrapped(|ui| {
        if other(ui, say(app, text::PHOTO)) {
            actions.push(UserAction::SavePhoto);
        }
        let video = if app.is_making_video() {
            say(app, text::END_VIDEO)
        } else {
            say(app, text::VIDEO)
        };
        if other(ui, video) {
            actions.push(UserAction::Video(!app.is_making_video()));
        }
        if other(
            ui,
            if *is_menu_open {
                say(app, text::LESS)
            } else {
                say(app, text::MORE)
            },
        ) {
            *is_menu_open = !*is_menu_open;
        }
    });
    if *is_menu_open {
        menu(ui, app, actions);
    }
}

fn clip(ui: &mut Ui, app: &App, actions: &mut Vec<UserAction>) {
    let playback = app.playback();
    let names = app.toy().clip_names();
    if !names.is_empty() {
        let chosen = playback.clip().and_then(|clip| names.get(clip.index()));
        ComboBox::from_id_salt("clip")
            .width(ui.available_width())
            .selected_text(chosen.map_or(say(app, text::AUTHORED), String::as_str))
            .show_ui(ui, |ui| {
                if ui
                    .selectable_label(playback.clip().is_none(), say(app, text::AUTHORED))
                    .clicked()
                {
                    actions.push(UserAction::Choose(None));
                }
                for (id, name) in app.toy().clip_ids().zip(&names) {
                    if ui.selectable_label(playback.clip() == Some(id), name).clicked() {
                        actions.push(UserAction::Choose(Some(id)));
                    }
                }
            });
    }
    if playback.length_s() <= 0.0 {
        return;
    }
    ui.horizontal(|ui| {
        let label = if playback.is_playing() {
            say(app, text::PAUSE)
        } else {
            say(app, text::PLAY)
        };
        if other(ui, label) {
            actions.push(UserAction::Play(!playback.is_playing()));
        }
        let times_s = [playback.time_s(), playback.length_s()];
        if let Some(part) = slider(ui, times_s, (say(app, text::TIME), playback.is_playing())) {
            let time_s = part * playback.length_s();
            actions.extend([UserAction::Play(false), UserAction::Scrub(time_s)]);
        }
    });
}

fn menu(ui: &mut Ui, app: &App, actions: &mut Vec<UserAction>) {
    let is_recording = app.is_recording();
    let record = if is_recording {
        text::END_RECORD
    } else {
        text::RECORD
    };
    let restore = app
        .simplified()
        .map(|_| (text::RESTORE, UserAction::RestorePreset));
    let toy = [
        (text::REPLACE, UserAction::Replace),
        (text::PICK_TOY, UserAction::PickToy),
        (text::RETAKE, UserAction::RetakePlate),
        (text::START_OVER, UserAction::StartOver),
    ];
    let engineers = [
        (record, UserAction::Record(!is_recording)),
        (text::PROFILE, UserAction::ShowProfile(!app.shows_profile())),
        (text::CHECK, UserAction::CheckPhone(true)),
        (text::SHARE, UserAction::Share),
    ];
    let toy = toy.into_iter().chain(restore).collect();
    for (title, entries) in [(text::TOY_GROUP, toy), (text::ENGINEER_GROUP, engineers.to_vec())] {
        group(ui, app, (title, entries), actions);
    }
}

/// Buttons below a title.
fn group(
    ui: &mut Ui,
    app: &App,
    (title, entries): (Words, Vec<(Words, UserAction)>),
    actions: &mut Vec<UserAction>,
) {
    let title = egui::RichText::new(say(app, title));
    ui.label(title.small().color(style::MUTED));
    ui.horizontal_wrapped(|ui| {
        for (label, action) in entries {
            if other(ui, say(app, label)) {
                actions.push(action);
            }
        }
    });
}
