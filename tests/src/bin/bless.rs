//! Makes the picture that each preset makes now the one that is expected of it, and the schema that the session reader
//! has now the one that is kept; for the self-test the means of blocks. Never ends in success.

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
use harness::session_format::{SCHEMA_FILE, SCHEMA_NAME, schema_text};

/// Rewrite the golden pictures from what the presets make on the software adapter, and session.schema.json.
#[derive(Parser)]
#[command(name = "bless", bin_name = "cargo xtask bless")]
struct Args {
    /// Only those whose name contains this [default: all]
    #[arg(default_value = "")]
    filter: String,
}

fn main() -> ExitCode {
    match run(&Args::parse()) {
        Ok(()) => eprintln!("blessed, look at what has changed, then run the tests again"),
        Err(error) => eprintln!("error: {error:#}"),
    }
    // Success would let a script bless and go on, with no one having looked.
    ExitCode::FAILURE
}

fn run(args: &Args) -> anyhow::Result<()> {
    let is_schema_named = SCHEMA_NAME.contains(&args.filter);
    let named: Vec<(Preset, String)> = Preset::ALL
        .iter()
        .map(|&preset| (preset, name_of(preset)))
        .filter(|(_, name)| name.contains(&args.filter))
        .collect();
    ensure!(
        is_schema_named || !named.is_empty(),
        "no golden's name contains \"{}\"",
        args.filter
    );
    if is_schema_named {
        write_whole(Path::new(SCHEMA_FILE), schema_text().as_bytes())?;
        eprintln!("{SCHEMA_FILE}");
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

/// What the core is to expect of a preset in its self-test, and the picture to look at.
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
