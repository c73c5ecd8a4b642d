//! Replacement of shader texts, for shader authors.

use super::window::Window;
use super::{Core, CoreError};
use crate::gpu::{GpuError, ShaderTexts};
use crate::passes::present::OUTPUT_FORMAT;
use crate::passes::screen;
use crate::preset::Preset;

impl Core {
    /// Draws with other WGSL files from now on: those of `texts`, and the built-in files otherwise.
    /// The scene must be set again, as after [`Core::forget_scene`]. Cores [beside](Core::beside)
    /// this one follow when their scenes are set; no [`Core::warm_up`] may run on another thread
    /// meanwhile.
    ///
    /// # Errors
    /// If the device refuses a pass, in the words of its compiler and with the pass's name: shaders
    /// and scene then stay unchanged.
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

    /// Whether all shaders are the built-in ones.
    #[must_use]
    pub fn has_built_in_shaders(&self) -> bool {
        self.gpu.has_built_in_shaders()
    }

    /// Compiles the passes of all presets and returns the screen's pass.
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
