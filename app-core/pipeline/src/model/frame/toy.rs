//! `toy`: the toy in the shown pose with its camera pixels, drawn once for each offset within a
//! pixel.

use std::sync::OnceLock;

use glam::{Vec2, Vec3};
use wgpu::{Face, StoreOp, TextureFormat, VertexFormat};

use crate::geometry::rect::PixelRect;
use crate::gpu::bindings::{GROUP_PASS, Resource, Slot};
use crate::gpu::buffer::Buffer;
use crate::gpu::context::Gpu;
use crate::gpu::pipeline::{Draw, DrawSpec, Stream, nearest_surface};
use crate::gpu::recorder::{Attachment, Recorder, discarded, sampled};
use crate::gpu::shader::{Shader, shader};
use crate::gpu::texture::{Texture, TextureView};
use crate::model::capture::appearance;
use crate::model::frame::moved_mask::MOVED_FORMAT;
use crate::model::lighting::self_shadow;
use crate::model::lighting::self_shadow::{GROUP_SELF_SHADOW, SELF_SHADOW_GROUP};
use crate::model::plan::Plan;
use crate::model::state::solution::{SEEN_SLOTS, SeenScene};
use crate::model::state::tints::{TintGrid, Tints};
use crate::passes::materials::MATERIAL_GROUP;
use crate::passes::pictures::ByForm;
use crate::passes::specular::Specular;
use crate::passes::toy_mesh::{LOOK_STREAMS, Sided, ToyMesh};

pub(crate) const SHADER: Shader = shader!("frame/toy");
/// The offset of a draw in pixels, followed by its inputs.
const SLOTS: &[Slot] = &[
    Slot::per_use::<Vec2>(),
    Slot::Depth,
    Slot::Texture,
    Slot::Texture,
    Slot::uniform::<TintGrid>(),
    Slot::Read,
    Slot::Texture,
    Slot::Texture,
    Slot::Texture,
    Slot::uniform::<Specular>(),
    Slot::Texture,
    Slot::Texture,
];
/// Streams of a draw with materials, followed by the physical pose.
const STREAMS: &[Stream] = &[
    LOOK_STREAMS[0],
    LOOK_STREAMS[1],
    LOOK_STREAMS[2],
    LOOK_STREAMS[3],
    (4, VertexFormat::Float32x3),
    (5, VertexFormat::Float32x3),
];
/// Format of premultiplied radiance for a single draw: the resolve averages linear light, and the
/// picture has no more codes.
const CODED_FORMAT: TextureFormat = TextureFormat::Rgba8UnormSrgb;
/// Format for draws that are still to be averaged.
const FINE_FORMAT: TextureFormat = TextureFormat::Rgba16Float;
const N_SAMPLES: u32 = 4;
/// Offsets of the draws: the multisample positions at half their size around the pixel's centre.
/// The 16 samples of four draws then lie in rows and columns and leave no hole. RMS error of the
/// area that a straight edge of any direction cuts off a pixel: 0.088 with the 4 samples of one
/// draw, 0.041 with 16; at a quarter of their size 0.054.
const OFFSETS_PX: [Vec2; 4] = [
    Vec2::new(-0.0625, -0.1875),
    Vec2::new(0.1875, -0.0625),
    Vec2::new(-0.1875, 0.0625),
    Vec2::new(0.0625, 0.1875),
];

/// Draws of both sides of each triangle, and of the side that faces the camera.
type Sides = ByForm<[Draw; 2]>;

/// Draws onto targets of a format and a number of samples.
struct Variants {
    target: (TextureFormat, u32),
    matt: Sides,
    /// Draws of a glossy toy, made on first use.
    glossy: OnceLock<Sides>,
}

impl Variants {
    fn new(gpu: &Gpu, target: (TextureFormat, u32)) -> Self {
        Self {
            target,
            matt: sides(gpu, target, false),
            glossy: OnceLock::new(),
        }
    }

    fn of(&self, gpu: &Gpu, is_glossy: bool) -> &Sides {
        if is_glossy {
            self.glossy.get_or_init(|| sides(gpu, self.target, true))
        } else {
            &self.matt
        }
    }
}

pub(crate) struct Pass {
    coded: Variants,
    fine: Variants,
    /// Draws with one sample per pixel.
    single: Variants,
}

pub(crate) struct Inputs<'a> {
    pub(crate) plan: &'a Plan,
    pub(crate) camera_in_anchor: Vec3,
    /// The part of the toy box in which the toy may be visible.
    pub(crate) shown_toy: Option<PixelRect>,
    pub(crate) seen: SeenScene<'a>,
    pub(crate) toy: &'a ToyMesh,
    pub(crate) appearance: &'a appearance::Targets,
    pub(crate) gbuffer_depth: &'a TextureView,
    /// Self-shadow of the shown pose, and of the physical one.
    pub(crate) self_shadow: [&'a self_shadow::Targets; 2],
    pub(crate) tints: &'a Tints,
    /// Colours that a soft picture mixes into those of the toy, and the parts of one surface in these.
    pub(crate) mixed: Option<&'a Texture>,
    pub(crate) unmixed: Option<&'a Texture>,
    /// Radiance that a glossy toy reflected.
    pub(crate) reflected: Option<&'a TextureView>,
    pub(crate) specular: &'a Buffer,
    /// Marks of things before the toy, if their fronts are known.
    pub(crate) marks_before: Option<&'a TextureView>,
}

/// Targets of the toy box's size: one for each draw, and those that stay in tile memory.
pub(crate) struct Targets {
    /// `None` if a pixel has a single sample.
    samples: Option<Samples>,
    depth: Texture,
    drawn: Vec<Texture>,
    /// Share of the pixel that shows a surface which the camera did not see in that place; a small
    /// share for one in other light (`common/moved`).
    pub(crate) moved: Texture,
}

/// Multisampled textures that are resolved into the targets.
struct Samples {
    drawn: Texture,
    moved: Texture,
}

impl Targets {
    pub(crate) fn new(gpu: &Gpu, plan: &Plan) -> Self {
        let size_px = plan.toy_box.size_px;
        let n_draws = plan.n_toy_draws.max(1);
        let n_samples = plan.n_toy_samples;
        let on_chip = |label, format| Texture::samples(gpu, label, size_px, (format, n_samples));
        let format = if n_draws > 1 { FINE_FORMAT } else { CODED_FORMAT };
        Self {
            samples: (n_samples > 1).then(|| Samples {
                drawn: on_chip("toy samples", format),
                moved: on_chip("toy moved samples", MOVED_FORMAT),
            }),
            depth: on_chip("toy depth", TextureFormat::Depth32Float),
            drawn: (0..n_draws)
                .map(|_| Texture::target(gpu, "toy", size_px, format))
                .collect(),
            moved: Texture::target(gpu, "toy moved", size_px, MOVED_FORMAT),
        }
    }

    /// Draws of the toy, 1 or 4.
    #[allow(clippy::cast_possible_truncation, reason = "a handful")]
    pub(crate) fn n_draws(&self) -> u32 {
        self.drawn.len() as u32
    }

    /// Attachments of one draw: radiance and the moved share. The samples of the last draw are
    /// enough for the moved share.
    fn attachments<'a>(&'a self, drawn: &'a Texture, is_last: bool) -> [Attachment<'a>; 2] {
        let samples = self.samples.as_ref();
        let moved_samples = samples.map(|samples| &samples.moved.view);
        let moved = match moved_samples {
            Some(forgotten) if !is_last => discarded(forgotten),
            _ => sampled(moved_samples, &self.moved.view),
        };
        [
            sampled(samples.map(|samples| &samples.drawn.view), &drawn.view),
            moved,
        ]
    }

    /// The drawn textures; the first one also replaces the draws that are left out.
    pub(crate) fn views(&self) -> [&TextureView; OFFSETS_PX.len()] {
        [0, 1, 2, 3].map(|draw| &self.drawn.get(draw).unwrap_or(&self.drawn[0]).view)
    }
}

impl Pass {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        Self {
            coded: Variants::new(gpu, (CODED_FORMAT, N_SAMPLES)),
            fine: Variants::new(gpu, (FINE_FORMAT, N_SAMPLES)),
            single: Variants::new(gpu, (CODED_FORMAT, 1)),
        }
    }

    /// Draws the toy once at the pixel's centre, or once for each offset.
    pub(crate) fn encode(&self, recorder: &mut Recorder<'_>, inputs: &Inputs<'_>, targets: &Targets) {
        let variants = match targets.drawn.len() {
            1 if targets.samples.is_none() => &self.single,
            1 => &self.coded,
            _ => &self.fine,
        };
        let sides = variants.of(recorder.gpu, inputs.reflected.is_some());
        let [draw, culled] = sides.of(recorder.gpu, &inputs.seen.frame);
        let [shown, physical] = inputs.self_shadow;
        let maps = shown.resources(recorder.gpu, physical);
        let materials = inputs.toy.bind_materials(recorder, draw);
        let offsets: &[Vec2] = if targets.drawn.len() == 1 {
            &[Vec2::ZERO]
        } else {
            &OFFSETS_PX
        };
        for (index, (drawn, offset_px)) in targets.drawn.iter().zip(offsets).enumerate() {
            let groups = [
                inputs.seen.bind(recorder, draw),
                recorder.bind_with(draw, GROUP_PASS, offset_px, &inputs.resources()),
                recorder.bind(draw, GROUP_SELF_SHADOW, &maps),
            ];
            let colors = targets
                .attachments(drawn, index + 1 == targets.drawn.len())
                .map(Some);
            let depth = Some(&targets.depth.view);
            let mut render = recorder.render(SHADER.name, &colors, depth, StoreOp::Discard);
            render.part_of(inputs.plan.part_drawn(&inputs.plan.toy_box));
            // An invisible toy is not drawn: the targets are only cleared.
            let Some(part) = inputs.shown_toy else { continue };
            render.within((part.origin_px, part.size_px));
            let sided = Sided {
                both: draw,
                culled,
                groups: &groups,
                camera_in_anchor: inputs.camera_in_anchor,
            };
            let toy = inputs.toy;
            toy.draw_parts(&mut render, &sided, &[&toy.shown, &toy.physical], &materials);
        }
    }
}

fn sides(gpu: &Gpu, (format, n_samples): (TextureFormat, u32), is_glossy: bool) -> Sides {
    let groups = [SEEN_SLOTS, SLOTS, MATERIAL_GROUP, SELF_SHADOW_GROUP];
    let is_coarse = ("IS_COARSE", u32::from(n_samples == 1));
    let is_glossy = ("IS_GLOSSY", u32::from(is_glossy));
    ByForm::new(gpu, move |gpu, form| {
        [None, Some(Face::Back)].map(|culled| {
            gpu.draw(&DrawSpec {
                vertex: "vs_toy",
                streams: STREAMS,
                n_samples,
                constants: vec![form, is_coarse, is_glossy],
                depth: Some(nearest_surface()),
                culled,
                ..DrawSpec::fullscreen(&SHADER, "fs_toy", groups, &[format, MOVED_FORMAT])
            })
        })
    })
}

impl<'a> Inputs<'a> {
    fn resources(&self) -> [Resource<'a>; 12] {
        // A sharp picture binds a placeholder that is not read, and so does one without such things.
        let of_soft = |drawn: Option<&'a Texture>| &drawn.unwrap_or(&self.appearance.base).view;
        [
            Resource::PerUse,
            self.gbuffer_depth.into(),
            (&self.appearance.base.view).into(),
            (&self.appearance.received.view).into(),
            (&self.tints.grid).into(),
            (&self.tints.cells).into(),
            (&self.appearance.source.view).into(),
            of_soft(self.mixed).into(),
            self.reflected.unwrap_or(&self.appearance.base.view).into(),
            self.specular.into(),
            of_soft(self.unmixed).into(),
            self.marks_before.unwrap_or(&self.appearance.base.view).into(),
        ]
    }
}
