//! The shim for SIMD matrices, run by an emulator of the phone's processor with a C function as `objc_msgSend`.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The phone's processor without any of Apple's software; its `core` is installed for the Android
/// shell.
const TARGET: &str = "aarch64-linux-android";

fn run(program: &str, command: impl FnOnce(&mut Command) -> &mut Command) -> String {
    let mut process = Command::new(program);
    let output = command(&mut process).output().expect(program);
    let told = String::from_utf8_lossy(&output.stdout).into_owned();
    let failed = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{program}: {told}{failed}");
    told
}

#[test]
#[cfg_attr(not(has_emulator), ignore = "needs gcc-aarch64-linux-gnu and qemu-user")]
fn matrices_arrive_through_the_shim_and_not_without() {
    let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/shim");
    let out = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let (library, program) = (out.join("libprobe.a"), out.join("shim"));
    let rustc = env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
    run(&rustc, |rustc| {
        rustc
            .args([
                "--edition",
                "2024",
                "--target",
                TARGET,
                "--crate-type",
                "staticlib",
            ])
            .args(["-C", "opt-level=2", "-C", "panic=abort", "-o"])
            .arg(&library)
            .arg(sources.join("probe.rs"))
    });
    run("aarch64-linux-gnu-gcc", |gcc| {
        gcc.args(["-static", "-O2", "-w", "-o"])
            .arg(&program)
            .arg(sources.join("mock.c"))
            .arg(&library)
    });
    let told = run("qemu-aarch64", |qemu| qemu.arg(&program));
    assert_eq!(told.trim(), "0 wrong");
}
