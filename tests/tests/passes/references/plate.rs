//! Plates with known colours: of a plane seen straight from above, higher or lower, at the same
//! place or beside it.

use app_pipeline::geometry::rect::PlaneRect;
use glam::{DMat3, DMat4, DVec2, DVec3, UVec2};
use reference::model::{ReceiverPlane, Region};
use reference::plate::{CHOICE_POWER, PlatePhoto, Viewpoint, choose};
use reference::raster::Raster;

const SIZE: UVec2 = UVec2::new(81, 61);

/// A camera straight over a point of the plane: a pixel covers 0.01 times its height in metres.
pub(crate) fn above(middle: DVec2, height_m: f64) -> Viewpoint {
    let pixel_m = 0.01 * height_m;
    let corner = middle - 0.5 * pixel_m * SIZE.as_dvec2();
    let plane = ReceiverPlane {
        plane_from_anchor: DMat4::IDENTITY,
        // w is the inverse of the depth.
        plane_from_region_px: DMat3::from_cols(DVec3::X * pixel_m, DVec3::Y * pixel_m, corner.extend(1.0))
            * (1.0 / height_m),
        lights: Vec::new(),
        reference_in_plane: DVec2::ZERO,
        rect: PlaneRect {
            min: DVec2::splat(-10.0),
            max: DVec2::splat(10.0),
        },
    };
    Viewpoint {
        region: Region {
            receivers: vec![plane],
            size_px: SIZE,
            border_px: [0.0; 4],
            lights: Vec::new(),
            light_radii: Vec::new(),
            reflection: None,
        },
        centre_in_anchor: DVec3::new(middle.x, height_m, middle.y),
    }
}

/// A colour that varies linearly over the plane.
pub(crate) fn slope(in_plane: DVec2) -> DVec3 {
    DVec3::new(0.5 + in_plane.x, 0.5 + in_plane.y, 0.3)
}

pub(crate) fn photo(camera: &Viewpoint, gain: f64, color: impl Fn(DVec2) -> DVec3) -> PlatePhoto {
    let plane = &camera.region.receivers[0];
    let picture = Raster::from_fn(SIZE, |at| color(plane.plane_point(at.as_dvec2() + 0.5).unwrap()));
    PlatePhoto {
        camera: camera.clone(),
        picture: picture.map(|color| color / gain),
        gain: DVec3::splat(gain),
    }
}

#[test]
fn a_slope_is_the_same_from_wherever_it_is_photographed() {
    let view = above(DVec2::ZERO, 1.0);
    for (middle, height_m, gain) in [
        (DVec2::ZERO, 1.0, 1.0),
        (DVec2::new(0.1234, -0.0517), 0.7, 1.3),
        (DVec2::new(-0.05, 0.02), 1.9, 0.6),
    ] {
        let plate = photo(&above(middle, height_m), gain, slope);
        let mut n_shown = 0;
        for texel in [UVec2::new(35, 25), UVec2::new(40, 30), UVec2::new(47, 33)] {
            let in_plane = view.region.receivers[0]
                .plane_point(texel.as_dvec2() + 0.5)
                .unwrap();
            let found = choose(&view, std::slice::from_ref(&plate), texel);
            // A cubic through a line is the line.
            assert!(
                (found.truncate() - slope(in_plane)).abs().max_element() < 1e-9,
                "{texel}: {found}"
            );
            n_shown += u32::from(found.w == 1.0);
        }
        assert_eq!(n_shown, 3, "{middle}");
    }
    let elsewhere = photo(&above(DVec2::new(3.0, 0.0), 1.0), 1.0, slope);
    assert_eq!(choose(&view, &[elsewhere], UVec2::new(40, 30)).w, 0.0);
}

#[test]
fn of_two_plates_detail_weighs_by_its_power_and_no_more_than_enough() {
    let view = above(DVec2::ZERO, 1.0);
    let direct_fraction_of_first = |heights_m: [f64; 2]| {
        let [first, second] = heights_m.map(|height_m| above(DVec2::ZERO, height_m));
        let plates = [
            photo(&first, 1.0, |_| DVec3::ONE),
            photo(&second, 1.0, |_| DVec3::ZERO),
        ];
        choose(&view, &plates, UVec2::new(40, 30)).x
    };
    // From the centre both are 30 px inside: less than the feather, and equal.
    assert!((direct_fraction_of_first([1.0, 1.0]) - 0.5).abs() < 1e-9);
    // A nearer plate is no better than the view's own distance.
    assert!((direct_fraction_of_first([0.5, 1.0]) - 0.5).abs() < 1e-9);
    // A tenth higher shows 1 / 1.21 of the pixels.
    let weight = 1.21_f64.powf(-CHOICE_POWER);
    let expected = 1.0 / (1.0 + weight);
    let found = direct_fraction_of_first([1.0, 1.1]);
    assert!((found - expected).abs() < 1e-6, "{found}, not {expected}");
    // A plate at twice the height is not used, unless there is no other.
    assert_eq!(direct_fraction_of_first([1.0, 2.0]), 1.0);
}
