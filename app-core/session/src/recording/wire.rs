//! Records of MCAP: an opcode, the number of bytes that follow, a body. Little endian.
//!
//! Source: the specification of MCAP (mcap.dev/spec). Reading borrows, and nothing is allocated by
//! a stated length.

use std::collections::BTreeMap;

/// First and last bytes of a file.
pub(super) const MAGIC: [u8; 8] = *b"\x89MCAP0\r\n";
/// Bytes of a record before its body.
pub(super) const HEAD_BYTES: u64 = HEAD_LEN as u64;
/// The same, for arrays.
pub(super) const HEAD_LEN: usize = 9;

pub(super) const HEADER: u8 = 0x01;
pub(super) const FOOTER: u8 = 0x02;
pub(super) const SCHEMA: u8 = 0x03;
pub(super) const CHANNEL: u8 = 0x04;
pub(super) const MESSAGE: u8 = 0x05;
pub(super) const CHUNK: u8 = 0x06;
pub(super) const MESSAGE_INDEX: u8 = 0x07;
pub(super) const CHUNK_INDEX: u8 = 0x08;
pub(super) const ATTACHMENT: u8 = 0x09;
pub(super) const ATTACHMENT_INDEX: u8 = 0x0a;
pub(super) const STATISTICS: u8 = 0x0b;
pub(super) const METADATA: u8 = 0x0c;
pub(super) const METADATA_INDEX: u8 = 0x0d;
pub(super) const SUMMARY_OFFSET: u8 = 0x0e;
pub(super) const DATA_END: u8 = 0x0f;
/// The body of a record to write.
#[derive(Default)]
pub(super) struct Body(Vec<u8>);

impl Body {
    pub(super) fn new() -> Self {
        Self::default()
    }

    pub(super) fn u16(mut self, number: u16) -> Self {
        self.0.extend(number.to_le_bytes());
        self
    }

    pub(super) fn u32(mut self, number: u32) -> Self {
        self.0.extend(number.to_le_bytes());
        self
    }

    pub(super) fn u64(mut self, number: u64) -> Self {
        self.0.extend(number.to_le_bytes());
        self
    }

    pub(super) fn text(self, text: &str) -> Self {
        self.counted(text.as_bytes())
    }

    /// Bytes after their number in 32 bits. Excess bytes, which no reader could use, are cut.
    pub(super) fn counted(self, bytes: &[u8]) -> Self {
        let n_bytes = u32::try_from(bytes.len()).unwrap_or(u32::MAX);
        let kept = bytes.get(..n_bytes as usize).unwrap_or(bytes);
        self.u32(n_bytes).raw(kept)
    }

    pub(super) fn raw(mut self, bytes: &[u8]) -> Self {
        self.0.extend_from_slice(bytes);
        self
    }

    pub(super) fn map(self, entries: &BTreeMap<String, String>) -> Self {
        let pairs = entries
            .iter()
            .fold(Self::new(), |body, (key, value)| body.text(key).text(value));
        self.counted(&pairs.0)
    }

    pub(super) fn as_bytes(&self) -> &[u8] {
        &self.0
    }

    /// The whole record.
    pub(super) fn record(self, opcode: u8) -> Vec<u8> {
        let mut record = head(opcode, self.0.len() as u64).to_vec();
        record.extend(self.0);
        record
    }
}

/// Opcode and length.
pub(super) fn head(opcode: u8, n_bytes: u64) -> [u8; HEAD_LEN] {
    let mut head = [opcode; HEAD_LEN];
    head[1..].copy_from_slice(&n_bytes.to_le_bytes());
    head
}

/// Parses opcode and length.
pub(super) fn parse_head(head: [u8; HEAD_LEN]) -> (u8, u64) {
    let [opcode, length @ ..] = head;
    (opcode, u64::from_le_bytes(length))
}

/// The unread part of a body. Every method returns `None` if too little is left.
#[derive(Clone, Copy)]
pub(super) struct Rest<'a>(pub(super) &'a [u8]);

impl<'a> Rest<'a> {
    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (array, rest) = self.0.split_first_chunk::<N>()?;
        self.0 = rest;
        Some(*array)
    }

    pub(super) fn u16(&mut self) -> Option<u16> {
        self.array().map(u16::from_le_bytes)
    }

    pub(super) fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    pub(super) fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    pub(super) fn take(&mut self, n_bytes: u64) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(usize::try_from(n_bytes).ok()?)?;
        self.0 = rest;
        Some(taken)
    }

    pub(super) fn text(&mut self) -> Option<&'a str> {
        let n_bytes = self.u32()?;
        std::str::from_utf8(self.take(n_bytes.into())?).ok()
    }

    /// Opcode and body of the next record.
    pub(super) fn record(&mut self) -> Option<(u8, &'a [u8])> {
        let (opcode, n_bytes) = parse_head(self.array()?);
        Some((opcode, self.take(n_bytes)?))
    }
}
