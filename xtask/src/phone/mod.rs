//! The two shells: checked, built and packaged on any machine, each as far as possible there.

mod android;
mod apk;
mod arcore;
pub(crate) mod calls;
mod classes;
mod elf;
mod imports;
mod ios;
mod log;
mod macho;
mod ndk;
pub(crate) mod size;
mod tools;
mod zip;

use std::process::Command;

use anyhow::{Result, bail};

use crate::command;
use crate::toolchain::Toolchain;

pub(crate) use arcore::Arcore;
pub(crate) use log::IphoneApp;

/// A shell.
pub(crate) struct Phone {
    /// Its package in the workspace.
    package: &'static str,
    /// Its compilation target.
    pub(crate) target: &'static str,
}

/// The iPhone shell.
pub(crate) const IOS: Phone = Phone {
    package: "app-ios",
    target: "aarch64-apple-ios",
};
/// The Android shell.
pub(crate) const ANDROID: Phone = Phone {
    package: "app-android",
    target: "aarch64-linux-android",
};

/// Notices of other programs' licences, beside the shells; both packages contain it.
const NOTICES: &str = "LICENSE-THIRD-PARTY";

/// The action for a shell.
pub(crate) enum Action {
    Check,
    Build,
    /// With ARCore's archive, if Android's own tools are installed; for engineers or for everybody.
    Package(Option<Arcore>, Profile),
    /// Fetches the files of a phone by cable.
    Log(IphoneApp),
}

/// The build profile of a library.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Profile {
    /// For everybody.
    #[default]
    Release,
    /// For engineers with an untested phone: with all run-time checks, and without fallbacks.
    FirstPhone,
}

impl Profile {
    /// Cargo's name of the profile, and the folder of its output.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Release => "release",
            Self::FirstPhone => "first-phone",
        }
    }
}

impl Phone {
    /// Type check and lints.
    pub(crate) fn check(&self, toolchain: &Toolchain) -> Command {
        let mut clippy = toolchain.cargo("clippy");
        clippy.args([
            "--locked",
            "--package",
            self.package,
            "--target",
            self.target,
            "--",
            "-D",
            "warnings",
        ]);
        clippy
    }

    /// The library, with `args` for the linker or the archiver.
    fn build(&self, toolchain: &Toolchain, profile: Profile, linker_args: &[String]) -> Result<Command> {
        let mut build = toolchain.cargo("rustc");
        build.args([
            "--locked",
            "--profile",
            profile.name(),
            "--lib",
            "--package",
            self.package,
        ]);
        build.args(["--target", self.target]);
        if self.is_android() && ndk::ndk().is_some() {
            build.envs(ndk::ndk_tools()?);
        }
        build.arg("--");
        build.args(linker_args.iter().map(|arg| format!("-Clink-arg={arg}")));
        Ok(build)
    }

    pub(crate) fn is_android(&self) -> bool {
        self.target == ANDROID.target
    }
}

/// Checks, builds or packages a shell.
pub(crate) fn run(toolchain: &Toolchain, phone: &Phone, action: Action) -> Result<()> {
    if !matches!(action, Action::Log(_)) {
        toolchain.ensure_target(phone.target)?;
    }
    match action {
        Action::Check => command::run(&mut phone.check(toolchain)),
        Action::Build if phone.is_android() && ndk::ndk().is_none() => {
            bail!(
                "no NDK found; set ANDROID_NDK_HOME to its folder. `cargo xtask android package` links without one"
            )
        }
        Action::Build => command::run(&mut phone.build(toolchain, Profile::Release, &[])?),
        Action::Package(arcore, profile) if phone.is_android() => {
            android::package(toolchain, profile, arcore.as_ref())
        }
        Action::Package(_, profile) => ios::package(toolchain, profile),
        Action::Log(app) => log::fetch(&toolchain.root, phone, &app),
    }
}
