//! The picture in more precision than codes, and in layers.

use app_core::frame::FrameInput;
use app_core::preset::Preset;
use app_core::scene::Image;
use app_core::shadow_style::ShadowStyle;
use app_core::sharpness::{Sharpness, Spread};
use app_pipeline::core::inspect::Inspect;
use app_pipeline::readback::{FloatMap, Map};
use app_scene::geometry::color::{linear_from_srgb, srgb_from_linear};

use crate::core::bundled::{core, first_input, scene, whole};

/// Unrounded codes of a map of light.
fn codes(light: &FloatMap) -> Vec<[f64; 3]> {
    let texels = light.texels.iter();
    texels
        .map(|[r, g, b, _]| [*r, *g, *b].map(|c| f64::from(255.0 * srgb_from_linear(c.clamp(0.0, 1.0)))))
        .collect()
}

fn code_of(image: &Image, index: usize, channel: usize) -> f64 {
    f64::from(image.rgba8[4 * index + channel])
}

/// Untouched pixels are the camera's; retargeted ones round to the picture of 8 bits, and lie
/// between its codes.
#[test]
fn light_is_the_picture_before_it_was_rounded() {
    let mut core = core();
    let (scene, input) = whole();
    for preset in [Preset::Fast, Preset::Balanced, Preset::Best] {
        core.set_scene(scene.clone(), preset).unwrap();
        core.frame(&input).unwrap();
        let (picture, light) = (core.read_picture().unwrap(), core.read_light().unwrap());
        let camera = input.image.rgba();
        let (mut n_made, mut n_between, mut n_others, mut most) = (0, 0, 0, 0.0_f64);
        for (index, codes) in codes(&light).into_iter().enumerate() {
            for (channel, fine) in codes.into_iter().enumerate() {
                let code = code_of(&picture, index, channel);
                most = most.max((fine - code).abs());
                if code == code_of(camera, index, channel) {
                    continue;
                }
                n_made += 1;
                n_between += u32::from((0.1..0.9).contains(&fine.fract()));
                n_others += u32::from(fine.round() != code);
            }
        }
        println!(
            "{preset}: {n_made} made, {n_between} between codes, {n_others} round otherwise, {most} codes off at most"
        );
        // Half a code is rounding; a software driver decodes codes with an error of up to .34,
        // which is removed from the light alone, and encodes with an error of .14: at most this
        // share of codes then moves to a neighbour.
        assert!(most < 1.0, "{preset}: {most} codes");
        assert!(
            3 * n_others < n_made,
            "{preset}: {n_others} of {n_made} round otherwise"
        );
        assert!(
            2 * n_between > n_made && n_made > 10_000,
            "{preset}: {n_between} of {n_made}"
        );
    }
}

#[test]
fn what_passes_through_is_the_cameras_code_by_code() {
    let mut core = core();
    let (scene, input) = whole();
    let physical_pose = scene.physical_pose.clone();
    core.set_scene(scene, Preset::Balanced).unwrap();
    let region = core.frame(&input).unwrap().region.unwrap();
    let light = core.read_light().unwrap();
    let camera = input.image.rgba();
    let width = light.width;
    let outside = (0..).zip(&light.texels).filter(|(index, _)| {
        let at = glam::UVec2::new(index % width, index / width);
        !at.wrapping_sub(region.origin_px).cmplt(region.size_px).all()
    });
    let mut n_outside = 0;
    for (index, texel) in outside {
        let codes = &camera.rgba8[4 * index as usize..];
        for (light, code) in texel.iter().zip(codes).take(3) {
            assert_eq!(*light, linear_from_srgb(f32::from(*code) / 255.0));
        }
        n_outside += 1;
    }
    assert!(n_outside > 1000);
    core.frame(&input.clone().with_shown_pose(physical_pose)).unwrap();
    let light = core.read_light().unwrap();
    for (index, codes) in codes(&light).into_iter().enumerate() {
        for (channel, fine) in codes.into_iter().enumerate() {
            assert!((fine - code_of(camera, index, channel)).abs() < 1e-3);
        }
    }
}

/// The toy over clean plate times shadow ratio is the picture, for any strength of the shadow; the
/// clean plate is that of a shadow without strength.
#[test]
fn layers_are_laid_together_to_the_picture() {
    check_layers(&first_input(), 0.9);
}

/// The same at soft outlines, where the toy mixes with the plate that it leaves free.
#[test]
fn layers_of_a_soft_picture_are_laid_together_to_it() {
    let soft = first_input().with_sharpness(Sharpness {
        plate_spread: Spread::NONE,
        outline_spread: Spread::round(1.5),
    });
    // More pixels are near the real toy's outline.
    check_layers(&soft, 0.8);
}

/// `least` is the part of the pixels to be compared.
fn check_layers(input: &FrameInput, least: f64) {
    let mut core = core();
    for preset in [Preset::Balanced, Preset::Best] {
        for strength in [1.0, 0.5] {
            core.set_scene(scene(), preset).unwrap();
            let style = |strength| ShadowStyle {
                strength,
                ..ShadowStyle::TRUE
            };
            let input = input.clone().with_shadow_style(style(strength));
            let region = core.frame(&input).unwrap().region.unwrap();
            let validity = core.read_map(Map::Validity).unwrap().unwrap();
            let (light, layers) = (core.read_light().unwrap(), core.read_layers().unwrap());
            core.frame(&input.clone().with_shadow_style(style(0.0))).unwrap();
            let bare = core.read_light().unwrap();
            let (mut most, mut most_bare, mut n_shadow, mut n_compared) = (0.0_f64, 0.0_f64, 0, 0);
            for index in 0..light.texels.len() {
                let [clean, ratio, toy] =
                    [&layers.clean_plate, &layers.shadow_ratio, &layers.toy].map(|layer| layer.texels[index]);
                // A pixel with the outline of the real toy stays if the toy does not move.
                let width = light.width as usize;
                let at = [index % width, index / width].map(|side| u32::try_from(side).unwrap());
                let at = glam::UVec2::from(at);
                let in_region = at.wrapping_sub(region.origin_px);
                let is_in_region = in_region.cmplt(region.size_px).all();
                let texel = (in_region.y.wrapping_mul(region.size_px.x)).wrapping_add(in_region.x);
                if is_in_region && validity.texels[texel as usize][0] < 1.0 && toy[3] < 1.0 {
                    continue;
                }
                n_compared += 1;
                let code = |light: f32| f64::from(255.0 * srgb_from_linear(light.clamp(0.0, 1.0)));
                for channel in 0..3 {
                    let laid = toy[channel] + (1.0 - toy[3]) * clean[channel] * ratio[channel];
                    most = most.max((code(laid) - code(light.texels[index][channel])).abs());
                    if toy[3] == 0.0 {
                        most_bare =
                            most_bare.max((code(clean[channel]) - code(bare.texels[index][channel])).abs());
                    }
                }
                let masks = layers.masks.texels[index];
                assert_eq!(masks[0], toy[3]);
                n_shadow += i32::from(masks[1] > 0.9 && ratio[1] < 0.9);
            }
            println!("{preset}, {strength}: {most} codes apart, bare {most_bare}, {n_shadow} in shadow");
            // Half floats have an error of .1 of a code; that of a driver's decoding, .34 at most,
            // is removed from each layer separately.
            assert!(most < 0.5, "{preset}, {strength}: {most} codes");
            assert!(most_bare < 1.0, "{preset}, {strength}: {most_bare} codes");
            assert!(n_shadow > 100, "{n_shadow}");
            assert!(
                f64::from(n_compared) > least * light.texels.len() as f64,
                "{n_compared} are compared"
            );
        }
    }
}

#[test]
fn what_stands_still_has_layers_where_they_are_wanted() {
    let mut core = core();
    let at_rest = first_input().with_shown_pose(scene().physical_pose);
    core.set_scene(scene(), Preset::Balanced).unwrap();
    core.frame(&at_rest).unwrap();
    let none = core.read_layers().unwrap();
    assert!(none.toy.texels.iter().all(|texel| texel[3] == 0.0));
    core.want_layers().unwrap();
    core.frame(&at_rest).unwrap();
    let layers = core.read_layers().unwrap();
    let n_toy = layers.toy.texels.iter().filter(|texel| texel[3] == 1.0).count();
    assert!(n_toy > 300, "{n_toy}");
    let camera = at_rest.image.rgba();
    let picture = core.read_picture().unwrap();
    let apart = |(a, b): (&u8, &u8)| a.abs_diff(*b);
    let most = picture.rgba8.iter().zip(&camera.rgba8).map(apart).max();
    assert!(most <= Some(1), "{most:?} codes from the camera's picture");
}
