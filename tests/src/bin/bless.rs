//! Rewrites the goldens: the expected picture of each preset, the schema of sessions with the
//! tables of its document, and the block means of the self-test. Never ends in success.

use std::path::Path;
use std::process::ExitCode;

use anyhow::{Context, ensure};
use app_core::core::Core;
use app_core::gpu::AdapterChoice;
use app_core::preset::Preset;
use app_core::self_test;
use app_core::wgpu;
use clap::Parser;
use desk::output::{make_folder, write_png, write_whole};
use harness::golden::{Goldens, SOFTWARE_ADAPTER, name_of, render};
use harness::session_format::{DOCUMENT_FILE, SCHEMA_FILE, document_text, schema_text};

/// Rewrite the golden pictures by the presets on the software adapter, session.schema.json, and the
/// tables of session.md.
#[derive(Parser)]
#[command(name = "bless", bin_name = "cargo xtask bless")]
struct Args {
    /// Only those whose name contains this text [default: all]
    #[arg(default_value = "")]
    filter: String,
}

fn main() -> ExitCode {
    match run(&Args::parse()) {
        Ok(()) => eprintln!("blessed, look at what has changed, then run the tests again"),
        Err(error) => eprintln!("error: {error:#}"),
    }
    // Success would let a script go on without anyone having looked.
    ExitCode::FAILURE
}

fn run(args: &Args) -> anyhow::Result<()> {
    let of_sessions = [(SCHEMA_FILE, schema_text()), (DOCUMENT_FILE, document_text())];
    let of_sessions = of_sessions.map(|(file, text)| (Path::new(file), text));
    let of_sessions: Vec<_> = of_sessions
        .into_iter()
        .filter(|(file, _)| {
            let name = file.file_name().unwrap_or_default();
            name.to_string_lossy().contains(&args.filter)
        })
        .collect();
    let named: Vec<(Preset, String)> = Preset::ALL
        .iter()
        .map(|&preset| (preset, name_of(preset)))
        .filter(|(_, name)| name.contains(&args.filter))
        .collect();
    ensure!(
        !of_sessions.is_empty() || !named.is_empty(),
        "no name contains \"{}\"",
        args.filter
    );
    for (file, text) in of_sessions {
        write_whole(file, text.as_bytes())?;
        eprintln!("{}", file.display());
    }
    if named.is_empty() {
        return Ok(());
    }
    bless_pictures(named)
}

fn bless_pictures(named: Vec<(Preset, String)>) -> anyhow::Result<()> {
    let adapter = AdapterChoice::Named(SOFTWARE_ADAPTER.to_owned());
    let mut core = pollster::block_on(Core::headless(&wgpu::Instance::default(), &adapter))
        .context("goldens are made on the software adapter alone")?;
    let goldens = Goldens::of_project();
    for &(preset, _) in &named {
        bless_self_test(&mut core, preset)?;
    }
    for (preset, name) in named {
        let rendered = render(&mut core, preset).with_context(|| name.clone())?;
        goldens.write(&name, &rendered.golden)?;
        eprintln!("{}", goldens.path(&name).display());
    }
    Ok(())
}

/// The expected block means of a preset's self-test, and its picture.
fn bless_self_test(core: &mut Core, preset: Preset) -> anyhow::Result<()> {
    let picture = self_test::render(core, preset).with_context(|| preset.name())?;
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let kept = top.join(format!("app-core/live/src/self_test/golden/{preset}.txt"));
    write_whole(&kept, self_test::kept(&picture).as_bytes())?;
    let looked_at = top.join("target/self_test");
    make_folder(&looked_at)?;
    write_png(&looked_at.join("photograph.png"), &self_test::photograph()?)?;
    let drawn = looked_at.join(format!("{preset}.png"));
    write_png(&drawn, &picture)?;
    eprintln!("{} of {}", kept.display(), drawn.display());
    Ok(())
}
