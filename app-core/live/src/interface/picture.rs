//! The camera's picture below the sheets: taps, drags and turns on it, and the shapes over it.

use egui::{Pos2, Sense, Ui};
use glam::{DAffine2, DVec2};

use super::input::{Screen, narrowed};
use super::{check, overlay};
use crate::app::{App, UserAction};

/// Turn for one step of a mouse's wheel, in radians.
const WHEEL_RAD: f64 = 0.05;

pub(super) fn show(ui: &mut Ui, app: &App, screen: &Screen, wheel_steps: f64, actions: &mut Vec<UserAction>) {
    let Some((picture_px, display)) = app.picture() else {
        return;
    };
    let picture_from_screen = display.image_from_screen(picture_px, screen.size_px);
    let units = f64::from(screen.pixels_per_unit());
    let pixel = |at: Pos2| picture_from_screen.transform_point2(units * DVec2::new(at.x.into(), at.y.into()));
    let response = ui.interact(
        ui.ctx().content_rect(),
        egui::Id::unique("picture"),
        // A screen reader has nothing to read of it.
        Sense::CLICK | Sense::DRAG,
    );
    let fingers = ui.ctx().multi_touch();
    if let Some(fingers) = fingers {
        // Screens have y downwards: seen from above, a turn to the right is negative.
        actions.push(UserAction::Twist(-f64::from(fingers.rotation_delta)));
    } else if response.clicked() {
        actions.extend(
            response
                .interact_pointer_pos()
                .map(|at| UserAction::Tap(pixel(at))),
        );
    } else if response.dragged() {
        let delta = response.drag_delta();
        actions.extend(response.interact_pointer_pos().map(|at| UserAction::Drag {
            from_px: pixel(at - delta),
            to_px: pixel(at),
        }));
    }
    if wheel_steps != 0.0 {
        actions.push(UserAction::Twist(wheel_steps * WHEEL_RAD));
    }
    overlay::show(ui, app, |pixel| on_screen(&picture_from_screen, units, pixel));
    check::picture(ui, app, |pixel| on_screen(&picture_from_screen, units, pixel));
}

/// Position on the screen of a pixel of the camera's picture, in the interface's points.
fn on_screen(picture_from_screen: &DAffine2, units: f64, pixel: DVec2) -> Pos2 {
    let at = picture_from_screen.inverse().transform_point2(pixel) / units;
    Pos2::new(narrowed(at.x), narrowed(at.y))
}
