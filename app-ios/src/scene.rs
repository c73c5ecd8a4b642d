//! Application and scene delegate: UIKit's life cycle, passed to the view.
//!
//! The scene life cycle is mandatory: an app built with the iOS 27 SDK without it is stopped at
//! launch (Apple, technical note TN3187).

use std::cell::RefCell;

use objc2::rc::{Allocated, Retained};
use objc2::runtime::NSObject;
use objc2::{ClassType, DefinedClass, MainThreadMarker, MainThreadOnly, define_class, msg_send};
use objc2_foundation::{NSObjectProtocol, NSString};
use objc2_ui_kit::{
    UIApplication, UIApplicationDelegate, UIResponder, UIScene, UISceneConnectionOptions, UISceneDelegate,
    UISceneSession, UIViewController, UIWindow, UIWindowScene, UIWindowSceneDelegate,
};

use crate::view::MetalView;
use app_shell::guard::guarded;

/// Passes the main thread to UIKit.
pub(crate) fn run_app() -> ! {
    let Some(main_thread) = MainThreadMarker::new() else {
        eprintln!("app-ios: app_ios_main must be called on the main thread");
        std::process::abort();
    };
    // Info.plist names the scene delegate, so the class must be registered before UIKit looks it up.
    let _registered = SceneDelegate::class();
    let delegate_class = NSString::from_class(AppDelegate::class());
    UIApplication::main(None, Some(&delegate_class), main_thread)
}

define_class!(
    // SAFETY: UIResponder may be subclassed freely; there is no Drop implementation.
    #[unsafe(super(UIResponder, NSObject))]
    #[thread_kind = MainThreadOnly]
    #[name = "ShadowAppDelegate"]
    struct AppDelegate;

    // SAFETY: NSObjectProtocol has no further requirements.
    unsafe impl NSObjectProtocol for AppDelegate {}

    // SAFETY: all methods of the protocol are optional; with scenes there is nothing left to do here.
    unsafe impl UIApplicationDelegate for AppDelegate {}
);

/// The objects of a connected scene that must stay alive.
struct Shown {
    view: Retained<MetalView>,
    /// UIKit does not keep the windows of a scene alive for us.
    _window: Retained<UIWindow>,
}

/// The scene delegate's state; empty while no scene is connected.
#[derive(Default)]
struct SceneState {
    shown: RefCell<Option<Shown>>,
}

define_class!(
    // SAFETY: UIResponder may be subclassed freely; there is no Drop implementation.
    #[unsafe(super(UIResponder, NSObject))]
    #[thread_kind = MainThreadOnly]
    #[name = "ShadowSceneDelegate"]
    #[ivars = SceneState]
    struct SceneDelegate;

    // SAFETY: init has the signature of every init.
    impl SceneDelegate {
        #[unsafe(method_id(init))]
        fn init(this: Allocated<Self>) -> Retained<Self> {
            let this = this.set_ivars(SceneState::default());
            // SAFETY: init is the designated initialiser of UIResponder.
            unsafe { msg_send![super(this), init] }
        }
    }

    // SAFETY: NSObjectProtocol has no further requirements.
    unsafe impl NSObjectProtocol for SceneDelegate {}

    // SAFETY: the methods have the signatures of the protocol and take no ownership.
    unsafe impl UISceneDelegate for SceneDelegate {
        #[unsafe(method(scene:willConnectToSession:options:))]
        fn scene_will_connect(
            &self,
            scene: &UIScene,
            _session: &UISceneSession,
            _options: &UISceneConnectionOptions,
        ) {
            guarded("a scene that connects", || self.connect(scene));
        }

        #[unsafe(method(sceneDidDisconnect:))]
        fn scene_did_disconnect(&self, _scene: &UIScene) {
            guarded("a scene that disconnects", || self.disconnect());
        }

        #[unsafe(method(sceneWillEnterForeground:))]
        fn scene_will_enter_foreground(&self, _scene: &UIScene) {
            guarded("entering the foreground", || self.with_view(MetalView::enter_foreground));
        }

        #[unsafe(method(sceneDidEnterBackground:))]
        fn scene_did_enter_background(&self, _scene: &UIScene) {
            guarded("entering the background", || self.with_view(MetalView::enter_background));
        }
    }

    // SAFETY: all methods of the protocol are optional.
    unsafe impl UIWindowSceneDelegate for SceneDelegate {}
);

impl SceneDelegate {
    /// Fills the scene with one window, and the window with the Metal view.
    fn connect(&self, scene: &UIScene) {
        let Some(window_scene) = scene.downcast_ref::<UIWindowScene>() else {
            eprintln!("app-ios: the connected scene has no windows");
            return;
        };
        let main_thread = self.mtm();
        let window = UIWindow::initWithWindowScene(UIWindow::alloc(main_thread), window_scene);
        let view = MetalView::new(main_thread, window.bounds());
        let controller = UIViewController::new(main_thread);
        controller.setView(Some(&view));
        window.setRootViewController(Some(&controller));
        window.makeKeyAndVisible();
        self.ivars().shown.replace(Some(Shown {
            view,
            _window: window,
        }));
    }

    /// Releases window and view; UIKit may connect the scene again later.
    fn disconnect(&self) {
        if let Some(shown) = self.ivars().shown.take() {
            shown.view.retire();
        }
    }

    /// Calls a function with the connected scene's view. A separate reference holds the view
    /// meanwhile, so that UIKit may call back into this delegate.
    fn with_view(&self, tell: impl FnOnce(&MetalView)) {
        let view = self
            .ivars()
            .shown
            .borrow()
            .as_ref()
            .map(|shown| shown.view.clone());
        if let Some(view) = view {
            tell(&view);
        }
    }
}
