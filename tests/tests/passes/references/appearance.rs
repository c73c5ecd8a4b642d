//! Colours of a toy in cases where their source pixels are known.

use glam::{DVec3, DVec4, UVec2};
use reference::appearance::{REACH_PX, Seen, ToyPixel, clean};
use reference::raster::Raster;

const SIZE: UVec2 = UVec2::new(17, 11);

fn pixel(value: f64) -> ToyPixel {
    ToyPixel {
        color: DVec3::splat(value),
        received: DVec4::splat(2.0 * value),
        base: DVec4::splat(3.0 * value),
    }
}

/// A toy at constant `depth`, some pixels of which, with a known value, show a single surface; all
/// others would give 9.
fn scene(depth: f64, known: &[(UVec2, f64, f64)]) -> Raster<Seen> {
    Raster::from_fn(SIZE, |at| {
        let found = known.iter().find(|(place, ..)| *place == at);
        found.map_or(
            Seen {
                pixel: pixel(9.0),
                depth,
                is_one_surface: false,
            },
            |(_, value, depth)| Seen {
                pixel: pixel(*value),
                depth: *depth,
                is_one_surface: true,
            },
        )
    })
}

fn color(seen: &Raster<Seen>, at: UVec2) -> Option<f64> {
    let found = clean(seen, at)?;
    assert!(
        (found.received.truncate() - 2.0 * found.color)
            .abs()
            .max_element()
            < 1e-12,
        "{found:?}"
    );
    assert!(
        (found.base.truncate() - 3.0 * found.color).abs().max_element() < 1e-12,
        "{found:?}"
    );
    Some(found.color.x)
}

#[test]
fn one_pixel_is_carried_as_far_as_it_reaches() {
    let reach = u32::try_from(REACH_PX).unwrap();
    let middle = UVec2::new(8, 5);
    let beside_toy = scene(0.0, &[(middle, 0.25, 0.5)]);
    for (offset, is_reached) in [(0, true), (reach, true), (reach + 1, false)] {
        let expected = is_reached.then_some(0.25);
        for at in [middle + UVec2::new(offset, 0), middle + UVec2::splat(offset)] {
            assert_eq!(color(&beside_toy, at), expected, "{at}");
        }
    }
    // A part of the toy that is too thin for such a pixel keeps its own.
    let thin = scene(0.5, &[(middle, 0.25, 0.5)]);
    assert_eq!(color(&thin, UVec2::new(1, 5)), Some(9.0));
}

#[test]
fn the_nearest_counts_of_its_own_surface_first() {
    let (near, far) = (UVec2::new(7, 5), UVec2::new(10, 5));
    let at = UVec2::new(8, 5);
    let beside_toy = scene(0.0, &[(near, 0.25, 0.5), (far, 1.0, 0.5)]);
    assert_eq!(color(&beside_toy, at), Some(0.25));
    // The nearer pixel belongs to another surface.
    let two_surfaces = scene(0.5, &[(near, 0.25, 0.4), (far, 1.0, 0.5)]);
    assert_eq!(color(&two_surfaces, at), Some(1.0));
    // It is used if there is no other.
    assert_eq!(color(&scene(0.5, &[(near, 0.125, 0.4)]), at), Some(0.125));
    // The first of two equally near ones.
    let opposite = UVec2::new(9, 5);
    let as_near = scene(0.0, &[(opposite, 1.0, 0.5), (near, 0.25, 0.5)]);
    assert_eq!(color(&as_near, at), Some(0.25));
}
