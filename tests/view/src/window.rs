//! The app in a window.

use std::sync::Arc;
use std::time::{Duration, Instant};

use anyhow::{Context, Result};
use app_core::Core;
use app_core::app::{GraphicsState, ShellEvent};
use app_core::interface::{Insets, Screen, Touch, TouchPhase};
use app_core::live::Live;
use app_core::preset::Preset;
use app_core::wgpu;
use app_shell::record::clock;
use app_shell::starts;
use app_shell::worker::Pace;
use winit::application::ApplicationHandler;
use winit::dpi::{LogicalSize, PhysicalPosition, PhysicalSize};
use winit::event::{ElementState, MouseButton, MouseScrollDelta, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::keyboard::{Key, NamedKey};
use winit::window::{Window, WindowId};

use desk::shaders::ShaderFolder;

use super::desktop::{Desk, Keeping};
use super::fault::Fault;
use super::feed::Feed;

/// Time between two camera frames.
const FRAME: Duration = Duration::from_millis(33);
/// Duration of a fault.
const FAULT_S: f64 = 5.0;
/// Interval between two checks of the shaders' files.
const LOOK: Duration = Duration::from_secs(1);
/// The mouse as a finger.
const MOUSE: u64 = 0;

/// Options of the window.
pub struct Options {
    /// How much work a frame may cost.
    pub preset: Preset,
    /// Width and height in points.
    pub size_points: [u32; 2],
    /// Faults, and their times in seconds.
    pub faults: Vec<(Fault, f64)>,
    /// Scale of letters; 1 is usual.
    pub text_scale: f64,
    /// Frames per second to keep.
    pub hold: Option<u32>,
    /// The user's files.
    pub keeping: Keeping,
    /// Shaders in place of the built-in ones, reloaded when they change.
    pub shaders: Option<ShaderFolder>,
    /// Number of seconds after which the window closes by itself.
    pub seconds: Option<f64>,
}

/// Opens the window, and returns when it is closed.
///
/// # Errors
/// When there is no display, no device, or the device is lost for good.
pub fn open(feed: Feed, options: Options) -> Result<()> {
    let event_loop = EventLoop::new().context("no display to open a window on; --tour needs none")?;
    let mut app = Shell {
        instance: wgpu::Instance::default(),
        start: Instant::now(),
        last_frame: None,
        last_look: None,
        feed: Some(feed),
        pressed_at: None,
        options,
        opened: None,
        result: Ok(()),
    };
    event_loop.run_app(&mut app)?;
    if let Some(Opened { desk, .. }) = &mut app.opened {
        desk.close();
    }
    app.result
}

struct Opened {
    window: Arc<Window>,
    desk: Desk,
}

struct Shell {
    instance: wgpu::Instance,
    start: Instant,
    last_frame: Option<Instant>,
    last_look: Option<Instant>,
    feed: Option<Feed>,
    /// Position of the mouse, and whether it is pressed.
    pressed_at: Option<(PhysicalPosition<f64>, bool)>,
    options: Options,
    opened: Option<Opened>,
    result: Result<()>,
}

impl Shell {
    fn open(&mut self, event_loop: &ActiveEventLoop) -> Result<()> {
        let Some(feed) = self.feed.take() else {
            return Ok(());
        };
        let [width, height] = self.options.size_points;
        let attributes = Window::default_attributes()
            .with_title("Shadow retargeting")
            .with_inner_size(LogicalSize::new(width, height));
        let window = Arc::new(event_loop.create_window(attributes)?);
        // Before any call of a driver.
        let history = starts::begin(&self.options.keeping.out, false);
        let core = self.core_on(&window)?;
        let mut live = Live::new(core, Arc::clone(&feed.scene().toy), self.options.preset);
        self.options
            .hold
            .into_iter()
            .for_each(|hold| live.set_target_fps(hold));
        live.set_clock(clock());
        let mut desk = Desk::new(live, feed, self.options.keeping.clone(), Pace::Live);
        desk.tell(ShellEvent::Started(history));
        desk.tell(ShellEvent::Foreground(true));
        desk.tell(ShellEvent::Surface(Some(window.inner_size().into())));
        self.opened = Some(Opened { window, desk });
        Ok(())
    }

    fn core_on(&self, window: &Arc<Window>) -> Result<Core> {
        let surface = self.instance.create_surface(Arc::clone(window))?;
        let size_px = window.inner_size().into();
        Ok(pollster::block_on(Core::on_surface(
            &self.instance,
            surface,
            size_px,
        ))?)
    }

    /// Draws one picture.
    fn draw(&mut self) -> Result<()> {
        self.strike_faults();
        self.reopen_device()?;
        self.follow_shaders();
        let now = Instant::now();
        let Some(Opened { window, desk }) = &mut self.opened else {
            return Ok(());
        };
        let elapsed = self.last_frame.map_or(FRAME, |last| now - last);
        if elapsed >= FRAME || self.last_frame.is_none() {
            self.last_frame = Some(now);
            desk.feed.follow(desk.live.app().step());
            desk.tick(elapsed.as_secs_f64());
        }
        let screen = Screen {
            size_px: window.inner_size().into(),
            pixels_per_point: window.scale_factor(),
            insets: Insets::default(),
            text_scale: self.options.text_scale,
        };
        let time_s = (now - self.start).as_secs_f64();
        if let Err(error) = desk.present(&screen, time_s) {
            eprintln!("nothing is drawn: {error}");
            desk.tell(ShellEvent::Graphics(GraphicsState::Lost));
        }
        Ok(())
    }

    fn reopen_device(&mut self) -> Result<()> {
        let Some(opened) = &mut self.opened else {
            return Ok(());
        };
        if !std::mem::take(&mut opened.desk.wants_device) {
            return Ok(());
        }
        // A window has one surface at a time.
        opened.desk.live.core_mut().suspend();
        let window = Arc::clone(&opened.window);
        let core = self.core_on(&window)?;
        if let Some(opened) = &mut self.opened {
            opened.desk.live.reopen(core);
        }
        // Another device begins with the built-in shaders.
        self.last_look = None;
        self.options.shaders.iter_mut().for_each(ShaderFolder::forget);
        Ok(())
    }

    /// Draws with changed shaders; refused ones are reported, and the latest good ones stay.
    fn follow_shaders(&mut self) {
        let (Some(folder), Some(Opened { desk, .. })) = (&mut self.options.shaders, &mut self.opened) else {
            return;
        };
        if self.last_look.is_some_and(|last| last.elapsed() < LOOK) {
            return;
        }
        self.last_look = Some(Instant::now());
        let replaced = folder.changed().map(|read| {
            let texts = read?;
            let replaced = desk.live.replace_shaders(texts);
            replaced.map_err(|error| error.to_string())
        });
        match replaced {
            Some(Ok(())) => println!("drawing with changed shaders"),
            Some(Err(error)) => eprintln!("the shaders stay as they were: {error}"),
            None => {}
        }
    }

    fn strike_faults(&mut self) {
        let time_s = self.start.elapsed().as_secs_f64();
        let Some(Opened { desk, .. }) = &mut self.opened else {
            return;
        };
        self.options.faults.retain_mut(|(fault, at_s)| {
            if *at_s > 0.0 && time_s >= *at_s {
                let event = fault.strikes(&mut desk.feed);
                event.into_iter().for_each(|event| desk.tell(event));
                // From now on the fault's end, as a negative number.
                *at_s = -(time_s + FAULT_S);
            } else if *at_s < 0.0 && time_s >= -*at_s {
                let event = fault.passes(&mut desk.feed);
                event.into_iter().for_each(|event| desk.tell(event));
                return false;
            }
            true
        });
    }

    fn resize(&mut self, size: PhysicalSize<u32>) {
        if let Some(Opened { desk, .. }) = &mut self.opened {
            desk.live.core_mut().resize(size.into());
            desk.tell(ShellEvent::Surface(Some(size.into())));
        }
    }

    fn touch(&mut self, phase: TouchPhase, at: PhysicalPosition<f64>) {
        if let Some(Opened { desk, .. }) = &mut self.opened {
            desk.live.touch(Touch {
                id: MOUSE,
                phase,
                at_px: at.into(),
            });
        }
    }

    fn mouse(&mut self, event: &WindowEvent) {
        match (event, self.pressed_at) {
            (WindowEvent::CursorMoved { position, .. }, before) => {
                let is_down = before.is_some_and(|(_, is_down)| is_down);
                self.pressed_at = Some((*position, is_down));
                if is_down {
                    self.touch(TouchPhase::Moved, *position);
                }
            }
            (WindowEvent::MouseInput { state, button, .. }, Some((at, _)))
                if *button == MouseButton::Left =>
            {
                let is_down = *state == ElementState::Pressed;
                self.pressed_at = Some((at, is_down));
                self.touch(
                    if is_down {
                        TouchPhase::Began
                    } else {
                        TouchPhase::Ended
                    },
                    at,
                );
            }
            (WindowEvent::MouseWheel { delta, .. }, _) => {
                let steps = match delta {
                    MouseScrollDelta::LineDelta(_, lines) => f64::from(*lines),
                    MouseScrollDelta::PixelDelta(pixels) => pixels.y / 20.0,
                };
                if let Some(Opened { desk, .. }) = &mut self.opened {
                    desk.live.wheel(steps);
                }
            }
            _ => {}
        }
    }
}

impl ApplicationHandler for Shell {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if let Err(error) = self.open(event_loop) {
            self.result = Err(error);
            event_loop.exit();
        }
        event_loop.set_control_flow(ControlFlow::Poll);
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        match event {
            WindowEvent::CloseRequested => event_loop.exit(),
            WindowEvent::KeyboardInput { event, .. } if event.logical_key == Key::Named(NamedKey::Escape) => {
                event_loop.exit();
            }
            WindowEvent::KeyboardInput { event, .. }
                if event.state == ElementState::Pressed
                    && !event.repeat
                    && event.logical_key.to_text() == Some("i") =>
            {
                if let Some(Opened { desk, .. }) = &mut self.opened {
                    desk.look_into();
                }
            }
            WindowEvent::DroppedFile(path) => {
                if let Some(Opened { desk, .. }) = &mut self.opened {
                    desk.pick(&path);
                }
            }
            WindowEvent::Resized(size) => self.resize(size),
            WindowEvent::RedrawRequested => {
                if let Err(error) = self.draw() {
                    self.result = Err(error);
                    event_loop.exit();
                }
            }
            event => self.mouse(&event),
        }
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        let is_over = self
            .options
            .seconds
            .is_some_and(|seconds| self.start.elapsed().as_secs_f64() > seconds);
        if is_over {
            event_loop.exit();
        }
        if let Some(Opened { window, .. }) = &self.opened {
            window.request_redraw();
        }
    }
}
