//! Pose of the toy and lights in use: at first those of the scene, then those of the frames.

use glam::{DMat4, DVec3, Vec3};

use super::Stage;
use super::supported::Lights;
use crate::geometry::displacement::between_poses;
use crate::geometry::outline::Outline;
use crate::gpu::Gpu;
use app_scene::frame::FrameInput;
use app_scene::geometry::bounds::Bounds;
use app_scene::scene::Light;
use app_scene::toy::ToyError;

/// Largest movement in the picture within which the learned state of an object's pose stays valid:
/// below the noise of any tracker, and below visible differences.
const SAME_POSE_PX: f64 = 0.1;

impl Stage {
    /// Adopts the frame's pose of the object, its lights and the reflection of its receiver, if
    /// they differ from those at the time of learning.
    pub(super) fn follow_placement(&mut self, gpu: &Gpu, input: &FrameInput) -> Result<(), ToyError> {
        let mut is_moved = false;
        if !self.is_object_placed || self.is_object_moved(input) {
            self.place_object(gpu, &input.world_from_object)?;
            is_moved = true;
        }
        let listed: &[Light] = input.lights.as_deref().unwrap_or(&self.scene.lights);
        if *listed != self.lights.listed {
            self.lights = Lights::new(listed, &self.receivers);
            is_moved = true;
        }
        is_moved |= self.take_reflection(input);
        if is_moved {
            self.reach = None;
            self.reached_rects.clear();
            self.cached_footprint = None;
            self.lights_inside = None;
            self.refused_steps = None;
            if let Some(state) = &mut self.state {
                state.is_placement_outdated = true;
            }
        }
        if self.lights_inside.is_none() {
            self.lights_inside = Some(self.find_lights_inside()?);
        }
        Ok(())
    }

    /// Lights inside the physical toy, as indices in the list that was given.
    fn find_lights_inside(&mut self) -> Result<Vec<usize>, ToyError> {
        let (anchor_from_world, bounds) = (self.layout().world_from_anchor().inverse(), self.physical_bounds);
        let mut inside = Vec::new();
        for (index, light) in self.lights.indices.iter().zip(&self.lights.used) {
            let Some(position_in_world) = light.position_in_world() else {
                continue;
            };
            let at = anchor_from_world.transform_point3(position_in_world);
            if at.cmpgt(bounds.min).all() && at.cmplt(bounds.max).all() {
                inside.push((*index, at));
            }
        }
        if inside.is_empty() {
            return Ok(Vec::new());
        }
        let anchor_from_object = self.anchor_from_object();
        let toy = &self.scene.toy;
        toy.pose(&self.scene.physical_pose, &anchor_from_object, &mut self.posed)?;
        let positions = &self.posed.positions;
        inside.retain(|(_, at)| is_inside(positions, toy.indices(), *at));
        Ok(inside.into_iter().map(|(index, _)| index).collect())
    }

    fn is_object_moved(&self, input: &FrameInput) -> bool {
        let poses = [&self.world_from_object, &input.world_from_object];
        let corners_in_object = self.bounds_in_object.corners();
        let view = self.view(&input.camera);
        poses[0] != poses[1] && between_poses(&view, &self.layout(), poses, corners_in_object) > SAME_POSE_PX
    }

    fn place_object(&mut self, gpu: &Gpu, world_from_object: &DMat4) -> Result<(), ToyError> {
        let anchor_from_object = self.layout().world_from_anchor().inverse() * *world_from_object;
        self.scene
            .toy
            .pose(&self.scene.physical_pose, &anchor_from_object, &mut self.posed)?;
        self.world_from_object = *world_from_object;
        self.is_object_placed = true;
        self.physical_bounds = Bounds::around(self.posed.points());
        self.physical_outline = Outline::around(&self.posed);
        self.toy.physical.write(gpu, &self.posed);
        Ok(())
    }

    /// Transform from the object's current pose to the anchor, which stays in its place for the
    /// scene.
    pub(super) fn anchor_from_object(&self) -> DMat4 {
        self.layout().world_from_anchor().inverse() * self.world_from_object
    }

    /// Transform from the object's shown place to the anchor; without a place of its own, that is
    /// its physical place.
    pub(super) fn anchor_from_shown(&self, world_from_shown: Option<&DMat4>) -> DMat4 {
        self.layout().world_from_anchor().inverse() * *world_from_shown.unwrap_or(&self.world_from_object)
    }

    /// The centre of the physical toy.
    pub(super) fn toy_in_anchor(&self) -> DVec3 {
        self.physical_bounds.centre()
    }
}

/// Whether a point is inside the mesh: the winding number there is above one half.
///
/// The winding number is the solid angle of all triangles as seen from there, with their sign,
/// relative to that of a sphere. It is 1 within a closed piece and 0 outside, and between the two
/// if the mesh has holes. Source: Jacobson, Kavan and Sorkine-Hornung 2013; solid angle of a
/// triangle: van Oosterom and Strackee 1983.
fn is_inside(positions: &[Vec3], indices: &[u32], at: DVec3) -> bool {
    let corner = |index: u32| positions.get(index as usize).map(|p| p.as_dvec3() - at);
    let half_angles_rad = indices.chunks_exact(3).filter_map(|triangle| {
        let [a, b, c] = [corner(triangle[0])?, corner(triangle[1])?, corner(triangle[2])?];
        let (a_m, b_m, c_m) = (a.length(), b.length(), c.length());
        let volume = a.dot(b.cross(c));
        let rest = a_m * b_m * c_m + a.dot(b) * c_m + b.dot(c) * a_m + c.dot(a) * b_m;
        // Both are 0 at a corner, which has no solid angle.
        Some(volume.atan2(rest))
    });
    // The threshold is half of the whole sphere's 4 pi, expressed in half angles.
    half_angles_rad.sum::<f64>().abs() > std::f64::consts::PI
}
