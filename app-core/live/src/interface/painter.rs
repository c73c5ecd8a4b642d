//! Drawing of egui's tessellated shapes on a target of the screen's.

use egui_wgpu::{Renderer, RendererOptions, ScreenDescriptor};

use super::{Painting, Textures};
use app_pipeline::core::Canvas;

/// egui's own renderer, for targets of one format that stores sRGB codes unchanged.
pub(crate) struct Painter {
    renderer: Renderer,
}

impl Painter {
    pub(crate) fn new(canvas: &Canvas<'_>) -> Self {
        let format = canvas.target.format();
        Self {
            renderer: Renderer::new(canvas.device, format, RendererOptions::PREDICTABLE),
        }
    }

    /// Paints over the target's content, or over the clear colour.
    pub(crate) fn paint(
        &mut self,
        canvas: &Canvas<'_>,
        (painting, textures): (&Painting, &Textures),
        below: wgpu::LoadOp<wgpu::Color>,
    ) {
        let &Canvas {
            device,
            queue,
            target,
        } = canvas;
        for (id, delta) in &textures.set {
            self.renderer.update_texture(device, queue, *id, delta);
        }
        let screen = ScreenDescriptor {
            size_in_pixels: [target.width(), target.height()],
            pixels_per_point: painting.pixels_per_point,
        };
        let view = target.create_view(&wgpu::TextureViewDescriptor::default());
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut commands =
            self.renderer
                .update_buffers(device, queue, &mut encoder, &painting.primitives, &screen);
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("interface"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: below,
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        });
        self.renderer
            .render(&mut pass.forget_lifetime(), &painting.primitives, &screen);
        commands.push(encoder.finish());
        queue.submit(commands);
        for id in &textures.free {
            self.renderer.free_texture(id);
        }
    }
}
