//! Warnings for broken input: each case has exactly the expected ones.

use std::sync::Arc;

use app_core::Core;
use app_core::frame::{FrameInput, Warning};
use app_core::gloss::{Gloss, N_GLOSSES};
use app_core::preset::Preset;
use app_core::scene::{FieldError, Image, Light, Receiver, Scene};
use app_core::toy::ToyError;
use app_pipeline::core::inspect::Inspect;
use app_pipeline::readback::Map;
use glam::{DMat4, DVec3};

use crate::core::bundled::{core, first_input, scene};

/// Longest message, in characters: three lines on a phone.
const MOST_CHARACTERS: usize = 240;

/// A scene, a frame of it, and the names of the warnings of both.
struct Case {
    what: &'static str,
    scene: Scene,
    input: FrameInput,
    expected: &'static [&'static str],
}

impl Case {
    fn new(what: &'static str, expected: &'static [&'static str]) -> Self {
        Self {
            what,
            scene: scene(),
            input: first_input(),
            expected,
        }
    }

    fn with_plate(mut self, change: impl Fn([u8; 4]) -> [u8; 4]) -> Self {
        for plate in &mut self.scene.plates {
            plate.image = changed(&plate.image, |_, pixel| change(pixel));
        }
        self
    }

    fn with_picture(mut self, image: Arc<Image>) -> Self {
        self.input.image = image.into();
        self
    }

    fn lit_by(mut self, lights: Vec<Light>) -> Self {
        self.scene.lights = lights;
        self
    }

    fn made_glossy(mut self, roughness: f32, strength: f32) -> Self {
        self.input.gloss = Gloss {
            roughness,
            strengths: [strength; N_GLOSSES],
        };
        self
    }

    /// Moves the real toy to another place.
    fn standing_at(mut self, in_world: DVec3) -> Self {
        let by = in_world - self.scene.world_from_object.w_axis.truncate();
        self.input.world_from_object = DMat4::from_translation(by) * self.scene.world_from_object;
        self
    }

    fn check(self, core: &mut Core) {
        core.set_scene(self.scene, Preset::Balanced).unwrap();
        let report = core.frame(&self.input).unwrap();
        let warnings = [report.warnings, core.read_fit_warnings().unwrap()].concat();
        let messages: Vec<String> = warnings.iter().map(ToString::to_string).collect();
        eprintln!("{}: {messages:?}", self.what);
        let names: Vec<String> = warnings.iter().map(name).collect();
        assert_eq!(names, self.expected, "{}: {messages:?}", self.what);
        for message in messages {
            assert!(message.chars().count() <= MOST_CHARACTERS, "{message}");
        }
    }
}

/// The name of a warning, and of an outlier.
fn name(warning: &Warning) -> String {
    let text = format!("{warning:?}");
    let text = text.trim_start_matches("Mismatch(");
    let end = text.find([' ', '{']).unwrap_or(text.len());
    text[..end].to_owned()
}

fn changed(image: &Image, change: impl Fn(usize, [u8; 4]) -> [u8; 4]) -> Arc<Image> {
    let pixels = image.rgba8.chunks_exact(4).enumerate();
    let rgba8 = pixels.flat_map(|(k, p)| change(k, [p[0], p[1], p[2], p[3]]));
    Arc::new(Image {
        rgba8: rgba8.collect(),
        ..image.clone()
    })
}

fn swapped([r, g, b, a]: [u8; 4]) -> [u8; 4] {
    [b, g, r, a]
}

fn brighter([r, g, b, a]: [u8; 4]) -> [u8; 4] {
    [
        r.saturating_add(25),
        g.saturating_add(20),
        b.saturating_add(12),
        a,
    ]
}

/// A camera's contrast: dark values become darker, and bright ones brighter.
fn with_contrast([r, g, b, a]: [u8; 4]) -> [u8; 4] {
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "from 0 to 255"
    )]
    let curved = |code: u8| {
        let x = f64::from(code) / 255.0;
        (255.0 * x * x * (3.0 - 2.0 * x)).round() as u8
    };
    [curved(r), curved(g), curved(b), a]
}

const fn bulb(position_in_world: DVec3) -> Light {
    Light::Sphere {
        position_in_world,
        radius_m: 0.005,
    }
}

fn toy_middle() -> DVec3 {
    let scene = scene();
    let bounds = scene.toy.bounds_of_pose(&scene.physical_pose).unwrap();
    let middle = (0.5 * (bounds.min + bounds.max)).as_dvec3();
    scene.world_from_object.transform_point3(middle)
}

/// The first picture with the whole real shadow in one code.
fn picture_with_shadow_of(core: &mut Core, code: u8) -> Arc<Image> {
    picture_with_shadow(core, |_, _| [code, code, code, 255])
}

/// The first picture with other pixels in the whole real shadow, by their index and the pixel.
fn picture_with_shadow(core: &mut Core, other: impl Fn(usize, [u8; 4]) -> [u8; 4]) -> Arc<Image> {
    let (scene, input) = (scene(), first_input());
    let width = scene.width_px as usize;
    core.set_scene(scene, Preset::Balanced).unwrap();
    let rect = core.frame(&input).unwrap().region.unwrap();
    let visibility = core.read_map(Map::PhysicalVisibility).unwrap().unwrap();
    let validity = core.read_map(Map::Validity).unwrap().unwrap();
    let [left, top] = rect.origin_px.to_array().map(|px| px as usize);
    let [n_columns, n_rows] = rect.size_px.to_array().map(|px| px as usize);
    changed(input.image.rgba(), |k, pixel| {
        let (x, y) = (k % width, k / width);
        if x < left || y < top || x >= left + n_columns || y >= top + n_rows {
            return pixel;
        }
        let texel = (y - top) * n_columns + (x - left);
        let is_shadow = validity.texels[texel][0] > 0.0 && visibility.texels[texel][0] < 0.99;
        if is_shadow { other(k, pixel) } else { pixel }
    })
}

/// Each defect of the picture or of the scene gives the warning of its cause.
#[test]
fn broken_input_is_told_by_its_cause() {
    let mut core = core();
    let plate = Arc::clone(&scene().plates[0].image);
    let picture = Arc::clone(first_input().image.rgba());
    let [black_shadow, white_shadow] = [0, 255].map(|code| picture_with_shadow_of(&mut core, code));
    let without_blue = picture_with_shadow(&mut core, |k, [r, g, _, a]| [r, g, plate.rgba8[4 * k + 2], a]);
    let without_a_half = picture_with_shadow(&mut core, |k, [r, g, b, a]| {
        [r, g, b.midpoint(plate.rgba8[4 * k + 2]), a]
    });
    let bundled = scene().lights[0];
    let camera = first_input().camera.world_from_camera;
    let behind = camera.transform_point3(DVec3::new(0.0, 0.0, 0.4));
    let cases = [
        Case::new("as it was taken", &[]),
        Case::new("a plate with no toy as picture", &["ToyNotSeen"]).with_picture(plate),
        Case::new("plate with red and blue swapped", &["RedAndBlueSwapped"]).with_plate(swapped),
        Case::new("picture with red and blue swapped", &["RedAndBlueSwapped"])
            .with_picture(changed(&picture, |_, pixel| swapped(pixel))),
        Case::new("another white balance", &[]).with_picture(changed(&picture, |_, pixel| brighter(pixel))),
        Case::new("the tone curve of a phone", &["BounceAtLimit"])
            .with_plate(with_contrast)
            .with_picture(changed(&picture, |_, pixel| with_contrast(pixel))),
        Case::new("black plate", &["PlateUnreadable"]).with_plate(|_| [0, 0, 0, 255]),
        Case::new("white plate", &["PlateUnreadable"]).with_plate(|_| [255; 4]),
        Case::new("black shadow", &["ShadowUnreadable"]).with_picture(black_shadow),
        Case::new("white shadow", &["ShadowUnreadable"]).with_picture(white_shadow),
        Case::new("shadow in red and green alone", &["NoShadowInColor"]).with_picture(without_blue),
        Case::new("shadow of half the strength in blue", &[]).with_picture(without_a_half),
        // The shadow in the picture then belongs to no listed light.
        Case::new("light inside the toy", &["LightsInsideToy", "Outlier(Shadow)"])
            .lit_by(vec![bulb(toy_middle())]),
        Case::new("a toy like a mirror", &["TooGlossy"]).made_glossy(0.02, 1.0),
        Case::new("a toy of metal", &["TooGlossy"]).made_glossy(0.2, 4.0),
        Case::new("a second light inside the toy", &["LightsInsideToy"])
            .lit_by(vec![bundled, bulb(toy_middle())]),
        Case::new("light where there is none", &["NoShadow", "Outlier(Shadow)"])
            .lit_by(vec![bulb(toy_middle() + DVec3::new(0.0, 0.2, 0.0))]),
        // The bulb's own shadow then has no known light.
        Case::new("no light", &["NoLight", "AmbientAlone", "Outlier(Shadow)"]).lit_by(Vec::new()),
        Case::new("toy behind the camera", &["ToyOutOfPicture"]).standing_at(behind),
        Case::new("toy far behind the camera", &["OutOfPicture"]).standing_at(behind.with_y(0.0)),
        Case::new(
            "toy aside from where it stands",
            &["ToyNotSeen", "Outlier(Object)", "Outlier(Shadow)"],
        )
        .standing_at(DVec3::new(0.09, 0.0, 0.0)),
    ];
    for case in cases {
        case.check(&mut core);
    }
}

/// The toy moves out of its old place even without a light.
#[test]
fn without_a_light_every_preset_moves_the_toy() {
    let mut core = core();
    let mut scene = scene();
    scene.lights.clear();
    let input = first_input();
    let photographed = input.image.rgba().rgba8.clone();
    for &preset in Preset::ALL {
        core.set_scene(scene.clone(), preset).unwrap();
        let report = core.frame(&input).unwrap();
        let has_ambient = !matches!(preset, Preset::Flat | Preset::Paper);
        assert_eq!(report.warnings, [Warning::NoLight { has_ambient }], "{preset:?}");
        let picture = core.read_picture().unwrap();
        let n_changed = picture.rgba8.chunks(4).zip(photographed.chunks(4));
        let n_changed = n_changed.filter(|(a, b)| a[0].abs_diff(b[0]) > 30).count();
        assert!(n_changed > 100, "{preset:?}: {n_changed} pixels");
    }
}

/// A warning counts items if there are many, and does not list them.
#[test]
fn many_of_a_kind_are_one_short_warning() {
    let mut core = core();
    let (scene, lights) = (scene(), 1000);
    let below = vec![bulb(-DVec3::Y); lights];
    let many = Case::new("a thousand lights below", &["LightsBelowReceivers"]);
    many.lit_by([scene.lights.clone(), below].concat())
        .check(&mut core);

    let aside = |index: u32| {
        let at = DVec3::new(5.0 + f64::from(index), 0.0, 0.0);
        Receiver {
            name: format!("shelf {index}"),
            world_from_plane: DMat4::from_translation(at),
            ..scene.receivers[0].clone()
        }
    };
    let mut many = Case::new("a thousand receivers", &["ReceiversLeftOut"]);
    many.scene.receivers.extend((0..999).map(aside));
    many.check(&mut core);
}

#[test]
fn numbers_and_lists_in_messages_are_short() {
    let known: Vec<String> = (0..1000).map(|k| format!("clip {k}")).collect();
    let unknown = |known: &[String], name: &str| ToyError::UnknownClip {
        file: "toy.glb".to_owned(),
        name: name.to_owned(),
        known: known.to_vec(),
    };
    let range = |value: f64| FieldError::Range {
        value,
        min: 1e-6,
        max: 1e6,
    };
    #[rustfmt::skip] // Each case has a line of its own.
    let cases = [
        (range(1e308).to_string(), "1e308 is not from 1e-6 to 1000000"),
        (range(-f64::MAX).to_string(), "-1.79769e308 is not from 1e-6 to 1000000"),
        (range(f64::MIN_POSITIVE).to_string(), "2.22507e-308 is not from 1e-6 to 1000000"),
        (range(0.1 + 0.2).to_string(), "0.3 is not from 1e-6 to 1000000"),
        (range(0.0).to_string(), "0 is not from 1e-6 to 1000000"),
        (range(-16385.0).to_string(), "-16385 is not from 1e-6 to 1000000"),
        (range(f64::NAN).to_string(), "NaN is not from 1e-6 to 1000000"),
        (range(f64::INFINITY).to_string(), "inf is not from 1e-6 to 1000000"),
        (unknown(&known[..2], "Wave").to_string(), "toy.glb: clip: none is called \"Wave\"; it has clip 0, clip 1"),
        (unknown(&known[..6], "Wave").to_string(), "toy.glb: clip: none is called \"Wave\"; it has clip 0, clip 1, clip 2, clip 3, clip 4, clip 5"),
        (unknown(&known, "Wave").to_string(), "toy.glb: clip: none is called \"Wave\"; it has clip 0, clip 1, clip 2, clip 3, clip 4 and 995 more"),
        (unknown(&[], "Wave").to_string(), "toy.glb: clip: none is called \"Wave\"; it has none"),
    ];
    for (message, expected) in cases {
        assert_eq!(message, expected);
    }
    let long = unknown(&known[..1], &"é".repeat(100_000)).to_string();
    assert!(long.chars().count() <= MOST_CHARACTERS, "{} bytes", long.len());
}
