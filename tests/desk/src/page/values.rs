//! The values of a picture for a page that is opened from disk: a browser shows a picture beside
//! such a page, but does not let a script read it. A second script beside the picture holds its
//! values.

use crate::output::WriteError;
use crate::output::folder::OutputFolder;

/// Folder of these scripts, below the output folder.
pub const VALUES_FOLDER: &str = "values";
/// First of the characters that stand for the bytes 0 to 255: none of them ends a text or needs an
/// escape.
const FIRST_CHARACTER: u32 = 0x100;

/// Writes the values of a picture. `file` is its path below the output folder, `png` its bytes.
pub(crate) fn write(output: &OutputFolder, file: &str, png: &[u8]) -> Result<(), WriteError> {
    let characters = png.iter().map(|byte| FIRST_CHARACTER + u32::from(*byte));
    let text: String = characters.filter_map(char::from_u32).collect();
    let name = serde_json::Value::from(file);
    let script = format!("takeValues({name}, \"{text}\");\n");
    output.write(&format!("{VALUES_FOLDER}/{file}.js"), script.as_bytes())
}
