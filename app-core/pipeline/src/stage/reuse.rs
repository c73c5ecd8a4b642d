//! Decides how much of the method's state a frame can reuse, and updates the state for the frame.

use std::mem;
use std::sync::Arc;

use glam::{UVec2, Vec4};

use super::footprint::{Footprint, SPARE_PX};
use super::marks::are_same;
use super::method::Method;
use super::soft;
use super::{MethodState, Stage};
use crate::baseline::Baseline;
use crate::baseline::plan::BaselinePlan;
use crate::baseline::uniform::{Baseline as Uniform, uniform};
use crate::frame::warning::Warning;
use crate::geometry::displacement::is_same_view;
use crate::geometry::rect::{PixelRect, PlaneRect};
use crate::geometry::view::View;
use crate::governor::QualityStep;
use crate::gpu::Gpu;
use crate::model::Model;
use crate::model::plan::{AROUND_TOY_PX, Plan};
use crate::model::state::SceneState;
use crate::model::state::grids::{grids_over, holds};
use crate::passes::globals::{Globals, globals};
use crate::passes::plate::PlateViews;
use crate::passes::thing_marks::Things;
use crate::plan::{Change, SceneFacts};
use crate::plates::choice::{covered_fraction, exposed};
use crate::plates::exposure::match_frame;
use crate::preset::{BaselineSettings, ModelSettings, Settings};
use app_scene::frame::FrameInput;
use app_scene::scene::{Light, Plate};

/// Step of the region's size under a moving camera, so that the size stays the same for a while.
const REGION_STEP_PX: u32 = 64;

/// The part of the method's state that a frame can reuse.
enum Reuse {
    /// Nothing, not even the targets.
    Nothing,
    /// Targets and pipelines: object or lights moved.
    Targets,
    /// Targets and the work region: visibilities were injected.
    Region,
    /// The learned state of the scene, in another view.
    SceneState,
    /// The learned state of the view as well; the picture is new.
    View,
    /// Everything except the shown pose.
    Picture,
}

impl Stage {
    /// Updates the method's state for the frame. Returns how much of it must be learned again, and
    /// whether the picture is as sharp as the previous one.
    pub(super) fn update_method(
        &mut self,
        gpu: &Gpu,
        input: &FrameInput,
        footprint: &Footprint,
    ) -> (Change, bool) {
        let sharpness = soft::taken(input.sharpness, self.sharpness);
        // The published method knows no softness.
        let is_published = matches!(self.settings, Settings::Baseline(_));
        let keeps_sharpness = is_published || sharpness == self.sharpness;
        self.sharpness = sharpness;
        let change = self.update_for(gpu, input, footprint, keeps_sharpness);
        (change, keeps_sharpness)
    }

    fn update_for(
        &mut self,
        gpu: &Gpu,
        input: &FrameInput,
        footprint: &Footprint,
        keeps_sharpness: bool,
    ) -> Change {
        self.plates.load(gpu, &self.scene, &footprint.choice.indices);
        self.reached_rects = united(&self.reached_rects, &footprint.plane_rects);
        let reuse = self.reusable(input, footprint);
        match if keeps_sharpness {
            reuse
        } else {
            self.softened(gpu, reuse)
        } {
            Reuse::Nothing => {
                if self.refused_steps != Some(size_in_steps(footprint.region.size_px)) {
                    self.start(gpu, input, footprint);
                }
                Change::Scene
            }
            Reuse::Targets => {
                self.relocate(gpu, input, footprint);
                Change::Scene
            }
            Reuse::Region => Change::Scene,
            Reuse::SceneState => {
                self.follow(gpu, footprint, true);
                Change::View
            }
            Reuse::View => Change::Picture,
            Reuse::Picture => Change::Pose,
        }
    }

    /// The reuse that remains for a picture that is softer or sharper than the previous one.
    fn softened(&mut self, gpu: &Gpu, reuse: Reuse) -> Reuse {
        let Some(Method::Model(model)) = self.state.as_mut().map(|state| &mut state.method) else {
            return reuse;
        };
        match reuse {
            Reuse::View | Reuse::Picture | Reuse::Region if !model.region.plan.is_softened => {
                // The targets for soft pictures do not exist yet.
                return Reuse::SceneState;
            }
            Reuse::Nothing | Reuse::Targets | Reuse::SceneState => return reuse,
            Reuse::View | Reuse::Picture | Reuse::Region => {}
        }
        model.soften(gpu, self.sharpness);
        match reuse {
            Reuse::Region => Reuse::Region,
            _ => Reuse::View,
        }
    }

    fn reusable(&mut self, input: &FrameInput, footprint: &Footprint) -> Reuse {
        let fronts = self.things_fronts(footprint);
        let Some(state) = &mut self.state else {
            return Reuse::Nothing;
        };
        let has_grids = match &state.method {
            Method::Model(model) => holds(&model.state.layout, &footprint.plane_rects),
            Method::Baseline(_) => true,
        };
        let is_within = is_same_view([&state.view, &footprint.view], &footprint.corners_in_world)
            && state.method.region().contains(&footprint.least_region)
            && state.method.holds_toy(footprint.least_toy_box)
            && state.method.has_fronts(&fronts);
        // Injected visibilities belong to one view.
        let is_visibility_outdated = mem::take(&mut state.is_visibility_outdated);
        let are_settings_outdated = mem::take(&mut state.are_settings_outdated);
        let is_placement_outdated = mem::take(&mut state.is_placement_outdated);
        let is_known = state.image.as_ref().is_some_and(|known| known.is(&input.image));
        let (known, given) = (state.things.as_ref(), self.things.as_ref().map(Things::given));
        let people = self.people.marks().map(Things::given);
        let are_things_known = are_same(known, given);
        let are_people_known = are_same(state.people.as_ref(), people);
        // Things in a learned picture are part of the learned state.
        let is_fit_outdated = !are_things_known && given.is_some() && (known.is_none() || is_known);
        state.things = given.cloned();
        state.people = people.cloned();
        if !has_grids {
            Reuse::Nothing
        } else if is_placement_outdated || is_fit_outdated {
            Reuse::Targets
        } else if !are_things_known || !are_people_known || !is_within || are_settings_outdated {
            Reuse::SceneState
        } else if is_visibility_outdated {
            Reuse::Region
        } else if is_known {
            Reuse::Picture
        } else {
            Reuse::View
        }
    }

    /// Starts without any state.
    fn start(&mut self, gpu: &Gpu, input: &FrameInput, footprint: &Footprint) {
        self.drop_method(gpu);
        self.refused_steps = None;
        let method = match self.settings {
            Settings::Model(settings) => match self.plan_within_limit(settings, footprint) {
                Some(plan) => self.model(gpu, plan, footprint),
                None => {
                    self.refused_steps = Some(size_in_steps(footprint.region.size_px));
                    return;
                }
            },
            Settings::Baseline(settings) => {
                let (plan, globals, uniform) = self.baseline_parts(&settings, footprint.region, footprint);
                Method::Baseline(Box::new(Baseline::new(gpu, plan, &globals, &uniform)))
            }
        };
        self.state = Some(MethodState {
            method,
            view: footprint.view.clone(),
            exposure: input.exposure,
            n_pictures: 0,
            image: None,
            things: self.things.as_ref().map(|things| things.given().clone()),
            people: self.people.marks().map(|people| people.given().clone()),
            light_indices: self.lights.indices.clone(),
            is_first_view: true,
            is_visibility_outdated: false,
            are_settings_outdated: false,
            is_placement_outdated: false,
        });
    }

    /// Adapts to another view, with toy and lights in the same place or not.
    fn follow(&mut self, gpu: &Gpu, footprint: &Footprint, is_same_place: bool) {
        let Some(mut state) = self.state.take() else {
            return;
        };
        let region = region_in(&state.method, footprint);
        state.method = match (self.settings, state.method) {
            (Settings::Model(settings), Method::Model(model)) => {
                let known = &model.region.plan;
                let facts = self.facts(footprint, (region, Some(known)));
                let facts = if is_same_place {
                    facts.steadied(&known.penumbrae_px)
                } else {
                    facts
                };
                let plan = Plan::new(&facts, &self.settings(settings));
                let globals = globals(&footprint.view, &region, &self.layout())
                    .with_boxes(&plan.toy_box, &plan.physical_box)
                    .with_reflection(self.reflection_channel());
                let light_points = self.light_points(&plan, &footprint.view);
                Method::Model(Box::new(model.follow(gpu, plan, &globals, light_points)))
            }
            (Settings::Baseline(settings), Method::Baseline(mut baseline)) => {
                let (plan, globals, uniform) = self.baseline_parts(&settings, region, footprint);
                baseline.follow(gpu, plan, &globals, &uniform);
                Method::Baseline(baseline)
            }
            _ => return,
        };
        state.view = footprint.view.clone();
        state.is_first_view = false;
        self.state = Some(state);
    }

    /// Adapts to another place of the object and the lights; everything is learned again.
    fn relocate(&mut self, gpu: &Gpu, input: &FrameInput, footprint: &Footprint) {
        if let Some(state) = &self.state
            && let (Settings::Model(settings), Method::Model(model)) = (self.settings, &state.method)
        {
            let known = &model.region.plan;
            let region = region_in(&state.method, footprint);
            let facts = self.facts(footprint, (region, Some(known)));
            let plan = Plan::new(&facts, &self.settings(settings));
            if plan.self_shadow != known.self_shadow {
                return self.start(gpu, input, footprint);
            }
        }
        self.follow(gpu, footprint, false);
        if let Some(mut state) = self.state.take() {
            if let Method::Model(model) = &mut state.method {
                let light_points = self.light_points(&model.region.plan, &footprint.view);
                model.relocate(gpu, light_points, &self.toy.physical.around);
            }
            state.is_first_view = true;
            state.light_indices.clone_from(&self.lights.indices);
            self.state = Some(state);
        }
    }

    /// Settings of a preset, reduced to the cost budget.
    pub(super) fn settings(&self, preset: ModelSettings) -> ModelSettings {
        let mut settings = ModelSettings {
            is_shadow_withheld: self.is_shadow_withheld,
            ..preset
        };
        let steps = self.quality_reductions.iter().chain(&self.asked_down);
        steps.for_each(|step| step.apply(&mut settings));
        settings
    }

    /// Sets the quality reductions from the next frame on. The learned state stays.
    pub(crate) fn set_quality_reductions(&mut self, steps: &[QualityStep]) {
        if self.asked_down != steps {
            self.asked_down = steps.to_vec();
            if let Some(state) = &mut self.state {
                state.are_settings_outdated = true;
            }
            self.refused_steps = None;
        }
    }

    /// Facts of a region. Its boxes never become smaller than those of a known plan.
    pub(super) fn facts(
        &self,
        footprint: &Footprint,
        (region, known): (PixelRect, Option<&Plan>),
    ) -> SceneFacts {
        #[allow(clippy::cast_possible_truncation, reason = "at most four")]
        let n_receivers = self.receivers.len() as u32;
        let physical_toy = self.physical_toy_in(&footprint.view);
        let looked_at = physical_toy.map(|toy| toy.grown(AROUND_TOY_PX, footprint.view.image_px));
        let boxed = (&region, footprint.view.image_px);
        SceneFacts {
            region,
            physical_toy,
            toy_box: box_in(
                boxed,
                footprint.least_toy_box,
                known.map(|plan| plan.toy_box.size_px),
            ),
            physical_box: box_in(boxed, looked_at, known.map(|plan| plan.physical_box.size_px)),
            pixel_in_object: self.pixel_in_object(footprint),
            penumbrae_px: footprint.penumbrae_px.clone(),
            n_receivers,
            is_plate_complete: self.is_plate_complete(footprint, &region)
                && !self.things.as_ref().is_some_and(Things::is_plate_wrong),
            has_things: self.things.is_some() || self.people.marks().is_some(),
            has_raised_things: self.has_raised_things(footprint),
            things_fronts: self.things_fronts(footprint),
            are_plates_scaled: footprint.plate_views.are_scaled(),
            sharpness: self.sharpness,
            is_softened: soft::is_soft(self.sharpness) || known.is_some_and(|plan| plan.is_softened),
            gloss: self.gloss,
            angular_radii_rad: self.angular_radii_rad(),
            reflection: self.reflection_in_use().copied(),
        }
    }

    /// Size of a pixel at the nearest part of the toy.
    fn pixel_in_object(&self, footprint: &Footprint) -> f64 {
        let world_from_anchor = self.layout().world_from_anchor();
        let camera = footprint.view.camera_in(&world_from_anchor);
        let (min, max) = (self.physical_bounds.min, self.physical_bounds.max);
        let from_nearest_m = camera.distance(camera.clamp(min, max));
        let metres_per_unit = self.world_from_object.x_axis.truncate().length();
        footprint.view.pixel_m(from_nearest_m) / metres_per_unit
    }

    /// Whether one or several plates show the whole region, which may be larger than the frame
    /// requires.
    fn is_plate_complete(&self, footprint: &Footprint, region: &PixelRect) -> bool {
        let Footprint { view, choice, .. } = footprint;
        let fraction = if *region == footprint.region {
            footprint.plate_fraction
        } else {
            covered_fraction(&self.scene, &self.layout(), view, region, choice)
        };
        fraction == 1.0
    }

    pub(super) fn plate_warning(&self, footprint: &Footprint) -> Option<Warning> {
        if self.scene.plates.is_empty() {
            return Some(Warning::PlateEstimated);
        }
        let fraction = footprint.plate_fraction;
        (fraction < 1.0).then_some(Warning::PlatePartial { fraction })
    }

    /// The plates at the frame's exposure, as the baseline reads them; the model fits the exposure
    /// together with the light.
    pub(super) fn plate_views_at_exposure_of(&self, input: &FrameInput, footprint: &Footprint) -> PlateViews {
        let frame = Plate {
            camera: input.camera,
            image: Arc::clone(input.image.rgba()),
        };
        let plates = (&footprint.choice.indices[..], &self.plates.gains[..]);
        let gain = match_frame((&self.scene, &self.receivers), &frame, plates, &footprint.region);
        exposed(&footprint.plate_views, gain)
    }

    /// The warning that no light is known.
    pub(super) fn light_warning(&self) -> Option<Warning> {
        let has_ambient = matches!(self.settings, Settings::Model(_));
        self.lights
            .used
            .is_empty()
            .then_some(Warning::NoLight { has_ambient })
    }

    fn model(&self, gpu: &Gpu, plan: Plan, footprint: &Footprint) -> Method {
        let globals = globals(&footprint.view, &plan.region, &self.layout())
            .with_boxes(&plan.toy_box, &plan.physical_box)
            .with_reflection(self.reflection_channel());
        let toy = (&self.toy.physical.around, self.toy.n_materials());
        let n_lights = self.lights.used.len();
        let state = SceneState::new(gpu, grids_over(&self.reached_rects), n_lights, toy);
        let light_points = self.light_points(&plan, &footprint.view);
        Method::Model(Box::new(Model::new(gpu, plan, &globals, light_points, state)))
    }

    /// The planned number of points of each light, followed by the eyes that see the toy reflected
    /// in a view.
    pub(super) fn light_points(&self, plan: &Plan, view: &View) -> Vec<Vec<Vec4>> {
        let lights = self.lights.used.iter().zip(&plan.n_light_points);
        lights
            .map(|(light, n_points)| self.points_of(light, *n_points))
            .chain(self.mirrored_eyes(plan, view))
            .collect()
    }

    /// Points over a light in the space of each receiver in turn. They are the same points, so that
    /// shadows meet at the receivers' common edges.
    pub(super) fn points_of(&self, light: &Light, n_points: usize) -> Vec<Vec4> {
        let world_from_anchor = self.layout().world_from_anchor();
        let target = self.toy_in_anchor();
        let points = light.points_in(&world_from_anchor.inverse(), target, n_points);
        let planes = self
            .receivers
            .iter()
            .map(|receiver| receiver.world_from_plane.inverse() * world_from_anchor);
        planes
            .flat_map(|plane_from_anchor| {
                points
                    .iter()
                    .map(move |p| (plane_from_anchor * p.as_dvec4()).as_vec4())
            })
            .collect()
    }

    /// The components of the baseline in a view.
    fn baseline_parts(
        &self,
        settings: &BaselineSettings,
        region: PixelRect,
        footprint: &Footprint,
    ) -> (BaselinePlan, Globals, Uniform) {
        let globals = globals(&footprint.view, &region, &self.layout());
        let uniform = uniform(&self.layout(), &footprint.bounds, settings);
        let plan = BaselinePlan::new(&self.facts(footprint, (region, None)), settings);
        (plan, globals, uniform)
    }
}

/// The region of a footprint, with a size that can stay the same for a while.
fn region_in(method: &Method, footprint: &Footprint) -> PixelRect {
    let image_px = footprint.view.image_px;
    let size_px = moving_size(method.region().size_px, &footprint.region, image_px);
    footprint.region.within(size_px, image_px)
}

/// The part of the image that becomes a box of a region which contains at least some of its pixels.
/// If no pixel is needed, the box keeps its size for later; `None` if it never had one.
fn box_in(
    (region, image_px): (&PixelRect, UVec2),
    least: Option<PixelRect>,
    known_px: Option<UVec2>,
) -> Option<PixelRect> {
    let needed = least.and_then(|least| least.grown(SPARE_PX, image_px).common(region));
    let Some(needed) = needed else {
        return known_px.map(|known_px| PixelRect {
            size_px: known_px.min(region.size_px),
            ..*region
        });
    };
    // A first box is as small as possible, like the region.
    let size_px = known_px.map_or(needed.size_px, |known_px| {
        moving_size(known_px, &needed, region.size_px)
    });
    let in_region = PixelRect {
        origin_px: needed.origin_px - region.origin_px,
        ..needed
    };
    let in_region = in_region.within(size_px, region.size_px);
    Some(PixelRect {
        origin_px: in_region.origin_px + region.origin_px,
        ..in_region
    })
}

/// The region's size under a moving camera: the current one if it suffices, otherwise the next
/// step.
fn moving_size(current_px: UVec2, needed: &PixelRect, image_px: UVec2) -> UVec2 {
    let stepped = (REGION_STEP_PX * size_in_steps(needed.size_px)).min(image_px);
    if needed.size_px.cmple(current_px).all() {
        current_px
    } else {
        stepped.max(current_px)
    }
}

/// Number of steps that contain a region, along each side.
fn size_in_steps(size_px: UVec2) -> UVec2 {
    UVec2::new(
        size_px.x.div_ceil(REGION_STEP_PX),
        size_px.y.div_ceil(REGION_STEP_PX),
    )
}

/// Union of both reaches on each receiver, so that switching between clips does not restart the
/// method.
fn united(known: &[PlaneRect], new: &[PlaneRect]) -> Vec<PlaneRect> {
    if known.is_empty() {
        return new.to_vec();
    }
    let pairs = known.iter().zip(new);
    pairs
        .map(|(a, b)| PlaneRect {
            min: a.min.min(b.min),
            max: a.max.max(b.max),
        })
        .collect()
}
