//! Data URIs: bytes inside the JSON tree.

/// The target of a URI.
pub(super) enum Uri<'a> {
    /// Bytes within it.
    Data(Vec<u8>),
    /// An invalid data URI.
    Broken,
    /// A name outside of the file.
    Elsewhere(&'a str),
}

/// Parses a URI.
pub(super) fn read(uri: &str) -> Uri<'_> {
    let is_data = uri
        .get(..5)
        .is_some_and(|scheme| scheme.eq_ignore_ascii_case("data:"));
    match is_data {
        false => Uri::Elsewhere(uri),
        true => bytes_from_data(&uri[5..]).map_or(Uri::Broken, Uri::Data),
    }
}

fn bytes_from_data(uri: &str) -> Option<Vec<u8>> {
    let (head, text) = uri.split_once(',')?;
    head.ends_with(";base64").then(|| bytes_from_base64(text))?
}

/// Source: RFC 4648, section 4.
fn bytes_from_base64(text: &str) -> Option<Vec<u8>> {
    let text = text.trim_end_matches('=').as_bytes();
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 2);
    for quad in text.chunks(4) {
        let mut bits = 0_u32;
        for &symbol in quad {
            bits = bits << 6 | sextet(symbol)?;
        }
        // A short last group holds one byte in two symbols or two bytes in three.
        let n_bytes = quad.len() * 6 / 8;
        bits <<= 6 * (4 - quad.len());
        bytes.extend_from_slice(&bits.to_be_bytes()[1..=n_bytes]);
    }
    Some(bytes)
}

fn sextet(symbol: u8) -> Option<u32> {
    let value = match symbol {
        b'A'..=b'Z' => symbol - b'A',
        b'a'..=b'z' => symbol - b'a' + 26,
        b'0'..=b'9' => symbol - b'0' + 52,
        b'+' => 62,
        b'/' => 63,
        _ => return None,
    };
    Some(value.into())
}

/// The decoded name of a URI: `%20` and the like are bytes of it. `None` if they are no text.
pub(super) fn percent_decoded(uri: &str) -> Option<String> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, after @ ..] = rest {
        let hex = |byte: u8| {
            char::from(byte)
                .to_digit(16)
                .and_then(|digit| u8::try_from(digit).ok())
        };
        match (first, after) {
            (b'%', [high, low, left @ ..]) if hex(*high).is_some() && hex(*low).is_some() => {
                bytes.push(hex(*high)? << 4 | hex(*low)?);
                rest = left;
            }
            _ => {
                bytes.push(*first);
                rest = after;
            }
        }
    }
    String::from_utf8(bytes).ok()
}
