//! The project's commands, as `cargo xtask <command>`. Each checks its requirements before it
//! starts, fetches them if permitted, and names missing ones.

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

use anyhow::{Context, Result, bail};
use lexopt::Arg::{Long, Short, Value};
use lexopt::{Parser, ValueExt};

use crate::phone::{ANDROID, Action, Arcore, IOS, IphoneApp, Phone, Profile};
use crate::toolchain::Toolchain;

/// The program of the demo.
const REPLAY: Program =
    Program::new("replay", "desk", "Replay a session: pictures, times, errors").on_device();

/// Programs that receive all arguments after their name.
#[rustfmt::skip] // One program a line.
const PROGRAMS: [Program; 16] = [
    REPLAY,
    Program::new("check", "desk", "Report all mistakes of a session, and draw its predictions over its first frame"),
    Program::new("align", "desk", "Write a session anew with cameras, pose and lights aligned by its pictures"),
    Program::new("convert", "desk", "Convert a session's folder to a recording, or a recording to a folder"),
    Program::new("import", "desk", "Make a session from a recording of nerfstudio, Record3D or Stray Scanner, a model of COLMAP or a scene of BOP"),
    Program::new("new", "film", "Make a session from photographs, with the toy as the marker"),
    Program::new("clips", "film", "List the clips of a toy, with thumbnails"),
    Program::new("animate", "film", "Make a film from a photograph: clips of the toy become numbered pictures").on_device(),
    Program::new("inbetween", "film", "Make the frames between key poses that were printed and photographed one by one").on_device(),
    Program::new("card", "desk", "Write a card to print and to lay beside the toy"),
    Program::new("bench", "measure", "Measure presets over sessions: time against error").on_device(),
    Program::new("ledger", "measure", "The cost of a session's frames on any device, counted without one"),
    Program::new("profile", "measure", "A trace for Perfetto and a table of tasks, of a session or of a phone's profile").on_device(),
    Program::new("stability", "measure", "Measure numerical stability on hard cases against bounds").on_device(),
    Program::new("view", "view", "Run the app on a desktop, with a session as its camera").on_device(),
    Program::new("bless", "tests", "Rewrite the golden pictures, the schema of sessions and its tables in the document").on_device(),
];

/// This program's own commands, with their descriptions.
#[rustfmt::skip] // One command a line.
const COMMANDS: [(&str, &str); 7] = [
    ("demo", "Replay the bundled session into target/demo"),
    ("test", "Run all checks that a change must pass"),
    ("fmt", "Format every source file"),
    ("size [--record]", "Package both shells and compare their sizes with the budgets; or record new sizes, within them"),
    ("calls", "Write the table of the shells' calls of their platforms"),
    ("ios check|build|package|log [--first-phone] [--device NAME] [--bundle ID]", "The iPhone shell: lints, the library, an app (on a Mac; elsewhere one that shows that it links), for engineers with --first-phone; or what a phone has written"),
    ("android check|build|package|log [--first-phone] [--arcore AAR --sha256 HEX]", "The Android shell: lints, the library (by the NDK), a package (with NDK, SDK and ARCore's archive, com.google.ar:core, whose SHA-256 is HEX, one to install), for engineers with --first-phone; or what a phone has written"),
];

/// The work that follows after all arguments are parsed.
type Work = Box<dyn FnOnce(&Toolchain) -> Result<ExitCode>>;

/// A program of the workspace.
#[derive(Clone, Copy)]
struct Program {
    name: &'static str,
    package: &'static str,
    about: &'static str,
    needs_device: bool,
}

impl Program {
    const fn new(name: &'static str, package: &'static str, about: &'static str) -> Self {
        Self {
            name,
            package,
            about,
            needs_device: false,
        }
    }

    /// A program that draws.
    const fn on_device(self) -> Self {
        Self {
            needs_device: true,
            ..self
        }
    }
}

fn main() -> ExitCode {
    run(Parser::from_env()).unwrap_or_else(|error| {
        eprintln!("error: {error:#}");
        ExitCode::FAILURE
    })
}

fn run(mut args: Parser) -> Result<ExitCode> {
    let command = match args.next()? {
        None => {
            eprint!("{}", help());
            return Ok(ExitCode::from(2));
        }
        Some(Long("help") | Short('h')) => {
            print!("{}", help());
            return Ok(ExitCode::SUCCESS);
        }
        Some(Value(command)) => command.string()?,
        Some(other) => return Err(other.unexpected().into()),
    };
    if let Some(program) = PROGRAMS.iter().find(|program| program.name == command) {
        let mut rest: Vec<OsString> = args.raw_args()?.collect();
        if rest.first().is_some_and(|arg| arg == "--") {
            rest.remove(0);
        }
        let toolchain = Toolchain::pinned()?;
        return match program.name {
            "bless" => bless(&toolchain, program, &rest),
            _ => harness::become_program(&toolchain, program, &rest),
        };
    }
    let asks = |args: &[OsString]| args.iter().any(|arg| arg == "--help" || arg == "-h");
    if command == "help" || asks(args.raw_args()?.as_slice()) {
        print!("{}", help());
        return Ok(ExitCode::SUCCESS);
    }
    match parsed(&command, &mut args) {
        Ok(work) => work(&Toolchain::pinned()?),
        Err(error) => {
            eprintln!("error: {error:#}");
            Ok(ExitCode::from(2))
        }
    }
}

/// The work of one of this program's own commands, after all of its arguments are parsed.
fn parsed(command: &str, args: &mut Parser) -> Result<Work> {
    type Step = fn(&Toolchain) -> Result<()>;
    let step: Step = match command {
        "demo" => {
            end(args)?;
            return Ok(Box::new(harness::demo));
        }
        "ios" => return phone_action(&IOS, args),
        "android" => return phone_action(&ANDROID, args),
        "size" => {
            let record = match args.next()? {
                Some(Long("record")) => true,
                Some(other) => return Err(other.unexpected().into()),
                None => false,
            };
            end(args)?;
            return Ok(Box::new(move |toolchain| size(toolchain, record)));
        }
        "fmt" => |toolchain| command::run(&mut format::rustfmt(toolchain, &[])?),
        "test" => test::run,
        "calls" => |toolchain| {
            let table = phone::calls::table(&toolchain.root)?;
            Ok(std::fs::write(toolchain.root.join("xtask/doc/calls.md"), table)?)
        },
        _ => bail!("there is no command \"{command}\"\n\n{}", help()),
    };
    end(args)?;
    Ok(Box::new(move |toolchain| {
        step(toolchain).map(|()| ExitCode::SUCCESS)
    }))
}

fn phone_action(phone: &'static Phone, args: &mut Parser) -> Result<Work> {
    let (mut action, mut archive, mut sha256) = (None, None, None);
    let (mut profile, mut app) = (Profile::default(), IphoneApp::default());
    while let Some(arg) = args.next()? {
        match arg {
            Value(word) if action.is_none() => action = Some(word.string()?),
            Long("arcore") if phone.is_android() => archive = Some(PathBuf::from(args.value()?)),
            Long("sha256") if phone.is_android() => sha256 = Some(args.value()?.string()?),
            Long("first-phone") => profile = Profile::FirstPhone,
            Long("device") if !phone.is_android() => app.device = Some(args.value()?.string()?),
            Long("bundle") if !phone.is_android() => app.bundle = Some(args.value()?.string()?),
            other => return Err(other.unexpected().into()),
        }
    }
    let arcore = match (archive, sha256) {
        (Some(archive), Some(sha256)) => Some(Arcore { archive, sha256 }),
        (None, None) => None,
        _ => bail!("--arcore and --sha256 go together"),
    };
    let action = match action.as_deref().context("check, build, package or log?")? {
        "package" => Action::Package(arcore, profile),
        _ if arcore.is_some() || profile != Profile::default() => {
            bail!("--arcore and --first-phone are for a package")
        }
        "log" => Action::Log(app),
        "check" => Action::Check,
        "build" => Action::Build,
        other => bail!("\"{other}\" is none of check, build, package and log"),
    };
    Ok(Box::new(move |toolchain| {
        phone::run(toolchain, phone, action).map(|()| ExitCode::SUCCESS)
    }))
}

fn size(toolchain: &Toolchain, record: bool) -> Result<ExitCode> {
    for phone in [&IOS, &ANDROID] {
        phone::run(toolchain, phone, Action::Package(None, Profile::Release))?;
    }
    phone::size::hold(&toolchain.root, record)?;
    Ok(ExitCode::SUCCESS)
}

/// Refuses further arguments.
fn end(args: &mut Parser) -> Result<()> {
    args.next()?.map_or(Ok(()), |arg| Err(arg.unexpected().into()))
}

fn help() -> String {
    let own = COMMANDS
        .iter()
        .map(|(command, about)| format!("  {command}\n      {about}\n"));
    let programs = PROGRAMS.iter().map(|program| {
        let Program { name, about, .. } = program;
        format!("  {name} …\n      {about} (`{name} --help` says more)\n")
    });
    let lines: String = own.chain(programs).collect();
    format!("The project's commands.\n\nUsage: cargo xtask <command>\n\nCommands:\n{lines}")
}

/// Rewrites the goldens of the bundled session, the schema of sessions and, unless some of those
/// are named, the goldens of the tests' own scenes.
fn bless(toolchain: &Toolchain, program: &Program, args: &[OsString]) -> Result<ExitCode> {
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
    harness::run(toolchain, program, args)
}
