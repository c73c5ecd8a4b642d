//! Informs the tests whether this machine can emulate the phone's processor.

use std::env;

/// Compiler and emulator, with their names in Debian's packages.
const PROGRAMS: [&str; 2] = ["aarch64-linux-gnu-gcc", "qemu-aarch64"];

fn main() {
    println!("cargo::rerun-if-env-changed=PATH");
    println!("cargo::rustc-check-cfg=cfg(has_emulator)");
    let folders: Vec<_> = env::split_paths(&env::var_os("PATH").unwrap_or_default()).collect();
    let has = |program: &str| {
        let found = folders
            .iter()
            .map(|folder| folder.join(program))
            .find(|path| path.is_file());
        // A file that does not exist yet makes this script run again.
        let path = found.clone().unwrap_or_else(|| program.into());
        println!("cargo::rerun-if-changed={}", path.display());
        found.is_some()
    };
    if PROGRAMS.map(has) == [true; 2] {
        println!("cargo::rustc-cfg=has_emulator");
    }
}
