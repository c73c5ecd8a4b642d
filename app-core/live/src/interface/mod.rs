//! The app's interface: screens for touch over the camera's picture, drawn by egui, the same on
//! phones and on a desktop.
//!
//! It reads the [`App`] and returns what the person does; it stores only the fingers' positions and
//! the open menu. Sizes are in points of the platform, and no touch target is lower than 44 of
//! them.

mod check;
mod input;
mod overlay;
mod painter;
mod parts;
mod picture;
mod play;
mod screens;
mod style;
mod text;
mod words;

use egui::{CentralPanel, Context, Frame};

use crate::app::{App, Step, UserAction};

pub use egui::accesskit;
pub use input::{Insets, Screen, Touch, TouchPhase};
pub(crate) use painter::Painter;
pub use text::{announced, of_closed, of_no_graphics, of_stopped};
pub use words::all_words;

/// A font of 18 KB: Roboto Medium, Copyright 2015 Google, Apache License 2.0, reduced to Latin
/// letters and signs.
const FONT: &[u8] = include_bytes!("roboto_medium.ttf");

/// The shapes to paint over the picture.
pub(crate) struct Painting {
    pub(crate) primitives: Vec<egui::ClippedPrimitive>,
    pub(crate) pixels_per_point: f32,
}

/// Textures that the painter lacks, and those that it may release.
#[derive(Default)]
pub(crate) struct Textures {
    pub(crate) set: Vec<(egui::TextureId, egui::epaint::ImageDelta)>,
    pub(crate) free: Vec<egui::TextureId>,
}

impl Textures {
    fn add(&mut self, mut delta: egui::TexturesDelta) {
        for (id, deltas) in delta.set.drain() {
            self.set.extend(deltas.into_iter().map(|delta| (id, delta)));
        }
        self.free.extend(delta.free.drain());
    }
}

/// A widget that a screen reader finds.
#[derive(Clone, Debug, PartialEq)]
pub struct Widget {
    /// The role, such as `Button` or `Label`.
    pub role: String,
    /// The text that is read out.
    pub label: String,
    /// Left, top, right and bottom, in physical pixels of the screen.
    pub bounds_px: [f64; 4],
}

/// The interface.
pub struct Interface {
    context: Context,
    widgets: Vec<Widget>,
    tree: Option<accesskit::TreeUpdate>,
    /// Actions of a screen reader since the last picture.
    requests: Vec<accesskit::ActionRequest>,
    textures: Textures,
    touches: input::Touches,
    is_menu_open: bool,
    time_s: f64,
}

impl Default for Interface {
    fn default() -> Self {
        let context = Context::default();
        style::apply(&context, FONT);
        context.enable_accesskit();
        Self {
            context,
            widgets: Vec::new(),
            tree: None,
            requests: Vec::new(),
            textures: Textures::default(),
            touches: input::Touches::default(),
            is_menu_open: false,
            time_s: 0.0,
        }
    }
}

impl Interface {
    /// A finger, or a mouse as one finger.
    pub fn touch(&mut self, touch: Touch) {
        self.touches.touch(touch);
    }

    /// The wheel of a mouse over the picture, in steps; it turns the ghost.
    pub fn wheel(&mut self, steps: f64) {
        self.touches.wheel(steps);
    }

    /// Closes the menu, if it is open.
    pub(crate) fn close_menu(&mut self) -> bool {
        std::mem::take(&mut self.is_menu_open)
    }

    /// One picture of the interface at `time_s`, which continues from call to call, and the
    /// person's actions.
    pub(crate) fn run(
        &mut self,
        app: &App,
        screen: &Screen,
        time_s: f64,
        profile: &str,
    ) -> (Vec<UserAction>, Painting) {
        let (actions, shapes, pixels_per_point) = self.laid_out(app, screen, time_s, profile);
        let painting = Painting {
            primitives: self.context.tessellate(shapes, pixels_per_point),
            pixels_per_point,
        };
        (actions, painting)
    }

    /// Changes of the textures since the last call.
    pub(crate) fn take_textures(&mut self) -> Textures {
        std::mem::take(&mut self.textures)
    }

    /// The person's actions, without a picture.
    pub fn actions(&mut self, app: &App, screen: &Screen) -> Vec<UserAction> {
        self.time_s += 0.1;
        self.laid_out(app, screen, self.time_s, "").0
    }

    fn laid_out(
        &mut self,
        app: &App,
        screen: &Screen,
        time_s: f64,
        profile: &str,
    ) -> (Vec<UserAction>, Vec<egui::epaint::ClippedShape>, f32) {
        self.time_s = time_s;
        let mut actions = Vec::new();
        let wheel_steps = self.touches.take_wheel();
        let mut input = self.touches.input(screen, time_s);
        let requests = self.requests.drain(..);
        input
            .events
            .extend(requests.map(egui::Event::AccessKitActionRequest));
        let is_menu_open = &mut self.is_menu_open;
        if app.step() != Step::Play {
            *is_menu_open = false;
        }
        let mut output = self.context.run_ui(input, |ui| {
            CentralPanel::default().frame(Frame::NONE).show(ui, |ui| {
                picture::show(ui, app, screen, wheel_steps, &mut actions);
                let notice = screens::notice(ui, app);
                if app.shows_profile() {
                    screens::profile(ui, profile, notice);
                }
                screens::sheet(ui, app, is_menu_open, &mut actions);
            });
        });
        self.widgets = widgets(&output.platform_output, output.pixels_per_point);
        self.tree = output.platform_output.accesskit_update.take();
        self.textures.add(output.textures_delta);
        (actions, output.shapes, output.pixels_per_point)
    }

    /// The whole tree of the latest picture for a screen reader; `None` before the first one.
    #[must_use]
    pub fn accessibility_tree(&self) -> Option<&accesskit::TreeUpdate> {
        self.tree.as_ref()
    }

    /// An action of a screen reader.
    pub fn request(&mut self, request: accesskit::ActionRequest) {
        self.requests.push(request);
    }

    /// The widgets for a screen reader in the latest picture.
    #[must_use]
    pub fn widgets(&self) -> &[Widget] {
        &self.widgets
    }
}

/// Labels and places of the widgets in the interface's accessibility tree.
fn widgets(output: &egui::PlatformOutput, pixels_per_point: f32) -> Vec<Widget> {
    let update = output.accesskit_update.as_ref();
    let nodes = update.map(|update| update.nodes.as_slice()).unwrap_or_default();
    let told = nodes.iter().filter_map(|(_, node)| {
        let bounds = node.bounds()?;
        Some(Widget {
            role: format!("{:?}", node.role()),
            label: node.label().or(node.value())?.to_owned(),
            bounds_px: [bounds.x0, bounds.y0, bounds.x1, bounds.y1]
                .map(|at| at * f64::from(pixels_per_point)),
        })
    });
    told.collect()
}

impl std::fmt::Debug for Interface {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Interface")
    }
}
