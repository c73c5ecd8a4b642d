//! The folder that a replay writes into.

use std::path::Path;
use std::rc::Rc;

use crate::files::SESSION_FILE;
use crate::output::folder::OutputFolder;
use crate::replay_error::ReplayError;

/// Refuses a folder that a replay would refuse to write into, and changes nothing. Call it before
/// long work.
///
/// # Errors
/// When it holds a session, or files that no run wrote.
pub fn check_out(out: &Path) -> Result<(), ReplayError> {
    refuse_session(out)?;
    Ok(OutputFolder::check(out)?)
}

/// Takes the folder, and removes the files of an earlier replay.
///
/// # Errors
/// As [`check_out`], and when another run writes into it.
pub(crate) fn take(out: &Path) -> Result<Rc<OutputFolder>, ReplayError> {
    refuse_session(out)?;
    Ok(Rc::new(OutputFolder::take(out)?))
}

fn refuse_session(out: &Path) -> Result<(), ReplayError> {
    if out.join(SESSION_FILE).exists() {
        return Err(ReplayError::OutIsSession {
            folder: out.to_owned(),
        });
    }
    Ok(())
}
