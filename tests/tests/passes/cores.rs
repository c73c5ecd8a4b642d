//! Cores that tests share in turn: devices and pipelines are created once, and a scene replaces
//! everything else.

use std::ops::{Deref, DerefMut};
use std::sync::{Mutex, PoisonError};

use app_core::core::{Core, CoreError};
use app_core::preset::Preset;
use app_core::scene::Scene;
use harness::open_core;

static IDLE: Mutex<Vec<Core>> = Mutex::new(Vec::new());

/// A core that is returned when it is dropped.
pub(crate) struct SharedCore(Option<Core>);

impl Deref for SharedCore {
    type Target = Core;

    fn deref(&self) -> &Core {
        self.0.as_ref().unwrap()
    }
}

impl DerefMut for SharedCore {
    fn deref_mut(&mut self) -> &mut Core {
        self.0.as_mut().unwrap()
    }
}

impl Drop for SharedCore {
    fn drop(&mut self) {
        let mut idle = IDLE.lock().unwrap_or_else(PoisonError::into_inner);
        idle.extend(self.0.take());
    }
}

/// A core that no test uses, with any scene.
pub(crate) fn any_core() -> SharedCore {
    let idle = IDLE.lock().unwrap_or_else(PoisonError::into_inner).pop();
    SharedCore(Some(idle.unwrap_or_else(open_core)))
}

/// A core with a scene.
pub(crate) fn core_on(scene: Scene, preset: Preset) -> Result<SharedCore, CoreError> {
    let mut core = any_core();
    core.set_scene(scene, preset)?;
    Ok(core)
}
