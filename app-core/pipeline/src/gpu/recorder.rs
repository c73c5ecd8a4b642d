//! Recording of one submission: each pass with its name, its bindings and, on request, its time stamps.

use std::ops::Range;

use glam::UVec2;

use super::bindings::{Resource, Slot};
use super::buffer::Buffer;
use super::context::Gpu;
use super::pass_run::{PassGroup, PassRun};
use super::pipeline::{Compute, Draw, Pipeline};
use super::stages::{StageTime, Stages};
use super::texture::{Texture, TextureView};
use super::timer::Timer;
use super::uniforms::Written;
use super::work::{Bound, Tally, Work};

/// Commands that are recorded and counted; without a device they are only counted.
pub(crate) struct Recorder<'g> {
    pub(crate) gpu: &'g Gpu,
    /// The group to which passes are attributed.
    pub(crate) group: PassGroup,
    /// Pixels of the retargeted pictures: the largest number that a compute shader processes.
    pub(crate) n_pixels: u64,
    pub(crate) stages: Stages,
    raw: Option<wgpu::CommandEncoder>,
    uniforms: Written,
    timer: Option<&'g mut Timer>,
    /// The passes, in the order of their first runs.
    ran: Vec<PassRun>,
    /// Bytes that the processor had transferred before.
    uploaded_bytes: u64,
}

/// A finished recording.
#[derive(Debug)]
pub(crate) struct Recorded {
    /// The passes, in the order of their first runs.
    pub(crate) ran: Vec<PassRun>,
    /// Bytes that the processor transferred meanwhile.
    pub(crate) uploaded_bytes: u64,
    pub(crate) stages: Vec<StageTime>,
}

/// A bind group to be set.
pub(crate) struct Group {
    index: u32,
    raw: Option<wgpu::BindGroup>,
    /// Dynamic offset of this use's uniform.
    offset: Option<u32>,
    bound: Vec<Bound>,
}

/// A colour attachment: a view, its load and store operations, and the target to which several
/// samples are resolved.
#[derive(Clone, Copy)]
pub(crate) struct Attachment<'a> {
    view: &'a TextureView,
    resolve_target: Option<&'a TextureView>,
    ops: wgpu::Operations<wgpu::Color>,
}

impl<'g> Recorder<'g> {
    pub(crate) fn new(gpu: &'g Gpu, timer: Option<&'g mut Timer>) -> Self {
        Self {
            raw: gpu.opened.as_ref().map(|opened| opened.device.encoder()),
            group: PassGroup::Frame,
            n_pixels: u64::MAX,
            stages: Stages::default(),
            uniforms: Written::default(),
            timer,
            ran: Vec::new(),
            uploaded_bytes: gpu.meter.uploaded_bytes(),
            gpu,
        }
    }

    /// Binds resources to a pipeline's group, in the order of its slots.
    pub(crate) fn bind<T>(&self, pipeline: &Pipeline<T>, index: usize, resources: &[Resource<'_>]) -> Group {
        Group {
            index: u32::try_from(index).unwrap_or(u32::MAX),
            raw: self.group(pipeline, index, resources),
            offset: None,
            bound: bound(pipeline.slots[index], resources),
        }
    }

    /// Like [`bind`](Self::bind), with `uniform`, for this use alone, in place of
    /// [`Resource::PerUse`].
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
        colors: &[Option<Attachment<'_>>],
        depth: Option<&TextureView>,
        keep_depth: wgpu::StoreOp,
    ) -> Render<'a> {
        let (group, gpu) = (self.group, self.gpu);
        let work = counted(&mut self.ran, group, pass);
        let tally = tally(work, colors, depth.map(|view| (view, keep_depth)));
        let stamps = self.timer.as_mut().and_then(|timer| timer.next(group, pass));
        let Some(encoder) = self.raw.as_mut().filter(|_| gpu.opened.is_some()) else {
            return Render { raw: None, tally };
        };
        let color_attachments: Vec<_> = colors
            .iter()
            .map(|color| color.as_ref().and_then(on_device))
            .collect();
        let raw = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(pass),
            color_attachments: &color_attachments,
            depth_stencil_attachment: depth.and_then(|view| {
                Some(wgpu::RenderPassDepthStencilAttachment {
                    view: view.raw.as_ref()?,
                    depth_ops: Some(wgpu::Operations {
                        load: wgpu::LoadOp::Clear(0.0),
                        store: keep_depth,
                    }),
                    stencil_ops: None,
                })
            }),
            timestamp_writes: stamps.map(|(query_set, first)| wgpu::RenderPassTimestampWrites {
                query_set,
                beginning_of_pass_write_index: Some(first),
                end_of_pass_write_index: Some(first + 1),
            }),
            occlusion_query_set: None,
            multiview_mask: None,
        });
        Render {
            raw: Some(raw),
            tally,
        }
    }

    /// Runs a fragment shader over the whole of `targets`.
    pub(crate) fn fullscreen(&mut self, draw: &Draw, groups: &[Group], targets: &[&TextureView]) {
        let colors: Vec<_> = targets.iter().map(|view| Some(cleared(view))).collect();
        self.fullscreen_onto(draw, groups, &colors);
    }

    /// Like [`fullscreen`](Self::fullscreen), onto attachments some of which may be kept.
    pub(crate) fn fullscreen_onto(
        &mut self,
        draw: &Draw,
        groups: &[Group],
        colors: &[Option<Attachment<'_>>],
    ) {
        let mut render = self.render(draw.name, colors, None, wgpu::StoreOp::Discard);
        render.begin(draw, groups);
        render.draw(0..3, 0..1);
    }

    /// The same, onto the part of the attachments at `origin_px` alone, of this size; nothing if
    /// the part is `None`.
    pub(crate) fn fullscreen_within(
        &mut self,
        draw: &Draw,
        groups: &[Group],
        colors: &[Option<Attachment<'_>>],
        part: Option<(UVec2, UVec2)>,
    ) {
        let mut render = self.render(draw.name, colors, None, wgpu::StoreOp::Discard);
        if let Some(part) = part {
            render.within(part);
            render.begin(draw, groups);
            render.draw(0..3, 0..1);
        }
    }

    pub(crate) fn compute(&mut self, compute: &Compute, groups: &[Group], workgroups: [u32; 3]) {
        self.compute_over(compute, groups, workgroups, self.n_pixels);
    }

    /// Runs a compute shader that processes this number of pixels.
    pub(crate) fn compute_over(
        &mut self,
        compute: &Compute,
        groups: &[Group],
        [x, y, z]: [u32; 3],
        n_pixels: u64,
    ) {
        let work = counted(&mut self.ran, self.group, compute.name);
        let mut tally = Tally::new(work, n_pixels);
        groups.iter().for_each(|group| tally.bind(&group.bound));
        tally.dispatch();
        let stamps = self
            .timer
            .as_mut()
            .and_then(|timer| timer.next(self.group, compute.name));
        let (Some(encoder), Some(compiled)) = (&mut self.raw, &compute.compiled) else {
            return;
        };
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(compute.name),
            timestamp_writes: stamps.map(|(query_set, first)| wgpu::ComputePassTimestampWrites {
                query_set,
                beginning_of_pass_write_index: Some(first),
                end_of_pass_write_index: Some(first + 1),
            }),
        });
        pass.set_pipeline(&compiled.raw);
        for group in groups {
            pass.set_bind_group(group.index, &group.raw, group.offset.as_slice());
        }
        pass.dispatch_workgroups(x, y, z);
    }

    /// Fills a target with black.
    pub(crate) fn blacken(&mut self, target: &TextureView) {
        self.render("black", &[Some(cleared(target))], None, wgpu::StoreOp::Discard);
    }

    /// Sets a buffer to zero.
    pub(crate) fn clear(&mut self, buffer: &Buffer) {
        if let (Some(encoder), Some(raw)) = (&mut self.raw, &buffer.raw) {
            encoder.clear_buffer(raw, 0, None);
        }
    }

    /// Copies a whole texture to one of the same size and format.
    pub(crate) fn copy(&mut self, from: &Texture, to: &Texture) {
        if let (Some(encoder), Some(from), Some(to)) = (&mut self.raw, from.raw(), to.raw()) {
            encoder.copy_texture_to_texture(from.as_image_copy(), to.as_image_copy(), to.size());
        }
    }

    /// Submits the commands; returns their passes.
    pub(crate) fn submit(mut self) -> Recorded {
        self.stages.begin("submit");
        if let (Some(opened), Some(mut encoder)) = (&self.gpu.opened, self.raw.take()) {
            if let Some(timer) = self.timer.take() {
                timer.resolve(&mut encoder);
            }
            self.uniforms.write(&opened.queue, &opened.uniforms);
            opened.queue.submit([encoder.finish()]);
        }
        self.gpu.meter.upload(self.uniforms.n_bytes());
        Recorded {
            uploaded_bytes: self.gpu.meter.uploaded_bytes() - self.uploaded_bytes,
            ran: self.ran,
            stages: self.stages.end(),
        }
    }

    fn group<T>(
        &self,
        pipeline: &Pipeline<T>,
        index: usize,
        resources: &[Resource<'_>],
    ) -> Option<wgpu::BindGroup> {
        let (opened, compiled) = self.gpu.opened.as_ref().zip(pipeline.compiled.as_ref())?;
        let layout = compiled.layouts[index].clone();
        // The device refuses a group that the pipeline lacks, and names it.
        let layout = layout.unwrap_or_else(|| opened.layout(&[]));
        opened.bind(&layout, resources)
    }
}

fn bound(slots: &[Slot], resources: &[Resource<'_>]) -> Vec<Bound> {
    let pairs = slots.iter().zip(resources);
    pairs
        .filter_map(|(slot, resource)| resource.bound(*slot))
        .collect()
}

/// The work of a pass, of which another run begins.
fn counted<'a>(ran: &'a mut Vec<PassRun>, group: PassGroup, pass: &'static str) -> &'a mut Work {
    let known = ran.iter().position(|run| (run.path, run.pass) == (group, pass));
    let index = known.unwrap_or_else(|| {
        ran.push(PassRun {
            path: group,
            pass,
            n_runs: 0,
            work: Work::default(),
        });
        ran.len() - 1
    });
    let run = &mut ran[index];
    run.n_runs += 1;
    &mut run.work
}

/// Counts the bytes that attachments move.
fn tally<'a>(
    work: &'a mut Work,
    colors: &[Option<Attachment<'_>>],
    depth: Option<(&TextureView, wgpu::StoreOp)>,
) -> Tally<'a> {
    let views = colors.iter().flatten().map(|color| color.view);
    let mut sizes = views
        .chain(depth.map(|(view, _)| view))
        .map(|view| view.shape.size_px);
    let mut tally = Tally::new(work, sizes.next().map_or(0, n_pixels));
    for color in colors.iter().flatten() {
        let is_loaded = matches!(color.ops.load, wgpu::LoadOp::Load);
        tally.attach(
            &color.view.shape,
            is_loaded,
            color.ops.store == wgpu::StoreOp::Store,
        );
        if let Some(resolved) = color.resolve_target {
            tally.attach(&resolved.shape, false, true);
        }
    }
    if let Some((view, store)) = depth {
        tally.attach(&view.shape, false, store == wgpu::StoreOp::Store);
    }
    tally
}

/// The attachment on a device; `None` for a view that was only counted.
fn on_device<'a>(color: &Attachment<'a>) -> Option<wgpu::RenderPassColorAttachment<'a>> {
    Some(wgpu::RenderPassColorAttachment {
        view: color.view.raw.as_ref()?,
        depth_slice: None,
        resolve_target: color.resolve_target.and_then(|view| view.raw.as_ref()),
        ops: color.ops,
    })
}

/// A render pass being recorded.
pub(crate) struct Render<'a> {
    raw: Option<wgpu::RenderPass<'a>>,
    tally: Tally<'a>,
}

impl Render<'_> {
    /// Sets a pipeline with its groups.
    pub(crate) fn begin(&mut self, draw: &Draw, groups: &[Group]) {
        if let (Some(raw), Some(compiled)) = (&mut self.raw, &draw.compiled) {
            raw.set_pipeline(&compiled.raw);
        }
        groups.iter().for_each(|group| self.set(group));
    }

    pub(crate) fn set(&mut self, group: &Group) {
        self.tally.bind(&group.bound);
        if let Some(raw) = &mut self.raw {
            raw.set_bind_group(group.index, &group.raw, group.offset.as_slice());
        }
    }

    pub(crate) fn set_vertices(&mut self, slot: u32, buffer: &Buffer) {
        self.tally.stream(buffer.id, buffer.n_bytes);
        if let (Some(raw), Some(buffer)) = (&mut self.raw, &buffer.raw) {
            raw.set_vertex_buffer(slot, buffer.slice(..));
        }
    }

    /// Sets a buffer of 32-bit indices.
    pub(crate) fn set_indices(&mut self, buffer: &Buffer) {
        if let (Some(raw), Some(buffer)) = (&mut self.raw, &buffer.raw) {
            raw.set_index_buffer(buffer.slice(..), wgpu::IndexFormat::Uint32);
        }
    }

    pub(crate) fn draw(&mut self, vertices: Range<u32>, instances: Range<u32>) {
        self.tally.draw(n(&vertices), n(&instances));
        if let Some(raw) = &mut self.raw {
            raw.draw(vertices, instances);
        }
    }

    pub(crate) fn draw_indexed(&mut self, indices: Range<u32>, instances: Range<u32>) {
        self.tally.draw_indexed(n(&indices), n(&instances));
        if let Some(raw) = &mut self.raw {
            raw.draw_indexed(indices, 0, instances);
        }
    }

    /// Draws a picture of `size_px` of which the attachments hold the part at `origin_px`; to be
    /// called before anything is set.
    pub(crate) fn part_of(&mut self, (origin_px, size_px): (UVec2, UVec2)) {
        let (origin, size) = (origin_px.as_vec2(), size_px.as_vec2());
        if let Some(raw) = &mut self.raw {
            raw.set_viewport(-origin.x, -origin.y, size.x, size.y, 0.0, 1.0);
        }
    }

    /// Limits drawing to a part of the attachments; to be called before anything is set.
    pub(crate) fn within(&mut self, part: (UVec2, UVec2)) {
        self.narrow(n_pixels(part.1));
        self.clip(part);
    }

    /// Counts only this number of pixels for the resources that are set next.
    pub(crate) fn narrow(&mut self, n_pixels: u64) {
        self.tally.narrow(n_pixels);
    }

    /// Limits the next draws to a part of the attachments; others are drawn in the rest of them.
    pub(crate) fn clip(&mut self, (origin_px, size_px): (UVec2, UVec2)) {
        if let Some(raw) = &mut self.raw {
            raw.set_scissor_rect(origin_px.x, origin_px.y, size_px.x, size_px.y);
        }
    }
}

fn n(range: &Range<u32>) -> u32 {
    range.end.saturating_sub(range.start)
}

/// Number of pixels of a picture of that size.
pub(crate) fn n_pixels(size_px: UVec2) -> u64 {
    u64::from(size_px.x) * u64::from(size_px.y)
}

/// An attachment that is cleared to zero and stored.
pub(crate) fn cleared(view: &TextureView) -> Attachment<'_> {
    cleared_to(view, wgpu::Color::TRANSPARENT)
}

/// An attachment that is cleared to a value and stored.
pub(crate) fn cleared_to(view: &TextureView, value: wgpu::Color) -> Attachment<'_> {
    Attachment {
        view,
        resolve_target: None,
        ops: wgpu::Operations {
            load: wgpu::LoadOp::Clear(value),
            store: wgpu::StoreOp::Store,
        },
    }
}

/// An attachment that keeps its texels where nothing is drawn.
pub(crate) fn loaded(view: &TextureView) -> Attachment<'_> {
    Attachment {
        ops: wgpu::Operations {
            load: wgpu::LoadOp::Load,
            store: wgpu::StoreOp::Store,
        },
        ..cleared(view)
    }
}

/// A multisampled attachment that is cleared to zero, never stored, and resolved into `target`.
pub(crate) fn resolved<'a>(view: &'a TextureView, target: &'a TextureView) -> Attachment<'a> {
    Attachment {
        resolve_target: Some(target),
        ..discarded(view)
    }
}

/// A target that starts at zero and is resolved from its samples, or has a single sample.
pub(crate) fn sampled<'a>(samples: Option<&'a TextureView>, target: &'a TextureView) -> Attachment<'a> {
    samples.map_or_else(|| cleared(target), |samples| resolved(samples, target))
}

/// A multisampled attachment that starts at zero and is discarded.
pub(crate) fn discarded(view: &TextureView) -> Attachment<'_> {
    Attachment {
        ops: wgpu::Operations {
            load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
            store: wgpu::StoreOp::Discard,
        },
        ..cleared(view)
    }
}
