//! Lights by a Fresnel lens and by a mirror ball, photographed by exact rays, compared with the
//! true lamps.

use std::sync::Arc;

use app_core::probe::{Form, ProbeError, ProbeReport, ProbeView, Reason, Sighting, Track, facet_at, look};
use app_core::scene::{Camera, FacetSlope, Image, Light, Probe, ProbePicture, ProbeShape};
use glam::{DMat4, DVec2, DVec3};
use measure::photographer::world::{camera, toward};
use measure::photographer::{Exposure, Ghost, Lamp, Mirror};

const SIZE_PX: [u32; 2] = [640, 480];
const SKY: DVec3 = DVec3::splat(0.35);
/// Viewers: nearly on the axis, and some 45 degrees off it.
const VIEWERS: [DVec3; 2] = [DVec3::new(0.0, 0.4, 0.05), DVec3::new(0.05, 0.3, 0.28)];
/// Elevation and azimuth of suns, degrees.
const SUNS: [[f64; 2]; 4] = [[35.0, 20.0], [50.0, 290.0], [65.0, 140.0], [80.0, 220.0]];

fn viewer(eye: DVec3) -> Camera {
    camera(SIZE_PX, eye, DVec3::ZERO)
}

fn sun([elevation_deg, azimuth_deg]: [f64; 2]) -> Lamp {
    Lamp::sun(toward(elevation_deg, azimuth_deg), 0.27f64.to_radians(), 0.7)
}

fn lens() -> Mirror {
    Mirror::lens(DMat4::IDENTITY)
}

fn ball() -> Mirror {
    Mirror::ball(DMat4::from_translation(DVec3::new(0.0, 0.03, 0.0)))
}

fn photograph(mirror: &Mirror, lamps: &[Lamp], eye: DVec3) -> ProbePicture {
    mirror.photograph((lamps, SKY), (&viewer(eye), SIZE_PX), &Exposure::default())
}

fn seen(shape: &ProbeShape, picture: &ProbePicture, form: Form) -> Sighting {
    look(&ProbeView { shape, picture }, form).unwrap()
}

/// Degrees between the only light of a sighting and a direction.
fn off_deg(sighting: &Sighting, direction: DVec3) -> f64 {
    assert_eq!(sighting.lights.len(), 1, "{sighting:?}");
    sighting.lights[0]
        .direction_in_world
        .angle_between(direction)
        .to_degrees()
}

#[test]
fn a_light_is_where_the_lens_shows_it() {
    for eye in VIEWERS {
        for at in SUNS {
            let picture = photograph(&lens(), &[sun(at)], eye);
            let exact = seen(&lens().shape, &picture, Form::Exact);
            let off_deg = off_deg(&exact, toward(at[0], at[1]));
            assert!(off_deg < 0.3, "{off_deg} from {eye}, {at:?}");
            let deviation_deg = exact.lights[0].deviation_rad.to_degrees();
            assert!(off_deg < 3.0 * deviation_deg, "{off_deg}, {deviation_deg}");
        }
    }
}

/// Equation 4 has R = (0, 0, 1) for the viewer: the error is the angle between the two, plus the
/// uncertainty from whole pixels of a highlight, which is larger for an oblique view of the lens.
#[test]
fn the_published_form_errs_by_the_viewers_angle() {
    for (eye, most_deg) in VIEWERS.into_iter().zip([0.5, 0.6]) {
        for at in SUNS {
            let picture = photograph(&lens(), &[sun(at)], eye);
            let published = seen(&lens().shape, &picture, Form::Published);
            let off_deg = off_deg(&published, toward(at[0], at[1]));
            let to_viewer = eye - published.lights[0].origin_in_world;
            let angle_deg = to_viewer.angle_between(DVec3::Y).to_degrees();
            assert!(
                (off_deg - angle_deg).abs() < most_deg,
                "{off_deg} for {angle_deg}, {at:?}"
            );
            assert!(angle_deg > 3.0, "{angle_deg}");
        }
    }
}

/// Control for the tests above: a wrong pose, side of the normal or viewer is detected.
#[test]
fn wrong_geometry_shows() {
    let at = SUNS[1];
    let picture = photograph(&lens(), &[sun(at)], VIEWERS[1]);
    let truth = toward(at[0], at[1]);
    let shape = lens().shape;
    let turned = ProbePicture {
        world_from_probe: DMat4::from_rotation_x(2f64.to_radians()),
        ..picture.clone()
    };
    let turned_deg = off_deg(&seen(&shape, &turned, Form::Exact), truth);
    assert!(turned_deg > 1.0, "the lens turned by 2 degrees: {turned_deg}");
    // Facets that lean inwards would show the light on the other side.
    let hollow_deg = off_deg(
        &seen(&shape, &picture, Form::Exact),
        DVec3::new(-truth.x, truth.y, -truth.z),
    );
    assert!(hollow_deg > 30.0, "{hollow_deg}");
    let mut beside = picture;
    beside.camera.world_from_camera.w_axis.x += 0.02;
    let beside_deg = off_deg(&seen(&shape, &beside, Form::Exact), truth);
    assert!(beside_deg > 1.0, "the viewer 2 cm beside: {beside_deg}");
}

#[test]
fn a_light_is_where_the_ball_shows_it() {
    for eye in VIEWERS {
        for at in SUNS {
            let picture = photograph(&ball(), &[sun(at)], eye);
            let exact = seen(&ball().shape, &picture, Form::Exact);
            let off_deg = off_deg(&exact, toward(at[0], at[1]));
            assert!(off_deg < 0.3, "{off_deg} from {eye}, {at:?}");
        }
    }
}

#[test]
fn two_lights_are_told_strongest_first() {
    let strong = Lamp::sun(toward(60.0, 40.0), 0.5f64.to_radians(), 0.8);
    let weak = Lamp::sun(toward(40.0, 200.0), 0.27f64.to_radians(), 0.15);
    let picture = photograph(&lens(), &[weak, strong], VIEWERS[1]);
    let sighting = seen(&lens().shape, &picture, Form::Exact);
    assert_eq!(
        (sighting.lights.len(), sighting.rejected.len()),
        (2, 0),
        "{sighting:?}"
    );
    for (light, truth) in sighting
        .lights
        .iter()
        .zip([toward(60.0, 40.0), toward(40.0, 200.0)])
    {
        let off_deg = light.direction_in_world.angle_between(truth).to_degrees();
        assert!(off_deg < 0.3, "{off_deg}: {light:?}");
    }
}

/// A streak across the axis from the highlight; the published form treats it as a light.
#[test]
fn a_ghost_is_no_light() {
    let at = SUNS[1];
    let outward = toward(0.0, at[1]);
    let outward = DVec2::new(outward.x, outward.z);
    let along_radius = [-0.012 * outward, -0.026 * outward];
    let around = [
        -0.03 * outward + 0.007 * outward.perp(),
        -0.03 * outward - 0.007 * outward.perp(),
    ];
    for ends_m in [along_radius, around] {
        let mirror = Mirror {
            ghosts: vec![Ghost {
                ends_m,
                width_m: 8e-4,
                light: 200.0,
            }],
            ..lens()
        };
        for eye in VIEWERS {
            let picture = photograph(&mirror, &[sun(at)], eye);
            let exact = seen(&mirror.shape, &picture, Form::Exact);
            assert!(off_deg(&exact, toward(at[0], at[1])) < 0.3, "{exact:?}");
            assert!(
                matches!(exact.rejected[..], [rejected] if matches!(rejected.reason, Reason::Streak { .. })),
                "{exact:?}"
            );
            assert_eq!(seen(&mirror.shape, &picture, Form::Published).lights.len(), 2);
        }
    }
}

#[test]
fn what_is_cut_off_below_or_too_wide_is_no_light() {
    let reason = |mirror: &Mirror, lamp: Lamp| {
        let sighting = seen(
            &mirror.shape,
            &photograph(mirror, &[lamp], VIEWERS[0]),
            Form::Exact,
        );
        assert_eq!(
            (sighting.lights.len(), sighting.rejected.len()),
            (0, 1),
            "{sighting:?}"
        );
        sighting.rejected[0].reason
    };
    let low = Lamp::sun(toward(-20.0, 200.0), 0.5f64.to_radians(), 0.7);
    assert_eq!(reason(&lens(), low), Reason::BelowLens);
    let window = Lamp::sun(toward(80.0, 0.0), 30f64.to_radians(), 100.0);
    assert!(matches!(reason(&lens(), window), Reason::TooWide { .. }));
    // A disc so small that the highlight lies across its border.
    let mut small = lens();
    let reach = (0.5 * (90.0 - 50.0f64)).to_radians().sin() * 0.05;
    small.shape = ProbeShape::FresnelLens {
        radius_m: reach,
        slope: FacetSlope::Focal {
            focal_m: reach / 40f64.to_radians().tan(),
        },
    };
    let axis = DVec3::new(0.0, 0.4, 0.0);
    let at_border = Lamp::sun(toward(50.0, 0.0), 1f64.to_radians(), 0.7);
    let picture = photograph(&small, &[at_border], axis);
    let sighting = seen(&small.shape, &picture, Form::Exact);
    assert!(sighting.lights.is_empty(), "{sighting:?}");
}

/// A bulb 60 cm away, in three views.
#[test]
fn views_tell_how_far_away_a_light_is() {
    let bulb = Lamp::bulb(0.6 * toward(55.0, 30.0), 0.01, 0.5);
    let eyes = [
        DVec3::new(-0.25, 0.35, 0.1),
        DVec3::new(0.2, 0.35, 0.2),
        DVec3::new(0.0, 0.4, -0.1),
    ];
    let mut track = Track::default();
    for (index, eye) in eyes.into_iter().enumerate() {
        let picture = photograph(&lens(), &[bulb], eye);
        let shape = &lens().shape;
        track
            .look(&ProbeView {
                shape,
                picture: &picture,
            })
            .unwrap();
        let light = track.lights()[0];
        assert_eq!((track.lights().len(), light.n_views), (1, index + 1));
        assert_eq!(light.distance_m.is_some(), index > 0, "{light:?}");
    }
    let light = track.lights()[0];
    let Light::Sphere {
        position_in_world, ..
    } = light.light
    else {
        panic!("{light:?}");
    };
    let off_m = position_in_world.distance(0.6 * toward(55.0, 30.0));
    assert!(off_m < 0.04, "{off_m} m off: {light:?}");
    let nearness = (1.0 / light.distance_m.unwrap() - 1.0 / 0.6).abs();
    assert!(nearness < 3.0 * light.nearness_deviation_per_m, "{light:?}");
}

#[test]
fn the_sun_has_no_distance() {
    let mut track = Track::default();
    for eye in VIEWERS {
        let picture = photograph(&lens(), &[sun(SUNS[2])], eye);
        let shape = &lens().shape;
        track
            .look(&ProbeView {
                shape,
                picture: &picture,
            })
            .unwrap();
    }
    assert!(
        matches!(track.lights()[0].light, Light::Directional { .. }),
        "{track:?}"
    );
    assert_eq!(track.lights()[0].n_views, 2);
}

#[test]
fn out_of_view_the_last_lights_stay() {
    let shape = &lens().shape;
    let mut track = Track::default();
    let mut look = |picture: &ProbePicture| {
        track.look(&ProbeView { shape, picture }).unwrap();
        (track.lights().to_vec(), track.n_unseen())
    };
    let picture = photograph(&lens(), &[sun(SUNS[0])], VIEWERS[0]);
    let (lights, _) = look(&picture);
    assert_eq!(lights.len(), 1);
    let elsewhere = ProbePicture {
        camera: camera(SIZE_PX, VIEWERS[0], DVec3::new(2.0, 0.0, 0.0)),
        ..picture.clone()
    };
    assert_eq!(look(&elsewhere), (lights.clone(), 1));
    let from_below = ProbePicture {
        camera: camera(SIZE_PX, DVec3::new(0.0, -0.4, 0.1), DVec3::ZERO),
        ..picture
    };
    assert_eq!(look(&from_below), (lights, 2));
    // Another light: the previous one is gone, and its rays are not used.
    let (moved, n_unseen) = look(&photograph(&lens(), &[sun(SUNS[3])], VIEWERS[0]));
    assert_eq!((moved.len(), moved[0].n_views, n_unseen), (1, 1, 0));
    let (dark, _) = look(&photograph(&lens(), &[], VIEWERS[0]));
    assert!(dark.is_empty());
}

/// A lens of another slope errs by degrees as a hemisphere; a table made of lamps at known places does not.
#[test]
fn a_calibrated_lens_needs_no_hemisphere() {
    let mirror = Mirror {
        shape: ProbeShape::FresnelLens {
            radius_m: 0.05,
            slope: FacetSlope::Focal { focal_m: 0.03 },
        },
        ..lens()
    };
    let mut facets = Vec::new();
    for elevation_deg in [86.0, 80.0, 74.0, 68.0, 62.0, 56.0, 50.0, 44.0, 38.0] {
        let lamp = sun([elevation_deg, 20.0]);
        let picture = photograph(&mirror, &[lamp], VIEWERS[0]);
        let view = ProbeView {
            shape: &mirror.shape,
            picture: &picture,
        };
        let at_px = seen(&mirror.shape, &picture, Form::Exact).lights[0].at_px;
        facets.extend(facet_at(&view, at_px, toward(elevation_deg, 20.0)).unwrap());
    }
    facets.sort_by(|a, b| a.at.total_cmp(&b.at));
    assert_eq!(facets.len(), 9);
    let told = |slope| ProbeShape::FresnelLens {
        radius_m: 0.05,
        slope,
    };
    let shapes = [
        FacetSlope::Hemisphere,
        FacetSlope::Focal { focal_m: 0.03 },
        FacetSlope::Table(facets),
    ];
    let picture = photograph(&mirror, &[sun([42.0, 250.0])], VIEWERS[1]);
    let [hemisphere, focal, table] =
        shapes.map(|slope| off_deg(&seen(&told(slope), &picture, Form::Exact), toward(42.0, 250.0)));
    assert!(hemisphere > 3.0, "{hemisphere}");
    assert!(focal < 0.3 && table < 0.4, "{focal}, {table}");
}

#[test]
fn what_cannot_be_is_refused() {
    let picture = photograph(&ball(), &[], VIEWERS[0]);
    let refused = |shape: &ProbeShape, picture: &ProbePicture| {
        look(&ProbeView { shape, picture }, Form::Exact).unwrap_err()
    };
    let flat = ProbeShape::MirrorBall { radius_m: 0.0 };
    assert!(matches!(refused(&flat, &picture), ProbeError::Input(_)));
    let table = ProbeShape::FresnelLens {
        radius_m: 0.05,
        slope: FacetSlope::Table(Vec::new()),
    };
    assert!(matches!(refused(&table, &picture), ProbeError::Input(_)));
    let mut cut = picture.clone();
    cut.image = Arc::new(Image {
        rgba8: vec![0; 5],
        ..*picture.image
    });
    assert!(matches!(refused(&ball().shape, &cut), ProbeError::Size { .. }));
    let mut mad = picture.clone();
    mad.world_from_probe.w_axis.x = f64::NAN;
    assert!(matches!(refused(&ball().shape, &mad), ProbeError::Input(_)));
    let mut far = picture;
    far.world_from_probe.w_axis.y = -4.0;
    assert!(matches!(
        refused(&ball().shape, &far),
        ProbeError::TooSmall { .. }
    ));
}

/// No picture causes a panic, and all results are finite.
#[test]
fn any_picture_is_read() {
    let mut state = 7u64;
    let mut next = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 56) as u8
    };
    for mirror in [lens(), ball()] {
        for bright in [0, 40, 200, 255] {
            let picture = photograph(&mirror, &[], VIEWERS[0]);
            let mut image = Image::clone(&picture.image);
            for pixel in image.rgba8.chunks_exact_mut(4) {
                let code = if next() < bright { 255 } else { next() };
                pixel[..3].fill(code);
            }
            let picture = ProbePicture {
                image: Arc::new(image),
                ..picture
            };
            let probe = Probe {
                shape: mirror.shape.clone(),
                pictures: vec![picture; 2],
            };
            let report = ProbeReport::of(&probe).unwrap();
            for light in &report.lights {
                assert!(light.seen.direction_in_world.is_normalized() && light.seen.power.is_finite());
            }
        }
    }
}
