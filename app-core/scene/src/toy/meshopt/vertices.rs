//! The vertex codec, versions 0 and 1: bytes at the same position of each element together, as
//! differences, in few bits.

/// Largest number of a block's bytes, and of its elements.
const BLOCK_BYTES: usize = 8192;
const MAX_BLOCK: usize = 256;
/// Number of bytes with a common bit width.
const GROUP: usize = 16;

/// A stream and the position in it.
struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    fn take(&mut self, n_bytes: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.rest.split_at_checked(n_bytes)?;
        self.rest = rest;
        Some(taken)
    }

    fn byte(&mut self) -> Option<u8> {
        self.take(1)?.first().copied()
    }
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Version {
    Zero,
    One,
}

/// The parameters of a block.
struct Shape<'a> {
    version: Version,
    n_elements: usize,
    /// In version 1: for each four bytes of an element, the kind of their differences.
    channels: &'a [u8],
}

/// Decodes `count` elements of `stride` bytes, a multiple of four up to 256.
pub(super) fn decode(stream: &[u8], count: usize, stride: usize) -> Option<Vec<u8>> {
    let (&header, rest) = stream.split_first()?;
    let version = match header {
        0xa0 => Version::Zero,
        0xa1 => Version::One,
        _ => return None,
    };
    let (tail_bytes, least) = match version {
        Version::Zero => (stride, 32),
        Version::One => (stride + stride / 4, 24),
    };
    let (data, tail) = rest.split_at_checked(rest.len().checked_sub(tail_bytes.max(least))?)?;
    let tail = tail.get(tail.len() - tail_bytes..)?;
    let (first, channels) = tail.split_at_checked(stride)?;
    let mut last = first.to_vec();
    let mut reader = Reader { rest: data };
    let mut bytes = vec![0; count.checked_mul(stride)?];
    let n_whole = (BLOCK_BYTES / stride / GROUP * GROUP).min(MAX_BLOCK);
    for block in bytes.chunks_mut(n_whole * stride) {
        let shape = Shape {
            version,
            n_elements: block.len() / stride,
            channels,
        };
        decode_block(&mut reader, &shape, block, &mut last)?;
    }
    reader.rest.is_empty().then_some(bytes)
}

/// Decodes a block. `last` is the element before the block, and then its last one.
fn decode_block(reader: &mut Reader, shape: &Shape, block: &mut [u8], last: &mut [u8]) -> Option<()> {
    let stride = last.len();
    let control = match shape.version {
        Version::Zero => &[],
        Version::One => reader.take(stride / 4)?,
    };
    for word in 0..stride / 4 {
        let control = control.get(word).copied();
        let mut lanes = [[0; MAX_BLOCK]; 4];
        for (byte, lane) in lanes.iter_mut().enumerate() {
            let mode = control.map(|control| control >> (2 * byte) & 3);
            decode_lane(reader, mode, &mut lane[..shape.n_elements])?;
        }
        let channel = shape.channels.get(word).copied().unwrap_or_default();
        add_up(&lanes, channel, (4 * word, stride), (block, last))?;
    }
    last.copy_from_slice(&block[block.len() - stride..]);
    Some(())
}

/// Decodes the differences of the bytes at one position. `mode` exists in version 1.
fn decode_lane(reader: &mut Reader, mode: Option<u8>, lane: &mut [u8]) -> Option<()> {
    let bits: [u32; 4] = match mode {
        None => [0, 2, 4, 8],
        Some(0) => [0, 1, 2, 4],
        Some(1) => [1, 2, 4, 8],
        Some(2) => return Some(()),
        Some(_) => {
            lane.copy_from_slice(reader.take(lane.len())?);
            return Some(());
        }
    };
    let n_groups = lane.len().div_ceil(GROUP);
    let header = reader.take(n_groups.div_ceil(4))?;
    for (index, group) in lane.chunks_mut(GROUP).enumerate() {
        let which = header.get(index / 4)? >> (2 * (index % 4)) & 3;
        let decoded = decode_group(reader, bits[usize::from(which)])?;
        group.copy_from_slice(&decoded[..group.len()]);
    }
    Some(())
}

/// Sixteen bytes of few bits each; a value of all ones stands for an additional byte after them.
fn decode_group(reader: &mut Reader, bits: u32) -> Option<[u8; GROUP]> {
    let mut group = [0; GROUP];
    match bits {
        0 => return Some(group),
        8 => {
            group.copy_from_slice(reader.take(GROUP)?);
            return Some(group);
        }
        _ => {}
    }
    let per_byte = 8 / bits as usize;
    let packed = reader.take(GROUP / per_byte)?;
    let all_ones = u8::MAX >> (8 - bits);
    for (index, byte) in group.iter_mut().enumerate() {
        let place = index % per_byte;
        // Single bits are in reverse order.
        let from_end = if bits == 1 { place } else { per_byte - 1 - place };
        let code = packed[index / per_byte] >> (bits as usize * from_end) & all_ones;
        *byte = if code == all_ones { reader.byte()? } else { code };
    }
    Some(group)
}

/// Integrates the differences of four bytes of each element, starting from the element before the
/// block.
fn add_up(
    lanes: &[[u8; MAX_BLOCK]; 4],
    channel: u8,
    (at, stride): (usize, usize),
    (block, last): (&mut [u8], &[u8]),
) -> Option<()> {
    let mut before: [u8; 4] = last.get(at..at + 4)?.try_into().ok()?;
    for (index, element) in block.chunks_exact_mut(stride).enumerate() {
        let difference = [0, 1, 2, 3].map(|lane: usize| lanes[lane][index]);
        before = match channel & 3 {
            0 => {
                let added = |i: usize| before[i].wrapping_add(unzigzag8(difference[i]));
                [added(0), added(1), added(2), added(3)]
            }
            1 => {
                let added = |i: usize| {
                    let difference = u16::from_le_bytes([difference[i], difference[i + 1]]);
                    let before = u16::from_le_bytes([before[i], before[i + 1]]);
                    before.wrapping_add(unzigzag16(difference)).to_le_bytes()
                };
                let [[a, b], [c, d]] = [added(0), added(2)];
                [a, b, c, d]
            }
            2 => {
                let turned = u32::from_le_bytes(difference).rotate_right(u32::from(channel >> 4));
                (turned ^ u32::from_le_bytes(before)).to_le_bytes()
            }
            _ => return None,
        };
        element.get_mut(at..at + 4)?.copy_from_slice(&before);
    }
    Some(())
}

fn unzigzag8(code: u8) -> u8 {
    (code >> 1) ^ (code & 1).wrapping_neg()
}

fn unzigzag16(code: u16) -> u16 {
    (code >> 1) ^ (code & 1).wrapping_neg()
}
