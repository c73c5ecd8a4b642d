//! Other texts of shaders, for those who change them.

use super::window::Window;
use super::{Core, CoreError};
use crate::gpu::{GpuError, ShaderTexts};
use crate::passes::present::OUTPUT_FORMAT;
use crate::passes::screen;
use crate::preset::Preset;

impl Core {
    /// Draws with other WGSL files from now on: those of `texts`, and all others as they are built in. The scene is to be set again, as
    /// after [`Core::forget_scene`]. Cores [beside](Core::beside) this one follow when their scenes are set; no
    /// [`Core::warm_up`] may run on another thread meanwhile.
    ///
    /// # Errors
    /// When the device refuses a pass, in the words of its compiler and with the pass's name: shaders and scene stay as they were.
    pub fn replace_shaders(&mut self, texts: ShaderTexts) -> Result<(), CoreError> {
        let before = self.gpu.replace_shaders(texts);
        let screen = match self.compile_all() {
            Ok(screen) => screen,
            Err(error) => {
                self.gpu.replace_shaders(before);
                return Err(error.into());
            }
        };
        if let Some(window) = &mut self.window {
            window.screen = screen;
        }
        self.preview = None;
        self.forget_scene();
        Ok(())
    }

    /// Whether nothing was put in place of the shaders that are built in.
    #[must_use]
    pub fn has_built_in_shaders(&self) -> bool {
        self.gpu.has_built_in_shaders()
    }

    /// Compiles the passes of all presets, and the screen's, which it returns.
    fn compile_all(&self) -> Result<screen::Pass, GpuError> {
        for preset in Preset::ALL {
            for compiled in self.warm_up(*preset) {
                compiled?;
            }
        }
        let format = self.window.as_ref().map_or(OUTPUT_FORMAT, Window::format);
        self.gpu.guarded(|| screen::Pass::new(&self.gpu, format))
    }
}
