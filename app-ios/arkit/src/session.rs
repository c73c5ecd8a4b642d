//! A session of ARKit: world tracking, its frames, and its reports.

use std::cell::{Cell, RefCell};
use std::path::Path;
use std::rc::Rc;

use app_core::app::{ArSession, ShellEvent};
use app_core::gpu::DeviceHandle;
use glam::DMat4;
use objc2::rc::{Allocated, Retained, autoreleasepool};
use objc2::runtime::{NSObject, ProtocolObject};
use objc2::{
    AnyThread, ClassType, DefinedClass, MainThreadMarker, MainThreadOnly, define_class, msg_send, sel,
};
use objc2_ar_kit::{
    ARAnchor, ARConfiguration, ARFrame, ARFrameSemantics, ARObjectAnchor, ARPlaneDetection, ARReferenceImage,
    ARReferenceObject, ARSession, ARSessionDelegate, ARSessionObserver, ARSessionRunOptions,
    ARWorldTrackingConfiguration,
};
use objc2_foundation::{NSError, NSObjectProtocol, NSProcessInfo, NSSet};
use objc2_ui_kit::UIView;

use super::coaching::Coach;
use super::frame::{Count, camera_frame};
use super::textures::TextureCache;
use super::{card, read, scan, shim};
use crate::convert::{self, AfterFailure};
use app_shell::guard::guarded;

/// A held anchor.
struct Held {
    id: u64,
    anchor: Retained<ARAnchor>,
}

/// State that the session and its delegate share.
struct Shared {
    tell: Rc<dyn Fn(ShellEvent)>,
    count: Cell<Count>,
    /// Start of the current world, on the clock of the frames; earlier frames belong to another
    /// world.
    world_since_s: Cell<f64>,
    held: RefCell<Option<Held>>,
    /// `None` until there is a device.
    textures: RefCell<Option<TextureCache>>,
    is_interrupted: Cell<bool>,
    /// `UIInterfaceOrientation` of the screen.
    orientation: Cell<isize>,
    /// Detections of the latest run.
    finds: Cell<Finds>,
    /// The card's reference image, if a person uses the card and ARKit has not refused it.
    card: RefCell<Card>,
    /// Reference object of the toy; `None` without a scan, or if ARKit has refused it.
    scan: RefCell<Option<Retained<ARReferenceObject>>>,
    /// `None` until there is a view.
    coach: RefCell<Option<Coach>>,
    /// Whether a frame was refused, with the reason in the log.
    is_refusing: Cell<bool>,
}

/// Things to detect in the camera's picture, or to measure.
#[derive(Clone, Copy, Debug, Default)]
pub struct Finds {
    /// Level planes.
    pub planes: bool,
    /// The printed card.
    pub card: bool,
    /// People, on phones that mask them.
    pub people: bool,
    /// Depths, on phones that measure them.
    pub depth: bool,
}

/// The card's picture, made on first use.
#[derive(Default)]
enum Card {
    #[default]
    Unmade,
    Made(Retained<ARReferenceImage>),
    /// It could not be made, or ARKit has refused it.
    Refused,
}

impl Shared {
    /// Runs `session` with the current detections.
    fn run(&self, session: &ARSession, options: ARSessionRunOptions) {
        let finds = self.finds.get();
        // SAFETY: new has no requirements.
        let configuration = unsafe { ARWorldTrackingConfiguration::new() };
        let planes = if finds.planes {
            ARPlaneDetection::Horizontal
        } else {
            ARPlaneDetection::empty()
        };
        let card = self.card_to_find(finds);
        if finds.card && card.is_none() {
            (self.tell)(ShellEvent::CardRefused);
        }
        if let Some(coach) = &*self.coach.borrow() {
            coach.helps(finds.planes);
        }
        // SAFETY: a configuration of this session's own, with options that every session takes.
        unsafe {
            configuration.setPlaneDetection(planes);
            // Pictures with local tone mapping cannot be compared with one another.
            configuration.setVideoHDRAllowed(false);
            if let Some(card) = card {
                configuration.setDetectionImages(Some(&NSSet::from_slice(&[&*card])));
                configuration.setMaximumNumberOfTrackedImages(1);
            }
            if finds.depth {
                ask(&configuration, ARFrameSemantics::SceneDepth);
            }
            if finds.people {
                ask(&configuration, ARFrameSemantics::PersonSegmentation);
            }
            if let Some(scan) = &*self.scan.borrow() {
                configuration.setDetectionObjects(&NSSet::from_slice(&[&**scan]));
            }
            session.runWithConfiguration_options(&configuration, options);
        }
    }

    fn card_to_find(&self, finds: Finds) -> Option<Retained<ARReferenceImage>> {
        let mut card = self.card.borrow_mut();
        if finds.card && matches!(*card, Card::Unmade) {
            *card = card::reference_image().map_or(Card::Refused, Card::Made);
        }
        match &*card {
            Card::Made(image) if finds.card => Some(image.clone()),
            _ => None,
        }
    }

    /// Reacts to a failed run.
    fn fail(&self, session: &ARSession, code: isize) {
        let had_card = self.finds.get().card && matches!(*self.card.borrow(), Card::Made(_));
        let had_scan = self.scan.borrow().is_some();
        match convert::after_failure(code, had_card || had_scan) {
            AfterFailure::RunWithLess if had_scan => {
                eprintln!("arkit: the toy is not recognised: the session refuses its scan");
                self.scan.replace(None);
                self.run(session, ARSessionRunOptions::empty());
            }
            AfterFailure::RunWithLess => {
                eprintln!("arkit: the card is not detected: the session refuses it");
                self.card.replace(Card::Refused);
                self.run(session, ARSessionRunOptions::empty());
            }
            AfterFailure::Tell(told) => (self.tell)(ShellEvent::ArSession(told)),
        }
    }

    /// Reads a frame and stores it for the shell; ARKit gets it back on return.
    fn take(&self, frame: &ARFrame) {
        // SAFETY: a property of a frame that was delivered, which never changes.
        if unsafe { frame.timestamp() } < self.world_since_s.get() {
            return;
        }
        let count = self.count.get();
        self.count.set(Count {
            n_frames: count.n_frames + 1,
            ..count
        });
        // SAFETY: a property of an anchor, which never changes.
        let identifier = |held: &Held| (held.id, unsafe { held.anchor.identifier() }.as_bytes());
        let held = self.held.borrow().as_ref().map(identifier);
        let textures = self.textures.borrow();
        let orientation = self.orientation.get();
        let taken = read::with_raw(frame, held, orientation, textures.as_ref(), |raw, lent| {
            camera_frame(raw, lent, count)
        });
        match taken {
            Some(Ok(frame)) => {
                self.is_refusing.set(false);
                (self.tell)(ShellEvent::Frame(Box::new(frame)));
            }
            Some(Err(error)) if !self.is_refusing.replace(true) => eprintln!("arkit: {error}"),
            None if !self.is_refusing.replace(true) => eprintln!("arkit: the camera's picture is locked"),
            _ => {}
        }
    }

    fn interrupt(&self, is_interrupted: bool) {
        self.is_interrupted.set(is_interrupted);
        let told = if is_interrupted {
            ArSession::Interrupted
        } else {
            ArSession::Able
        };
        (self.tell)(ShellEvent::ArSession(told));
    }
}

define_class!(
    // SAFETY: NSObject may be subclassed freely; there is no Drop implementation.
    #[unsafe(super(NSObject))]
    #[thread_kind = MainThreadOnly]
    #[name = "ShadowSessionDelegate"]
    #[ivars = Rc<Shared>]
    struct Delegate;

    // SAFETY: NSObjectProtocol has no further requirements.
    unsafe impl NSObjectProtocol for Delegate {}

    // SAFETY: the methods have the signatures of the protocol and take no ownership. Without a queue of its own, a session
    // calls them on the main thread.
    unsafe impl ARSessionObserver for Delegate {
        #[unsafe(method(session:didFailWithError:))]
        fn session_did_fail(&self, session: &ARSession, error: &NSError) {
            guarded("a failed session", || {
                eprintln!("arkit: ARKit: {error}");
                self.ivars().fail(session, error.code());
            });
        }

        #[unsafe(method(sessionWasInterrupted:))]
        fn session_was_interrupted(&self, _session: &ARSession) {
            guarded("an interrupted session", || self.ivars().interrupt(true));
        }

        #[unsafe(method(sessionInterruptionEnded:))]
        fn session_interruption_ended(&self, _session: &ARSession) {
            guarded("an interrupted session", || self.ivars().interrupt(false));
        }

        #[unsafe(method(sessionShouldAttemptRelocalization:))]
        fn session_should_attempt_relocalization(&self, _session: &ARSession) -> bool {
            true
        }
    }

    // SAFETY: as above.
    unsafe impl ARSessionDelegate for Delegate {
        #[unsafe(method(session:didUpdateFrame:))]
        fn session_did_update_frame(&self, _session: &ARSession, frame: &ARFrame) {
            guarded("a camera frame", || autoreleasepool(|_| self.ivars().take(frame)));
        }
    }
);

impl Delegate {
    fn new(main_thread: MainThreadMarker, shared: Rc<Shared>) -> Retained<Self> {
        let this = Self::alloc(main_thread).set_ivars(shared);
        // SAFETY: init is the designated initialiser of NSObject.
        unsafe { msg_send![super(this), init] }
    }
}

/// A session that reports on the main thread.
pub struct Session {
    session: Retained<ARSession>,
    /// The session does not retain it.
    _delegate: Retained<Delegate>,
    shared: Rc<Shared>,
    /// Whether the app wants it to run.
    is_running: Cell<bool>,
}

impl Session {
    /// A session that is not running yet.
    pub fn new(main_thread: MainThreadMarker, tell: Rc<dyn Fn(ShellEvent)>) -> Self {
        let shared = Rc::new(Shared {
            tell,
            count: Cell::default(),
            world_since_s: Cell::new(0.0),
            held: RefCell::default(),
            textures: RefCell::default(),
            is_interrupted: Cell::new(false),
            orientation: Cell::new(0),
            finds: Cell::default(),
            card: RefCell::default(),
            scan: RefCell::default(),
            coach: RefCell::default(),
            is_refusing: Cell::new(false),
        });
        let delegate = Delegate::new(main_thread, Rc::clone(&shared));
        // SAFETY: new has no requirements.
        let session = unsafe { ARSession::new() };
        // SAFETY: the delegate lives as long as the session, on the thread that the session calls it on.
        unsafe { session.setDelegate(Some(ProtocolObject::from_ref(&*delegate))) };
        Self {
            session,
            _delegate: delegate,
            shared,
            is_running: Cell::new(false),
        }
    }

    /// Lends pictures to this device from now on, or copies them without one.
    pub fn lend_to(&self, device: Option<DeviceHandle>) {
        self.shared.textures.replace(device.and_then(TextureCache::new));
    }

    /// Shows ARKit's own guidance over a view until a table is found.
    pub fn coach_over(&self, view: &UIView) {
        let coach = Coach::over(view, &self.session);
        self.shared.coach.replace(Some(coach));
    }

    /// Detects the toy by this scan, at once if the session runs; `None` ends that. The world and
    /// all other anchors stay.
    pub fn recognise(&self, scan: Option<&Path>) {
        let scan = scan.and_then(scan::reference_object);
        let has_scan = scan.is_some();
        let had_scan = self.shared.scan.replace(scan).is_some();
        if !(has_scan || had_scan) {
            return;
        }
        self.forget_toys();
        if self.is_running.get() {
            self.shared.run(&self.session, ARSessionRunOptions::empty());
        }
    }

    /// Removes the anchors of toys that were recognised by another scan, which stay otherwise.
    fn forget_toys(&self) {
        // SAFETY: properties of a session and of its latest frame, and an anchor of that frame is removed.
        unsafe {
            let Some(frame) = self.session.currentFrame() else {
                return;
            };
            for anchor in &frame.anchors() {
                if anchor.downcast_ref::<ARObjectAnchor>().is_some() {
                    self.session.removeAnchor(&anchor);
                }
            }
        }
    }

    /// Whether this phone has world tracking.
    pub fn is_supported() -> bool {
        // The class that is asked matters, and the binding has the method on its parent alone.
        // SAFETY: a method of every configuration's class that returns a truth value.
        unsafe { msg_send![ARWorldTrackingConfiguration::class(), isSupported] }
    }

    /// Sets the screen's orientation, a `UIInterfaceOrientation`.
    pub fn set_orientation(&self, orientation: isize) {
        self.shared.orientation.set(orientation);
    }

    /// Starts, or continues with another configuration.
    pub fn run(&self, finds: Finds, is_new_world: bool) {
        self.shared.finds.set(finds);
        let mut options = ARSessionRunOptions::empty();
        if is_new_world {
            options = ARSessionRunOptions::ResetTracking | ARSessionRunOptions::RemoveExistingAnchors;
            let count = self.shared.count.get();
            self.shared.count.set(Count {
                world_epoch: count.world_epoch + 1,
                ..count
            });
            self.shared
                .world_since_s
                .set(NSProcessInfo::processInfo().systemUptime());
            self.shared.held.replace(None);
        }
        self.is_running.set(true);
        self.shared.run(&self.session, options);
    }

    /// Pauses. An interrupted session has paused already, and reports its end only if it is left
    /// alone.
    pub fn pause(&self) {
        self.is_running.set(false);
        if !self.shared.is_interrupted.get() {
            // SAFETY: pausing has no requirements.
            unsafe { self.session.pause() };
        }
    }

    /// Handles the foreground: an interruption may have ended unreported, or is reported again.
    pub fn enter_foreground(&self) {
        if self.shared.is_interrupted.get() {
            self.shared.interrupt(false);
        }
    }

    /// Holds a place as an anchor of this number, and releases the previous one.
    pub fn hold(&self, id: u64, world_from_anchor: &DMat4) {
        let Some(anchor) = anchor_at(world_from_anchor) else {
            return;
        };
        // SAFETY: an anchor that was just made is added, and one that was added is removed.
        unsafe {
            self.session.addAnchor(&anchor);
            if let Some(before) = self.shared.held.replace(Some(Held { id, anchor })) {
                self.session.removeAnchor(&before.anchor);
            }
        }
    }
}

/// Asks for depths or masks beside what a configuration asks for already, if this phone can do both.
fn ask(configuration: &ARConfiguration, semantics: ARFrameSemantics) {
    // SAFETY: a property of a configuration of our own.
    let semantics = unsafe { configuration.frameSemantics() } | semantics;
    let class = ARWorldTrackingConfiguration::class();
    // The class that is asked matters, and the binding has the method on its parent alone.
    // SAFETY: a method of every configuration's class that takes semantics and returns a truth value.
    let can: bool = unsafe { msg_send![class, supportsFrameSemantics: semantics] };
    if can {
        // SAFETY: the class supports these semantics.
        unsafe { configuration.setFrameSemantics(semantics) };
    }
}

/// A new anchor.
fn anchor_at(world_from_anchor: &DMat4) -> Option<Retained<ARAnchor>> {
    let columns = shim::Columns4(world_from_anchor.as_mat4().to_cols_array_2d());
    let empty: Allocated<ARAnchor> = ARAnchor::alloc();
    // The initialiser takes over the reference.
    let empty = std::mem::ManuallyDrop::new(empty);
    // SAFETY: the initialiser of ARAnchor takes a SIMD matrix of four columns, and returns the anchor retained.
    unsafe {
        let anchor = shim::with4(
            Allocated::as_ptr(&empty).cast(),
            read::selector(sel!(initWithTransform:)),
            &columns,
        );
        Retained::from_raw(anchor.cast())
    }
}
