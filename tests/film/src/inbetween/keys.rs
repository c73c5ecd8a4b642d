//! Registers all keys: one camera, one exposure and one light for all, and the estimated place of
//! each print.

use std::sync::Arc;

use app_core::alignment::{AlignError, Aligner, Alignment, AlignmentWarning};
use app_core::frame::FrameInput;
use app_core::scene::{Camera, Intrinsics, Light, Plate, Pose, Receiver, Scene};
use glam::{DMat3, DMat4, DVec3};

use super::InbetweenError;
use super::blend::Reference;
use super::exposure::{Clear, gains};
use super::light::LightPicture;
use super::placement;
use super::resample::resampled;
use super::shot::Shot;
use super::stage::Figure;

/// Largest distance of a print that stands on its mark.
const MOST_OFF_MARK_M: f64 = 0.006;
const MOST_OFF_MARK_RAD: f64 = 0.1;
/// A camera nearer to the reference than this, at the picture's corners, is not corrected.
const LEAST_MOVED_PX: f64 = 0.02;

/// A key as it would have been photographed by the reference camera, in the reference exposure.
#[derive(Clone, Debug)]
pub struct Key {
    /// The core's input, without the pose and the place to show.
    pub input: FrameInput,
    /// The scene with the toy in the pose of the print.
    pub scene: Arc<Scene>,
    /// The pose of the print.
    pub pose: Pose,
    /// Seconds of the film.
    pub time_secs: f64,
    /// The print's middle in world.
    middle: DVec3,
    /// Its corrections.
    pub found: Found,
}

/// The detected and corrected differences of a key.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Found {
    /// Difference of the camera from the reference: at the picture's corners in pixels, in metres,
    /// and in radians.
    pub camera: Option<PoseDifference>,
    /// Difference of the print from its shown place: in pixels at its centre, in metres, and in
    /// radians.
    pub print: Option<PoseDifference>,
    /// Factors per channel.
    pub gains: [f64; 3],
    /// Warnings, for example if the toy was not found.
    pub warnings: Vec<String>,
}

/// A difference of two poses.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PoseDifference {
    /// In the picture, in pixels.
    pub moved_px: f64,
    /// In metres.
    pub moved_m: f64,
    /// In radians.
    pub turned_rad: f64,
}

/// All keys of a shot.
pub struct Keys {
    /// In the order of the film.
    pub keys: Vec<Key>,
    /// The camera of the film.
    pub camera: Camera,
    /// The place of the toy in all frames.
    pub world_from_shown: DMat4,
    /// Whether that is the shot's mark, and not the place of the first print.
    pub is_mark: bool,
    /// The lights of all keys.
    pub lights: Arc<[Light]>,
    /// The picture of the table.
    pub reference: Reference,
}

/// A key whose camera, print and lights were estimated in its own photograph.
struct Sighted {
    recorded: FrameInput,
    alignment: Alignment,
    pose: Pose,
    time_secs: f64,
    /// Of its photograph and its entry in the session.
    warnings: Vec<String>,
}

impl Keys {
    /// Estimates the differences between keys. Reports each key to `progress`.
    ///
    /// # Errors
    /// When a photograph cannot be read or aligned.
    pub fn find(shot: &Shot, mut progress: impl FnMut(usize)) -> Result<Self, InbetweenError> {
        let mut sighted = Vec::new();
        for index in 0..shot.n_keys() {
            progress(index);
            sighted.push(sighted_key(shot, index)?);
        }
        let first = sighted.first().ok_or(InbetweenError::NoKey)?;
        let plate = shot.scene().plates.first();
        let camera = plate.map_or(first.alignment.camera, |plate| plate.camera);
        let lights = common_lights(shot.scene(), &sighted);
        let stage = Stage {
            shot,
            camera,
            lights: &lights,
        };
        let reference = stage.reference(first)?;
        // Each photograph as recorded goes with its key: a large one has a hundred megabytes.
        let keys = sighted.into_iter().enumerate();
        let mut keys = keys
            .map(|(index, key)| stage.key(index, &key, &reference))
            .collect::<Result<Vec<_>, _>>()?;
        let mark = shot.scene().world_from_object;
        let off_mark = |key: &Key| off(&mark, &key.input.world_from_object, &key.middle);
        let is_near =
            |off: PoseDifference| off.moved_m < MOST_OFF_MARK_M && off.turned_rad < MOST_OFF_MARK_RAD;
        let is_mark = keys.iter().all(|key| is_near(off_mark(key)));
        let world_from_shown = if is_mark {
            mark
        } else {
            keys[0].input.world_from_object
        };
        for key in &mut keys {
            let middle = key.middle;
            let print = off(&world_from_shown, &key.input.world_from_object, &middle);
            let px_per_m = camera.intrinsics.fx_px / distance_m(&camera, middle);
            key.found.print = (print != PoseDifference::default()).then_some(PoseDifference {
                moved_px: print.moved_m * px_per_m,
                ..print
            });
        }
        Ok(Self {
            keys,
            camera,
            world_from_shown,
            is_mark,
            lights,
            reference,
        })
    }
}

fn sighted_key(shot: &Shot, index: usize) -> Result<Sighted, InbetweenError> {
    let frame = shot.key(index)?;
    let recorded = FrameInput::from(&frame);
    let mut aligner = Aligner::new(shot.scene_with(&frame.shown_pose));
    Ok(Sighted {
        alignment: aligned(&mut aligner, &recorded, index)?,
        recorded,
        pose: frame.shown_pose,
        time_secs: frame.time_secs,
        warnings: frame.warnings.iter().map(ToString::to_string).collect(),
    })
}

fn aligned(aligner: &mut Aligner, input: &FrameInput, index: usize) -> Result<Alignment, InbetweenError> {
    aligner
        .align(input)
        .map_err(|reason: AlignError| InbetweenError::Align {
            index,
            reason: Box::new(reason),
        })
}

/// The common lights: medians over the keys.
fn common_lights(scene: &Scene, keys: &[Sighted]) -> Arc<[Light]> {
    let found = |key: &Sighted| key.alignment.lights.clone();
    let lists: Vec<Arc<[Light]>> = keys
        .iter()
        .map(|key| found(key).unwrap_or_else(|| key.recorded.lights_in(scene)))
        .collect();
    let Some(first) = lists.first() else {
        return scene.lights.as_slice().into();
    };
    if lists.iter().any(|list| list.len() != first.len()) {
        // The longest list of lights among the keys.
        return lists
            .iter()
            .max_by_key(|list| list.len())
            .unwrap_or(first)
            .clone();
    }
    // Each key sorts its lights by strength: the same light is the one in the nearest direction.
    let toy = scene.world_from_object.w_axis.truncate();
    let common = |light: &Light| {
        let of_keys: Option<Vec<Light>> = lists.iter().map(|list| same_light(list, light, toy)).collect();
        of_keys
            .and_then(|of_keys| median_light(&of_keys))
            .unwrap_or(*light)
    };
    first.iter().map(common).collect()
}

/// The light of a list in the direction nearest to another's, as seen from a place.
fn same_light(list: &[Light], light: &Light, place: DVec3) -> Option<Light> {
    let wanted = light.direction_from(place)?;
    let along = |light: &Light| {
        light
            .direction_from(place)
            .map_or(f64::NEG_INFINITY, |direction| direction.dot(wanted))
    };
    list.iter().max_by(|a, b| along(a).total_cmp(&along(b))).copied()
}

/// `None` if they are of several kinds.
fn median_light(lights: &[Light]) -> Option<Light> {
    let numbers: Option<Vec<(DVec3, f64)>> = lights
        .iter()
        .map(|light| match (*light, lights.first()?) {
            (
                Light::Sphere {
                    position_in_world,
                    radius_m,
                },
                Light::Sphere { .. },
            ) => Some((position_in_world, radius_m)),
            (
                Light::Directional {
                    direction_to_light_in_world,
                    angular_radius_rad,
                },
                Light::Directional { .. },
            ) => Some((direction_to_light_in_world, angular_radius_rad)),
            _ => None,
        })
        .collect();
    let numbers = numbers?;
    let of = |number: fn(&(DVec3, f64)) -> f64| median(numbers.iter().map(number).collect());
    let vector = DVec3::new(of(|(v, _)| v.x), of(|(v, _)| v.y), of(|(v, _)| v.z));
    let size = of(|(_, size)| *size);
    Some(match lights.first()? {
        Light::Sphere { .. } => Light::sphere(vector, size),
        Light::Directional { .. } => Light::Directional {
            direction_to_light_in_world: vector.try_normalize()?,
            angular_radius_rad: size,
        },
    })
}

/// The mean of the two middle values; 0 without any.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    let middle = [values.len().saturating_sub(1) / 2, values.len() / 2];
    middle.iter().filter_map(|at| values.get(*at)).sum::<f64>() / 2.0
}

/// A photograph registered to the common camera.
struct Registered {
    picture: LightPicture,
    /// Its shift at the corners; 0 if it was not resampled.
    moved_px: f64,
    gains: [f64; 3],
}

/// The common reference of all keys.
struct Stage<'a> {
    shot: &'a Shot,
    camera: Camera,
    lights: &'a Arc<[Light]>,
}

impl Stage<'_> {
    fn size_px(&self) -> [usize; 2] {
        let scene = self.shot.scene();
        [scene.width_px as usize, scene.height_px as usize]
    }

    fn reference(&self, first: &Sighted) -> Result<Reference, InbetweenError> {
        if let Some(plate) = self.shot.scene().plates.first() {
            return Ok(Reference {
                picture: LightPicture::of(&plate.image),
                touched: None,
            });
        }
        let scene = self.shot.scene();
        let figure = self.figure(&first.pose, &first.alignment.world_from_object)?;
        Ok(Reference {
            picture: LightPicture::of(first.recorded.image.rgba()),
            touched: Some(figure.touched(&scene.receivers, self.lights)),
        })
    }

    fn figure(&self, pose: &Pose, world_from_object: &DMat4) -> Result<Figure, InbetweenError> {
        let toy = &self.shot.scene().toy;
        Ok(Figure::new(
            toy,
            (pose, world_from_object),
            &self.camera,
            self.size_px(),
        )?)
    }

    /// The place of a print from its estimated pose: shifted and turned on the table alone, if that
    /// explains it.
    fn on_plane(&self, key: &Sighted, found: &DMat4) -> Result<DMat4, InbetweenError> {
        let scene = self.shot.scene();
        let mark = &scene.world_from_object;
        let Some(receiver) = nearest(&scene.receivers, mark) else {
            return Ok(*found);
        };
        let on_mark = self.figure(&key.pose, mark)?;
        let standing = placement::on_plane([mark, found], on_mark.points(), &self.camera, receiver);
        Ok(standing.unwrap_or(*found))
    }

    /// A photograph registered to the common camera, and its factors per channel. `from_px` is the
    /// estimate of its camera.
    fn registered(
        &self,
        own: &LightPicture,
        from_px: DMat3,
        (reference, clear): (&Reference, &Clear),
    ) -> Registered {
        let is_moved = |from_px: &DMat3| corner_px(from_px, self.size_px()) > LEAST_MOVED_PX;
        let table = &reference.picture;
        let mut registered = Registered {
            picture: own.clone(),
            moved_px: 0.0,
            gains: gains(own, table, clear),
        };
        if !is_moved(&from_px) {
            return registered;
        }
        registered.picture = resampled(own, &from_px);
        registered.gains = gains(&registered.picture, table, clear);
        registered.moved_px = corner_px(&from_px, self.size_px());
        registered
    }

    /// A key's photograph in the common camera and exposure, and the estimate of its print there.
    fn key(&self, index: usize, key: &Sighted, reference: &Reference) -> Result<Key, InbetweenError> {
        let scene = self.shot.scene();
        let found_camera = key.alignment.camera;
        let receiver = nearest(&scene.receivers, &key.alignment.world_from_object);
        let own = LightPicture::of(key.recorded.image.rgba());
        let figure = self.figure(&key.pose, &key.alignment.world_from_object)?;
        let touched = figure.touched(&scene.receivers, self.lights);
        let clear = Clear::new(&touched, reference, self.size_px());
        let Registered {
            mut picture,
            moved_px,
            gains,
        } = self.registered(
            &own,
            carried(&self.camera, &found_camera, receiver),
            (reference, &clear),
        );
        let is_moved = moved_px > 0.0;
        let is_dimmed = gains != [1.0; 3];
        if is_dimmed {
            picture = brightened(picture, gains);
        }
        let mut input = key.recorded.clone().with_lights(Some(Arc::clone(self.lights)));
        let mut alignment = key.alignment.clone();
        let of_print = scene.clone().with_physical_pose(key.pose.clone());
        if is_moved || is_dimmed {
            input = input
                .with_image(picture.encoded())
                .with_camera(self.camera)
                .with_world_from_object(alignment.world_from_object)
                .with_exposure(1.0);
            alignment = aligned(&mut Aligner::new(of_print.clone()), &input, index)?;
        }
        // A foot of a posed print may well be above the table.
        let is_other = |warning: &&AlignmentWarning| !matches!(warning, AlignmentWarning::OffReceiver { .. });
        let others = alignment.warnings.iter().filter(is_other);
        let others = others.map(ToString::to_string);
        let warnings = key.warnings.iter().cloned().chain(others).collect();
        let world_from_object = self.on_plane(key, &alignment.world_from_object)?;
        let input = alignment
            .applied_to(&input)
            .with_camera(self.camera)
            .with_world_from_object(world_from_object)
            .with_lights(Some(Arc::clone(self.lights)));
        let scene = alignment.scene.map_or_else(
            || Arc::new(of_print.clone()),
            |changed| {
                let mut print = of_print
                    .clone()
                    .with_plates(plates(&changed, scene))
                    .with_toy(Arc::clone(&changed.toy));
                print.receivers.clone_from(&changed.receivers);
                Arc::new(print)
            },
        );
        let grain = app_core::grain::Grain::of(&scene, input.image.rgba(), &input.camera);
        let [now, then] = [&self.camera, &found_camera].map(|camera| camera.world_from_camera);
        let camera = off(&now, &then, &now.w_axis.truncate());
        Ok(Key {
            middle: self.figure(&key.pose, &input.world_from_object)?.middle(),
            input: input.with_grain(grain),
            scene,
            pose: key.pose.clone(),
            time_secs: key.time_secs,
            found: Found {
                camera: is_moved.then_some(PoseDifference { moved_px, ..camera }),
                print: None,
                gains,
                warnings,
            },
        })
    }
}

/// The plates of an aligned scene, the first of which stands for the reference camera.
fn plates(aligned: &Scene, given: &Scene) -> Vec<Plate> {
    let mut plates = aligned.plates.clone();
    if let (Some(plate), Some(first)) = (plates.first_mut(), given.plates.first()) {
        plate.camera = first.camera;
    }
    plates
}

fn brightened(mut picture: LightPicture, gains: [f64; 3]) -> LightPicture {
    #[allow(clippy::cast_possible_truncation, reason = "about 1")]
    let gains = gains.map(|gain| gain as f32);
    for pixel in &mut picture.rgb {
        (0..3).for_each(|channel| pixel[channel] *= gains[channel]);
    }
    picture
}

/// The receiver whose plane is nearest to a toy's origin.
fn nearest<'a>(receivers: &'a [Receiver], world_from_object: &DMat4) -> Option<&'a Receiver> {
    let origin = world_from_object.w_axis.truncate();
    let height = |receiver: &Receiver| {
        let plane_from_world = receiver.world_from_plane.inverse();
        plane_from_world.transform_point3(origin).y.abs()
    };
    receivers.iter().min_by(|a, b| height(a).total_cmp(&height(b)))
}

/// The map from pixels of one camera to another's, for points of a receiver; for points at infinity
/// if there is none or if it is seen edge-on.
fn carried(camera: &Camera, other: &Camera, receiver: Option<&Receiver>) -> DMat3 {
    let other_from_camera = other.world_from_camera.inverse() * camera.world_from_camera;
    let rotation = DMat3::from_mat4(other_from_camera);
    let step = other_from_camera.w_axis.truncate();
    let plane = receiver.and_then(|receiver| {
        let camera_from_plane = camera.world_from_camera.inverse() * receiver.world_from_plane;
        let normal = camera_from_plane.y_axis.truncate();
        let distance_m = normal.dot(camera_from_plane.w_axis.truncate());
        (distance_m.abs() > 1e-3).then(|| normal / distance_m)
    });
    let shift = plane.map_or(DMat3::ZERO, |plane| {
        DMat3::from_cols(step * plane.x, step * plane.y, step * plane.z)
    });
    pixels(&other.intrinsics) * (rotation + shift) * pixels(&camera.intrinsics).inverse()
}

/// From points in camera space to pixels, both up to a factor.
fn pixels(k: &Intrinsics) -> DMat3 {
    DMat3::from_cols(
        DVec3::new(k.fx_px, 0.0, 0.0),
        DVec3::new(0.0, -k.fy_px, 0.0),
        DVec3::new(-k.cx_px, -k.cy_px, -1.0),
    )
}

/// The largest shift of a corner by a homography, in pixels.
fn corner_px(from_px: &DMat3, [width_px, height_px]: [usize; 2]) -> f64 {
    let [width, height] = [width_px as f64, height_px as f64];
    let corners = [[0.0, 0.0], [width, 0.0], [0.0, height], [width, height]];
    let moved = corners.map(|[x, y]| {
        let at = DVec3::new(x, y, 1.0);
        let there = *from_px * at;
        (there.truncate() / there.z - at.truncate()).length()
    });
    moved.into_iter().fold(0.0, f64::max)
}

/// The difference of two poses, at a point of the world.
fn off(world_from_a: &DMat4, world_from_b: &DMat4, middle_in_world: &DVec3) -> PoseDifference {
    // Moves a point of a to its place in b.
    let motion = *world_from_b * world_from_a.inverse();
    let (_, rotation, _) = motion.to_scale_rotation_translation();
    let back = motion.inverse().transform_point3(*middle_in_world);
    let turned_rad = rotation.normalize().to_axis_angle().1;
    PoseDifference {
        moved_px: 0.0,
        moved_m: (back - *middle_in_world).length(),
        turned_rad: turned_rad.min(std::f64::consts::TAU - turned_rad),
    }
}

fn distance_m(camera: &Camera, point: DVec3) -> f64 {
    let eye = camera.world_from_camera.w_axis.truncate();
    (point - eye).length().max(1e-3)
}
