//! The picture in cases with a known result: nothing moved, or the toy was taken away.

use glam::{DVec3, DVec4, UVec2};
use reference::composite::{Shown, inside_border, receiver_color};
use reference::model::{Pictures, Region};
use reference::raster::{Raster, texels_of};

use crate::references::flat::{grid, region, scatter, truth, two_bulbs};

const SIZE: UVec2 = UVec2::new(61, 37);

fn noise(seed: u32) -> Raster<f64> {
    Raster::from_fn(SIZE, |at| scatter(at.x + SIZE.x * at.y, seed))
}

fn colors(seed: u32) -> Raster<DVec3> {
    noise(seed).map(|value| DVec3::new(value, 1.0 - value, 0.5 + 0.5 * value))
}

/// A frame that no model explains, in which nothing has moved.
fn scene() -> (Region, Pictures, Shown) {
    let visibility = noise(2).map(|value| DVec4::new(value, 1.0 - value, 0.0, 0.0));
    let ambient = Raster::from_fn(UVec2::new(9, 6), |at| scatter(at.x + at.y, 3));
    let pictures = Pictures {
        frame: colors(0),
        plate: colors(1),
        seen: Raster::from_fn(SIZE, |_| 1.0),
        visibility: visibility.clone(),
        ambient: ambient.clone(),
    };
    let residual = Raster::from_fn(UVec2::new(16, 10), |at| DVec3::splat(scatter(at.x, at.y)));
    let shown = Shown {
        visibility,
        ambient,
        solution: truth(2),
        residuals: vec![residual],
        grids: vec![grid(SIZE, 4)],
        strength: 1.0,
    };
    (region(SIZE, two_bulbs()), pictures, shown)
}

fn picture(region: &Region, pictures: &Pictures, shown: &Shown) -> Raster<DVec3> {
    Raster::from_fn(SIZE, |texel| receiver_color(region, pictures, shown, texel)[0])
}

#[test]
fn unmoved_shadow_passes_the_frame_through() {
    let (region, pictures, shown) = scene();
    assert_eq!(picture(&region, &pictures, &shown), pictures.frame);
}

#[test]
fn beside_the_receiver_only_the_toy_goes() {
    let (mut region, mut pictures, shown) = scene();
    let rect = &mut region.receivers[0].rect;
    (rect.min.x, rect.max.x) = (-0.105, 0.105);
    // Even rows are clear of the toy, odd ones are not.
    pictures.seen = Raster::from_fn(SIZE, |at| f64::from(1 - at.y % 2));
    let picture = picture(&region, &pictures, &shown);
    for row in 0..SIZE.y {
        // The receiver ends 10.5 pixels from the centre, which is at 30.5.
        for column in [19, 41] {
            let at = UVec2::new(column, row);
            let bare = pictures.plate.at(at) * shown.solution.gain;
            let expected = if row % 2 == 0 { pictures.frame.at(at) } else { bare };
            assert!((picture.at(at) - expected).abs().max_element() < 1e-12, "{at}");
        }
        for column in [20, 40] {
            let at = UVec2::new(column, row);
            assert_eq!(picture.at(at) == pictures.frame.at(at), row % 2 == 0, "{at}");
        }
    }
}

#[test]
fn toy_taken_away_leaves_the_plate_at_the_frames_exposure() {
    let (region, mut pictures, mut shown) = scene();
    pictures.seen = Raster::from_fn(SIZE, |_| 0.0);
    shown.visibility = Raster::from_fn(SIZE, |_| DVec4::ONE);
    shown.ambient = Raster::from_fn(UVec2::ONE, |_| 1.0);
    shown.residuals = vec![Raster::from_fn(UVec2::ONE, |_| DVec3::ZERO)];
    let expected = pictures.plate.map(|plate| plate * shown.solution.gain);
    for (actual, expected) in picture(&region, &pictures, &shown)
        .texels()
        .iter()
        .zip(expected.texels())
    {
        assert!(
            (actual - expected).abs().max_element() < 1e-12,
            "{actual}, not {expected}"
        );
    }
}

/// A shadow of no strength equals that of a toy that was taken away; with half the strength a gray
/// receiver loses half as much; and one of twice the strength equals two shadows, one over the
/// other.
#[test]
fn a_weak_shadow_takes_its_share_and_a_strong_one_is_laid_over_itself() {
    let (region, mut pictures, mut shown) = scene();
    pictures.seen = Raster::from_fn(SIZE, |_| 0.0);
    shown.residuals = vec![Raster::from_fn(UVec2::ONE, |_| DVec3::ZERO)];
    let mut of_strength = |strength| {
        shown.strength = strength;
        picture(&region, &pictures, &shown)
    };
    let [none, half, true_one, twice, most] = [0.0, 0.5, 1.0, 2.0, 1e9].map(&mut of_strength);
    let mut n_black = 0;
    for at in texels_of(SIZE) {
        let open = pictures.plate.at(at) * shown.solution.gain;
        assert!((none.at(at) - open).abs().max_element() < 1e-12, "{at}");
        let expected = open.midpoint(true_one.at(at));
        assert!((half.at(at) - expected).abs().max_element() < 1e-12, "{at}");
        let expected = true_one.at(at) * true_one.at(at) / open;
        assert!((twice.at(at) - expected).abs().max_element() < 1e-12, "{at}");
        n_black += u32::from(most.at(at) == DVec3::ZERO);
    }
    assert!(2 * n_black > SIZE.element_product(), "{n_black} are black");
}

#[test]
fn border_fades_into_the_frame_at_inner_edges_alone() {
    let (mut region, mut pictures, mut shown) = scene();
    // The left edge is inside the camera's picture, the others are the picture's own.
    region.border_px = [10.0, 0.0, 0.0, 0.0];
    shown.visibility = Raster::from_fn(SIZE, |_| DVec4::ONE);
    let faded = picture(&region, &pictures, &shown);
    region.border_px = [0.0; 4];
    let whole = picture(&region, &pictures, &shown);
    for (column, share) in [(0, 0.05), (4, 0.45), (9, 0.95), (10, 1.0), (60, 1.0)] {
        for row in [0, 18, 36] {
            let at = UVec2::new(column, row);
            let expected = pictures.frame.at(at).lerp(whole.at(at), share);
            assert!((faded.at(at) - expected).abs().max_element() < 1e-12, "{at}");
        }
    }
    assert!((inside_border(&region, UVec2::ZERO) - 1.0).abs() < 1e-12);

    // The toy reaches even there.
    pictures.seen = Raster::from_fn(SIZE, |_| 0.0);
    let whole = picture(&region, &pictures, &shown);
    region.border_px = [10.0, 0.0, 0.0, 0.0];
    assert_eq!(picture(&region, &pictures, &shown), whole);
}
