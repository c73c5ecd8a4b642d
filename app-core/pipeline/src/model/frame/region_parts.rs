//! Parts of the region that `composite` draws with a shader each: near the toy, in a shadow, and
//! open.

use glam::{UVec2, Vec2};

use crate::geometry::rect::PixelRect;
use crate::geometry::silhouette::ByCamera;
use crate::geometry::tiles::Tiles;
use crate::model::capture::detail;
use crate::model::lighting::{LightMaps, Lighting, Posed, TILE_PX};
use crate::model::plan::AROUND_TOY_PX;
use crate::model::region::Region;
use crate::passes::toy_mesh::{CasterLod, PoseBuffers, ToyMesh};

/// The tiles that a toy in one pose changes.
pub(crate) struct Marks {
    /// Tiles near the toy.
    near: Tiles,
    /// Tiles in which more than a little ambient light may change.
    shadowed: Tiles,
}

impl Marks {
    /// The marks of a pose, with the maps of its lights.
    pub(crate) fn of(
        region: &Region,
        lighting: &Lighting,
        toy: &ToyMesh,
        pose: &PoseBuffers,
        maps: &LightMaps,
    ) -> Self {
        let mut near = Tiles::over(region.plan.region.size_px, TILE_PX);
        let mut shadowed = near.clone();
        let globals = region.globals_on_device();
        if region.plan.is_shadow_withheld || region.plan.has_things {
            // The validity then also marks shadows or objects.
            near.mark_all();
        } else {
            let camera = ByCamera {
                origin_px: Vec2::ZERO,
                ..globals.uniform.by_camera()
            };
            // Beyond it neither the validity nor the drawn toy differs.
            let around_px = AROUND_TOY_PX as f32 + globals.uniform.soft_reach_px;
            toy.mark_seen(&mut near, pose, CasterLod::Own, &camera, around_px);
        }
        if detail::is_needed(&region.plan) || region.plan.n_lights == 0 {
            // Each pixel has its own residual, or the ambient light may change as much as in a
            // shadow.
            shadowed.mark_all();
        } else {
            lighting.mark_shadows(&mut shadowed, Posed { globals, toy, pose }, maps);
        }
        Self { near, shadowed }
    }

    /// Marks all tiles as shadowed: the light changes wherever any of it is hidden.
    pub(crate) fn shadow_all(&mut self) {
        self.shadowed.mark_all();
    }
}

/// Rectangles that cover the region.
pub(crate) struct RegionParts {
    /// Outside the toy and its shadows in either pose.
    pub(crate) open: Vec<PixelRect>,
    /// Parts in which shadows may fall.
    pub(crate) shadowed: Vec<PixelRect>,
    /// Parts near the toy.
    pub(crate) near: Vec<PixelRect>,
}

impl RegionParts {
    /// Treats the whole region of `size_px` as near the toy.
    pub(crate) fn all_near(size_px: UVec2) -> Self {
        Self {
            open: Vec::new(),
            shadowed: Vec::new(),
            near: Tiles::over(size_px, TILE_PX).rects(false),
        }
    }

    /// The parts for the marks of both poses.
    pub(crate) fn new([physical, shown]: [&Marks; 2]) -> Self {
        let (mut near, mut shadowed) = (physical.near.clone(), physical.shadowed.clone());
        near.join(&shown.near);
        shadowed.join(&shown.shadowed);
        let shadowed_alone = shadowed.without(&near).rects(true);
        shadowed.join(&near);
        Self {
            open: shadowed.rects(false),
            shadowed: shadowed_alone,
            near: near.rects(true),
        }
    }
}
