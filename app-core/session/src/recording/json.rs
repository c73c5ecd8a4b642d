//! JSON that a caller gives to a writer.

use std::collections::BTreeMap;

use serde_json::value::RawValue;

use super::error::WriteError;
use super::viewer::SessionShape;
use crate::MAX_INDEX_BYTES;

/// The session's index without its frames, and what viewers need of it.
pub(super) fn session_without_frames(session: &str) -> Result<(Box<RawValue>, SessionShape), WriteError> {
    const WHAT: &str = "the session's index";
    let failed = |error: serde_json::Error| json_error(WHAT, &error);
    if session.len() as u64 > MAX_INDEX_BYTES {
        return Err(WriteError::TooLarge {
            what: WHAT,
            n_bytes: session.len() as u64,
            max_bytes: MAX_INDEX_BYTES,
        });
    }
    let mut keys: BTreeMap<String, &RawValue> = serde_json::from_str(session).map_err(failed)?;
    keys.remove("frames");
    let raw = serde_json::value::to_raw_value(&keys).map_err(failed)?;
    let shape = serde_json::from_str(raw.get()).unwrap_or_default();
    Ok((raw, shape))
}

/// An object's text as it was written; `what` names it in an error.
pub(super) fn object<'a>(what: &'static str, text: &'a str) -> Result<&'a RawValue, WriteError> {
    let raw: &RawValue = serde_json::from_str(text).map_err(|error| json_error(what, &error))?;
    if raw.get().starts_with('{') {
        Ok(raw)
    } else {
        let reason = "not an object".to_owned();
        Err(WriteError::Json { what, reason })
    }
}

/// The error of a text that is not as it must be.
pub(super) fn json_error(what: &'static str, error: &serde_json::Error) -> WriteError {
    let reason = error.to_string();
    WriteError::Json { what, reason }
}
