//! The one view of the app: a Metal layer, its size, fingers on it, and the clock that asks for pictures.

use std::cell::{Cell, OnceCell, RefCell};
use std::rc::Rc;

use app_core::app::ShellEvent;
use app_core::interface::{Insets, Screen, Touch, TouchPhase, of_stopped};
use ios_media::message::Message;
use ios_media::voice_over::VoiceOver;
use objc2::rc::{Retained, autoreleasepool};
use objc2::runtime::{AnyClass, NSObject};
use objc2::{ClassType, DefinedClass, MainThreadMarker, MainThreadOnly, define_class, msg_send, sel};
use objc2_core_foundation::CGRect;
use objc2_foundation::{NSNotification, NSNotificationCenter, NSRunLoop, NSRunLoopCommonModes, NSSet};
use objc2_quartz_core::{CADisplayLink, CAFrameRateRange, CAMetalLayer};
use objc2_ui_kit::{
    UIApplicationDidReceiveMemoryWarningNotification, UIEvent, UIFontMetrics, UIResponder, UITouch,
    UITraitEnvironment, UIView,
};

use crate::convert::size_px;
use crate::hand_on::show_sheet;
use crate::inbox::Inbox;
use crate::person;
use crate::shell::Shell;
use crate::stage::StageError;
use app_shell::guard::guarded;

/// The view's state.
pub(crate) struct ViewState {
    shell: RefCell<Shell>,
    inbox: Rc<Inbox>,
    in_foreground: Cell<bool>,
    /// Retains the view, too.
    voice_over: RefCell<Option<VoiceOver>>,
    /// Shown while there is no app, and after a touch there is another.
    message: RefCell<Option<Message>>,
    /// Frame rate of the clock.
    frames_per_s: Cell<u32>,
    /// Retains the view, as the view retains it: [`MetalView::retire`] breaks the circle.
    display_link: OnceCell<Retained<CADisplayLink>>,
}

define_class!(
    // SAFETY: UIView may be subclassed; layoutSubviews calls super, and there is no Drop implementation.
    #[unsafe(super(UIView, UIResponder, NSObject))]
    #[thread_kind = MainThreadOnly]
    #[name = "ShadowMetalView"]
    #[ivars = ViewState]
    pub(crate) struct MetalView;

    // SAFETY: the methods have the signatures that UIKit, the display link and the notification centre call them with.
    impl MetalView {
        #[unsafe(method(layerClass))]
        fn layer_class() -> &'static AnyClass {
            CAMetalLayer::class()
        }

        #[unsafe(method(layoutSubviews))]
        fn layout_subviews(&self) {
            // SAFETY: the method of the superclass takes nothing and returns nothing.
            let () = unsafe { msg_send![super(self), layoutSubviews] };
            self.run("layout", |shell| self.fit(shell));
        }

        #[unsafe(method(displayLinkDidFire:))]
        fn display_link_did_fire(&self, _link: &CADisplayLink) {
            let mut shared = Vec::new();
            self.run("a picture", |shell| {
                autoreleasepool(|_| self.draw(shell))?;
                shared = shell.take_shared();
                Ok(())
            });
            if !shared.is_empty() {
                // The shell is not borrowed now: a sheet may trigger a layout of the view.
                guarded("a picture", || show_sheet(self, &shared));
            }
        }

        #[unsafe(method(touchesBegan:withEvent:))]
        fn touches_began(&self, touches: &NSSet<UITouch>, _event: Option<&UIEvent>) {
            guarded("touches", || self.touch(touches, TouchPhase::Began));
        }

        #[unsafe(method(touchesMoved:withEvent:))]
        fn touches_moved(&self, touches: &NSSet<UITouch>, _event: Option<&UIEvent>) {
            guarded("touches", || self.touch(touches, TouchPhase::Moved));
        }

        #[unsafe(method(touchesEnded:withEvent:))]
        fn touches_ended(&self, touches: &NSSet<UITouch>, _event: Option<&UIEvent>) {
            guarded("touches", || self.touch(touches, TouchPhase::Ended));
        }

        #[unsafe(method(touchesCancelled:withEvent:))]
        fn touches_cancelled(&self, touches: &NSSet<UITouch>, _event: Option<&UIEvent>) {
            guarded("touches", || self.touch(touches, TouchPhase::Cancelled));
        }

        #[unsafe(method(memoryIsLow:))]
        fn memory_is_low(&self, _notification: &NSNotification) {
            guarded("a memory warning", || self.ivars().inbox.tell(ShellEvent::MemoryLow));
        }
    }
);

impl MetalView {
    /// A view of the given frame (points) that draws nothing until it enters the foreground.
    pub(crate) fn new(main_thread: MainThreadMarker, frame: CGRect) -> Retained<Self> {
        let inbox = Rc::<Inbox>::default();
        let state = ViewState {
            shell: RefCell::new(Shell::new(main_thread, Rc::clone(&inbox))),
            inbox,
            in_foreground: Cell::new(false),
            voice_over: RefCell::default(),
            message: RefCell::default(),
            frames_per_s: Cell::default(),
            display_link: OnceCell::new(),
        };
        let this = Self::alloc(main_thread).set_ivars(state);
        // SAFETY: initWithFrame: is UIView's designated initialiser and takes a CGRect.
        let this: Retained<Self> = unsafe { msg_send![super(this), initWithFrame: frame] };
        this.setMultipleTouchEnabled(true);
        let inbox = Rc::clone(&this.ivars().inbox);
        let voice_over = VoiceOver::over(&this, move |request| inbox.request(request));
        this.ivars().voice_over.replace(Some(voice_over));
        this.ivars().shell.borrow().coach_over(&this);
        // SAFETY: the view answers memoryIsLow:, which takes the notification as its only argument; the centre keeps no
        // reference to it and forgets it when it goes.
        unsafe {
            NSNotificationCenter::defaultCenter().addObserver_selector_name_object(
                &this,
                sel!(memoryIsLow:),
                Some(UIApplicationDidReceiveMemoryWarningNotification),
                None,
            );
        }
        // SAFETY: the view answers displayLinkDidFire:, which takes the link as its only argument.
        let link = unsafe { CADisplayLink::displayLinkWithTarget_selector(&this, sel!(displayLinkDidFire:)) };
        link.setPaused(true);
        // SAFETY: this is the main thread, whose run loop it is.
        unsafe { link.addToRunLoop_forMode(&NSRunLoop::mainRunLoop(), NSRunLoopCommonModes) };
        this.ivars().display_link.get_or_init(|| link);
        this
    }

    /// Creates the surface, and with the first one the app, and starts the clock.
    pub(crate) fn enter_foreground(&self) {
        self.ivars().in_foreground.set(true);
        self.run("entering the foreground", |shell| {
            self.fit(shell)?;
            shell.enter_foreground();
            Ok(())
        });
        self.pause_clock(false);
    }

    /// Stops the clock, the camera, and drops the surface: iOS allows no GPU work in the background.
    pub(crate) fn enter_background(&self) {
        self.ivars().in_foreground.set(false);
        self.pause_clock(true);
        self.run("entering the background", |shell| {
            shell.enter_background();
            Ok(())
        });
    }

    /// Ends the clock for good, and with it the view's last reference from UIKit's run loop.
    pub(crate) fn retire(&self) {
        self.enter_background();
        self.ivars().voice_over.take();
        if let Some(link) = self.ivars().display_link.get() {
            link.invalidate();
        }
    }

    fn pause_clock(&self, paused: bool) {
        if let Some(link) = self.ivars().display_link.get() {
            link.setPaused(paused);
        }
    }

    /// Draws one picture, with a new app after a panic.
    fn draw(&self, shell: &mut Shell) -> Result<(), StageError> {
        let Some(screen) = self.screen() else {
            return Ok(());
        };
        if let Some(scene) = self.window().and_then(|window| window.windowScene()) {
            shell.set_orientation(scene.effectiveGeometry().interfaceOrientation().0);
        }
        if shell.begins_anew() {
            self.fit(shell)?;
        }
        shell.present(&self.layer(), &screen)?;
        if let Some(voice_over) = &*self.ivars().voice_over.borrow() {
            shell.show_to(voice_over);
        }
        self.set_rate(shell.frames_per_s());
        Ok(())
    }

    fn set_rate(&self, frames_per_s: u32) {
        if self.ivars().frames_per_s.replace(frames_per_s) == frames_per_s {
            return;
        }
        if let Some(link) = self.ivars().display_link.get() {
            let rate = frames_per_s as f32;
            link.setPreferredFrameRateRange(CAFrameRateRange {
                minimum: rate,
                maximum: rate,
                preferred: rate,
            });
        }
    }

    /// Stores touches for the app, in pixels of the screen.
    fn touch(&self, touches: &NSSet<UITouch>, phase: TouchPhase) {
        let is_stopped = self.ivars().message.borrow().is_some();
        if is_stopped && phase == TouchPhase::Began {
            return self.run("a new start", |shell| self.fit(shell));
        }
        let pixels_per_point = self.pixels_per_point();
        for touch in touches {
            let at_points = touch.locationInView(Some(self));
            self.ivars().inbox.touch(Touch {
                // UIKit keeps the object as long as the finger is down.
                id: Retained::as_ptr(&touch).addr() as u64,
                phase,
                at_px: [at_points.x, at_points.y].map(|points| points * pixels_per_point),
            });
        }
    }

    fn pixels_per_point(&self) -> f64 {
        // SAFETY: reading a property of the view's own traits, on the main thread.
        unsafe { self.traitCollection().displayScale() }
    }

    /// The screen, as the interface needs it. `None` before the first layout.
    fn screen(&self) -> Option<Screen> {
        let (pixels_per_point, size_points) = (self.pixels_per_point(), self.bounds().size);
        let insets = self.safeAreaInsets();
        Some(Screen {
            size_px: size_px([size_points.width, size_points.height], pixels_per_point)?,
            pixels_per_point,
            insets: Insets {
                left_px: insets.left * pixels_per_point,
                top_px: insets.top * pixels_per_point,
                right_px: insets.right * pixels_per_point,
                bottom_px: insets.bottom * pixels_per_point,
            },
            // Size of a hundred points with the person's letter size.
            text_scale: UIFontMetrics::defaultMetrics().scaledValueForValue(100.0) / 100.0,
        })
    }

    /// Matches the surface with the view's size on the current screen, if the view is in front.
    fn fit(&self, shell: &mut Shell) -> Result<(), StageError> {
        match self.screen() {
            Some(screen) if self.ivars().in_foreground.get() => {
                // VoiceOver's places are computed with it.
                self.setContentScaleFactor(screen.pixels_per_point);
                self.ivars().message.take();
                shell.fit(&self.layer(), screen.size_px)
            }
            // The view is in the background or has no layout yet: layoutSubviews will bring a size.
            _ => Ok(()),
        }
    }

    /// Lets `act` work on the shell. After an error the app is dropped, and a touch, the next layout
    /// or the return to the foreground starts a new one; after a panic the next picture does, unless
    /// panics follow one another. Until then a message covers the last picture.
    fn run(&self, callback: &str, act: impl FnOnce(&mut Shell) -> Result<(), StageError>) {
        let Ok(mut shell) = self.ivars().shell.try_borrow_mut() else {
            // UIKit laid the view out while the shell was at work; the size is read again at the next layout.
            return;
        };
        let outcome = guarded(callback, || act(&mut shell));
        match outcome {
            Some(Ok(())) => return,
            Some(Err(error)) => {
                eprintln!("app-ios: {callback:?}: {error}");
                shell.stop();
            }
            None => shell.panicked(),
        }
        guarded("dropping the app", || shell.clear());
        if !shell.begins_anew() {
            let words = of_stopped(person::language());
            self.ivars().message.replace(Message::over(self, words));
        }
    }
}
