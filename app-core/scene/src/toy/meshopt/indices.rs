//! The index codecs: triangles by recent edges and corners, and plain sequences by differences.

/// A reader of numbers of variable length.
struct Numbers<'a> {
    rest: std::slice::Iter<'a, u8>,
}

impl Numbers<'_> {
    fn byte(&mut self) -> Option<u8> {
        self.rest.next().copied()
    }

    /// Seven bits per byte, the low ones first.
    fn number(&mut self) -> Option<u32> {
        let mut number = 0;
        for shift in [0, 7, 14, 21, 28] {
            let byte = self.byte()?;
            number |= u32::from(byte & 127) << shift;
            if byte < 128 {
                break;
            }
        }
        Some(number)
    }

    fn is_at_end(&self) -> bool {
        self.rest.len() == 0
    }
}

fn unzigzag(code: u32) -> u32 {
    (code >> 1) ^ (code & 1).wrapping_neg()
}

/// The last sixteen items.
struct Recent<T> {
    all: [T; 16],
    next: usize,
}

impl<T: Copy> Recent<T> {
    /// An item by its age; the newest is 0.
    fn get(&self, age: usize) -> T {
        self.all[self.next.wrapping_sub(1 + age) & 15]
    }

    fn push(&mut self, value: T) {
        self.all[self.next] = value;
        self.next = (self.next + 1) & 15;
    }
}

/// The decoder's state.
struct Triangles<'a> {
    numbers: Numbers<'a>,
    /// Frequent pairs of corners.
    pairs: &'a [u8],
    edges: Recent<[u32; 2]>,
    corners: Recent<u32>,
    /// The lowest index that no triangle has used yet.
    next: u32,
    /// The last index that was written explicitly.
    last: u32,
}

/// Corners of triangles; `count` is a multiple of three.
pub(super) fn triangles(stream: &[u8], count: usize) -> Option<Vec<u32>> {
    const PAIRS: usize = 16;
    let (&header, rest) = stream.split_first()?;
    let (codes, rest) = rest.split_at_checked(count / 3)?;
    let (data, pairs) = rest.split_at_checked(rest.len().checked_sub(PAIRS)?)?;
    // glTF does not allow version 0.
    if header != 0xe1 {
        return None;
    }
    let mut state = Triangles {
        numbers: Numbers { rest: data.iter() },
        pairs,
        edges: Recent {
            all: [[u32::MAX; 2]; 16],
            next: 0,
        },
        corners: Recent {
            all: [u32::MAX; 16],
            next: 0,
        },
        next: 0,
        last: 0,
    };
    let mut corners = Vec::with_capacity(count);
    for &code in codes {
        corners.extend(state.triangle(code)?);
    }
    state.numbers.is_at_end().then_some(corners)
}

impl Triangles<'_> {
    fn triangle(&mut self, code: u8) -> Option<[u32; 3]> {
        if code >= 0xf0 {
            return self.without_edge(code);
        }
        let [a, b] = self.edges.get(usize::from(code >> 4));
        let c = match code & 15 {
            0 => self.fresh(),
            known @ 1..=12 => self.corners.get(usize::from(known)),
            13 => self.near(u32::MAX),
            14 => self.near(1),
            _ => self.written()?,
        };
        // Corners that were known already are not pushed again.
        if !matches!(code & 15, 1..=12) {
            self.corners.push(c);
        }
        self.edges.push([c, b]);
        self.edges.push([a, c]);
        Some([a, b, c])
    }

    /// A triangle without a recent edge.
    fn without_edge(&mut self, code: u8) -> Option<[u32; 3]> {
        let pair = match code {
            0xfe | 0xff => self.numbers.byte()?,
            _ => *self.pairs.get(usize::from(code & 15))?,
        };
        if code >= 0xfe && pair == 0 {
            self.next = 0;
        }
        let of = [if code == 0xff { 15 } else { 0 }, pair >> 4, pair & 15];
        // All new corners are counted before the first explicit one is read.
        let mut corners = [0; 3];
        for (corner, &which) in corners.iter_mut().zip(&of) {
            *corner = match which {
                0 => self.fresh(),
                15 => 0,
                known => self.corners.get(usize::from(known) - 1),
            };
        }
        for (corner, &which) in corners.iter_mut().zip(&of) {
            if which == 15 {
                *corner = self.written()?;
            }
        }
        let [a, b, c] = corners;
        for (corner, which) in corners.into_iter().zip(of) {
            if which == 0 || which == 15 {
                self.corners.push(corner);
            }
        }
        self.edges.push([b, a]);
        self.edges.push([c, b]);
        self.edges.push([a, c]);
        Some(corners)
    }

    fn fresh(&mut self) -> u32 {
        let fresh = self.next;
        self.next = self.next.wrapping_add(1);
        fresh
    }

    fn near(&mut self, step: u32) -> u32 {
        self.last = self.last.wrapping_add(step);
        self.last
    }

    fn written(&mut self) -> Option<u32> {
        let step = unzigzag(self.numbers.number()?);
        Some(self.near(step))
    }
}

/// Indices of any topology.
pub(super) fn sequence(stream: &[u8], count: usize) -> Option<Vec<u32>> {
    const TAIL: usize = 4;
    let (&header, rest) = stream.split_first()?;
    let data = rest.get(..rest.len().checked_sub(TAIL)?)?;
    // Each index takes at least one byte.
    if header != 0xd1 || data.len() < count {
        return None;
    }
    let mut numbers = Numbers { rest: data.iter() };
    let mut last = [0_u32; 2];
    let mut indices = Vec::with_capacity(count);
    for _ in 0..count {
        let code = numbers.number()?;
        let base = &mut last[(code & 1) as usize];
        *base = base.wrapping_add(unzigzag(code >> 1));
        indices.push(*base);
    }
    numbers.is_at_end().then_some(indices)
}
