//! The lights as a view has them: points that are drawn from, and the visibilities that come of it.

use glam::Vec4;
use wgpu::TextureFormat;

use crate::gpu::Gpu;
use crate::gpu::encoder::Encoder;
use crate::gpu::texture::Texture;
use crate::light_points::ambient_directions;
use crate::passes::occlusion::{Caster, OcclusionTargets};
use crate::passes::toy_mesh::{PoseBuffers, ToyMesh};
use crate::pipeline::Passes;
use crate::plan::Plan;

/// Format of the ambient map.
pub(crate) const AMBIENT_FORMAT: TextureFormat = TextureFormat::R16Float;

/// Visibility of the lights and of the ambient light, for one pose.
pub(crate) struct Visibilities {
    pub(crate) lights: Texture,
    pub(crate) ambient: Texture,
    /// Replaces what the passes make of the lights.
    pub(crate) injected: Option<Texture>,
}

impl Visibilities {
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        let region_px = plan.region.size_px;
        Self {
            lights: Texture::plain_target(gpu, "visibility", region_px, plan.visibility_format),
            ambient: Texture::plain_target(gpu, "ambient", plan.ambient_px, AMBIENT_FORMAT),
            injected: None,
        }
    }
}

/// Points over the lights, directions of the ambient light, and what these are drawn to.
pub(crate) struct Lighting {
    /// Of each light those in the space of the first receiver, which is the stage, then those of the next.
    pub(crate) points: Vec<Vec<Vec4>>,
    n_receivers: usize,
    /// All lights use them, one after the other.
    light_targets: OcclusionTargets,
    ambient_targets: OcclusionTargets,
    ambient_directions: Vec<Vec4>,
}

impl Lighting {
    /// `points` are those of each light, receiver by receiver.
    pub(crate) fn new(gpu: &Gpu, plan: &Plan, points: Vec<Vec<Vec4>>) -> Self {
        let (region_px, n_receivers) = (plan.region.size_px, plan.n_receivers as usize);
        Self {
            points,
            light_targets: OcclusionTargets::new(gpu, region_px, region_px),
            ambient_targets: OcclusionTargets::new(gpu, plan.ambient_px, region_px),
            // Each receiver has its own hemisphere.
            ambient_directions: ambient_directions(plan.n_ambient_directions).repeat(n_receivers),
            n_receivers,
        }
    }

    /// The points of each light in stage space.
    pub(crate) fn points_in_stage(&self) -> Vec<&[Vec4]> {
        let points = self.points.iter();
        points
            .map(|points| &points[..points.len() / self.n_receivers.max(1)])
            .collect()
    }

    /// Encodes visibility and ambient visibility of the toy in a pose.
    pub(crate) fn encode(
        &self,
        gpu: &Gpu,
        encoder: &mut Encoder,
        (passes, globals): (&Passes, &wgpu::Buffer),
        (toy, pose): (&ToyMesh, &PoseBuffers),
        outputs: &Visibilities,
    ) {
        let occlusion = &passes.occlusion;
        for (points, visibility) in self.points.iter().zip(&passes.lights) {
            let caster = Caster { toy, pose, points };
            occlusion.encode(gpu, encoder, globals, &caster, &self.light_targets);
            visibility.encode(gpu, encoder, &self.light_targets, &outputs.lights.view);
        }
        if let Some(injected) = &outputs.injected {
            outputs.lights.encode_copy(encoder, injected);
        }
        let points = &self.ambient_directions;
        let caster = Caster { toy, pose, points };
        occlusion.encode(gpu, encoder, globals, &caster, &self.ambient_targets);
        passes
            .ambient
            .encode(gpu, encoder, &self.ambient_targets, &outputs.ambient.view);
    }
}
