//! Shown shadows that are stronger, weaker, harder or softer than the true one.

use app_core::frame::FrameInput;
use app_core::preset::Preset;
use app_core::scene::Image;
use app_core::shadow_style::ShadowStyle;
use app_pipeline::core::inspect::Inspect;
use app_pipeline::readback::{FloatMap, Map};

use crate::core::bundled::{core, first_input, picture_of, scene, whole};

fn styled(input: &FrameInput, strength: f64, softness: f64) -> FrameInput {
    input
        .clone()
        .with_shadow_style(ShadowStyle { strength, softness })
}

/// No effect of a style remains in a picture with another, although other state is kept, and the
/// true style equals no style.
#[test]
fn a_style_is_that_of_its_frame() {
    let mut core = core();
    let input = first_input();
    for preset in [Preset::Fast, Preset::Balanced, Preset::Best] {
        core.set_scene(scene(), preset).unwrap();
        // A wider shadow reaches farther, and its region is determined once.
        core.frame(&styled(&input, 1.0, 1.5)).unwrap();
        let styles = [(1.0, 1.0), (0.5, 1.0), (1.0, 0.3), (1.0, 1.5), (2.0, 1.0)];
        let mut made = |order: [usize; 5]| {
            order.map(|index| {
                let (strength, softness) = styles[index];
                (index, picture_of(&mut core, &styled(&input, strength, softness)))
            })
        };
        let (forth, mut back) = (made([0, 1, 2, 3, 4]), made([4, 3, 2, 1, 0]));
        back.reverse();
        assert!(forth == back, "{preset}");
        for (index, (_, picture)) in forth.iter().enumerate().skip(1) {
            assert!(*picture != forth[0].1, "{preset}: style {index}");
        }
        assert!(picture_of(&mut core, &input) == forth[0].1, "{preset}");
    }
    // Preset `paper` draws shadows as published.
    core.set_scene(scene(), Preset::Paper).unwrap();
    let [plain, other] = [(1.0, 1.0), (0.5, 2.0)]
        .map(|(strength, softness)| picture_of(&mut core, &styled(&input, strength, softness)));
    assert!(plain == other);
}

/// A moving camera and a style that changes make no object on the device, frame by frame.
#[test]
fn a_softer_shadow_makes_nothing_on_the_device() {
    let mut core = core();
    let input = first_input();
    core.set_scene(scene(), Preset::Balanced).unwrap();
    // The widest shadow first: its region contains the others.
    let mut n_made = |index: usize| {
        let mut moved = styled(&input, 1.0, [2.0, 1.5, 1.0, 0.5][index % 4]);
        moved.camera.world_from_camera.w_axis.x += 1e-4 * [0.0, 1.0, 2.0][index % 3];
        core.frame(&moved).unwrap();
        core.n_created().map(|(_, n)| n)
    };
    let after_first = (0..12).map(&mut n_made).last().unwrap();
    let after_all = (12..24).map(n_made).last().unwrap();
    assert_eq!(after_all, after_first);
}

#[test]
fn a_toy_that_stands_still_passes_through_with_its_true_shadow_alone() {
    let mut core = core();
    let input = first_input().with_shown_pose(scene().physical_pose);
    for (strength, softness, is_made) in [(1.0, 1.0, false), (0.5, 1.0, true), (1.0, 2.0, true)] {
        core.set_scene(scene(), Preset::Balanced).unwrap();
        let report = core.frame(&styled(&input, strength, softness)).unwrap();
        assert_eq!(report.region.is_some(), is_made, "{strength}, {softness}");
    }
}

#[test]
fn a_style_out_of_range_is_refused_by_name() {
    let input = first_input();
    for (strength, softness, field) in [
        (-0.1, 1.0, "shadow_style.strength: -0.1 is not from 0 to 4"),
        (f64::NAN, 1.0, "shadow_style.strength"),
        (1.0, 4.1, "shadow_style.softness: 4.1 is not from 0 to 4"),
    ] {
        let refused = styled(&input, strength, softness)
            .check()
            .unwrap_err()
            .to_string();
        assert!(refused.contains(field), "{refused}");
    }
}

/// Codes of the pixels that show the toy in neither pose, by the session's coverage; the others are
/// 0.
fn of_receiver(picture: &[u8], plate: &Image, is_shown: impl Fn(usize) -> bool) -> Vec<[f64; 3]> {
    assert_eq!(picture.len(), plate.rgba8.len());
    let pixels = picture
        .chunks_exact(4)
        .zip(plate.rgba8.chunks_exact(4))
        .enumerate();
    let shown = pixels.filter(|(index, _)| is_shown(*index));
    shown
        .map(|(_, (made, plate))| [0, 1, 2].map(|c| f64::from(made[c]) - f64::from(plate[c])))
        .collect()
}

/// Without its shadow the toy stands on the plate, which the session's camera took in the same
/// light.
#[test]
fn without_strength_the_receiver_is_the_clean_plate() {
    let mut core = core();
    let (scene, input) = whole();
    let plate = scene.plates[0].image.clone();
    core.set_scene(scene, Preset::Balanced).unwrap();
    let mut difference = |strength| {
        let input = styled(&input, strength, 1.0);
        let region = core.frame(&input).unwrap().region.unwrap();
        let picture = core.read_picture().unwrap();
        let coverage = core.read_map(Map::Coverage).unwrap().unwrap();
        let width = picture.width_px as usize;
        let is_shown = |index: usize| {
            let at = glam::UVec2::new(
                u32::try_from(index % width).unwrap(),
                u32::try_from(index / width).unwrap(),
            );
            let in_region = at.wrapping_sub(region.origin_px);
            in_region.cmplt(region.size_px).all()
                && coverage.texels[(in_region.y * region.size_px.x + in_region.x) as usize][0] == 0.0
        };
        let differences = of_receiver(&picture.rgba8, &plate, is_shown);
        let n = 3.0 * f64::from(u32::try_from(differences.len()).unwrap());
        let all = || differences.as_flattened().iter();
        let far = all().filter(|codes| codes.abs() > 1.5).count();
        (
            (all().map(|codes| codes * codes).sum::<f64>() / n).sqrt(),
            f64::from(u32::try_from(far).unwrap()) / n,
        )
    };
    let ([rms, far], [true_rms, _]) = (
        <[f64; 2]>::from(difference(0.0)),
        <[f64; 2]>::from(difference(1.0)),
    );
    println!("rms {rms}, beyond 1 code {far}; with the true shadow {true_rms}");
    assert!(rms < 1.0 && far < 0.02, "{rms} codes, {far} are beyond one");
    assert!(true_rms > 5.0, "with a shadow it is {true_rms}");
}

/// Number of pixels whose light is partly hidden, and the sum of their hidden shares.
fn penumbra(visibility: &FloatMap) -> [f64; 2] {
    let hidden = || visibility.texels.iter().map(|texel| 1.0 - f64::from(texel[0]));
    let n_partly = hidden().filter(|hidden| (0.05..0.95).contains(hidden)).count();
    [f64::from(u32::try_from(n_partly).unwrap()), hidden().sum()]
}

#[test]
fn a_softer_shadow_has_a_wider_penumbra_and_hides_as_much() {
    let mut core = core();
    let (scene, input) = whole();
    core.set_scene(scene, Preset::Balanced).unwrap();
    // All in the region of the widest shadow.
    let mut of_softness = |softness| {
        core.frame(&styled(&input, 1.0, softness)).unwrap();
        let physical = core.read_map(Map::PhysicalVisibility).unwrap().unwrap();
        let shown = core.read_map(Map::Visibility).unwrap().unwrap();
        (penumbra(&shown), physical)
    };
    let ([twice, hidden_2], real_2) = of_softness(2.0);
    let ([once, hidden_1], real_1) = of_softness(1.0);
    let ([half, hidden_h], _) = of_softness(0.5);
    println!("penumbra {half} {once} {twice}, hidden {hidden_h} {hidden_1} {hidden_2}");
    assert!(real_1 == real_2, "the real shadow is as soft as it is");
    for (wider, narrower) in [(twice, once), (once, half)] {
        assert!(
            (1.6..2.4).contains(&(wider / narrower)),
            "{half}, {once}, {twice}"
        );
    }
    for hidden in [hidden_2, hidden_h] {
        assert!(
            (hidden / hidden_1 - 1.0).abs() < 0.03,
            "{hidden_h}, {hidden_1}, {hidden_2}"
        );
    }
}
