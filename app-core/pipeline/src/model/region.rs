//! The work region of the latest view: its plan and its globals.

use crate::geometry::rect::PixelRect;
use crate::gpu::buffer::Buffer;
use crate::gpu::context::Gpu;
use crate::model::plan::Plan;
use crate::passes::globals::{Globals, GlobalsOnDevice};
use app_scene::sharpness::Sharpness;
use app_scene::things::MAX_FRONTS;

pub(crate) struct Region {
    pub(crate) plan: Plan,
    /// Contents of `globals`.
    pub(crate) uniform: Globals,
    pub(crate) globals: Buffer,
    /// Specular reflection of the toy.
    pub(crate) specular: Buffer,
}

impl Region {
    pub(crate) fn new(gpu: &Gpu, plan: Plan, globals: &Globals) -> Self {
        let uniform = planned(globals, &plan);
        Self {
            globals: gpu.uniform("globals", &uniform),
            specular: gpu.uniform("specular", &plan.specular),
            uniform,
            plan,
        }
    }

    /// Switches to another view.
    pub(crate) fn follow(&mut self, gpu: &Gpu, plan: Plan, globals: &Globals) {
        self.uniform = planned(globals, &plan);
        self.plan = plan;
        gpu.write(&self.globals, &[self.uniform]);
        gpu.write(&self.specular, &[self.plan.specular]);
    }

    /// Sets the sharpness of the picture.
    pub(crate) fn soften(&mut self, gpu: &Gpu, sharpness: Sharpness) {
        self.plan.sharpness = sharpness;
        self.uniform = self.uniform.with_spread(sharpness.outline_spread);
        gpu.write(&self.globals, &[self.uniform]);
    }

    /// The globals, on the processor and on the device.
    pub(crate) fn globals_on_device(&self) -> GlobalsOnDevice<'_> {
        GlobalsOnDevice {
            uniform: &self.uniform,
            buffer: &self.globals,
        }
    }

    /// The rectangle of the camera image.
    pub(crate) fn rect(&self) -> PixelRect {
        self.plan.region
    }
}

/// A region's globals with those that its plan determines.
fn planned(globals: &Globals, plan: &Plan) -> Globals {
    let mut things_fronts = [[0.0; 4]; MAX_FRONTS];
    for (out, front) in things_fronts.iter_mut().zip(&plan.things_fronts) {
        *out = front.plane().as_vec4().to_array();
    }
    Globals {
        things_fronts,
        ..globals.with_spread(plan.sharpness.outline_spread)
    }
}
