//! The picture finer than codes, and in layers.

use app_core::preset::Preset;
use app_core::scene::Image;
use app_core::shadow_style::ShadowStyle;
use app_pipeline::readback::FloatMap;
use app_scene::geometry::color::{linear_from_srgb, srgb_from_linear};

use crate::core::bundled::{core, first_input, scene, whole};

/// Codes of a map of light, not rounded.
fn codes(light: &FloatMap) -> Vec<[f64; 3]> {
    let texels = light.texels.iter();
    texels
        .map(|[r, g, b, _]| [*r, *g, *b].map(|c| f64::from(255.0 * srgb_from_linear(c.clamp(0.0, 1.0)))))
        .collect()
}

fn code_of(image: &Image, index: usize, channel: usize) -> f64 {
    f64::from(image.rgba8[4 * index + channel])
}

/// What is untouched is the camera's, what is made rounds to the picture of 8 bits, and lies between its codes.
#[test]
fn light_is_the_picture_before_it_was_rounded() {
    let mut core = core();
    let (scene, input) = whole();
    for preset in [Preset::Fast, Preset::Balanced, Preset::Best] {
        core.set_scene(scene.clone(), preset).unwrap();
        core.frame(&input).unwrap();
        let (picture, light) = (core.read_picture().unwrap(), core.read_light().unwrap());
        let camera = input.image.rgba();
        let (mut n_made, mut n_between, mut most) = (0, 0, 0.0_f64);
        for (index, codes) in codes(&light).into_iter().enumerate() {
            for (channel, fine) in codes.into_iter().enumerate() {
                let code = code_of(&picture, index, channel);
                most = most.max((fine - code).abs());
                if code == code_of(camera, index, channel) {
                    continue;
                }
                n_made += 1;
                n_between += u32::from((0.1..0.9).contains(&fine.fract()));
            }
        }
        println!("{preset}: {n_made} made, {n_between} between codes, {most} codes off at most");
        // Half a code is rounding, .14 of one a software driver's when it encodes.
        assert!(most < 0.7, "{preset}: {most} codes");
        assert!(5 * n_between > 3 * n_made && n_made > 10_000, "{preset}: {n_between} of {n_made}");
    }
}

#[test]
fn what_passes_through_is_the_cameras_code_by_code() {
    let mut core = core();
    let input = first_input();
    core.set_scene(scene(), Preset::Balanced).unwrap();
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
        for channel in 0..3 {
            let code = camera.rgba8[4 * index as usize + channel];
            assert_eq!(texel[channel], linear_from_srgb(f32::from(code) / 255.0));
        }
        n_outside += 1;
    }
    assert!(n_outside > 1000);
    let at_rest = input.clone().with_shown_pose(scene().physical_pose);
    core.frame(&at_rest).unwrap();
    let light = core.read_light().unwrap();
    for (index, codes) in codes(&light).into_iter().enumerate() {
        for (channel, fine) in codes.into_iter().enumerate() {
            assert!((fine - code_of(camera, index, channel)).abs() < 1e-3);
        }
    }
}

/// The toy over clean plate times shadow ratio is the picture, whatever the shadow's strength; the clean plate is that of a shadow
/// without any.
#[test]
fn layers_are_laid_together_to_the_picture() {
    let mut core = core();
    let input = first_input();
    for preset in [Preset::Balanced, Preset::Best] {
        for strength in [1.0, 0.5] {
            core.set_scene(scene(), preset).unwrap();
            let style = |strength| ShadowStyle {
                strength,
                ..ShadowStyle::TRUE
            };
            let input = input.clone().with_shadow_style(style(strength));
            core.frame(&input).unwrap();
            let (light, layers) = (core.read_light().unwrap(), core.read_layers().unwrap());
            core.frame(&input.clone().with_shadow_style(style(0.0))).unwrap();
            let bare = core.read_light().unwrap();
            let (mut most, mut most_bare, mut n_shadow) = (0.0_f64, 0.0_f64, 0);
            for index in 0..light.texels.len() {
                let [clean, ratio, toy] =
                    [&layers.clean_plate, &layers.shadow_ratio, &layers.toy].map(|layer| layer.texels[index]);
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
            // Half floats are some .06 of a code at most; where the toy mixes with what it stood before, the camera's pixel stays.
            assert!(most < 1.0, "{preset}, {strength}: {most} codes");
            assert!(most_bare < 1.0, "{preset}, {strength}: {most_bare} codes");
            assert!(n_shadow > 100, "{n_shadow}");
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
