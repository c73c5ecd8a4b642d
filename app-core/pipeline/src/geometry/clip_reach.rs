//! Extent of a toy in its physical pose, over a whole clip and in further shown poses, in anchor space: independent
//! of cameras.

use glam::DMat4;

use crate::geometry::outline::Outline;
use crate::geometry::reach::Reach;
use crate::geometry::scene_layout::SceneLayout;
use crate::geometry::view::View;
use app_scene::geometry::bounds::Bounds;
use app_scene::reflection::Reflection;
use app_scene::toy::{ClipId, Pose, PosedMesh, Toy, ToyError};

/// Number of moments of a clip that contribute to its outline.
const N_MOMENTS: u32 = 64;

/// Bounds and outline over a clip.
pub(crate) struct ClipReach {
    /// The clip; `None` for the model's pose as authored.
    pub(crate) clip: Option<ClipId>,
    /// Bounds of the toy alone.
    pub(crate) bounds: Bounds,
    outline: Outline,
}

impl ClipReach {
    /// Poses the toy into `posed`: once as `physical`, at its real place, and at moments of `clip`,
    /// at its shown place.
    pub(crate) fn new(
        toy: &Toy,
        (physical, anchor_from_object): (&Pose, &DMat4),
        (clip, anchor_from_shown): (Option<ClipId>, &DMat4),
        posed: &mut PosedMesh,
    ) -> Result<Self, ToyError> {
        toy.pose(physical, anchor_from_object, posed)?;
        let mut outline = Outline::around(posed);
        for moment in &moments(toy, clip)? {
            toy.pose(moment, anchor_from_shown, posed)?;
            posed.points().for_each(|p| outline.include(p));
        }
        Ok(Self {
            clip,
            bounds: Bounds::around(outline.points()),
            outline,
        })
    }

    /// Reach of everything that a scene announces: poses at places in anchor space, and the
    /// physical pose.
    pub(crate) fn of_film<'a>(
        toy: &Toy,
        (physical, anchor_from_object): (&Pose, &DMat4),
        film: impl Iterator<Item = (&'a Pose, DMat4)>,
        posed: &mut PosedMesh,
    ) -> Result<Self, ToyError> {
        toy.pose(physical, anchor_from_object, posed)?;
        let mut outline = Outline::around(posed);
        for (pose, anchor_from_shown) in film {
            toy.pose(pose, &anchor_from_shown, posed)?;
            posed.points().for_each(|p| outline.include(p));
        }
        Ok(Self {
            clip: None,
            bounds: Bounds::around(outline.points()),
            outline,
        })
    }

    /// Includes a pose of the same toy, from a tracker or between the moments. Returns whether the
    /// bounds grew.
    pub(crate) fn grow(&mut self, posed: &PosedMesh) -> bool {
        let mut has_grown = false;
        for point in posed.points() {
            if !self.outline.holds(point) {
                self.outline.include(point);
                has_grown = true;
            }
        }
        if has_grown {
            self.bounds = Bounds::around(self.outline.points());
        }
        has_grown
    }

    /// Extent of the toy, its shadows and its reflection in a view.
    pub(crate) fn on_view<'a>(
        &self,
        view: &'a View,
        layout: &SceneLayout<'_>,
        reflection: Option<&Reflection>,
    ) -> Reach<'a> {
        let reach = Reach::new(view, &self.bounds, layout);
        let mut reach = reach.with_reflection(reflection, layout.toy_in_anchor);
        self.outline.points().for_each(|p| reach.include(p));
        reach
    }
}

/// Moments of a clip, evenly spaced, or the pose as authored.
fn moments(toy: &Toy, clip: Option<ClipId>) -> Result<Vec<Pose>, ToyError> {
    let Some(clip) = clip else {
        return Ok(vec![Pose::Authored]);
    };
    let (duration_secs, _) = toy.clamp_time(clip, f64::MAX)?;
    let moment = |k: u32| Pose::Clip {
        clip,
        time_secs: duration_secs * f64::from(k) / f64::from(N_MOMENTS - 1),
    };
    Ok((0..N_MOMENTS).map(moment).collect())
}
