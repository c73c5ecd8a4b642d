//! The part of protocol buffers that Foxglove's messages need: writing of fields and of the
//! descriptors for viewers, and reading of one field.
//!
//! Source: protobuf.dev/programming-guides/encoding, and `google/protobuf/descriptor.proto`.

const VARINT: u64 = 0;
const FIXED64: u64 = 1;
const COUNTED: u64 = 2;
const FIXED32: u64 = 5;
/// Payload bits of a varint's byte.
const LOW_BITS: u64 = 0x7f;
/// Largest number of bytes of a 64-bit varint.
const MAX_VARINT_BYTES: u64 = 10;

/// A message to write.
#[derive(Default)]
pub(super) struct Fields(Vec<u8>);

impl Fields {
    pub(super) fn new() -> Self {
        Self::default()
    }

    fn raw_varint(mut self, mut number: u64) -> Self {
        while number > LOW_BITS {
            self.0.push(0x80 | (number & LOW_BITS) as u8);
            number >>= 7;
        }
        self.0.push((number & LOW_BITS) as u8);
        self
    }

    pub(super) fn varint(self, field: u64, number: u64) -> Self {
        self.raw_varint(field << 3 | VARINT).raw_varint(number)
    }

    pub(super) fn fixed32(self, field: u64, number: u32) -> Self {
        let mut tagged = self.raw_varint(field << 3 | FIXED32);
        tagged.0.extend(number.to_le_bytes());
        tagged
    }

    pub(super) fn double(self, field: u64, number: f64) -> Self {
        let mut tagged = self.raw_varint(field << 3 | FIXED64);
        tagged.0.extend(number.to_le_bytes());
        tagged
    }

    pub(super) fn bytes(self, field: u64, bytes: &[u8]) -> Self {
        let mut tagged = self
            .raw_varint(field << 3 | COUNTED)
            .raw_varint(bytes.len() as u64);
        tagged.0.extend_from_slice(bytes);
        tagged
    }

    pub(super) fn text(self, field: u64, text: &str) -> Self {
        self.bytes(field, text.as_bytes())
    }

    pub(super) fn message(self, field: u64, message: &Self) -> Self {
        self.bytes(field, &message.0)
    }

    /// A repeated field, packed.
    pub(super) fn doubles(self, field: u64, numbers: &[f64]) -> Self {
        let packed: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        self.bytes(field, &packed)
    }

    pub(super) fn into_bytes(self) -> Vec<u8> {
        self.0
    }
}

/// `google.protobuf.Timestamp`.
pub(super) fn timestamp(time_ns: u64) -> Fields {
    const NS_PER_SEC: u64 = 1_000_000_000;
    Fields::new()
        .varint(1, time_ns / NS_PER_SEC)
        .varint(2, time_ns % NS_PER_SEC)
}

/// Type of a field, as descriptors number it.
#[derive(Clone, Copy)]
pub(super) enum Kind {
    Double,
    Int64,
    Int32,
    Fixed32,
    Text,
    Bytes,
    Doubles,
    /// A message, by its full name.
    Message(&'static str),
}

/// Descriptor of one message's file.
pub(super) struct Descriptor {
    pub(super) file: &'static str,
    pub(super) package: &'static str,
    pub(super) message: &'static str,
    /// Files of nested messages.
    pub(super) uses: &'static [&'static Descriptor],
    pub(super) fields: &'static [(&'static str, u64, Kind)],
}

impl Descriptor {
    /// `google.protobuf.FileDescriptorProto`.
    fn encoded(&self) -> Fields {
        const OPTIONAL: u64 = 1;
        const REPEATED: u64 = 3;
        let mut message = Fields::new().text(1, self.message);
        for (name, number, kind) in self.fields {
            let (of_type, label, named) = match kind {
                Kind::Double => (1, OPTIONAL, None),
                Kind::Doubles => (1, REPEATED, None),
                Kind::Int64 => (3, OPTIONAL, None),
                Kind::Int32 => (5, OPTIONAL, None),
                Kind::Fixed32 => (7, OPTIONAL, None),
                Kind::Text => (9, OPTIONAL, None),
                Kind::Message(name) => (11, OPTIONAL, Some(name)),
                Kind::Bytes => (12, OPTIONAL, None),
            };
            let field = Fields::new().text(1, name).varint(3, *number);
            let field = field.varint(4, label).varint(5, of_type);
            let field = match named {
                Some(name) => field.text(6, name),
                None => field,
            };
            message = message.message(2, &field);
        }
        let file = Fields::new().text(1, self.file).text(2, self.package);
        let file = self.uses.iter().fold(file, |file, used| file.text(3, used.file));
        file.message(4, &message).text(12, "proto3")
    }

    /// `google.protobuf.FileDescriptorSet` of the file and all its dependencies, as MCAP's schemas
    /// need it.
    pub(super) fn with_used(&self) -> Vec<u8> {
        let used = self.uses.iter().map(|used| used.encoded());
        used.chain([self.encoded()])
            .fold(Fields::new(), |set, file| set.message(1, &file))
            .into_bytes()
    }
}

/// Range of the bytes of the first length-delimited field with that number in a message. `None` if
/// there is none, or the message is invalid.
pub(super) fn counted_field(message: &[u8], field: u64) -> Option<std::ops::Range<usize>> {
    let mut at = 0_usize;
    while at < message.len() {
        let tag = varint(message, &mut at)?;
        let n_bytes = match tag & 7 {
            VARINT => {
                varint(message, &mut at)?;
                0
            }
            FIXED64 => 8,
            FIXED32 => 4,
            COUNTED => usize::try_from(varint(message, &mut at)?).ok()?,
            _ => return None,
        };
        let end = at.checked_add(n_bytes).filter(|end| *end <= message.len())?;
        if tag == field << 3 | COUNTED {
            return Some(at..end);
        }
        at = end;
    }
    None
}

fn varint(message: &[u8], at: &mut usize) -> Option<u64> {
    let mut number = 0;
    for place in 0..MAX_VARINT_BYTES {
        let byte = u64::from(*message.get(*at)?);
        *at += 1;
        number |= (byte & LOW_BITS) << (7 * place);
        if byte <= LOW_BITS {
            return Some(number);
        }
    }
    None
}
