//! The picture finer than a screen needs it, for programs that work on it further. Frames cost nothing for it until it is read.

use super::{Core, CoreError};
use crate::readback::FloatMap;
use crate::readback::layers::Layers;

impl Core {
    /// Waits for the device and returns the latest picture in linear light; alpha is 1. What is made in it is finer than codes of 8
    /// bits, and may be brighter than white; all else is the camera's codes, decoded. With the baseline's presets all of it is codes.
    ///
    /// # Errors
    /// When there is no scene, or the device is lost.
    pub fn read_light(&self) -> Result<FloatMap, CoreError> {
        let stage = self.stage.as_ref().ok_or(CoreError::NoScene)?;
        Ok(self.gpu.guarded(|| stage.read_light(&self.gpu))??)
    }

    /// Makes frames that would pass through, since they show what is there, like all others from the next one on, so that they have
    /// layers. Until another scene is set.
    ///
    /// # Errors
    /// When there is no scene.
    pub fn want_layers(&mut self) -> Result<(), CoreError> {
        self.stage.as_mut().ok_or(CoreError::NoScene)?.want_layers();
        Ok(())
    }

    /// Waits for the device and returns the layers of the latest picture, with the whole effect. Where the camera's picture passes
    /// through, and with the baseline's presets, that picture is the clean plate, and there is neither toy nor shadow.
    ///
    /// # Errors
    /// When there is no scene, or the device is lost.
    pub fn read_layers(&self) -> Result<Layers, CoreError> {
        let stage = self.stage.as_ref().ok_or(CoreError::NoScene)?;
        Ok(self.gpu.guarded(|| stage.read_layers(&self.gpu))??)
    }
}
