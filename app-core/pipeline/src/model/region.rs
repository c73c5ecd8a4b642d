//! The work region of the latest view: its plan and its globals.

use crate::geometry::rect::PixelRect;
use crate::gpu::buffer::Buffer;
use crate::gpu::context::Gpu;
use crate::model::plan::Plan;
use crate::passes::globals::{Globals, GlobalsOnDevice};

pub(crate) struct Region {
    pub(crate) plan: Plan,
    /// Contents of `globals`.
    pub(crate) uniform: Globals,
    pub(crate) globals: Buffer,
}

impl Region {
    pub(crate) fn new(gpu: &Gpu, plan: Plan, globals: &Globals) -> Self {
        Self {
            plan,
            uniform: *globals,
            globals: gpu.uniform("globals", globals),
        }
    }

    /// Moves on to another view.
    pub(crate) fn follow(&mut self, gpu: &Gpu, plan: Plan, globals: &Globals) {
        self.plan = plan;
        self.uniform = *globals;
        gpu.write(&self.globals, &[*globals]);
    }

    /// The globals, here and there.
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
