//! Imports within the pipeline have one direction: from each layer only to the layers that follow
//! it. And no crate has a circle of imports. The test reads the sources and proves that it finds a
//! wrong import.

mod graph;
mod rooms;
mod source;

use graph::{Import, circles, imports};
use rooms::out_of_order;
use source::{Module, modules};

const PIPELINE: &str = "app-core/pipeline";
/// All other packages that are part of a phone app.
const PACKAGES: [&str; 11] = [
    "app-core/scene",
    "app-core/alignment",
    "app-core/session",
    "app-core/live",
    "app-core/shell",
    "app-ios",
    "app-ios/arkit",
    "app-ios/media",
    "app-android",
    "app-android/arcore",
    "app-android/media",
];

fn problems(modules: &[Module]) -> Vec<String> {
    let imports = imports(modules);
    assert!(imports.len() > 200, "only {} imports are seen", imports.len());
    in_circles(&imports)
        .chain(imports.iter().filter_map(out_of_order))
        .chain(unplaced(&imports))
        .collect()
}

fn in_circles(imports: &[Import]) -> impl Iterator<Item = String> + use<> {
    circles(imports)
        .into_iter()
        .map(|circle| format!("circle: {}", circle.join(" -> ")))
}

/// Modules that are in no layer.
fn unplaced(imports: &[Import]) -> impl Iterator<Item = String> + '_ {
    let modules = imports.iter().flat_map(|import| [&import.from, &import.to]);
    let mut unplaced: Vec<&String> = modules.filter(|module| rooms::rank(module).is_none()).collect();
    unplaced.sort_unstable();
    unplaced.dedup();
    unplaced
        .into_iter()
        .map(|module| format!("{module} is in no room"))
}

#[test]
fn imports_go_one_way() {
    let problems = problems(&modules(PIPELINE));
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[test]
fn no_crate_imports_in_a_circle() {
    let of_package = |package: &str| -> Vec<String> {
        let mut modules = modules(package);
        // Replacement of ARCore for tests: one unit in several files.
        modules.retain(|module| !module.path.starts_with("fake"));
        let circles = in_circles(&imports(&modules));
        circles.map(|circle| format!("{package}, {circle}")).collect()
    };
    let problems: Vec<String> = PACKAGES.into_iter().flat_map(of_package).collect();
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[test]
fn a_planted_import_is_found() {
    // A module, a line that is inserted into it, and words of the expected problem.
    #[rustfmt::skip] // One fault a line.
    let faults = [
        ("gpu::texture", "use crate::core::Core;", "gpu::texture imports core"),
        ("model::capture::fit", "use crate::model::frame::composite;", "model::capture::fit imports model::frame::composite"),
        ("baseline::warp", "fn planted() { crate::model::plan::planted(); }", "baseline::warp imports model::plan"),
        (
            "model::state::grids",
            "use crate::model::plan;
use crate::model::state::tints::Tints;\nuse super::super::state::SceneState;",
            "circle: ",
        ),
        ("geometry::extent", "planted! { crate::geometry::view::planted }", "circle: "),
        ("planted", "use crate::scene::Scene;", "planted is in no room"),
    ];
    for (path, line, words) in faults {
        let mut modules = modules(PIPELINE);
        match modules.iter_mut().find(|module| module.path == path) {
            Some(module) => module.text += line,
            None => modules.push(Module {
                path: path.to_owned(),
                text: line.to_owned(),
            }),
        }
        // `tints` must import it in turn for the circle in the state.
        if path == "model::state::grids" {
            let tints = modules
                .iter_mut()
                .find(|module| module.path == "model::state::tints");
            tints.unwrap().text += "use crate::model::state::grids::grids_over;";
        }
        let found = problems(&modules);
        assert!(
            found.iter().any(|problem| problem.contains(words)),
            "\"{line}\" in {path} is not found: {found:?}"
        );
    }
}
