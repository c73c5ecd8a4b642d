//! The app's present moment as a session of one frame: its replay is a page with all presets side
//! by side, the maps and times, and a picture of the lights.

use std::path::Path;
use std::sync::Arc;

use app_core::Core;
use app_core::app::{App, Show};
use app_core::frame::FrameInput;
use app_core::gpu::AdapterChoice;
use app_core::preset::Preset;
use app_core::scene::{Image, Scene};
use app_core::session::{Session, SessionError, SessionFrame, SessionWarning};
use app_core::wgpu;

use desk::gizmo;
use desk::gizmo::Gizmo;
use desk::output::folder::OutputFolder;
use desk::page::PAGE_FILE;
use desk::progress::Quiet;
use desk::replay::{Options, replay};

/// Picture of the lights, beside the page.
const LIGHTS_FILE: &str = "lights.png";

/// A moment of the app.
pub struct Moment {
    scene: Scene,
    frame: SessionFrame,
}

impl Moment {
    /// The present moment; `None` while the toy does not move.
    #[must_use]
    pub fn of(app: &App) -> Option<Self> {
        let Show::Toy { scene, input, .. } = app.show() else {
            return None;
        };
        let mut scene = Scene::clone(scene);
        if let Some(lights) = &input.lights {
            scene.lights = lights.to_vec();
        }
        // The lights are known already; a probe would be evaluated again.
        scene.probe = None;
        let frame = SessionFrame {
            time_secs: 0.0,
            image: Arc::clone(input.image.rgba()),
            camera: input.camera,
            world_from_object: input.world_from_object,
            exposure: input.exposure,
            light_estimate: input.light_estimate,
            depth: input.depth.clone(),
            people: input.people.clone(),
            shown_pose: input.shown_pose,
            world_from_shown: input.world_from_shown,
            warnings: Vec::new(),
        };
        Some(Self { scene, frame })
    }

    /// Draws it with every preset on its own device, without alignment, and writes the page into a
    /// folder; returns the page's path.
    ///
    /// # Errors
    /// When there is no device, a preset refuses, or nothing can be written.
    pub fn write(&self, folder: &Path) -> anyhow::Result<std::path::PathBuf> {
        let instance = wgpu::Instance::default();
        let mut core = pollster::block_on(Core::headless(&instance, &AdapterChoice::Fastest))?;
        let options = Options {
            presets: Preset::ALL.to_vec(),
            out: Some(folder.to_owned()),
            is_aligned: false,
            ..Options::default()
        };
        replay(self, None, &mut core, &options, &mut Quiet)?;
        self.draw_lights(&OutputFolder::reopen(folder)?)?;
        Ok(folder.join(PAGE_FILE))
    }

    /// The lights of the picture, as rays from the toy's centre.
    fn draw_lights(&self, folder: &OutputFolder) -> anyhow::Result<()> {
        let mut picture = Image::clone(&self.frame.image);
        let input = FrameInput::from(&self.frame);
        let lights = Gizmo::listed(&self.scene, &input);
        gizmo::rays(&mut picture, (&self.scene, &input), &lights, gizmo::FOUND);
        folder.write_png(LIGHTS_FILE, &picture)?;
        Ok(())
    }
}

impl Session for Moment {
    fn scene(&self) -> &Scene {
        &self.scene
    }

    fn warnings(&self) -> &[SessionWarning] {
        &[]
    }

    fn n_frames(&self) -> usize {
        1
    }

    fn frame(&self, _: usize) -> Result<SessionFrame, SessionError> {
        Ok(self.frame.clone())
    }
}
