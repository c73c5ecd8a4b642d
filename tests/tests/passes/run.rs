//! The core on each setup, once for all tests, with all of its results.

use std::sync::{Arc, LazyLock};

use app_core::core::CoreError;
use app_core::frame::{FrameInput, Warning};
use app_core::gloss::Gloss;
use app_core::preset::Preset;
use app_core::reflection::Reflection;
use app_core::scene::{Image, Plate, Scene};
use app_core::shadow_style::ShadowStyle;
use app_core::sharpness::Sharpness;
use app_pipeline::core::inspect::Inspect;
use app_pipeline::geometry::rect::PixelRect;
use app_pipeline::model::plan::Plan;
use app_pipeline::model::state::solution::{Fit, ReceiverFit};
use app_pipeline::model::state::tints::TintMap;
use app_pipeline::readback::{FloatMap, Map};
use glam::{DVec2, DVec3, DVec4, UVec2, Vec3, Vec4};
use reference::grid::PlaneGrid;
use reference::model::{Pictures, ReceiverSolution, Region, Solution};
use reference::raster::Raster;
use reference::reflection::Reflection as KnownReflection;

use crate::cores::core_on;
use crate::device::Device;
use crate::errors::Errors;
use crate::photo::{code, photograph, unrounded_code};
use crate::setups::SETUPS;
use crate::stand::Stand;

/// Results of the device for a setup.
pub(crate) struct Run {
    pub(crate) stand: Stand,
    pub(crate) shadow_style: ShadowStyle,
    pub(crate) plan: Plan,
    pub(crate) region: Region,
    /// Pictures as the passes read them.
    pub(crate) pictures: Pictures,
    /// Validity: r if the frame shows the receiver, g if it shows the toy.
    pub(crate) validity: Raster<DVec4>,
    pub(crate) gbuffer_base: Raster<DVec3>,
    /// Light that the physical toy receives from each light.
    pub(crate) gbuffer_received: Raster<DVec4>,
    pub(crate) shown_visibility: Raster<DVec4>,
    pub(crate) shown_ambient: Raster<f64>,
    /// Coverage of each pixel by the shown toy.
    pub(crate) coverage: Raster<f64>,
    pub(crate) solution: Solution,
    /// Filled residuals on each receiver, their certainty, and the places of their cells.
    pub(crate) residuals: Vec<Raster<DVec4>>,
    pub(crate) grids: Vec<PlaneGrid>,
    /// Tints of the toy's paint, one grid per material.
    pub(crate) tints: TintMap,
    /// The lights' share of the plate's radiance.
    pub(crate) direct_fraction: Raster<DVec3>,
    /// Codes of the finished picture, within the region.
    pub(crate) picture: Raster<[u8; 4]>,
}

static RUNS: LazyLock<Result<Vec<Run>, String>> = LazyLock::new(|| {
    let decoded = Device::shared().decoded();
    let run = |setup| {
        let stand = Stand::new(setup);
        let pictures = photograph(&stand);
        Run::new(stand, pictures, &decoded).map_err(|error| error.to_string())
    };
    SETUPS.into_iter().map(run).collect()
});

/// A run for each setup.
///
/// # Panics
///
/// Panics without an adapter, with the core's message.
pub(crate) fn runs() -> &'static [Run] {
    match &*RUNS {
        Ok(runs) => runs,
        Err(error) => panic!("{error}"),
    }
}

impl Run {
    /// A run for a plate and a frame; `decoded` are the linear values of all codes, as the device
    /// decodes them.
    pub(crate) fn new(stand: Stand, pictures: [Arc<Image>; 2], decoded: &[f64]) -> Result<Self, CoreError> {
        Self::by(Preset::Balanced, stand, pictures, decoded)
    }

    /// A run with a preset.
    pub(crate) fn by(
        preset: Preset,
        stand: Stand,
        [plate, frame]: [Arc<Image>; 2],
        decoded: &[f64],
    ) -> Result<Self, CoreError> {
        Self::of(preset, (stand, Sharpness::SHARP), [plate, frame], decoded)
    }

    /// A run with a picture that counts as soft.
    pub(crate) fn of(
        preset: Preset,
        (stand, sharpness): (Stand, Sharpness),
        [plate, frame]: [Arc<Image>; 2],
        decoded: &[f64],
    ) -> Result<Self, CoreError> {
        let input = input(&stand, &frame).with_sharpness(sharpness);
        Self::made((preset, &input), stand, [plate, frame], decoded)
    }

    /// A run with a glossy toy.
    pub(crate) fn glossy(
        gloss: Gloss,
        stand: Stand,
        [plate, frame]: [Arc<Image>; 2],
        decoded: &[f64],
    ) -> Result<Self, CoreError> {
        let input = input(&stand, &frame).with_gloss(gloss);
        Self::made((Preset::Balanced, &input), stand, [plate, frame], decoded)
    }

    /// A run with a shadow style.
    pub(crate) fn styled(
        style: ShadowStyle,
        stand: Stand,
        [plate, frame]: [Arc<Image>; 2],
        decoded: &[f64],
    ) -> Result<Self, CoreError> {
        let input = input(&stand, &frame).with_shadow_style(style);
        Self::made((Preset::Balanced, &input), stand, [plate, frame], decoded)
    }

    /// A run with a reflecting table.
    pub(crate) fn reflecting(
        reflection: Reflection,
        stand: Stand,
        [plate, frame]: [Arc<Image>; 2],
        decoded: &[f64],
    ) -> Result<Self, CoreError> {
        let input = input(&stand, &frame).with_reflection(Some(reflection));
        Self::made((Preset::Balanced, &input), stand, [plate, frame], decoded)
    }

    fn made(
        (preset, input): (Preset, &FrameInput),
        stand: Stand,
        [plate, frame]: [Arc<Image>; 2],
        decoded: &[f64],
    ) -> Result<Self, CoreError> {
        let mut core = core_on(scene(&stand, &plate), preset)?;
        let report = core.frame(input)?;
        let expected = match stand.setup.lights {
            [] => vec![Warning::NoLight { has_ambient: true }],
            _ => Vec::new(),
        };
        assert_eq!(report.warnings, expected);
        let plan = core.plan().expect("the toy moves").clone();
        let (origin, size) = (plan.region.origin_px, plan.region.size_px);
        let map = |map| Ok::<_, CoreError>(raster(&core.read_map(map)?.expect("the toy moves")));
        let visible = |map: Raster<DVec4>| map.map(|texel| texel.x);
        let as_decoded =
            |color: DVec3| DVec3::from(color.to_array().map(|linear| decoded[usize::from(code(linear))]));
        let plate = map(Map::Plate)?.map(DVec4::truncate);
        let validity = map(Map::Validity)?;
        let base = map(Map::GbufferBase)?;
        let fit = core.read_fit()?.expect("the toy moves");
        let picture = core.read_picture()?;
        let residuals = core.read_residuals()?;
        Ok(Self {
            region: Region {
                reflection: input
                    .reflection
                    .map(|reflection| known_reflection(&stand, &reflection)),
                ..stand.region(&plan.region)
            },
            pictures: Pictures {
                frame: crop(&frame, &plan.region, decoded),
                plate: plate.map(|texel| {
                    if plan.is_plate_fine {
                        texel
                    } else {
                        as_decoded(texel)
                    }
                }),
                seen: validity.map(|texel| texel.x),
                visibility: map(Map::PhysicalVisibility)?,
                ambient: visible(map(Map::PhysicalAmbient)?),
            },
            validity,
            // The map is decoded by the standard; the shader uses the driver's decoding.
            gbuffer_base: base.map(|texel| as_decoded(texel.truncate())),
            gbuffer_received: map(Map::GbufferReceived)?,
            shown_visibility: map(Map::Visibility)?,
            shown_ambient: visible(map(Map::Ambient)?),
            coverage: visible(map(Map::Coverage)?),
            solution: solution(&fit, stand.setup.lights.len()),
            residuals: residuals.iter().map(|(_, residual)| raster(residual)).collect(),
            grids: residuals.iter().map(|(grid, _)| PlaneGrid::from(grid)).collect(),
            tints: core.read_tints()?.expect("the toy moves"),
            direct_fraction: map(Map::DirectFraction)?.map(DVec4::truncate),
            picture: Raster::from_fn(size, |texel| texel_of(&picture, origin + texel)),
            shadow_style: input.shadow_style,
            stand,
            plan,
        })
    }
}

/// Reflection of a stand's table, for the references.
pub(crate) fn known_reflection(stand: &Stand, reflection: &Reflection) -> KnownReflection {
    KnownReflection {
        channel: stand.setup.lights.len(),
        alpha: reflection.roughness,
        surroundings: Vec3::from(reflection.surroundings).as_dvec3(),
        toy_above_surroundings: Vec3::from(reflection.toy_above_surroundings).as_dvec3(),
        eye_in_plane: stand.camera_ray(DVec2::ZERO).0,
    }
}

/// A frame of a stand, from its camera.
pub(crate) fn input(stand: &Stand, image: &Arc<Image>) -> FrameInput {
    FrameInput::new(Arc::clone(image), stand.camera, stand.world_from_object)
        .with_shown_pose(stand.shown_pose.clone())
}

pub(crate) fn scene(stand: &Stand, plate: &Arc<Image>) -> Scene {
    Scene::new(
        stand.setup.image_px.to_array(),
        Arc::clone(&stand.toy),
        stand.world_from_object,
        stand.receivers.clone(),
    )
    .with_name(stand.setup.name)
    .with_physical_pose(stand.physical_pose.clone())
    .with_lights(stand.setup.lights.to_vec())
    .with_plates(vec![plate_of(stand, plate)])
}

/// A plate that the stand's camera took.
pub(crate) fn plate_of(stand: &Stand, image: &Arc<Image>) -> Plate {
    Plate {
        camera: stand.camera,
        image: Arc::clone(image),
    }
}

pub(crate) fn raster(map: &FloatMap) -> Raster<DVec4> {
    let texel = |at: UVec2| Vec4::from(map.texels[(at.y * map.width + at.x) as usize]).as_dvec4();
    Raster::from_fn(UVec2::new(map.width, map.height), texel)
}

/// A rectangle of a picture, as shaders read it: `decoded` has the linear value of each code.
pub(crate) fn crop(image: &Image, rect: &PixelRect, decoded: &[f64]) -> Raster<DVec3> {
    Raster::from_fn(rect.size_px, |texel| {
        let [r, g, b, _] = texel_of(image, rect.origin_px + texel).map(|code| decoded[usize::from(code)]);
        DVec3::new(r, g, b)
    })
}

pub(crate) fn texel_of(image: &Image, at: UVec2) -> [u8; 4] {
    let first = 4 * (at.y * image.width_px + at.x) as usize;
    [0, 1, 2, 3].map(|channel| image.rgba8[first + channel])
}

/// Codes of two pictures at a place, channel by channel.
pub(crate) fn codes_at(
    actual: &Image,
    expected: &Image,
    at: UVec2,
) -> impl Iterator<Item = (f64, f64)> + use<> {
    let (actual, expected) = (texel_of(actual, at), texel_of(expected, at));
    (0..3).map(move |channel| (f64::from(actual[channel]), f64::from(expected[channel])))
}

/// The device's fit, for the references.
pub(crate) fn solution(fit: &Fit, n_lights: usize) -> Solution {
    let color = |value: &[f32; 4]| Vec4::from(*value).truncate().as_dvec3();
    let receiver = |fit: &ReceiverFit| ReceiverSolution {
        bounce: color(&fit.bounce),
        direct_fractions: fit.direct_fraction[..n_lights].iter().map(color).collect(),
        clipped: color(&fit.clipped),
    };
    Solution {
        gain: color(&fit.gain),
        intensities: fit.intensity[..n_lights].iter().map(color).collect(),
        receivers: fit.receivers.iter().map(receiver).collect(),
        toy: fit.toy[..2 + n_lights].iter().map(color).collect(),
    }
}

/// Precision of every stage's input: difference between the driver's decoding and the standard's.
#[test]
fn driver_decodes_srgb_within_half_a_code() {
    let pairs = (0..=255u8)
        .zip(Device::shared().decoded())
        .map(|(code, linear)| (unrounded_code(linear), f64::from(code)));
    // A software driver's polynomial has an error of at most 0.34 codes.
    Errors::between(pairs).check_all("codes of decoded codes", 0.5);
}
