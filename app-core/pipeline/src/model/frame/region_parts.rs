//! Parts of the region that `composite` draws by a shader each: near the toy, in a shadow, and open.

use glam::{UVec2, Vec2};

use crate::geometry::rect::PixelRect;
use crate::geometry::silhouette::ByCamera;
use crate::geometry::tiles::Tiles;
use crate::model::capture::detail;
use crate::model::lighting::{LightMaps, Lighting, Posed, TILE_PX};
use crate::model::region::Region;
use crate::passes::toy_mesh::{CasterLod, PoseBuffers, ToyMesh};

/// Farthest that the validity and what is drawn of a toy tell of it, in pixels beyond its triangles.
const AROUND_TOY_PX: f32 = 10.0;

/// What a toy in one pose changes.
pub(crate) struct Marks {
    /// Tiles near it.
    near: Tiles,
    /// Tiles in which more may change than a little ambient light.
    shadowed: Tiles,
}

impl Marks {
    /// Of a pose, with the maps of its lights.
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
            // The validity then tells of shadows or of things, too.
            near.mark_all();
        } else {
            let camera = ByCamera {
                origin_px: Vec2::ZERO,
                ..globals.uniform.by_camera()
            };
            let around_px = AROUND_TOY_PX + globals.uniform.soft_reach_px();
            toy.mark_seen(&mut near, pose, CasterLod::Own, &camera, around_px);
        }
        if detail::is_needed(&region.plan) || region.plan.n_lights == 0 {
            // Each pixel has its own residual, or the ambient light's change may be as large as a shadow.
            shadowed.mark_all();
        } else {
            lighting.mark_shadows(&mut shadowed, Posed { globals, toy, pose }, maps);
        }
        Self { near, shadowed }
    }

    /// Marks all as shadowed: the light changes wherever any of it is hidden.
    pub(crate) fn shadow_all(&mut self) {
        self.shadowed.mark_all();
    }
}

/// Rectangles that fill the region.
pub(crate) struct RegionParts {
    /// Clear of the toy and of its shadows in either pose.
    pub(crate) open: Vec<PixelRect>,
    /// Where shadows may fall.
    pub(crate) shadowed: Vec<PixelRect>,
    /// Near the toy.
    pub(crate) near: Vec<PixelRect>,
}

impl RegionParts {
    /// All of a region of `size_px` as near the toy.
    pub(crate) fn all_near(size_px: UVec2) -> Self {
        Self {
            open: Vec::new(),
            shadowed: Vec::new(),
            near: Tiles::over(size_px, TILE_PX).rects(false),
        }
    }

    /// Of both poses.
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
