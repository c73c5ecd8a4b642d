//! The cost of a scene's frame, estimated before anything is allocated. Settings are turned down
//! until it fits the budget.

use glam::{DVec2, DVec3, DVec4, Vec4};

use super::Stage;
use super::footprint::Footprint;
use crate::frame::warning::Warning;
use crate::governor::{BALANCED_QUALITY_LADDER, QualityStep};
use crate::gpu::{Gpu, Recorder, Texture, n_pixels};
use crate::model::Model;
use crate::model::plan::Plan;
use crate::model::state::SceneState;
use crate::model::state::grids::grids_over;
use crate::passes::globals::globals;
use crate::passes::pictures::{Frame, Picture, Pictures};
use crate::passes::present::REGION_FORMAT;
use crate::plan::{Change, FrameDelta};
use crate::preset::ModelSettings;

/// Maximum number of drawn triangles of a new view: with one light, 90,000 triangles of a toy stay
/// below it with the settings of `balanced`, and 250,000, the most that is read, with all of them
/// turned down.
const MOST_TRIANGLES: u64 = 30_000_000;
/// Maximum number of pixels that the triangles of a new frame's shadows and toy cover, counted once
/// for each triangle: a phone that fills some thousand million a second takes seconds for it.
const MOST_COVERED_PX: f64 = 4e9;
/// Number of times that the toy is drawn as the camera sees it: coverage, its samples and those of
/// the moved mask.
const N_CAMERA_DRAWS: f64 = 40.0;

/// Cost of a new view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cost {
    triangles: u64,
    covered_px: f64,
}

impl Cost {
    fn is_too_much(&self) -> bool {
        self.triangles > MOST_TRIANGLES || self.covered_px > MOST_COVERED_PX
    }
}

/// Pixels that the toy covers, summed over its triangles: from the camera, by its shadows from each
/// light, and from above.
struct Covered {
    by_camera_px: f64,
    by_lights_px: Vec<f64>,
    from_above_px: f64,
}

impl Stage {
    /// The plan of a region with the finest settings within the budget; `None` if even the lowest
    /// exceed it. Keeps the reductions for later views, and the warning about them.
    pub(super) fn plan_within_limit(
        &mut self,
        settings: ModelSettings,
        footprint: &Footprint,
    ) -> Option<Plan> {
        self.quality_reductions.clear();
        self.cost_warning = None;
        let facts = self.facts(footprint, (footprint.region, None));
        let covered = self.covered(footprint);
        let mut steps = BALANCED_QUALITY_LADDER.iter();
        let mut first = None;
        loop {
            let settings = self.settings(settings);
            let plan = Plan::new(&facts, &settings);
            let cost = self.cost(&plan, footprint, &covered, settings.ambient_divisor);
            let Cost {
                triangles,
                covered_px,
            } = *first.get_or_insert(cost);
            if !cost.is_too_much() {
                if !self.quality_reductions.is_empty() {
                    let what = self
                        .quality_reductions
                        .iter()
                        .map(|step: &QualityStep| step.what)
                        .collect();
                    self.cost_warning = Some(Warning::QualityReduced {
                        what,
                        triangles,
                        covered_px,
                    });
                }
                return Some(plan);
            }
            let Some(step) = steps.next() else {
                self.cost_warning = Some(Warning::TooCostly {
                    triangles: cost.triangles,
                    covered_px: cost.covered_px,
                });
                return None;
            };
            self.quality_reductions.push(*step);
        }
    }

    /// Counts the work of a new view, which is less than that of a new scene.
    fn cost(&self, plan: &Plan, footprint: &Footprint, covered: &Covered, divisor: u32) -> Cost {
        let gpu = Gpu::default();
        let globals = globals(&footprint.view, &plan.region, &self.layout())
            .with_boxes(&plan.toy_box, &plan.physical_box)
            .with_reflection(self.reflection_channel());
        let toy = (&self.toy.physical.around, self.toy.n_materials());
        let state = SceneState::new(&gpu, grids_over(&self.reached_rects), plan.n_lights, toy);
        let light_points = self.light_points(plan, &footprint.view);
        let mut model = Model::new(&gpu, plan.clone(), &globals, light_points, state);
        let frame = Texture::target(&gpu, "frame", plan.region.size_px, REGION_FORMAT);
        let pictures = Pictures {
            things: None,
            people: None,
            grain: None,
            frame: Frame::Picture(Picture {
                light: &frame.view,
                codes: &frame.view,
            }),
            n_before: 0,
            exposure_ratio: 1.0,
            plates: &self.plates.pictures.view,
            plate_views: &self.plates.views,
            is_same_view: footprint.choice.is_same_view,
        };
        let mut recorder = Recorder::new(&gpu, None);
        let delta = FrameDelta {
            change: Change::View,
            is_pose_new: true,
            keeps_sharpness: false,
        };
        model.update_coverage_tiles(&self.toy, delta);
        model.encode(&mut recorder, &self.toy, &pictures, delta);
        self.toy.forget_lists();
        let count = |n: usize| n as f64;
        let by_lights = plan.n_light_points.iter().zip(&covered.by_lights_px);
        let by_lights: f64 = by_lights.map(|(n_points, px)| count(*n_points) * px).sum();
        let texel_px = f64::from(divisor * divisor);
        Cost {
            triangles: recorder.submit().ran.iter().map(|run| run.work.triangles()).sum(),
            covered_px: by_lights
                + count(plan.n_ambient_directions) * covered.from_above_px / texel_px
                + N_CAMERA_DRAWS * covered.by_camera_px,
        }
    }

    /// Covered pixels of the shown pose, on the first receiver; half of the triangles face away.
    fn covered(&self, footprint: &Footprint) -> Covered {
        let (layout, view) = (self.layout(), &footprint.view);
        let world_from_anchor = layout.world_from_anchor();
        let most_px = n_pixels(footprint.region.size_px) as f64;
        let image_px = |point: DVec3| {
            let at = view.image_px_from(&world_from_anchor, point.extend(1.0));
            (at.z > 0.0).then(|| at.truncate() / at.z)
        };
        let points: Vec<DVec3> = self.posed.points().collect();
        let sum = |place: &dyn Fn(DVec3) -> Option<DVec2>| -> f64 {
            let places: Vec<Option<DVec2>> = points.iter().map(|point| place(*point)).collect();
            let triangles = self.scene.toy.indices().as_chunks().0.iter();
            let areas =
                triangles.map(|corners: &[u32; 3]| area_px(corners.map(|corner| places[corner as usize])));
            0.5 * areas
                .map(|area| area.unwrap_or(most_px).min(most_px))
                .sum::<f64>()
        };
        let above = Vec4::new(0.0, 1.0, 0.0, 0.0);
        let shadow_px = |light: Vec4| sum(&|point| image_px(flattened(point, light.as_dvec4())?));
        let lights = self.lights.used.iter();
        let first_points = lights.filter_map(|light| self.points_of(light, 16).first().copied());
        Covered {
            by_camera_px: sum(&image_px),
            by_lights_px: first_points.map(shadow_px).collect(),
            from_above_px: shadow_px(above),
        }
    }
}

/// The shadow of a point on the plane y = 0; `None` if the point is at least as high as the light.
fn flattened(point: DVec3, light: DVec4) -> Option<DVec3> {
    let height = light.y - point.y * light.w;
    (height > 0.0).then(|| point - (light.truncate() - point * light.w) * (point.y / height))
}

/// Area of a triangle; `None` if one of its corners is not visible.
fn area_px([a, b, c]: [Option<DVec2>; 3]) -> Option<f64> {
    let (a, b, c) = (a?, b?, c?);
    Some(0.5 * (b - a).perp_dot(c - a).abs())
}
