//! A Vulkan driver for replay and tests: searched, and installed if the system permits.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Result, bail};

use crate::command;
use crate::debian;

/// A software driver and the loader, by the package names of Debian and Ubuntu.
const APT_PACKAGES: [&str; 2] = ["mesa-vulkan-drivers", "libvulkan1"];
/// The same for other systems: package manager and the line to run.
const OTHER_SYSTEMS: [(&str, &str); 3] = [
    ("dnf", "sudo dnf install mesa-vulkan-drivers vulkan-loader"),
    ("pacman", "sudo pacman -S vulkan-swrast vulkan-icd-loader"),
    ("zypper", "sudo zypper install libvulkan_lvp libvulkan1"),
];

/// Makes sure that there is a Vulkan driver. Systems other than Linux have their own.
pub(crate) fn ensure() -> Result<()> {
    if !cfg!(target_os = "linux") || is_there() {
        return Ok(());
    }
    println!("There is no Vulkan driver on this machine; a software one is enough.");
    if command::find("apt-get").is_none() {
        let line = OTHER_SYSTEMS
            .iter()
            .find(|(manager, _)| command::find(manager).is_some());
        bail!(
            "no Vulkan driver; install one and run this again: {}",
            line.map_or("Mesa's lavapipe and the Vulkan loader", |(_, line)| line)
        );
    }
    debian::install("no Vulkan driver", &APT_PACKAGES)?;
    if !is_there() {
        bail!(
            "{} are installed, but no Vulkan driver is found",
            APT_PACKAGES.join(" and ")
        );
    }
    Ok(())
}

/// Whether there are both a loader and a driver for it.
fn is_there() -> bool {
    has_loader() && (has_chosen_driver() || has_installed_driver())
}

fn has_loader() -> bool {
    const LOADER: &str = "libvulkan.so.1";
    // Not on root's search path on Debian.
    let known = ["ldconfig", "/sbin/ldconfig"]
        .iter()
        .find_map(|program| command::output(program, &["-p"]));
    let chosen = env::var_os("LD_LIBRARY_PATH").unwrap_or_default();
    known.is_some_and(|list| list.contains(LOADER))
        || env::split_paths(&chosen).any(|folder| folder.join(LOADER).exists())
}

/// Whether the user chose a driver for the loader.
fn has_chosen_driver() -> bool {
    let lists = ["VK_DRIVER_FILES", "VK_ICD_FILENAMES", "VK_ADD_DRIVER_FILES"].map(env::var_os);
    lists
        .iter()
        .flatten()
        .any(|list| env::split_paths(list).any(|path| path.exists()))
}

fn has_installed_driver() -> bool {
    let home = env::var_os("HOME").map(|home| PathBuf::from(home).join(".local/share"));
    let listed = env::var_os("XDG_DATA_DIRS").unwrap_or_default();
    let folders = ["/usr/share", "/usr/local/share", "/etc"]
        .map(PathBuf::from)
        .into_iter();
    folders
        .chain(home)
        .chain(env::split_paths(&listed))
        .any(|folder| has_driver_file(&folder.join("vulkan/icd.d")))
}

fn has_driver_file(folder: &Path) -> bool {
    let Ok(entries) = fs::read_dir(folder) else {
        return false;
    };
    entries.flatten().any(|entry| {
        entry
            .path()
            .extension()
            .is_some_and(|extension| extension == "json")
    })
}
