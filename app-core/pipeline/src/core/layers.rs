//! The picture in more precision than a screen needs, for programs that process it further. Frames
//! have no cost for it until it is read.

use super::{Core, CoreError};
use crate::readback::FloatMap;
use crate::readback::layers::Layers;

impl Core {
    /// Waits for the device and returns the latest picture in linear light; alpha is 1. Retargeted
    /// pixels have more precision than 8-bit codes and may be brighter than white; all other pixels
    /// are the camera's codes, decoded. With the baseline's presets all pixels are codes.
    ///
    /// # Errors
    /// If there is no scene, or the device is lost.
    pub fn read_light(&self) -> Result<FloatMap, CoreError> {
        let stage = self.stage.as_ref().ok_or(CoreError::NoScene)?;
        Ok(self.gpu.guarded(|| stage.read_light(&self.gpu))??)
    }

    /// Processes frames that would pass through unchanged like all others from the next frame on,
    /// so that they have layers, until another scene is set.
    ///
    /// # Errors
    /// If there is no scene.
    pub fn want_layers(&mut self) -> Result<(), CoreError> {
        self.stage.as_mut().ok_or(CoreError::NoScene)?.want_layers();
        Ok(())
    }

    /// Waits for the device and returns the layers of the latest picture, with the whole effect. If
    /// the camera's picture passes through, and with the baseline's presets, the clean plate is
    /// that picture, and toy and shadow are empty.
    ///
    /// # Errors
    /// If there is no scene, or the device is lost.
    pub fn read_layers(&self) -> Result<Layers, CoreError> {
        let stage = self.stage.as_ref().ok_or(CoreError::NoScene)?;
        Ok(self.gpu.guarded(|| stage.read_layers(&self.gpu))??)
    }
}
