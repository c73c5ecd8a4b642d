//! `plate` compared with its reference: cameras all around a table and a wall, and pictures full of
//! detail.

use app_core::reflection::Reflection;
use app_core::scene::MAX_RECEIVERS;
use app_pipeline::passes::plate::{PlateView, PlateViews};
use glam::{DMat3, DVec3, DVec4, UVec2};
use reference::plate::{PlatePhoto, Viewpoint, choose};
use reference::raster::Raster;

use app_core::wgpu;
use app_pipeline::geometry::rect::PixelRect;

use crate::alone::{Bindings, Draw, check_faults, source};
use crate::device::Device;
use crate::errors::{Errors, pairs_of};
use crate::numbers::numbers;
use crate::run::known_reflection;
use crate::setups::WALL;
use crate::stand::Stand;

/// Viewpoint in front of the wall, and one behind it.
const BEFORE: DVec3 = DVec3::new(0.15, 0.34, 0.41);
const BEHIND: DVec3 = DVec3::new(0.1, 0.25, -0.45);
/// Viewpoints beside the first, far to the side, closer, and behind the wall as well.
const PLATES: [DVec3; 4] = [
    DVec3::new(0.26, 0.36, 0.34),
    DVec3::new(-0.4, 0.42, 0.12),
    DVec3::new(0.05, 0.2, 0.26),
    DVec3::new(0.0, 0.3, -0.5),
];

fn stand(offset: DVec3) -> Stand {
    Stand::seen_from(WALL.of_size(161, 123), offset)
}

fn viewpoint(stand: &Stand, rect: &PixelRect) -> Viewpoint {
    Viewpoint {
        region: stand.region(rect),
        centre_in_anchor: stand.view().camera_in(&stand.anchored[0].world_from_plane),
    }
}

fn plates() -> Vec<(Stand, PlatePhoto)> {
    let plate = |(seed, offset): (u32, &DVec3)| {
        let stand = stand(*offset);
        let photo = PlatePhoto {
            camera: viewpoint(&stand, &stand.whole_image()),
            picture: numbers(stand.setup.image_px, seed).map(DVec4::truncate),
            // The gain identifies the plate from which a colour comes.
            gain: DVec3::new(1.0, 0.5, 0.25) * f64::from(seed - 29),
        };
        (stand, photo)
    };
    (30..).zip(&PLATES).map(plate).collect()
}

/// The shader's uniform, computed from the cameras.
fn plate_views(here: &Stand, plates: &[(Stand, PlatePhoto)]) -> PlateViews {
    let cameras = |stand: &Stand| {
        let mut cameras = [[0.0; 4]; MAX_RECEIVERS];
        let slots = cameras.iter_mut().zip(&stand.anchored);
        slots.for_each(|(slot, receiver)| {
            let camera = stand.view().camera_in(&receiver.world_from_plane);
            *slot = camera.extend(1.0).as_vec4().to_array();
        });
        cameras
    };
    let columns = |m: DMat3| m.as_mat3().to_cols_array_2d().map(|[x, y, z]| [x, y, z, 0.0]);
    let mut views: PlateViews = bytemuck::Zeroable::zeroed();
    for (slot, (stand, photo)) in views.plates.iter_mut().zip(plates) {
        let mut plate: PlateView = bytemuck::Zeroable::zeroed();
        plate.gain = photo.gain.extend(1.0).as_vec4().to_array();
        plate.camera_in_plane = cameras(stand);
        let homographies = plate.plate_px_from_plane.iter_mut().zip(&stand.anchored);
        homographies.for_each(|(slot, receiver)| {
            *slot = columns(stand.view().image_px_from_plane(&receiver.world_from_plane));
        });
        *slot = plate;
    }
    PlateViews {
        camera_in_plane: cameras(here),
        n_plates: u32::try_from(plates.len()).unwrap(),
        ..views
    }
}

/// Errors of the colours and alpha that `source` makes: for all plates, or for one from the other
/// side of the wall.
fn errors(source: &str) -> Errors {
    errors_over(None, source)
}

/// The same over a glossy table.
fn errors_of_glossy(source: &str) -> Errors {
    let reflection = Reflection {
        roughness: 0.15,
        surroundings: [0.5, 0.7, 0.9],
        toy_above_surroundings: [0.6, -0.4, -0.8],
    };
    errors_over(Some(&reflection), source)
}

fn errors_over(reflection: Option<&Reflection>, source: &str) -> Errors {
    let plates = plates();
    let views = [
        (BEFORE, &plates[..]),
        (BEHIND, &plates[..]),
        (BEFORE, &plates[3..]),
        (BEHIND, &plates[..1]),
    ];
    let of_views = views.map(|(offset, plates)| pairs(reflection, source, offset, plates));
    Errors::between(of_views.concat())
}

/// Actual and expected colours and alpha of a view's plate.
fn pairs(
    reflection: Option<&Reflection>,
    source: &str,
    offset: DVec3,
    plates: &[(Stand, PlatePhoto)],
) -> Vec<(f64, f64)> {
    let device = Device::shared();
    let pictures: Vec<Raster<DVec4>> = plates
        .iter()
        .map(|(_, photo)| photo.picture.map(|color| color.extend(1.0)))
        .collect();
    let array = device.array(&pictures.iter().collect::<Vec<_>>());
    let photos: Vec<PlatePhoto> = plates.iter().map(|(_, photo)| photo.clone()).collect();
    let here = stand(offset);
    let rect = PixelRect {
        origin_px: UVec2::new(9, 4),
        size_px: UVec2::new(141, 110),
    };
    let channel = here.setup.lights.len();
    let globals = here
        .globals(&rect)
        .with_reflection(reflection.map(|known| (known, channel)));
    let globals = device.uniform(&globals);
    let views = device.uniform(&plate_views(&here, plates));
    let shared: Bindings<'_> = vec![(0, globals.as_entire_binding())];
    let own: Bindings<'_> = vec![
        (0, views.as_entire_binding()),
        (1, wgpu::BindingResource::TextureView(&array)),
    ];
    let draw = Draw::of(source, "fs_choose", rect.size_px);
    let actual = device.draw(draw, [&shared, &own]);
    let mut view = viewpoint(&here, &rect);
    view.region.reflection = reflection.map(|reflection| known_reflection(&here, reflection));
    let expected = Raster::from_fn(rect.size_px, |texel| choose(&view, &photos, texel));
    let n_shown = expected.texels().iter().filter(|texel| texel.w == 1.0).count();
    assert!(
        n_shown > 1000 && n_shown < expected.texels().len(),
        "{n_shown} are shown"
    );
    pairs_of(&actual, &expected)
}

/// A position in a plate has an error of some 1e-5 of a pixel, and neighbours differ by up to 4.
/// Measured: 1.1e-4.
const ALLOWED: f64 = 1e-3;

#[test]
fn the_best_of_plates_all_around() {
    errors(&source("plate")).check_all("plates all around", ALLOWED);
}

#[test]
fn a_fault_in_the_choice_is_found() {
    let faults = [
        ("FEATHER_PX: f32 = 32.0", "FEATHER_PX: f32 = 31.0"),
        ("LEAST_COSINE: f32 = 0.1", "LEAST_COSINE: f32 = 0.5"),
        ("return square * square;", "return square * cosine;"),
        ("LEAST_WEIGHT: f32 = 0.02", "LEAST_WEIGHT: f32 = 0.03"),
        ("* determinant(", "/ determinant("),
        (".y > 0.0;", ".y > -1e9;"),
        ("{ return true; }", "{ return false; }"),
        ("let point = surface_point", "let point = receiver_point"),
        ("2.0 - 5.0 * ", "2.0 - 4.9 * "),
        ("[k].gain.rgb;", "[k].gain.aaa;"),
    ];
    check_faults("plate", &faults, ALLOWED, errors);
}

/// Each plate is freed of what the table reflects to its own camera.
#[test]
fn plates_of_a_glossy_table() {
    errors_of_glossy(&source("plate")).check_all("plates of a glossy table", ALLOWED);
    let faults = [
        (
            "without_reflection(color, at.xy, views.plates[k].camera_in_plane[0].xyz)",
            "without_reflection(color, at.xy, views.plates[0].camera_in_plane[0].xyz)",
        ),
        (
            "without_reflection(color, at.xy, views.plates[k].camera_in_plane[0].xyz)",
            "color",
        ),
        (
            "max(color - reflected_to(camera, point, vec4f(1.0), 1.0), vec3f(0.0))",
            "(color - reflected_to(camera, point, vec4f(1.0), 1.0))",
        ),
    ];
    check_faults("plate", &faults, ALLOWED, errors_of_glossy);
}
