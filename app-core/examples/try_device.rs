//! What a driver makes of the passes: it compiles each for every preset, and draws the self-test's pictures.
//!
//! `cargo run -p app-core --example try_device`
//!
//! The names go to standard error, where drivers print what their compilers counted: such lines are of the pass named below them.

use std::error::Error;

use app_core::preset::Preset;
use app_core::{Core, gpu, self_test, wgpu};

fn main() -> Result<(), Box<dyn Error>> {
    let instance = wgpu::Instance::default();
    let mut core = pollster::block_on(Core::headless(&instance, &gpu::AdapterChoice::Fastest))?;
    println!("{}", core.adapter_name());
    for &preset in Preset::ALL {
        for pass in core.warm_up(preset) {
            eprintln!("{preset} {}", pass?);
        }
    }
    for &preset in Preset::ALL {
        // A driver without a device draws nothing: that is no failure of this program.
        match self_test::run(&mut core, preset) {
            Ok(difference) => println!(
                "{preset}: worst block {:.3} codes off, mean {:.3}",
                difference.worst_codes, difference.mean_codes
            ),
            Err(error) => println!("{preset}: {error}"),
        }
    }
    Ok(())
}
