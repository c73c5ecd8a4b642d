//! Estimates toy, table, cameras and lights from the photographs.

use anyhow::Context;
use app_core::alignment::{
    Aligner, Alignment, AlignmentWarning, FoundToy, Outlines, PoseAlignment, find_toy,
};
use app_core::frame::FrameInput;
use app_core::scene::{Camera, Image, Light, Plate, PoseUncertainty, Receiver, Scene, Surface};
use desk::check::overlay;
use glam::{DMat4, DVec2, DVec3};

use super::{Given, NewError, Side, Wanted, table};

/// Assumed distance of the table before the toy is found, in metres, and the angle at which the
/// camera looks down on it.
const TABLE_AWAY_M: f64 = 0.5;
const TABLE_DOWN_RAD: f64 = 0.7;
/// Half the sides of a table of unknown size, over the diagonal of the toy's box, and their lower
/// bound.
const TABLE: f64 = 6.0;
const LEAST_TABLE_M: f64 = 0.3;
/// Uncertainty of a table's slope that is worth a warning, in radians.
const UNSURE_RAD: f64 = 0.01;
/// Unexplained share of a shadow that is worth a warning.
const UNEXPLAINED: f64 = 0.3;

/// The estimates; world is the table's space: the origin under the toy's centre, +Y up, +Z towards
/// the camera.
pub(super) struct Found {
    pub(super) scene: Scene,
    pub(super) input: FrameInput,
    alignment: Alignment,
    toy: FoundToy,
    turn_rad: f64,
    height_m: f64,
}

/// Estimates all from the photographs.
pub(super) fn find(given: &Given, wanted: &Wanted) -> anyhow::Result<Found> {
    let camera = given.camera();
    let plates = given.plates.iter().map(|plate| Plate {
        image: plate.image.clone().into(),
        camera,
    });
    let down = DMat4::from_rotation_x(TABLE_DOWN_RAD);
    let guessed = DMat4::from_translation(TABLE_AWAY_M * DVec3::NEG_Z) * down;
    let image = &given.photograph.image;
    let scene = Scene::new(
        [image.width_px, image.height_px],
        given.toy.clone(),
        given.upright,
        vec![table(guessed, given)],
    )
    .with_physical_pose(given.pose.clone())
    .with_plates(plates.collect());
    let input = FrameInput::new(image.clone(), camera, given.upright);
    let search = find_toy(&scene, &input, &wanted.view.directions())?;
    let toy = match &search.found[..] {
        [] => return Err(not_found(given, search.nearest_px).into()),
        [toy] => toy.clone(),
        several => {
            let mut sides: Vec<Side> = several
                .iter()
                .map(|toy| Side::of_turn(turn_rad(toy, given)))
                .collect();
            sides.dedup();
            return Err(NewError::Ambiguous { sides }.into());
        }
    };
    let mut found: Option<Found> = None;
    for world_from_table in &toy.world_from_tables {
        let laid = world_from_camera(given, wanted, &toy, world_from_table);
        let other = aligned(given, (&scene, &search.plate_cameras), &toy, &laid)?;
        if found
            .as_ref()
            .is_none_or(|found| other.unexplained() < found.unexplained())
        {
            found = Some(other);
        }
    }
    let mut found = found.context("no plane under the toy")?;
    let is_floating = toy.world_from_tables.len() > 1 || wanted.lifted_m > 0.0;
    found.scene.resting = is_floating.then_some(false);
    found.lower_to_table(given)?;
    Ok(found)
}

/// Transforms world to the table, and estimates the lights.
fn aligned(
    given: &Given,
    (scene, plate_cameras): (&Scene, &[Camera]),
    toy: &FoundToy,
    world_from_camera: &DMat4,
) -> anyhow::Result<Found> {
    let placed = |camera: &Camera| Camera {
        world_from_camera: *world_from_camera * camera.world_from_camera,
        ..*camera
    };
    let mut scene = scene.clone();
    for (plate, camera) in scene.plates.iter_mut().zip(plate_cameras) {
        plate.camera = placed(camera);
    }
    scene.world_from_object = *world_from_camera * toy.world_from_object;
    scene.receivers = vec![table(DMat4::IDENTITY, given)];
    // The toy defines the camera's place relative to the table; plates were registered to it.
    scene.uncertainty.camera = PoseUncertainty {
        position_m: Some(0.0),
        rotation_rad: Some(0.0),
    };
    let camera = placed(&given.camera());
    let input = FrameInput::new(given.photograph.image.clone(), camera, scene.world_from_object);
    let mut aligner = Aligner::new(scene);
    let alignment = aligner.align(&input)?;
    let mut scene = Scene::clone(aligner.scene());
    let input = alignment.applied_to(&input);
    let is_found = |_: &&_| alignment.report.assumed.is_none();
    scene.lights = alignment
        .lights
        .as_deref()
        .filter(is_found)
        .unwrap_or_default()
        .to_vec();
    scene.world_from_object = input.world_from_object;
    Ok(Found {
        turn_rad: turn_rad(toy, given),
        height_m: given.height_m,
        scene,
        input,
        alignment,
        toy: toy.clone(),
    })
}

/// Transform from the camera's space, in which the toy was found, to the table's.
fn world_from_camera(given: &Given, wanted: &Wanted, toy: &FoundToy, table: &DMat4) -> DMat4 {
    let up = table.y_axis.truncate().normalize_or(DVec3::Y);
    let middle = toy.world_from_object.transform_point3(given.middle());
    let above_m = (middle - table.w_axis.truncate()).dot(up);
    let origin = middle - (above_m + wanted.lifted_m) * up;
    let towards = -origin - (-origin).dot(up) * up;
    let z = towards.normalize_or(up.any_orthonormal_vector());
    let x = up.cross(z);
    let camera_from_world =
        DMat4::from_cols(x.extend(0.0), up.extend(0.0), z.extend(0.0), origin.extend(1.0));
    camera_from_world.inverse()
}

/// The turn of the toy relative to the camera: 0 if its front is visible.
fn turn_rad(toy: &FoundToy, given: &Given) -> f64 {
    let moved = toy.world_from_object * given.upright.inverse();
    let middle = toy.world_from_object.transform_point3(given.middle());
    let up = moved.transform_vector3(DVec3::Y).normalize_or(DVec3::Y);
    // A model that was turned upright keeps its axes except for that turn.
    let front = moved.transform_vector3(DVec3::Z);
    let to_camera = (-middle - (-middle).dot(up) * up).normalize_or(DVec3::Z);
    let right = up.cross(to_camera);
    front.dot(right).atan2(front.dot(to_camera))
}

fn table(world_from_plane: DMat4, given: &Given) -> Receiver {
    Receiver {
        name: "table".to_owned(),
        world_from_plane,
        half_extent_m: DVec2::splat((TABLE * given.diagonal_m()).max(LEAST_TABLE_M)),
        surface: Surface::Textured,
    }
}

fn not_found(given: &Given, nearest_px: Option<f64>) -> NewError {
    let reached = match nearest_px {
        None => "too little of any outline is visible".to_owned(),
        Some(px) => {
            format!("the nearest outline stays {px:.1} px from the photograph's, or is met by chance alone")
        }
    };
    let plate = if given.plates.is_empty() {
        "Photograph the place without the toy as well, from the same stand. "
    } else {
        ""
    };
    NewError::NotFound {
        reached,
        advice: format!(
            "{plate}Check that all is taken from one place, that the model is this toy in this pose (--pose CLIP@TIME), which of the model's axes points up (--up), that nothing hides it, and the focal length (--focal-35mm); or give the visible side (--view)"
        ),
    }
}

impl Found {
    /// Share of the shadow that the lights leave unexplained: all of it if there is no light.
    fn unexplained(&self) -> f64 {
        self.alignment.report.unexplained.unwrap_or(1.0)
    }

    /// Moves toy and cameras to the height above the table that the shadow shows, and aligns the
    /// lights there.
    fn lower_to_table(&mut self, given: &Given) -> anyhow::Result<()> {
        let Self { scene, input, .. } = self;
        if scene.lights.is_empty() || scene.plates.is_empty() {
            return Ok(());
        }
        let lights = scene.lights.clone();
        let Some(higher_m) = table::higher_m(scene, input, &lights, given.diagonal_m())? else {
            return Ok(());
        };
        let lifted = DMat4::from_translation(-higher_m * DVec3::Y);
        for plate in &mut scene.plates {
            plate.camera.world_from_camera = lifted * plate.camera.world_from_camera;
        }
        input.camera.world_from_camera = lifted * input.camera.world_from_camera;
        input.world_from_object = lifted * input.world_from_object;
        scene.world_from_object = input.world_from_object;
        input.lights = None;
        let aligned = table::aligned_at(scene, input, &lights, 0.0)?;
        scene.lights = aligned.lights.map_or(lights, |found| found.to_vec());
        input.lights = Some(scene.lights.clone().into());
        Ok(())
    }

    /// The photograph with the outlines of toy and shadows, and a grid on the table.
    pub(super) fn drawn(&self, given: &Given) -> anyhow::Result<Image> {
        let mut picture = given.photograph.image.clone();
        overlay::receivers(&mut picture, &self.scene, &self.input);
        overlay::outlines(
            &mut picture,
            &Outlines::of(&self.scene, &self.input)?,
            overlay::ALIGNED,
        );
        Ok(picture)
    }

    /// The results in sentences.
    pub(super) fn facts(&self) -> Vec<String> {
        let camera = self.input.camera.world_from_camera.w_axis.truncate();
        let toy = self.input.world_from_object.w_axis.truncate();
        let down_deg = (camera.y / camera.length()).clamp(-1.0, 1.0).asin().to_degrees();
        let mut facts = vec![format!(
            "the toy is {:.1} cm high, as it stands",
            100.0 * self.height_m
        )];
        facts.push(format!(
            "the toy is found: its {} is seen from {:.2} m, {down_deg:.0} degrees above the table; its outline is {:.2} px from the photograph's, its place known to {:.2} mm along the view",
            Side::of_turn(self.turn_rad),
            camera.distance(toy),
            self.pose().map_or(self.toy.outline_px, PoseAlignment::shown_px),
            1e3 * self.toy.deviation.depth_m,
        ));
        facts.extend(self.alignment.report.discovered.iter().enumerate().map(|(index, light)| {
            let away = light.distance_m.map_or("far away".to_owned(), |metres| format!("{metres:.2} m away"));
            format!(
                "light {index} is found by its shadow: {away}, {:.1} degrees wide, {:.0} % of the light",
                2.0 * light.angular_radius_rad.to_degrees(),
                100.0 * light.share
            )
        }));
        facts
    }

    fn pose(&self) -> Option<&PoseAlignment> {
        self.alignment.report.pose.as_ref()
    }

    /// Possible mistakes, and losses.
    pub(super) fn warnings(&self, given: &Given) -> Vec<String> {
        // The table was fitted under the toy.
        let is_other = |warning: &&AlignmentWarning| !matches!(warning, AlignmentWarning::OffReceiver { .. });
        let others = self.alignment.warnings.iter().filter(is_other);
        let mut warnings: Vec<String> = others.map(ToString::to_string).collect();
        if given.plates.is_empty() {
            warnings.push(
                "there is no photograph of the place without the toy: what the toy and its shadow hide is estimated, and the lights are less accurate"
                    .to_owned(),
            );
        }
        let slope_rad = self.toy.deviation.rotation_rad;
        if slope_rad > UNSURE_RAD {
            warnings.push(format!(
                "the table's slope is known to {:.1} degrees alone",
                slope_rad.to_degrees()
            ));
        }
        if let Some(part) = self
            .alignment
            .report
            .unexplained
            .filter(|part| *part > UNEXPLAINED)
        {
            warnings.push(format!(
                "{:.0} % of the shadow stays unexplained: look at the drawing before you go on",
                100.0 * part
            ));
        }
        warnings
    }

    /// The lights with a shadow.
    pub(super) fn lights(&self) -> &[Light] {
        &self.scene.lights
    }
}
