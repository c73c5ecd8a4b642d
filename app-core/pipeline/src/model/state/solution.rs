//! The solution of the fits, and the sums from which it is solved.

use crate::gpu::bindings::{GROUP_SCENE, Resource, Slot};
use crate::gpu::buffer::Buffer;
use crate::gpu::pipeline::Pipeline;
use crate::gpu::recorder::{Group, Recorder};
use crate::gpu::shader::{Mirrors, mirrors};
use crate::gpu::shared::shared_struct;
use crate::passes::globals::Globals;
use crate::passes::pictures::{Encoding, Frame};
use app_scene::scene::{MAX_LIGHTS, MAX_RECEIVERS};

/// WGSL part of the solution.
pub(crate) const FIT: Mirrors = mirrors!("common/fit", structs: [ReceiverFit, Fit], constants: [N_COLUMNS]);
/// Slots that the model's passes share: the globals and the fit.
pub(crate) const SCENE_SLOTS: &[Slot] = &[Slot::uniform::<Globals>(), Slot::Read];
/// The same with the camera's picture.
pub(crate) const SEEN_SLOTS: &[Slot] = &[
    SCENE_SLOTS[0],
    SCENE_SLOTS[1],
    Slot::per_use::<Encoding>(),
    Slot::Texture,
    Slot::Texture,
];

/// Maximum number of unknowns of a fit: two, and one per light.
pub const N_COLUMNS: usize = 2 + MAX_LIGHTS;
/// Sums of a fit in one channel: the upper triangle of the normal equations row by row, their right-hand side, and the
/// clipped pixels' part of the first.
pub const N_FIT_SUMS: usize = N_COLUMNS * (N_COLUMNS + 1) / 2 + N_COLUMNS + 1;
/// Colour channels.
pub(crate) const N_CHANNELS: usize = 3;
/// Weight of the fit's priors relative to the energy of its first column.
pub(crate) const PRIOR_WEIGHT: f32 = 1e-4;
/// Weight of the first receiver's gain as the prior of the others', relative to the same energy.
pub(crate) const SAME_GAIN_WEIGHT: f32 = 10.0;
/// Prior of the toy's bounce.
pub(crate) const PRIOR_BOUNCE: f32 = 0.27;
/// Prior of the sum of all lights' direct fractions.
pub(crate) const PRIOR_DIRECT_FRACTION: f32 = 0.5;

shared_struct! {
    /// The fit of a receiver.
    pub struct ReceiverFit {
        pub bounce: [f32; 4],
        pub direct_fraction: [[f32; 4]; MAX_LIGHTS],
        pub clipped: [f32; 4],
    }
}

shared_struct! {
    /// All fits.
    pub struct Fit {
        pub gain: [f32; 4],
        pub intensity: [[f32; 4]; MAX_LIGHTS],
        pub receivers: [ReceiverFit; MAX_RECEIVERS],
        pub toy: [[f32; 4]; N_COLUMNS],
    }
}

/// Resources of [`SCENE_SLOTS`].
#[derive(Clone, Copy)]
pub(crate) struct Scene<'a> {
    pub(crate) globals: &'a Buffer,
    pub(crate) solution: &'a Buffer,
}

impl<'a> Scene<'a> {
    pub(crate) fn resources(&self) -> [Resource<'a>; 2] {
        [self.globals.into(), self.solution.into()]
    }
}

/// A scene with the camera's picture, of the image's size.
#[derive(Clone, Copy)]
pub(crate) struct SeenScene<'a> {
    pub(crate) scene: Scene<'a>,
    pub(crate) frame: Frame<'a>,
}

impl SeenScene<'_> {
    /// Binds it to a pipeline whose first group has [`SEEN_SLOTS`].
    pub(crate) fn bind<T>(&self, recorder: &mut Recorder<'_>, pipeline: &Pipeline<T>) -> Group {
        let [globals, solution] = self.scene.resources();
        let [picture, chroma] = self.frame.views().map(Resource::from);
        let resources = [globals, solution, Resource::PerUse, picture, chroma];
        recorder.bind_with(pipeline, GROUP_SCENE, &self.frame.uniform(), &resources)
    }
}

/// The starting solution, which also remains if a frame has no valid pixel.
pub(crate) fn start(n_lights: usize) -> Fit {
    let direct_fraction = PRIOR_DIRECT_FRACTION / n_lights.max(1) as f32;
    // Without any light no shadow is known either.
    let bounce = if n_lights == 0 { 1.0 } else { PRIOR_BOUNCE };
    let mut receiver = ReceiverFit {
        bounce: [bounce; 4],
        direct_fraction: [[0.0; 4]; MAX_LIGHTS],
        clipped: [0.0; 4],
    };
    receiver.direct_fraction[..n_lights.min(MAX_LIGHTS)].fill([direct_fraction; 4]);
    let mut fit = Fit {
        gain: [1.0; 4],
        intensity: [[1.0; 4]; MAX_LIGHTS],
        receivers: [receiver; MAX_RECEIVERS],
        toy: [[0.0; 4]; N_COLUMNS],
    };
    fit.toy[..2].fill([0.5; 4]);
    fit
}

/// Bytes of the accumulated sums for each receiver and the toy.
pub(crate) const fn accumulated_bytes() -> u64 {
    (size_of::<f32>() * N_FIT_SUMS * N_CHANNELS * (MAX_RECEIVERS + 1)) as u64
}
