//! Recording of one submission: each pass with its name, its bindings and, on request, its time stamps.

use glam::UVec2;

use super::bindings::Resource;
use super::context::Gpu;
use super::pass_run::{PassRun, Path};
use super::pipeline::{Compute, Draw, Pipeline};
use super::timer::Timer;
use super::uniforms::Written;

/// Commands being recorded.
pub(crate) struct Recorder<'g> {
    pub(crate) gpu: &'g Gpu,
    /// The path to which passes are attributed.
    pub(crate) path: Path,
    raw: wgpu::CommandEncoder,
    uniforms: Written,
    timer: Option<&'g mut Timer>,
    /// In the order of their first runs.
    ran: Vec<PassRun>,
}

/// A bind group to be set.
pub(crate) struct Group {
    index: u32,
    raw: wgpu::BindGroup,
    /// Dynamic offset of the uniform of this use.
    offset: Option<u32>,
}

impl<'g> Recorder<'g> {
    pub(crate) fn new(gpu: &'g Gpu, timer: Option<&'g mut Timer>) -> Self {
        Self {
            raw: gpu.device.encoder(),
            path: Path::Frame,
            uniforms: Written::default(),
            timer,
            ran: Vec::new(),
            gpu,
        }
    }

    /// Binds resources to a pipeline's group, in the order of its slots.
    pub(crate) fn bind<T>(&self, pipeline: &Pipeline<T>, index: usize, resources: &[Resource<'_>]) -> Group {
        Group {
            index: u32::try_from(index).unwrap_or(u32::MAX),
            raw: self.group(pipeline, index, resources),
            offset: None,
        }
    }

    /// The same with `uniform`, for this use alone, in place of [`Resource::PerUse`].
    pub(crate) fn bind_with<T, U: bytemuck::Pod>(
        &mut self,
        pipeline: &Pipeline<T>,
        index: usize,
        uniform: &U,
        resources: &[Resource<'_>],
    ) -> Group {
        let offset = self.uniforms.add(uniform);
        Group {
            offset: Some(offset),
            ..self.bind(pipeline, index, resources)
        }
    }

    /// Begins a render pass under the name of its shader.
    pub(crate) fn render<'a>(
        &'a mut self,
        pass: &'static str,
        colors: &[Option<wgpu::RenderPassColorAttachment<'_>>],
        depth: Option<&wgpu::TextureView>,
        keep_depth: wgpu::StoreOp,
    ) -> Render<'a> {
        self.count(pass);
        let stamps = self.timer.as_mut().and_then(|timer| timer.next(self.path, pass));
        let raw = self.raw.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(pass),
            color_attachments: colors,
            depth_stencil_attachment: depth.map(|view| wgpu::RenderPassDepthStencilAttachment {
                view,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0.0),
                    store: keep_depth,
                }),
                stencil_ops: None,
            }),
            timestamp_writes: stamps.map(|(query_set, first)| wgpu::RenderPassTimestampWrites {
                query_set,
                beginning_of_pass_write_index: Some(first),
                end_of_pass_write_index: Some(first + 1),
            }),
            occlusion_query_set: None,
            multiview_mask: None,
        });
        Render(raw)
    }

    /// Runs a fragment shader over the whole of `targets`.
    pub(crate) fn fullscreen(&mut self, draw: &Draw, groups: &[Group], targets: &[&wgpu::TextureView]) {
        let colors: Vec<_> = targets.iter().map(|view| Some(cleared(view))).collect();
        self.fullscreen_onto(draw, groups, &colors);
    }

    /// The same onto attachments of which some may be kept.
    pub(crate) fn fullscreen_onto(
        &mut self,
        draw: &Draw,
        groups: &[Group],
        colors: &[Option<wgpu::RenderPassColorAttachment<'_>>],
    ) {
        let mut render = self.render(draw.name, colors, None, wgpu::StoreOp::Discard);
        render.begin(draw, groups);
        render.0.draw(0..3, 0..1);
    }

    /// The same, onto the part of them at `origin_px` alone, of so many pixels; nowhere where there is none.
    pub(crate) fn fullscreen_within(
        &mut self,
        draw: &Draw,
        groups: &[Group],
        colors: &[Option<wgpu::RenderPassColorAttachment<'_>>],
        part: Option<(UVec2, UVec2)>,
    ) {
        let mut render = self.render(draw.name, colors, None, wgpu::StoreOp::Discard);
        if let Some((origin_px, size_px)) = part {
            render.begin(draw, groups);
            render
                .0
                .set_scissor_rect(origin_px.x, origin_px.y, size_px.x, size_px.y);
            render.0.draw(0..3, 0..1);
        }
    }

    pub(crate) fn compute(&mut self, compute: &Compute, groups: &[Group], workgroups: [u32; 3]) {
        self.count(compute.name);
        let stamps = self
            .timer
            .as_mut()
            .and_then(|timer| timer.next(self.path, compute.name));
        let mut pass = self.raw.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(compute.name),
            timestamp_writes: stamps.map(|(query_set, first)| wgpu::ComputePassTimestampWrites {
                query_set,
                beginning_of_pass_write_index: Some(first),
                end_of_pass_write_index: Some(first + 1),
            }),
        });
        pass.set_pipeline(&compute.raw);
        for group in groups {
            pass.set_bind_group(group.index, &group.raw, group.offset.as_slice());
        }
        let [x, y, z] = workgroups;
        pass.dispatch_workgroups(x, y, z);
    }

    /// Sets a buffer to zero.
    pub(crate) fn clear(&mut self, buffer: &wgpu::Buffer) {
        self.raw.clear_buffer(buffer, 0, None);
    }

    /// Copies all of a texture to one of the same size and format.
    pub(crate) fn copy(&mut self, from: &wgpu::Texture, to: &wgpu::Texture) {
        self.raw
            .copy_texture_to_texture(from.as_image_copy(), to.as_image_copy(), to.size());
    }

    /// Submits the commands; returns the passes that are in them.
    pub(crate) fn submit(mut self) -> Vec<PassRun> {
        if let Some(timer) = self.timer.take() {
            timer.resolve(&mut self.raw);
        }
        self.uniforms.write(&self.gpu.queue, &self.gpu.uniforms);
        self.gpu.queue.submit([self.raw.finish()]);
        self.ran
    }

    fn group<T>(&self, pipeline: &Pipeline<T>, index: usize, resources: &[Resource<'_>]) -> wgpu::BindGroup {
        let layout = pipeline.layouts[index].clone();
        // A group that the pipeline lacks is refused by the device, which names it.
        let layout = layout.unwrap_or_else(|| self.gpu.layout(&[]));
        self.gpu.bind(&layout, resources)
    }

    fn count(&mut self, pass: &'static str) {
        let path = self.path;
        match self
            .ran
            .iter_mut()
            .find(|run| (run.path, run.pass) == (path, pass))
        {
            Some(run) => run.n_runs += 1,
            None => self.ran.push(PassRun {
                path,
                pass,
                n_runs: 1,
            }),
        }
    }
}

/// A render pass being recorded.
pub(crate) struct Render<'a>(pub(crate) wgpu::RenderPass<'a>);

impl Render<'_> {
    /// Sets a pipeline with its groups.
    pub(crate) fn begin(&mut self, draw: &Draw, groups: &[Group]) {
        self.0.set_pipeline(&draw.raw);
        groups.iter().for_each(|group| self.set(group));
    }

    pub(crate) fn set(&mut self, group: &Group) {
        self.0
            .set_bind_group(group.index, &group.raw, group.offset.as_slice());
    }
}

/// An attachment that is cleared to zero and stored.
pub(crate) fn cleared(view: &wgpu::TextureView) -> wgpu::RenderPassColorAttachment<'_> {
    cleared_to(view, wgpu::Color::TRANSPARENT)
}

/// An attachment that is cleared to a value and stored.
pub(crate) fn cleared_to(
    view: &wgpu::TextureView,
    value: wgpu::Color,
) -> wgpu::RenderPassColorAttachment<'_> {
    wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops: wgpu::Operations {
            load: wgpu::LoadOp::Clear(value),
            store: wgpu::StoreOp::Store,
        },
    }
}

/// An attachment that keeps its texels where nothing is drawn.
pub(crate) fn loaded(view: &wgpu::TextureView) -> wgpu::RenderPassColorAttachment<'_> {
    wgpu::RenderPassColorAttachment {
        ops: wgpu::Operations {
            load: wgpu::LoadOp::Load,
            store: wgpu::StoreOp::Store,
        },
        ..cleared(view)
    }
}

/// A multisampled attachment that is cleared to zero, never stored, and resolved into `target`.
pub(crate) fn resolved<'a>(
    view: &'a wgpu::TextureView,
    target: &'a wgpu::TextureView,
) -> wgpu::RenderPassColorAttachment<'a> {
    wgpu::RenderPassColorAttachment {
        resolve_target: Some(target),
        ..discarded(view)
    }
}

/// A multisampled attachment that starts at zero and is forgotten.
pub(crate) fn discarded(view: &wgpu::TextureView) -> wgpu::RenderPassColorAttachment<'_> {
    wgpu::RenderPassColorAttachment {
        ops: wgpu::Operations {
            load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
            store: wgpu::StoreOp::Discard,
        },
        ..cleared(view)
    }
}
