//! Links in the documents: every linked file and heading exists.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Folders of the project with documents; `README.md` is beside them.
const FOLDERS: [&str; 6] = ["app-core", "app-ios", "app-android", "tests", "xtask", "shaders"];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().to_owned()
}

/// All documents below a folder.
fn documents_in(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(documents_in(&path));
        } else if path.extension().is_some_and(|extension| extension == "md") {
            found.push(path);
        }
    }
    found
}

/// The lines outside of code blocks.
fn prose(text: &str) -> String {
    let mut is_code = false;
    let lines = text.lines().filter(|line| {
        let is_fence = line.trim_start().starts_with("```");
        is_code ^= is_fence;
        !is_code && !is_fence
    });
    lines.collect::<Vec<_>>().join("\n")
}

/// The anchors of a page's headings, as GitHub makes them.
fn anchors(text: &str) -> BTreeSet<String> {
    let headings = prose(text);
    let headings = headings.lines().filter(|line| line.starts_with('#'));
    let kept = |c: &char| c.is_alphanumeric() || "-_ ".contains(*c);
    let anchor = |line: &str| {
        let heading = line.trim_start_matches('#').trim().to_lowercase();
        heading.chars().filter(kept).collect::<String>().replace(' ', "-")
    };
    headings.map(anchor).collect()
}

/// Targets of the links of a page, without those to other sites. Items of code are no targets: who reads the page as a
/// file cannot follow them, so a page names them in brackets alone, and its module defines what they are.
fn links(text: &str) -> Vec<String> {
    let text = prose(text);
    let targets = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    let targets = targets.filter(|target| !target.contains("://"));
    targets.map(str::to_owned).collect()
}

/// The links of a page without a target.
fn broken(page: &Path, text: &str) -> Vec<String> {
    let is_broken = |link: &String| {
        let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
        let target = if file.is_empty() {
            page.to_owned()
        } else {
            page.parent().unwrap().join(file)
        };
        let is_there = target.exists();
        let has_anchor = || fs::read_to_string(&target).is_ok_and(|text| anchors(&text).contains(anchor));
        !is_there || !(anchor.is_empty() || has_anchor())
    };
    links(text).into_iter().filter(is_broken).collect()
}

#[test]
fn links_of_the_documents_lead_somewhere() {
    let root = root();
    let mut pages = vec![root.join("README.md")];
    pages.extend(FOLDERS.iter().flat_map(|folder| documents_in(&root.join(folder))));
    let mut wrong = Vec::new();
    for page in &pages {
        let text = fs::read_to_string(page).unwrap();
        wrong.extend(
            broken(page, &text)
                .into_iter()
                .map(|link| format!("{}: {link}", page.display())),
        );
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    // Control: a missing file, a missing heading and an item of code are detected, and a link in a
    // code block is ignored.
    let planted = "[a](app-core/doc/no.md) [b](app-core/doc/session.md#no) [c](app-core/doc/session.md#keys) \
        [e](super::Step)\n```\n[d](no.md)\n```";
    assert_eq!(
        broken(&pages[0], planted),
        ["app-core/doc/no.md", "app-core/doc/session.md#no", "super::Step"]
    );
}
