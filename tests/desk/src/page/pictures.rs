//! The pictures of a page beside the results.

use std::collections::HashMap;
use std::rc::Rc;
use std::sync::Arc;

use app_core::scene::Image;

use crate::output::WriteError;
use crate::output::folder::OutputFolder;
use crate::page::values;

/// Writes pictures into one folder. A picture equal to the last one of its name is not written
/// again: results of learning from the real shadow stay for many frames.
pub(crate) struct Pictures {
    output: Rc<OutputFolder>,
    /// Prefix of returned paths.
    prefix: String,
    folder: &'static str,
    has_values: bool,
    latest: HashMap<&'static str, (Arc<Image>, String)>,
}

impl Pictures {
    /// A writer into `folder` below `prefix`, which is empty or ends in `/`; nothing is created
    /// yet.
    pub(crate) fn new(output: &Rc<OutputFolder>, prefix: &str, folder: &'static str) -> Self {
        Self {
            output: Rc::clone(output),
            prefix: prefix.to_owned(),
            folder,
            has_values: false,
            latest: HashMap::new(),
        }
    }

    /// A writer of pictures whose values the page can show.
    pub(crate) fn with_values(self) -> Self {
        Self {
            has_values: true,
            ..self
        }
    }

    /// Writes the picture `name` of frame `index` and returns its path below the prefix.
    pub(crate) fn write(
        &mut self,
        name: &'static str,
        index: usize,
        image: Arc<Image>,
    ) -> Result<String, WriteError> {
        if let Some((latest, file)) = self.latest.get(name)
            && *latest == image
        {
            return Ok(file.clone());
        }
        let file = format!("{}/{name}_{index:04}.png", self.folder);
        let path = format!("{}{file}", self.prefix);
        let png = self.output.write_png(&path, &image)?;
        if self.has_values {
            values::write(&self.output, &path, &png)?;
        }
        self.latest.insert(name, (image, file.clone()));
        Ok(file)
    }
}
