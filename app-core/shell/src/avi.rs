//! A video of JPEG pictures at a constant rate: Motion JPEG in an AVI file.
//!
//! Source: Microsoft, «AVI RIFF File Reference», of which this is the part with one stream and an
//! index.

use std::io::{self, Seek, SeekFrom, Write};

/// `AVIF_HASINDEX`.
const HAS_INDEX: u32 = 0x10;
/// `AVIIF_KEYFRAME`.
const KEY_FRAME: u32 = 0x10;
/// Bytes of `avih`, `strh` and `strf`.
const MAIN_BYTES: u32 = 56;
const STREAM_BYTES: u32 = 56;
const FORMAT_BYTES: u32 = 40;
/// Name and length before the content of a chunk.
const HEAD_BYTES: u32 = 8;
/// Offset from the beginning of the file to the type of the list of pictures.
const MOVIE_AT: u32 = 12 + HEAD_BYTES + list_bytes() + HEAD_BYTES;
/// Maximum size of a file: players count its bytes in 31 bits.
const MAX_BYTES: u32 = 1 << 30;

/// Contents of the list `hdrl`.
const fn list_bytes() -> u32 {
    let stream = 4 + HEAD_BYTES + STREAM_BYTES + HEAD_BYTES + FORMAT_BYTES;
    4 + HEAD_BYTES + MAIN_BYTES + HEAD_BYTES + stream
}

/// Writes one video; [`Avi::finish`] completes it.
#[derive(Debug)]
pub(crate) struct Avi<W> {
    file: W,
    size_px: [u32; 2],
    hz: u32,
    /// Offset of each picture from the list's type, and its length.
    pictures: Vec<[u32; 2]>,
    /// Bytes of the list of pictures, including its type.
    movie_bytes: u32,
    longest: u32,
}

impl<W: Write + Seek> Avi<W> {
    /// Begins a video of `hz` pictures a second.
    ///
    /// # Errors
    /// Those of the file.
    pub(crate) fn begin(file: W, size_px: [u32; 2], hz: u32) -> io::Result<Self> {
        let mut avi = Self {
            file,
            size_px,
            hz,
            pictures: Vec::new(),
            movie_bytes: 4,
            longest: 0,
        };
        avi.write_head()?;
        Ok(avi)
    }

    /// Number of pictures so far.
    #[must_use]
    pub(crate) fn n_pictures(&self) -> usize {
        self.pictures.len()
    }

    /// Whether there is space for this picture.
    #[must_use]
    pub(crate) fn has_room(&self, jpeg: &[u8]) -> bool {
        let index = u32::try_from(16 * self.pictures.len()).unwrap_or(u32::MAX);
        let picture = u32::try_from(jpeg.len()).unwrap_or(u32::MAX);
        let all = [MOVIE_AT, self.movie_bytes, index, picture, 4 * HEAD_BYTES];
        all.into_iter().fold(0, u32::saturating_add) < MAX_BYTES
    }

    /// Adds a picture, which is shown for one period of the rate.
    ///
    /// # Errors
    /// Those of the file; [`io::ErrorKind::FileTooLarge`] if there is no space for it.
    pub(crate) fn add(&mut self, jpeg: &[u8]) -> io::Result<()> {
        if !self.has_room(jpeg) {
            return Err(io::ErrorKind::FileTooLarge.into());
        }
        let n_bytes = u32::try_from(jpeg.len()).map_err(io::Error::other)?;
        chunk(&mut self.file, *b"00dc", n_bytes)?;
        self.file.write_all(jpeg)?;
        let pad = n_bytes % 2;
        self.file.write_all(&[0][..pad as usize])?;
        self.pictures.push([self.movie_bytes, n_bytes]);
        self.movie_bytes += HEAD_BYTES + n_bytes + pad;
        self.longest = self.longest.max(n_bytes);
        Ok(())
    }

    /// Writes the index and the sizes that were unknown before, and returns the file.
    ///
    /// # Errors
    /// Those of the file.
    pub(crate) fn finish(mut self) -> io::Result<W> {
        let n_pictures = u32::try_from(self.pictures.len()).map_err(io::Error::other)?;
        chunk(&mut self.file, *b"idx1", 16 * n_pictures)?;
        for [offset, n_bytes] in &self.pictures {
            self.file.write_all(b"00dc")?;
            words(&mut self.file, &[KEY_FRAME, *offset, *n_bytes])?;
        }
        self.file.seek(SeekFrom::Start(0))?;
        self.write_head()?;
        self.file.seek(SeekFrom::End(0))?;
        self.file.flush()?;
        Ok(self.file)
    }

    /// Writes the part before the first picture, with the sizes known so far.
    fn write_head(&mut self) -> io::Result<()> {
        let n_pictures = u32::try_from(self.pictures.len()).map_err(io::Error::other)?;
        let [width, height] = self.size_px;
        let index_bytes = HEAD_BYTES + 16 * n_pictures;
        let (hz, longest, file) = (self.hz.max(1), self.longest, &mut self.file);
        chunk(
            file,
            *b"RIFF",
            MOVIE_AT - HEAD_BYTES + self.movie_bytes + index_bytes,
        )?;
        file.write_all(b"AVI ")?;
        chunk(file, *b"LIST", list_bytes())?;
        file.write_all(b"hdrl")?;
        chunk(file, *b"avih", MAIN_BYTES)?;
        let most_per_s = longest.saturating_mul(hz);
        let main = [
            1_000_000 / hz,
            most_per_s,
            0,
            HAS_INDEX,
            n_pictures,
            0,
            1,
            longest,
            width,
            height,
        ];
        words(file, &main)?;
        words(file, &[0; 4])?;
        chunk(
            file,
            *b"LIST",
            4 + HEAD_BYTES + STREAM_BYTES + HEAD_BYTES + FORMAT_BYTES,
        )?;
        file.write_all(b"strl")?;
        chunk(file, *b"strh", STREAM_BYTES)?;
        file.write_all(b"vidsMJPG")?;
        // Flags, priority and language, first frame; scale and rate: pictures a second; start and length; the largest picture.
        words(file, &[0, 0, 0, 1, hz, 0, n_pictures, longest])?;
        // Quality by default, no fixed size of a sample, and the rectangle of the picture.
        words(file, &[u32::MAX, 0, 0, width & 0xffff | height << 16])?;
        chunk(file, *b"strf", FORMAT_BYTES)?;
        let picture_bytes = width.saturating_mul(height).saturating_mul(3);
        // One plane of 24 bits.
        words(file, &[FORMAT_BYTES, width, height, 24 << 16 | 1])?;
        file.write_all(b"MJPG")?;
        words(file, &[picture_bytes, 0, 0, 0, 0])?;
        chunk(file, *b"LIST", self.movie_bytes)?;
        file.write_all(b"movi")
    }
}

fn chunk(file: &mut impl Write, name: [u8; 4], n_bytes: u32) -> io::Result<()> {
    file.write_all(&name)?;
    words(file, &[n_bytes])
}

fn words(file: &mut impl Write, words: &[u32]) -> io::Result<()> {
    words
        .iter()
        .try_for_each(|word| file.write_all(&word.to_le_bytes()))
}
