//! The examples run: they are the first code that a stranger copies.

use std::error::Error;

#[path = "../examples/live_loop.rs"]
mod live_loop;
#[path = "../examples/own_device.rs"]
mod own_device;
#[path = "../examples/session_from_code/main.rs"]
mod session_from_code;

#[test]
fn a_device_of_the_programs_own() -> Result<(), Box<dyn Error>> {
    own_device::main()
}

#[test]
fn a_loop_over_poses() -> Result<(), Box<dyn Error>> {
    live_loop::main()
}

#[test]
fn a_session_from_code() -> Result<(), Box<dyn Error>> {
    session_from_code::main()
}
