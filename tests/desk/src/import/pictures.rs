//! Pictures of a recording as a session needs them: one size, one lens, intrinsics of that size.

use std::io::Cursor;
use std::path::Path;

use app_core::scene::{Image, Intrinsics};
use app_core::session::Files;
use app_core::session::record::LensRecord;
use app_scene::picture;
use image::{ImageFormat, ImageReader, Limits};

use super::error::{ImportError, ImportReason};
use super::imported::Imported;
use super::lens::Lens;
use crate::output::png_of;

/// Limit for the size of a session's file.
pub(super) const MAX_FILE_BYTES: u64 = 512 << 20;
/// Rounding of a scaled picture's sides, in pixels.
const ROUNDED_PX: f64 = 1.5;
/// Largest distance of a principal point from the centre, as a fraction of the picture's side, if
/// its picture's size is unknown.
const OFF_CENTRE: f64 = 0.2;

/// The pictures' properties in the session.
pub(super) struct Fitted {
    pub(super) size_px: [u32; 2],
    /// Intrinsics of each frame.
    pub(super) intrinsics: Vec<Intrinsics>,
    /// The session's own lens, if all pictures have it.
    pub(super) lens: Option<LensRecord>,
    /// Whether each picture is undistorted by its own lens, since the session cannot express it.
    pub(super) is_undistorted: bool,
    pub(super) notes: Vec<String>,
}

/// Reads every picture's header, before any picture is written.
pub(super) fn fit(files: &dyn Files, imported: &Imported) -> Result<Fitted, ImportError> {
    let mut first: Option<(String, [u32; 2])> = None;
    let mut intrinsics = Vec::new();
    let mut scaled = None;
    for frame in &imported.frames {
        let size_px = size_px(files, &frame.image)?;
        let (first, first_px) = first.get_or_insert_with(|| (frame.image.clone(), size_px));
        let refused = |reason| Err(ImportError::new(&frame.image, "the picture", reason));
        if size_px != *first_px {
            return refused(ImportReason::Sizes {
                size_px,
                first: first.clone(),
                first_px: *first_px,
            });
        }
        let of_picture = of_size(frame.intrinsics, frame.size_px, size_px);
        match of_picture {
            Ok((of_picture, factor)) => {
                intrinsics.push(of_picture);
                scaled = scaled.or(factor.zip(frame.size_px));
            }
            Err(reason) => return refused(reason),
        }
    }
    let size_px = first.map_or([0; 2], |(_, size_px)| size_px);
    let mut fitted = Fitted {
        size_px,
        intrinsics,
        lens: None,
        is_undistorted: false,
        notes: Vec::new(),
    };
    if let Some((factor, [width, height])) = scaled {
        fitted.notes.push(format!(
            "the pictures are {} x {} px, the intrinsics of {width} x {height} px: these are scaled by {factor:.4}",
            size_px[0], size_px[1]
        ));
    }
    fitted.choose_lens(imported)?;
    Ok(fitted)
}

impl Fitted {
    /// Chooses the session's own lens if it is exact, else undistorted pictures.
    fn choose_lens(&mut self, imported: &Imported) -> Result<(), ImportError> {
        let Some(first) = imported.frames.first() else {
            return Ok(());
        };
        let lenses = imported
            .frames
            .iter()
            .map(|frame| frame.lens)
            .zip(&self.intrinsics);
        if lenses.clone().all(|(lens, _)| lens == Lens::NONE) {
            return Ok(());
        }
        let mut shared = lenses.clone();
        if shared.all(|(lens, of_picture)| lens == first.lens && lens.fits_session(of_picture, self.size_px))
        {
            self.lens = first.lens.as_session().map(|lens| LensRecord::from(&lens));
            return Ok(());
        }
        for (frame, (lens, of_picture)) in imported.frames.iter().zip(lenses) {
            lens.check(of_picture, self.size_px).map_err(|reason| {
                let lens = lens.named();
                ImportError::new(&frame.image, "the lens", ImportReason::Folds { lens, reason })
            })?;
        }
        self.is_undistorted = true;
        self.notes.push(format!(
            "the lens ({}) is more than a session's k1 and k2 for all frames: the pictures are undistorted, and written as PNG",
            first.lens.named()
        ));
        Ok(())
    }

    /// Path and bytes of a frame's picture in the session.
    pub(super) fn picture(
        &self,
        files: &dyn Files,
        imported: &Imported,
        index: usize,
    ) -> anyhow::Result<Vec<u8>> {
        let frame = &imported.frames[index];
        let bytes = read(files, &frame.image)?;
        if !self.is_undistorted {
            return Ok(bytes);
        }
        let made = frame
            .lens
            .to_pinhole(&self.intrinsics[index], &decoded(&frame.image, bytes)?);
        Ok(png_of(Path::new(&frame.image), &made)?)
    }

    /// Path of a picture in the session.
    pub(super) fn path(&self, image: &str) -> String {
        if self.is_undistorted && !image.ends_with(".png") {
            format!("{image}.png")
        } else {
            image.to_owned()
        }
    }
}

/// Intrinsics of a picture, and their scale factor; those of another picture are scaled if it
/// differs in size alone.
fn of_size(
    [fx, fy, cx, cy]: [f64; 4],
    stated_px: Option<[f64; 2]>,
    size_px: [u32; 2],
) -> Result<(Intrinsics, Option<f64>), ImportReason> {
    let [width, height] = size_px.map(f64::from);
    let [across, down] = match stated_px {
        None => [1.0; 2],
        Some(stated_px) => {
            let [across, down] = [width / stated_px[0], height / stated_px[1]];
            let is_same = (across * stated_px[1] - height).abs() <= ROUNDED_PX
                || (down * stated_px[0] - width).abs() <= ROUNDED_PX;
            if !is_same || !across.is_normal() || !down.is_normal() {
                return Err(ImportReason::Aspect { size_px, stated_px });
            }
            [across, down]
        }
    };
    let [cx, cy] = [across * cx, down * cy];
    let off = [cx / width - 0.5, cy / height - 0.5];
    if stated_px.is_none() && off.iter().any(|off| off.abs() > OFF_CENTRE) {
        return Err(ImportReason::Centre {
            size_px,
            centre_px: [cx, cy],
        });
    }
    let of_picture = Intrinsics {
        fx_px: across * fx,
        fy_px: down * fy,
        cx_px: cx,
        cy_px: cy,
    };
    let is_scaled = across != 1.0 || down != 1.0;
    Ok((of_picture, is_scaled.then_some(across)))
}

pub(super) fn read(files: &dyn Files, path: &str) -> Result<Vec<u8>, ImportError> {
    files
        .read(path, MAX_FILE_BYTES)
        .map_err(|error| ImportError::new(path, "the file", error))
}

/// Size in the picture's header.
fn size_px(files: &dyn Files, path: &str) -> Result<[u32; 2], ImportError> {
    let bytes = read(files, path)?;
    let is_read = matches!(
        image::guess_format(&bytes),
        Ok(ImageFormat::Png | ImageFormat::Jpeg)
    );
    if let (false, Some((format, way_out))) = (is_read, picture::kind(&bytes)) {
        let reason = ImportReason::OtherFormat { format, way_out };
        return Err(ImportError::new(path, "the file", reason));
    }
    let reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format();
    let size = reader
        .ok()
        .filter(|_| is_read)
        .and_then(|reader| reader.into_dimensions().ok())
        .ok_or_else(|| ImportError::new(path, "the file", ImportReason::NotAPicture))?;
    Ok(size.into())
}

fn decoded(path: &str, bytes: Vec<u8>) -> anyhow::Result<Image> {
    let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format()?;
    let mut limits = Limits::default();
    limits.max_alloc = Some(MAX_FILE_BYTES);
    reader.limits(limits);
    let picture = reader
        .decode()
        .map_err(|_| ImportError::new(path, "the file", ImportReason::NotAPicture))?;
    let picture = picture.into_rgba8();
    Ok(Image {
        width_px: picture.width(),
        height_px: picture.height(),
        rgba8: picture.into_raw(),
    })
}
