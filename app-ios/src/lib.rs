//! The iPhone shell: one window scene with one Metal view that the shared core draws on.
//!
//! Data flows one way: UIKit calls the delegates in `scene`, they tell the `view` when it is in front, and the view
//! lends its layer to the `stage`, which keeps the one `app_core::Core`.
//! `convert` holds everything that knows ARKit's axes and pixel rules and UIKit's points; the core knows none of them.
//!
//! What works: the core is created on the view's layer, follows its size, loses its surface in the background while
//! device and pipelines stay, and presents a frame per display refresh.
//! `arkit` reads ARKit's frames into plain structs, and makes frames of ours of them.
//! What is not here yet: a session of ARKit that delivers those. No camera image, pose, plane or light reaches the core, so
//! the screen shows what the core presents before its first camera frame.
//!
//! The crate is a static library with one C function, `app_ios_main`. It builds on any system, because only linking
//! needs Apple's SDK; `README.md` beside this crate tells how a Mac makes an app of it.
//! On other systems only `convert` and what of `arkit` is free of Apple's are compiled.

pub mod arkit;
pub mod convert;

#[cfg(target_os = "ios")]
mod guard;
#[cfg(target_os = "ios")]
mod scene;
#[cfg(target_os = "ios")]
mod stage;
#[cfg(target_os = "ios")]
mod view;

/// Starts UIKit with this app's delegate; the app's `main` calls it first and once, on the main thread.
///
/// Never returns: UIKit ends the process.
#[cfg(target_os = "ios")]
// SAFETY: no other definition of this symbol is linked, and `main.c` declares it with this signature.
#[unsafe(no_mangle)]
pub extern "C" fn app_ios_main() -> ! {
    scene::run_app()
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_property_list_names_the_scene_delegate() {
        let named_in_property_list = include_str!("../Info.plist")
            .split_once("<key>UISceneDelegateClassName</key>")
            .and_then(|(_, rest)| rest.split_once("<string>")?.1.split_once("</string>"))
            .map(|(name, _)| name)
            .expect("a scene delegate in Info.plist");
        let declared_in_code = format!("#[name = \"{named_in_property_list}\"]");
        assert!(
            include_str!("scene.rs").contains(&declared_in_code),
            "no {declared_in_code} in scene.rs"
        );
    }
}
