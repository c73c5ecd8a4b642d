//! The project's commands, as `cargo xtask <command>`. Each checks what it needs before it starts, fetches what it may,
//! and names what is missing.

mod command;
mod debian;
mod format;
mod harness;
mod phone;
mod test;
mod toolchain;
mod vulkan;

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::phone::{ANDROID, Action, Arcore, IOS};
use crate::toolchain::Toolchain;

/// The project's commands
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
enum Command {
    /// Replay the bundled session into target/demo
    Demo,
    /// Replay a session: pictures, times, errors (`replay --help` tells more)
    #[command(disable_help_flag = true)]
    Replay {
        /// Handed on to the harness
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        args: Vec<OsString>,
    },
    /// Say what is wrong with a session, and draw what it predicts over its first frame (`check --help` tells more)
    #[command(disable_help_flag = true)]
    Check {
        /// Handed on to the harness
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        args: Vec<OsString>,
    },
    /// Write a session anew with cameras, pose and lights aligned by its pictures (`align --help` tells more)
    #[command(disable_help_flag = true)]
    Align {
        /// Handed on to the harness
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        args: Vec<OsString>,
    },
    /// Make a recording of a session's folder, or a folder of a recording (`convert --help` tells more)
    #[command(disable_help_flag = true)]
    Convert {
        /// Handed on to the harness
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        args: Vec<OsString>,
    },
    /// Make a session of a recording of nerfstudio, Record3D or Stray Scanner (`import --help` tells more)
    #[command(disable_help_flag = true)]
    Import {
        /// Handed on to the harness
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        args: Vec<OsString>,
    },
    /// Measure presets over sessions: time against error (`bench --help` tells more)
    #[command(disable_help_flag = true)]
    Bench {
        /// Handed on to the harness
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        args: Vec<OsString>,
    },
    /// What frames of a session must cost on any device, without one (`ledger --help` tells more)
    #[command(disable_help_flag = true)]
    Ledger {
        /// Handed on to the harness
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        args: Vec<OsString>,
    },
    /// Profile a session, or read a profile of a phone: a trace for Perfetto, and a table of tasks (`profile --help` tells more)
    #[command(disable_help_flag = true)]
    Profile {
        /// Handed on to the harness
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        args: Vec<OsString>,
    },
    /// Measure numerical stability on hard cases against bounds (`stability --help` tells more)
    #[command(disable_help_flag = true)]
    Stability {
        /// Handed on to the harness
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        args: Vec<OsString>,
    },
    /// Run the app on a desktop, with a session as its camera (`view --help` tells more)
    #[command(disable_help_flag = true)]
    View {
        /// Handed on to the harness
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        args: Vec<OsString>,
    },
    /// Write a card to print and to lay beside the toy (`card --help` tells more)
    #[command(disable_help_flag = true)]
    Card {
        /// Handed on to the harness
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        args: Vec<OsString>,
    },
    /// Rewrite the golden pictures and the schema of sessions (`bless --help` tells more)
    #[command(disable_help_flag = true)]
    Bless {
        /// Handed on to the harness
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        args: Vec<OsString>,
    },
    /// Format every source file
    Fmt,
    /// Check everything that must hold before a change is taken
    Test,
    /// Package both shells and hold their sizes against the budgets
    Size {
        /// Take the sizes anew, within the budgets
        #[arg(long)]
        record: bool,
    },
    /// Write the table of what the shells call of their platforms
    Calls,
    /// The iPhone shell
    #[command(subcommand)]
    Ios(IosCommand),
    /// The Android shell
    #[command(subcommand)]
    Android(AndroidCommand),
}

#[derive(Clone, Copy, Subcommand)]
enum IosCommand {
    /// Type check and lint for the phone
    Check,
    /// Build the library
    Build,
    /// Make an app: by Xcode on a Mac, elsewhere one that shows that it links
    Package,
}

#[derive(Subcommand)]
enum AndroidCommand {
    /// Type check and lint for the phone
    Check,
    /// Build the library with the NDK
    Build,
    /// Make a package: with NDK, SDK and ARCore one to install, else one that shows that it links
    Package {
        /// ARCore's archive, com.google.ar:core, an .aar
        #[arg(long, requires = "sha256")]
        arcore: Option<PathBuf>,
        /// What its SHA-256 must be, in hexadecimal
        #[arg(long, requires = "arcore")]
        sha256: Option<String>,
    },
}

impl From<IosCommand> for Action {
    fn from(command: IosCommand) -> Self {
        match command {
            IosCommand::Check => Self::Check,
            IosCommand::Build => Self::Build,
            IosCommand::Package => Self::Package(None),
        }
    }
}

impl From<AndroidCommand> for Action {
    fn from(command: AndroidCommand) -> Self {
        match command {
            AndroidCommand::Check => Self::Check,
            AndroidCommand::Build => Self::Build,
            AndroidCommand::Package { arcore, sha256 } => {
                let arcore = arcore.zip(sha256);
                Self::Package(arcore.map(|(archive, sha256)| Arcore { archive, sha256 }))
            }
        }
    }
}

fn main() -> ExitCode {
    run(Command::parse()).unwrap_or_else(|error| {
        eprintln!("error: {error:#}");
        ExitCode::FAILURE
    })
}

fn run(command: Command) -> anyhow::Result<ExitCode> {
    let toolchain = Toolchain::pinned()?;
    match command {
        Command::Demo => return harness::demo(&toolchain),
        Command::Replay { args } => return harness::run(&toolchain, "replay", &args),
        Command::Check { args } => return harness::run_on_processor(&toolchain, "check", &args),
        Command::Align { args } => return harness::run_on_processor(&toolchain, "align", &args),
        Command::Convert { args } => return harness::run_on_processor(&toolchain, "convert", &args),
        Command::Import { args } => return harness::run_on_processor(&toolchain, "import", &args),
        Command::Bench { args } => return harness::run(&toolchain, "bench", &args),
        Command::Ledger { args } => return harness::run_on_processor(&toolchain, "ledger", &args),
        Command::Profile { args } => return harness::run(&toolchain, "profile", &args),
        Command::Stability { args } => return harness::run(&toolchain, "stability", &args),
        Command::View { args } => return harness::run(&toolchain, "view", &args),
        Command::Card { args } => return harness::run_on_processor(&toolchain, "card", &args),
        Command::Bless { args } => return bless(&toolchain, &args),
        Command::Fmt => command::run(&mut format::rustfmt(&toolchain, &[])?)?,
        Command::Test => test::run(&toolchain)?,
        Command::Size { record } => {
            for phone in [&IOS, &ANDROID] {
                phone::run(&toolchain, phone, Action::Package(None))?;
            }
            phone::size::hold(&toolchain.root, record)?;
        }
        Command::Calls => {
            let table = phone::calls::table(&toolchain.root)?;
            std::fs::write(toolchain.root.join("xtask/doc/calls.md"), table)?;
        }
        Command::Ios(command) => phone::run(&toolchain, &IOS, command.into())?,
        Command::Android(command) => phone::run(&toolchain, &ANDROID, command.into())?,
    }
    Ok(ExitCode::SUCCESS)
}

/// Rewrites the goldens of the bundled session, the schema of sessions and, unless some of those are named, the goldens
/// of the scenes that only tests know.
fn bless(toolchain: &Toolchain, args: &[OsString]) -> anyhow::Result<ExitCode> {
    if args.is_empty() {
        let mut test = toolchain.cargo("test");
        test.args([
            "--package",
            "tests",
            "--test",
            "passes",
            "bless",
            "--",
            "--ignored",
        ]);
        // It never ends in success, so that no script goes on without anyone having looked.
        let _ = command::run(&mut test);
    }
    harness::run(toolchain, "bless", args)
}
