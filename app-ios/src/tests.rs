//! Checks of the sources against the property list and each other.

/// Methods that Objective-C calls, without a guard. Those that only return a constant or call the
/// superclass need none.
fn unguarded_methods(source: &str) -> Vec<&str> {
    const CONSTANT: [&str; 3] = ["layerClass)", "init)", "session_should_attempt_relocalization"];
    let classes = source
        .split("define_class!(")
        .skip(1)
        .map(|rest| rest.split_once("\n);").map_or(rest, |(class, _)| class));
    let methods = classes.flat_map(|class| {
        let methods = class.split("#[unsafe(method").skip(1);
        methods.map(|rest| rest.split_once("\n        }\n").map_or(rest, |(body, _)| body))
    });
    methods
        .filter(|body| !CONSTANT.iter().any(|constant| body.contains(constant)))
        .filter(|body| !body.contains("guarded(\"") && !body.contains("self.run(\""))
        .collect()
}

/// Blocks that the system calls, without a guard. Empty ones need none.
fn unguarded_blocks(source: &str) -> Vec<&str> {
    let blocks = source.split("RcBlock::new(").skip(1);
    blocks
        .map(|rest| rest.split_once("\n            })").map_or(rest, |(body, _)| body))
        .filter(|body| !body.contains("guarded(\"") && !body.contains("| {})"))
        .collect()
}

#[test]
fn whatever_the_system_calls_is_guarded() {
    let sources = [
        include_str!("view.rs"),
        include_str!("scene.rs"),
        include_str!("../arkit/src/session.rs"),
        include_str!("../arkit/src/camera.rs"),
        include_str!("../media/src/jpeg.rs"),
        include_str!("../media/src/video.rs"),
    ];
    for source in sources {
        assert_eq!(unguarded_methods(source), [""; 0]);
        assert_eq!(unguarded_blocks(source), [""; 0]);
    }
    let method = "define_class!(\n        #[unsafe(method(tapped:))]\n        fn tapped(&self) {\n            self.tap();\n        }\n);";
    assert_eq!(unguarded_methods(method).len(), 1);
    let block = "let block = RcBlock::new(move || {\n                end();\n            });";
    assert_eq!(unguarded_blocks(block).len(), 1);
}

#[test]
fn the_phone_is_held_by_either_hand() {
    let list = include_str!("../Info.plist");
    for side in ["Left", "Right"] {
        assert!(
            list.contains(&format!("<string>UIInterfaceOrientationLandscape{side}</string>")),
            "{side}"
        );
    }
}

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
