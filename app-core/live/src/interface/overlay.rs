//! Shapes over the camera's picture: the reticle on the table, the toy's ghost, and the ring for
//! turning it.

use egui::epaint::Vertex;
use egui::{Color32, ColorImage, Mesh, Pos2, Shape, Stroke, TextureHandle, TextureOptions, Ui, pos2};
use glam::DVec2;

use super::input::narrowed;
use super::style;
use crate::app::{App, Reticle, Step};
use app_alignment::Silhouette;

/// Opacity of the ghost and of its border, of 255.
const FILL: f32 = 90.0;
const BORDER: f32 = 255.0;
/// Radius of the largest dot of the grid, of the knob, and of the reticle while no table is found, in points.
const DOT_POINTS: f32 = 2.5;
const KNOB_POINTS: f32 = 14.0;
const RETICLE_POINTS: f32 = 34.0;

/// Draws the shapes; `at` maps a pixel of the camera's picture to the screen.
pub(super) fn show(ui: &Ui, app: &App, at: impl Fn(DVec2) -> Pos2) {
    if app.step() == Step::FindTable && app.obstacle().is_none() && app.phone_question().is_none() {
        match app.reticle() {
            Some(Reticle { ring_px, dots_px }) => {
                for (dot_px, seen) in dots_px {
                    let colour = style::GHOST.gamma_multiply(narrowed(seen));
                    ui.painter().circle_filled(at(dot_px), DOT_POINTS, colour);
                }
                outline(ui, ring_px.into_iter().map(&at), Stroke::new(4.0, style::ACCENT));
            }
            None => {
                let middle = ui.ctx().content_rect().center();
                let stroke = Stroke::new(2.0, style::MUTED);
                ui.painter().circle_stroke(middle, RETICLE_POINTS, stroke);
            }
        }
    }
    if let Some(silhouette) = app.ghost() {
        ghost(ui, &silhouette, &at);
    }
    if let Some((ring_px, knob_px)) = app.ring_px() {
        outline(ui, ring_px.into_iter().map(&at), Stroke::new(5.0, style::ACCENT));
        ui.painter()
            .circle_filled(at(knob_px), KNOB_POINTS, style::ACCENT);
    }
}

fn outline(ui: &Ui, corners: impl Iterator<Item = Pos2>, stroke: Stroke) {
    let corners: Vec<Pos2> = corners.collect();
    ui.painter().add(Shape::closed_line(corners, stroke));
}

/// The toy as one translucent form with a line around it.
fn ghost(ui: &Ui, silhouette: &Silhouette, at: impl Fn(DVec2) -> Pos2) {
    let [low, high] = silhouette.corners_px;
    let corners = [
        (low, pos2(0.0, 0.0)),
        (DVec2::new(high.x, low.y), pos2(1.0, 0.0)),
        (high, pos2(1.0, 1.0)),
        (DVec2::new(low.x, high.y), pos2(0.0, 1.0)),
    ];
    let texture = texture(ui, silhouette);
    let vertices = corners.map(|(corner_px, uv)| Vertex {
        pos: at(corner_px),
        uv,
        color: Color32::WHITE,
    });
    ui.painter().add(Shape::mesh(Mesh {
        indices: vec![0, 1, 2, 0, 2, 3],
        vertices: vertices.to_vec(),
        texture_id: texture.id(),
    }));
}

/// The latest silhouette as a texture, which is kept as long as the interface.
fn texture(ui: &Ui, silhouette: &Silhouette) -> TextureHandle {
    let id = egui::Id::unique("ghost");
    let [columns, rows] = silhouette.size.map(|side| side as usize);
    let [red, green, blue, _] = style::GHOST.to_array();
    let covered = |x: usize, y: usize| {
        let code = silhouette.coverage.get(y * columns + x).copied().unwrap_or(0);
        f32::from(code) / 255.0
    };
    let pixels = (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y)));
    let pixels = pixels.map(|(x, y)| {
        // The lowest coverage among the neighbours gives the distance from the border.
        let least = [(0, 1), (2, 1), (1, 0), (1, 2)].map(|(right, down)| match (x + right, y + down) {
            (0, _) | (_, 0) => 0.0,
            (x, y) if x > columns || y > rows => 0.0,
            (x, y) => covered(x - 1, y - 1),
        });
        let here = covered(x, y);
        let border = here - least.into_iter().fold(here, f32::min);
        let alpha = (FILL * here + BORDER * border).min(BORDER);
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 255")]
        Color32::from_rgba_unmultiplied(red, green, blue, alpha as u8)
    });
    let image = ColorImage::new([columns, rows], pixels.collect());
    let known = ui.ctx().data(|data| data.get_temp::<TextureHandle>(id));
    let mut texture = known.unwrap_or_else(|| {
        let empty = ColorImage::new([1, 1], vec![Color32::TRANSPARENT]);
        ui.ctx().load_texture("ghost", empty, TextureOptions::LINEAR)
    });
    texture.set(image, TextureOptions::LINEAR);
    ui.ctx().data_mut(|data| data.insert_temp(id, texture.clone()));
    texture
}
