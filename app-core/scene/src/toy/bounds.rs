//! Bounding boxes of a toy: in one pose, and over a whole clip.

use glam::{DAffine3, DVec3, Vec3};

use super::Toy;
use super::clip::{Clip, ClipId};
use super::error::ToyError;
use super::limits::{MAX_BOUNDS_SAMPLES, MAX_NUMBER};
use super::moment::Pose;
use super::pose::is_within;

/// An axis-aligned box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Lowest x, y and z.
    pub min: Vec3,
    /// Highest x, y and z.
    pub max: Vec3,
}

impl Bounds {
    const EMPTY: Self = Self {
        min: Vec3::INFINITY,
        max: Vec3::NEG_INFINITY,
    };

    fn include(&mut self, point: Vec3) {
        self.min = self.min.min(point);
        self.max = self.max.max(point);
    }
}

impl Toy {
    /// The box around the toy in one pose, in object space.
    ///
    /// # Errors
    /// As [`Toy::pose`], except that positions may be from -1e12 to 1e12 along each axis.
    pub fn bounds_of_pose(&self, pose: &Pose) -> Result<Bounds, ToyError> {
        let mut bounds = Bounds::EMPTY;
        self.include_pose(pose, &mut bounds)?;
        Ok(bounds)
    }

    /// The box around the toy over a clip, in object space.
    ///
    /// It is computed at every key and 30 times per second (less often in clips of more than some
    /// 1000 such moments), so a movement between two of them can reach a little beyond it.
    ///
    /// # Errors
    /// As [`Toy::bounds_of_pose`].
    pub fn bounds_over_clip(&self, id: ClipId) -> Result<Bounds, ToyError> {
        let mut bounds = Bounds::EMPTY;
        for time_secs in moments_secs(self.clip(id)?) {
            let moment = Pose::Clip { clip: id, time_secs };
            self.include_pose(&moment, &mut bounds)?;
        }
        Ok(bounds)
    }

    fn include_pose(&self, pose: &Pose, bounds: &mut Bounds) -> Result<(), ToyError> {
        let rig_pose = self.rig_pose(pose, DAffine3::IDENTITY)?;
        for surface in self.surfaces.iter() {
            let geometry = &self.geometries[surface.geometry];
            let active = geometry.active_targets(self.rig.morph_weights(&rig_pose, surface.node));
            let mut fault = None;
            surface.deform(geometry, &rig_pose, &active, |vertex, position: DVec3, _| {
                let position = position.as_vec3();
                if !is_within(position, MAX_NUMBER) {
                    fault = Some(surface.first_vertex + vertex);
                }
                bounds.include(position);
            });
            if let Some(vertex) = fault {
                return Err(self.overflow(vertex, MAX_NUMBER));
            }
        }
        Ok(())
    }
}

/// The times of the keys and of a grid of 30 per second, increasing.
fn moments_secs(clip: &Clip) -> Vec<f64> {
    const STEPS_PER_SEC: f64 = 30.0;
    const MAX_STEPS: f64 = (MAX_BOUNDS_SAMPLES / 2) as f64;
    let n_steps = (clip.duration_secs * STEPS_PER_SEC).ceil().clamp(1.0, MAX_STEPS);
    let mut grid: Vec<f64> = Vec::new();
    let mut step = 0.0;
    while step <= n_steps {
        grid.push(clip.duration_secs * step / n_steps);
        step += 1.0;
    }
    let keys = clip
        .channels
        .iter()
        .flat_map(|channel| &channel.track.times_secs)
        .copied();
    let mut moments: Vec<f64> = keys.filter(|&key_secs| key_secs >= 0.0).collect();
    sort_and_dedup(&mut moments);
    let stride = moments.len().div_ceil(MAX_BOUNDS_SAMPLES / 2).max(1);
    let mut moments: Vec<f64> = moments.into_iter().step_by(stride).chain(grid).collect();
    sort_and_dedup(&mut moments);
    moments
}

fn sort_and_dedup(times_secs: &mut Vec<f64>) {
    times_secs.sort_by(f64::total_cmp);
    times_secs.dedup();
}
