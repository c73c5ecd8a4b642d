//! The sheet while the toy moves: clip, time, photo, video, and all else behind one button.

use egui::{ComboBox, Ui};

use super::parts::{other, slider};
use super::{style, text};
use crate::app::{App, UserAction};

pub(super) fn show(ui: &mut Ui, app: &App, is_menu_open: &mut bool, actions: &mut Vec<UserAction>) {
    if let Some(verdict) = app.verdict() {
        let words = egui::RichText::new(text::of_verdict(verdict));
        ui.label(words.small().color(style::MUTED));
    }
    if app.simplified().is_some() {
        ui.label(egui::RichText::new(text::SIMPLE).small());
    }
    if app.is_recording() {
        ui.label(egui::RichText::new(text::RECORDING).small());
    }
    clip(ui, app, actions);
    ui.horizontal_wrapped(|ui| {
        if other(ui, text::PHOTO) {
            actions.push(UserAction::SavePhoto);
        }
        let video = if app.is_making_video() {
            text::END_VIDEO
        } else {
            text::VIDEO
        };
        if other(ui, video) {
            actions.push(UserAction::Video(!app.is_making_video()));
        }
        if other(ui, if *is_menu_open { text::LESS } else { text::MORE }) {
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
            .selected_text(chosen.map_or(text::AUTHORED, String::as_str))
            .show_ui(ui, |ui| {
                if ui
                    .selectable_label(playback.clip().is_none(), text::AUTHORED)
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
            text::PAUSE
        } else {
            text::PLAY
        };
        if other(ui, label) {
            actions.push(UserAction::Play(!playback.is_playing()));
        }
        let part = playback.time_s() / playback.length_s();
        if let Some(part) = slider(ui, part, (playback.time_s(), text::TIME)) {
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
    let entries = [
        (record, UserAction::Record(!is_recording)),
        (text::PROFILE, UserAction::ShowProfile(!app.shows_profile())),
        (text::CHECK, UserAction::CheckPhone(true)),
        (text::REPLACE, UserAction::Replace),
        (text::RETAKE, UserAction::RetakePlate),
        (text::PICK_TOY, UserAction::PickToy),
        (text::SHARE, UserAction::Share),
        (text::START_OVER, UserAction::StartOver),
    ];
    ui.horizontal_wrapped(|ui| {
        let restore = app
            .simplified()
            .map(|_| (text::RESTORE, UserAction::RestorePreset));
        for (label, action) in entries.into_iter().chain(restore) {
            if other(ui, label) {
                actions.push(action);
            }
        }
    });
}
