//! The one view of the app: a Metal layer, its size, and the clock that asks for frames.

use std::cell::{Cell, OnceCell, RefCell};

use objc2::rc::Retained;
use objc2::runtime::{AnyClass, NSObject};
use objc2::{ClassType, DefinedClass, MainThreadMarker, MainThreadOnly, define_class, msg_send, sel};
use objc2_core_foundation::CGRect;
use objc2_foundation::{NSRunLoop, NSRunLoopCommonModes};
use objc2_quartz_core::{CADisplayLink, CAMetalLayer};
use objc2_ui_kit::{UIResponder, UITraitEnvironment, UIView};

use crate::convert::size_px;
use crate::guard::guarded;
use crate::stage::{Stage, StageError};

/// The view's state.
pub(crate) struct ViewState {
    stage: RefCell<Stage>,
    in_foreground: Cell<bool>,
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

    // SAFETY: the methods have the signatures that UIKit and, for the last, the display link call them with.
    impl MetalView {
        #[unsafe(method(layerClass))]
        fn layer_class() -> &'static AnyClass {
            CAMetalLayer::class()
        }

        #[unsafe(method(layoutSubviews))]
        fn layout_subviews(&self) {
            // SAFETY: the method of the superclass takes nothing and returns nothing.
            let () = unsafe { msg_send![super(self), layoutSubviews] };
            self.run("layout", |stage| self.fit(stage));
        }

        #[unsafe(method(displayLinkDidFire:))]
        fn display_link_did_fire(&self, _link: &CADisplayLink) {
            self.run("present", Stage::present);
        }
    }
);

impl MetalView {
    /// A view of the given frame (points) that draws nothing until it enters the foreground.
    pub(crate) fn new(main_thread: MainThreadMarker, frame: CGRect) -> Retained<Self> {
        let state = ViewState {
            stage: RefCell::new(Stage::new()),
            in_foreground: Cell::new(false),
            display_link: OnceCell::new(),
        };
        let this = Self::alloc(main_thread).set_ivars(state);
        // SAFETY: initWithFrame: is UIView's designated initialiser and takes a CGRect.
        let this: Retained<Self> = unsafe { msg_send![super(this), initWithFrame: frame] };
        // SAFETY: the view answers displayLinkDidFire:, which takes the link as its only argument.
        let link = unsafe { CADisplayLink::displayLinkWithTarget_selector(&this, sel!(displayLinkDidFire:)) };
        link.setPaused(true);
        // SAFETY: this is the main thread, whose run loop it is.
        unsafe { link.addToRunLoop_forMode(&NSRunLoop::mainRunLoop(), NSRunLoopCommonModes) };
        this.ivars().display_link.get_or_init(|| link);
        this
    }

    /// Creates the surface, and with the first one the core, and starts the clock.
    pub(crate) fn enter_foreground(&self) {
        self.ivars().in_foreground.set(true);
        self.run("entering the foreground", |stage| self.fit(stage));
        self.pause_clock(false);
    }

    /// Stops the clock and drops the surface: iOS allows no GPU work in the background.
    pub(crate) fn enter_background(&self) {
        self.ivars().in_foreground.set(false);
        self.pause_clock(true);
        self.run("entering the background", |stage| {
            stage.suspend();
            Ok(())
        });
    }

    /// Ends the clock for good, and with it the view's last reference from UIKit's run loop.
    pub(crate) fn retire(&self) {
        self.enter_background();
        if let Some(link) = self.ivars().display_link.get() {
            link.invalidate();
        }
    }

    fn pause_clock(&self, paused: bool) {
        if let Some(link) = self.ivars().display_link.get() {
            link.setPaused(paused);
        }
    }

    /// Matches the surface with the view's size on the current screen, if the view is in front.
    fn fit(&self, stage: &mut Stage) -> Result<(), StageError> {
        if !self.ivars().in_foreground.get() {
            return Ok(());
        }
        // SAFETY: reading a property of the view's own traits, on the main thread.
        let pixels_per_point = unsafe { self.traitCollection().displayScale() };
        let size_points = self.bounds().size;
        match size_px([size_points.width, size_points.height], pixels_per_point) {
            Some(size_px) => stage.fit(&self.layer(), size_px),
            // Not laid out yet: layoutSubviews comes back with a size.
            None => Ok(()),
        }
    }

    /// Lets `act` work on the stage. After an error or a panic the core is dropped, and the next layout or return to
    /// the foreground starts a new one; until then the view keeps its last picture.
    fn run(&self, what: &str, act: impl FnOnce(&mut Stage) -> Result<(), StageError>) {
        let Ok(mut stage) = self.ivars().stage.try_borrow_mut() else {
            // UIKit laid the view out while the stage was at work; the size is read again at the next layout.
            return;
        };
        match guarded(|| act(&mut stage)) {
            Some(Ok(())) => return,
            Some(Err(error)) => eprintln!("app-ios: {what}: {error}"),
            None => eprintln!("app-ios: {what}: panicked, see above"),
        }
        guarded(|| stage.clear());
    }
}
