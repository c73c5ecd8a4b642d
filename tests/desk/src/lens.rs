//! Converts pictures from the pinhole's view to the session's lens.

use app_core::lens::Lens;
use app_core::scene::Image;
use app_core::session::{Session, SessionError};

/// The photograph of the frame `index` with the changes of its pinhole's picture `made`, of the
/// same size: `made` itself if the session has no lens. Pixels with unchanged surroundings are the
/// photograph's own.
///
/// # Errors
/// When there is no such frame, or its picture cannot be read.
pub fn through_lens(session: &dyn Session, index: usize, made: Image) -> Result<Image, SessionError> {
    Ok(match lens_for(session, index, &made)? {
        Some(lens) => {
            let seen = session.frame(index)?.image;
            lens.with_changes(&*session.photograph(index)?, [&*seen, &made])
        }
        None => made,
    })
}

/// A map over the pinhole's picture of the frame `index`, of the same size, converted to the
/// photograph: `map` itself if the session has no lens. Pixels beside it are zero.
///
/// # Errors
/// When there is no such frame.
pub fn map_through_lens(session: &dyn Session, index: usize, map: Image) -> Result<Image, SessionError> {
    Ok(match lens_for(session, index, &map)? {
        Some(lens) => lens.of_map(&map),
        None => map,
    })
}

/// The lens for a picture of the session's size.
fn lens_for(session: &dyn Session, index: usize, picture: &Image) -> Result<Option<Lens>, SessionError> {
    let scene = session.scene();
    let lens = session.lens(index)?;
    Ok(lens.filter(|_| picture.is_of_size([scene.width_px, scene.height_px])))
}
