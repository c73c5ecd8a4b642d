//! A scene on the device: the toy, the plates, the frame and the state learned from them.

pub(crate) mod camera_texture;
mod cost_limit;
mod footprint;
mod glossy;
mod marks;
pub(crate) mod method;
mod output;
mod people;
mod placement;
mod reflection;
mod reuse;
mod soft;
mod style;
mod supported;

use std::sync::{Arc, OnceLock};

use glam::{DMat4, UVec2};

use crate::frame::FrameReport;
use crate::frame::warning::Warning;
use crate::geometry::anchored::AnchoredReceiver;
use crate::geometry::clip_reach::ClipReach;
use crate::geometry::outline::Outline;
use crate::geometry::rect::{PixelRect, PlaneRect};
use crate::geometry::scene_layout::SceneLayout;
use crate::geometry::view::View;
use crate::governor::QualityStep;
use crate::gpu::{Gpu, GpuError, Recorder, Texture, n_pixels};
use crate::passes::pictures::{Frame, PictureGrain, Pictures};
use crate::passes::present;
use crate::passes::thing_marks::Things;
use crate::passes::toy_mesh::{Casting, ToyMesh};
use crate::plan::{Change, FrameDelta, SkippedWork};
use crate::plates::store::PlateStore;
use crate::preset::Settings;
use crate::readback::decoding::Decoding;
use crate::readback::inject::InjectedVisibility;
use crate::readback::{FloatMap, Map};
use app_scene::camera_frame::CameraImage;
use app_scene::frame::FrameInput;
use app_scene::geometry::bounds::Bounds;
use app_scene::geometry::nearest_receivers::corners_in_world;
use app_scene::gloss::Gloss;
use app_scene::reflection::Reflection;
use app_scene::scene::{Camera, Image, Scene};
use app_scene::shadow_style::ShadowStyle;
use app_scene::sharpness::Sharpness;
use app_scene::things::Things as GivenThings;
use app_scene::toy;
use app_scene::toy::{PosedMesh, Toy, ToyError};

use camera_texture::CameraTexture;
use footprint::Footprint;
use method::Method;
use people::Crowd;
use supported::{Lights, Receivers};

/// A scene on the device.
pub(crate) struct Stage {
    scene: Arc<Scene>,
    settings: Settings,
    receivers: Vec<AnchoredReceiver>,
    /// Indices of `receivers` in the scene's list.
    receiver_indices: Vec<usize>,
    receivers_warning: Option<Warning>,
    lights: Lights,
    /// Lights inside the physical toy, as indices in the given list; `None` until it is computed.
    lights_inside: Option<Vec<usize>>,
    /// Pose of the object at the time of learning.
    world_from_object: DMat4,
    /// Whether the physical pose on the device is that one.
    is_object_placed: bool,
    /// Bounds of the physical pose, in object space.
    bounds_in_object: Bounds,
    /// Bounds of the physical pose, in anchor space.
    physical_bounds: Bounds,
    physical_outline: Outline,
    is_shadow_withheld: bool,
    /// Whether a repeated pose counts as a new one.
    is_every_pose_new: bool,
    /// Quality steps that the caller requests.
    asked_down: Vec<QualityStep>,
    /// Quality steps that are applied because the scene exceeds the cost budget.
    quality_reductions: Vec<QualityStep>,
    /// The warning for it.
    cost_warning: Option<Warning>,
    /// Size, in steps, of a region for which the scene is too costly at any quality, as long as
    /// placement and settings stay the same.
    refused_steps: Option<UVec2>,
    /// Reach of the clip that was shown last, including the poses shown so far.
    reach: Option<ClipReach>,
    /// Footprint of the latest frame.
    cached_footprint: Option<Arc<Footprint>>,
    toy: ToyMesh,
    posed: PosedMesh,
    camera: CameraTexture,
    plates: PlateStore,
    /// Things beside the toy in the latest picture.
    things: Option<Things>,
    /// People in the latest picture.
    people: Crowd,
    present: present::Pass,
    state: Option<MethodState>,
    /// Part of each receiver that the clips shown so far reach.
    reached_rects: Vec<PlaneRect>,
    /// Sharpness of the latest picture.
    sharpness: Sharpness,
    /// Gloss of the toy.
    gloss: Gloss,
    /// Reflection of the first receiver, as given by the latest frame.
    reflection: Option<Reflection>,
    /// Style of the latest frame's shadow.
    shadow_style: ShadowStyle,
    /// Style of the shadow that was drawn last.
    drawn_style: ShadowStyle,
    /// Share of the region's picture that the frame shows; `None` if the camera image is shown.
    effect: Option<f64>,
    /// The latest frame's noise.
    grain: Option<PictureGrain>,
    /// Whether frames that could pass through are computed, since their layers were requested.
    is_layered: bool,
    /// The picture as a texture, once it was requested.
    output: OnceLock<Texture>,
    /// The picture in linear light, once it was requested.
    output_light: OnceLock<Texture>,
    /// The device's decoding of codes, once it was requested.
    decoding: OnceLock<Decoding>,
}

/// The method with its state, and the latest frame from which it learned.
struct MethodState {
    method: Method,
    view: View,
    /// Relative exposure of `image`.
    exposure: f64,
    /// Number of pictures from which the method learned.
    n_pictures: u32,
    image: Option<CameraImage>,
    /// Lights at the time of learning, as indices in the list that was given.
    light_indices: Vec<usize>,
    /// Whether the method learned from one view alone.
    is_first_view: bool,
    /// Whether visibilities were injected after learning.
    is_visibility_outdated: bool,
    /// Things beside the toy at the time of learning.
    things: Option<GivenThings>,
    /// People in the picture that was learned last.
    people: Option<GivenThings>,
    /// Whether settings were turned down or up after learning.
    are_settings_outdated: bool,
    /// Whether the object or the lights moved after learning.
    is_placement_outdated: bool,
}

/// Meshes that cast the toy's shadows. The baseline draws the whole mesh, as published.
fn casting(toy: &Toy, settings: Settings) -> Casting<'_> {
    let settings = match settings {
        Settings::Model(settings) => Some(settings),
        Settings::Baseline(_) => None,
    };
    Casting {
        simplified: match settings {
            Some(settings) if settings.caster_px.is_some() => toy.casters(),
            _ => &[],
        },
        is_culled: settings.is_some(),
    }
}

impl Stage {
    pub(crate) fn new(
        gpu: &Gpu,
        scene: Arc<Scene>,
        settings: Settings,
        toy_in_object: &toy::Bounds,
    ) -> Result<Self, ToyError> {
        let bounds_in_object = Bounds {
            min: toy_in_object.min.as_dvec3(),
            max: toy_in_object.max.as_dvec3(),
        };
        let toy_in_world = scene
            .world_from_object
            .transform_point3(bounds_in_object.centre());
        let corners_in_world = corners_in_world(toy_in_object, &scene.world_from_object);
        let receivers = Receivers::new(&scene.receivers, toy_in_world, &corners_in_world);
        let anchor_from_object = receivers.anchored[0].world_from_plane.inverse() * scene.world_from_object;
        let mut posed = PosedMesh::default();
        scene
            .toy
            .pose(&scene.physical_pose, &anchor_from_object, &mut posed)?;
        let size_px = UVec2::new(scene.width_px, scene.height_px);
        Ok(Self {
            bounds_in_object,
            physical_bounds: Bounds::around(posed.points()),
            physical_outline: Outline::around(&posed),
            toy: ToyMesh::new(gpu, &scene.toy, &posed, &casting(&scene.toy, settings)),
            posed,
            camera: CameraTexture::new(size_px),
            plates: PlateStore::new(gpu, &scene, &receivers.anchored),
            things: None,
            people: Crowd::default(),
            present: present::Pass::new(gpu),
            state: None,
            reached_rects: Vec::new(),
            sharpness: Sharpness::SHARP,
            gloss: Gloss::NONE,
            reflection: None,
            shadow_style: ShadowStyle::TRUE,
            drawn_style: ShadowStyle::TRUE,
            lights_inside: None,
            lights: Lights::new(&scene.lights, &receivers.anchored),
            receivers: receivers.anchored,
            receiver_indices: receivers.indices,
            receivers_warning: receivers.warning,
            effect: None,
            grain: None,
            is_layered: false,
            output: OnceLock::new(),
            output_light: OnceLock::new(),
            decoding: OnceLock::new(),
            settings,
            world_from_object: scene.world_from_object,
            is_object_placed: true,
            scene,
            is_shadow_withheld: false,
            is_every_pose_new: false,
            quality_reductions: Vec::new(),
            asked_down: Vec::new(),
            cost_warning: None,
            refused_steps: None,
            reach: None,
            cached_footprint: None,
        })
    }

    /// Hides the real shadow from learning from the next frame on, and drops the learned state.
    pub(crate) fn withhold_shadow(&mut self) {
        if matches!(self.settings, Settings::Model(_)) {
            self.is_shadow_withheld = true;
            self.state = None;
        }
    }

    /// Draws repeated poses as if they were new.
    pub(crate) fn draw_every_pose(&mut self) {
        self.is_every_pose_new = true;
    }

    /// The scene that is staged.
    pub(crate) fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Waits for the device and returns a map, if the method makes it.
    pub(crate) fn read_map(&self, gpu: &Gpu, map: Map) -> Result<Option<FloatMap>, GpuError> {
        let Some(method) = self.method() else {
            return Ok(None);
        };
        method.read_map(gpu, self.learned_image(), map)
    }

    /// The method with its learned state, if there is any.
    pub(crate) fn method(&self) -> Option<&Method> {
        self.state.as_ref().map(|state| &state.method)
    }

    /// Lights at the time of learning, as indices in the list that was given.
    pub(crate) fn light_indices(&self) -> &[usize] {
        self.state.as_ref().map_or(&[], |state| &state.light_indices)
    }

    /// Lights inside the physical toy, as indices in the list that was given.
    pub(crate) fn lights_inside(&self) -> &[usize] {
        self.lights_inside.as_deref().unwrap_or_default()
    }

    /// Whether the method learned from one view at most.
    pub(crate) fn is_first_view(&self) -> bool {
        self.state.as_ref().is_some_and(|state| state.is_first_view)
    }

    /// Whether the view that was learned last shows the real toy.
    pub(crate) fn is_toy_in_picture(&self) -> bool {
        let view = self.state.as_ref().map(|state| &state.view);
        view.is_some_and(|view| self.shows_toy(view))
    }

    /// Whether the physical toy is in the picture.
    fn shows_toy(&self, view: &View) -> bool {
        self.physical_toy_in(view).is_some()
    }

    /// The pixels of the image that can show the physical toy.
    fn physical_toy_in(&self, view: &View) -> Option<PixelRect> {
        view.image_rect(&self.layout().world_from_anchor(), self.physical_outline.points())
    }

    /// The picture that was learned last.
    pub(crate) fn learned_image(&self) -> Option<&Image> {
        Some(self.state.as_ref()?.image.as_ref()?.rgba())
    }

    /// Indices, in the scene's list, of the receivers in use.
    pub(crate) fn receiver_indices(&self) -> &[usize] {
        &self.receiver_indices
    }

    /// Drops the learned state and the uploads, which a refused frame may have left incomplete.
    pub(crate) fn forget(&mut self, gpu: &Gpu) {
        self.drop_method(gpu);
        self.camera.forget();
        self.plates.forget();
        self.things = None;
        self.people = Crowd::default();
        self.is_object_placed = false;
    }

    /// Drops the method with its targets, which the cached bind groups also refer to.
    fn drop_method(&mut self, gpu: &Gpu) {
        self.state = None;
        gpu.release_groups();
    }

    /// Replaces visibilities in later frames, if anything has been learned.
    pub(crate) fn inject(&mut self, gpu: &Gpu, maps: &InjectedVisibility) {
        if let Some(state) = &mut self.state {
            state.method.inject(gpu, maps);
            state.is_visibility_outdated = true;
        }
    }

    /// Encodes one frame. If its pose or placement is refused, the camera image is shown.
    pub(crate) fn encode(
        &mut self,
        recorder: &mut Recorder<'_>,
        input: &FrameInput,
    ) -> Result<FrameReport, ToyError> {
        self.effect = None;
        recorder.stages.begin("camera picture");
        self.camera.take(recorder.gpu, &input.image);
        recorder.stages.begin("placement");
        self.follow_placement(recorder.gpu, input)?;
        let about_scene = self
            .receivers_warning
            .iter()
            .chain(&self.lights.warnings)
            .cloned();
        let inside = self.lights_inside().to_vec();
        let about_lights = (!inside.is_empty()).then_some(Warning::LightsInsideToy { lights: inside });
        let mut report = FrameReport {
            ran: Vec::new(),
            uploaded_bytes: 0,
            stages: Vec::new(),
            change: None,
            skipped: Vec::new(),
            region: None,
            warnings: about_scene.chain(about_lights).collect(),
        };
        recorder.stages.begin("pose and footprint");
        self.take_shadow_style(input);
        match self.footprint(input)? {
            Err(reason) => reason.tell(&mut report),
            Ok(footprint) => {
                self.encode_region(recorder, input, &footprint, &mut report);
                self.effect = Some(input.effect);
            }
        }
        Ok(report)
    }

    fn encode_region(
        &mut self,
        recorder: &mut Recorder<'_>,
        input: &FrameInput,
        footprint: &Footprint,
        report: &mut FrameReport,
    ) {
        let gpu = recorder.gpu;
        let is_pose_new = self.take_shown_pose(gpu);
        recorder.stages.begin("reuse");
        self.take_things(gpu, input);
        self.take_people(gpu, input, footprint);
        self.take_gloss(gpu, input);
        let (change, keeps_sharpness) = self.update_method(gpu, input, footprint);
        self.style_shadow(gpu, change);
        report.warnings.extend(self.cost_warning.clone());
        recorder.stages.begin("encode");
        let Some(state) = &mut self.state else {
            return;
        };
        #[allow(clippy::cast_possible_truncation, reason = "both within 1e9 of 1")]
        let exposure_ratio = (input.exposure / state.exposure) as f32;
        let n_before = state.n_pictures;
        if change >= Change::Picture {
            state.n_pictures = n_before.wrapping_add(1);
            state.exposure = input.exposure;
            state.image = Some(input.image.clone());
        }
        let delta = FrameDelta {
            change,
            is_pose_new,
            keeps_sharpness,
        };
        state.method.update_coverage_tiles(&self.toy, delta);
        let Some(MethodState { method, .. }) = &self.state else {
            return;
        };
        if change >= Change::Picture {
            let views = match method {
                Method::Model(_) => footprint.plate_views,
                Method::Baseline(_) => self.plate_views_at_exposure_of(input, footprint),
            };
            gpu.write(&self.plates.views, &[views]);
        }
        // The region of the marks depends on the view.
        if change >= Change::View {
            let world_from_plane = self.layout().world_from_anchor();
            for things in self.things.iter().chain(self.people.marks()) {
                things.follow(gpu, &footprint.view, &method.region(), &world_from_plane);
            }
        }
        recorder.n_pixels = n_pixels(method.region().size_px);
        let frame = match method {
            Method::Model(_) => self.camera.frame(gpu),
            // Its pass `retarget` filters linear light of the whole picture.
            Method::Baseline(_) => Frame::Picture(self.camera.keep_decoded(recorder)),
        };
        let picture = self.state.as_ref().map_or(0, |state| state.n_pictures);
        self.grain = input.grain.map(|grain| PictureGrain { grain, picture });
        let pictures = Pictures {
            frame,
            grain: self.grain,
            n_before,
            exposure_ratio,
            plates: &self.plates.pictures.view,
            plate_views: &self.plates.views,
            is_same_view: footprint.choice.is_same_view,
            things: self.things.as_ref(),
            people: self.people.marks(),
        };
        method.encode(recorder, &self.toy, &pictures, delta);
        report.skipped.extend(skipped(delta));
        report.skipped.extend_from_slice(method.skipped());
        report.region = Some(method.region());
        report.change = Some(change);
        report.warnings.extend(self.plate_warning(footprint));
        report.warnings.extend(self.light_warning());
        report.warnings.extend(self.thing_warnings());
        report.warnings.extend(self.surface_warnings());
        if !self.shows_toy(&footprint.view) {
            report.warnings.push(Warning::ToyOutOfPicture);
        }
    }

    /// Uploads the shown pose if it or its shadow's style changed. Returns whether to draw it.
    fn take_shown_pose(&mut self, gpu: &Gpu) -> bool {
        // After a refused frame nothing is known, and its pose may not have been uploaded.
        let is_known =
            self.state.is_some() && self.toy.shown.is(&self.posed) && self.drawn_style == self.shadow_style;
        let is_new = self.is_every_pose_new || !is_known;
        if is_new {
            self.toy.shown.write(gpu, &self.posed);
        }
        is_new
    }

    fn layout(&self) -> SceneLayout<'_> {
        SceneLayout {
            receivers: &self.receivers,
            lights: &self.lights.used,
            toy_in_anchor: self.toy_in_anchor(),
        }
    }

    fn view(&self, camera: &Camera) -> View {
        View::new(self.size_px(), camera)
    }

    /// Size of each picture.
    fn size_px(&self) -> UVec2 {
        UVec2::new(self.scene.width_px, self.scene.height_px)
    }
}

/// Work that a frame does not need.
fn skipped(delta: FrameDelta) -> impl Iterator<Item = SkippedWork> {
    let pose = delta.keeps_pose().then_some(SkippedWork {
        what: "shadows of the shown pose",
        reason: "it is the one that is there",
    });
    let is_known = delta.change < Change::View && delta.keeps_sharpness;
    let capture = is_known.then_some(SkippedWork {
        what: "capture path",
        reason: "scene, pose and camera are known",
    });
    pose.into_iter().chain(capture)
}
