//! Lines over a photograph.

use app_core::alignment::Outlines;
use app_core::frame::FrameInput;
use app_core::scene::{Image, Scene};
use glam::{DVec2, DVec3};

use crate::gizmo::dot;

/// Colour of given values: red.
pub const GIVEN: [u8; 3] = [255, 40, 40];
/// Colour of aligned values: green.
pub const ALIGNED: [u8; 3] = [40, 255, 60];
/// Colour of receivers: blue.
const RECEIVERS: [u8; 3] = [70, 120, 255];
/// Number of lines of a receiver's grid around the toy, their spacing, and dots along each.
const N_LINES: i32 = 6;
const LINE_M: f64 = 0.05;
const N_DOTS: i32 = 400;

/// Draws outlines of toy and shadows.
pub fn outlines(picture: &mut Image, outlines: &Outlines, color: [u8; 3]) {
    let shadows = outlines.shadows.iter().flatten();
    for at_px in outlines.toy.iter().chain(shadows) {
        dot(picture, *at_px, color);
    }
}

/// Draws a grid on each receiver around the foot of the toy: a line every 5 cm.
pub fn receivers(picture: &mut Image, scene: &Scene, input: &FrameInput) {
    for receiver in &scene.receivers {
        let toy = input.world_from_object.w_axis.truncate();
        let foot = receiver.world_from_plane.inverse().transform_point3(toy);
        let foot = (DVec2::new(foot.x, foot.z) / LINE_M).round() * LINE_M;
        for line in -N_LINES..=N_LINES {
            for step in -N_DOTS..=N_DOTS {
                let across = f64::from(line) * LINE_M;
                let along = f64::from(step) / f64::from(N_DOTS) * f64::from(N_LINES) * LINE_M;
                for from_foot in [DVec2::new(across, along), DVec2::new(along, across)] {
                    let at = foot + from_foot;
                    let is_on = at.abs().cmple(receiver.half_extent_m).all();
                    let world = receiver
                        .world_from_plane
                        .transform_point3(DVec3::new(at.x, 0.0, at.y));
                    if let Some(at_px) = input.camera.pixel_of(world).filter(|_| is_on) {
                        dot(picture, at_px, RECEIVERS);
                    }
                }
            }
        }
    }
}
