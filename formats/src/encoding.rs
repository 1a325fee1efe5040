//! Byte order marks of text files.

use std::borrow::Cow;
use std::char::{REPLACEMENT_CHARACTER, decode_utf16};

/// The text as UTF-8 without its byte order mark. Text with the mark of UTF-16 is converted; anything else is left
/// unchanged.
pub fn to_utf8(bytes: &[u8]) -> Cow<'_, [u8]> {
    let unit: fn([u8; 2]) -> u16 = match bytes {
        [0xef, 0xbb, 0xbf, rest @ ..] => return Cow::Borrowed(rest),
        [0xff, 0xfe, ..] => u16::from_le_bytes,
        [0xfe, 0xff, ..] => u16::from_be_bytes,
        _ => return Cow::Borrowed(bytes),
    };
    let (pairs, _) = bytes[2..].as_chunks::<2>();
    let text: String =
        decode_utf16(pairs.iter().map(|p| unit(*p))).map(|c| c.unwrap_or(REPLACEMENT_CHARACTER)).collect();
    Cow::Owned(text.into_bytes())
}

/// As [`to_utf8`], without a copy where there is no mark.
pub fn into_utf8(bytes: Vec<u8>) -> Vec<u8> {
    match to_utf8(&bytes) {
        Cow::Borrowed(text) if text.len() == bytes.len() => bytes,
        text => text.into_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::to_utf8;

    #[test]
    fn marks_are_taken_off_and_utf_16_is_converted() {
        let text = "v 1 2 3 # Länge 𝛼";
        for unit in [u16::to_le_bytes as fn(u16) -> [u8; 2], u16::to_be_bytes] {
            let bytes: Vec<u8> = std::iter::once(0xfeff).chain(text.encode_utf16()).flat_map(unit).collect();
            assert_eq!(&*to_utf8(&bytes), text.as_bytes());
        }
        assert_eq!(&*to_utf8(format!("\u{feff}{text}").as_bytes()), text.as_bytes());
        assert_eq!(&*to_utf8(text.as_bytes()), text.as_bytes());
        assert_eq!(&*to_utf8(&[0xff, 0xfe, 0x41]), b"");
    }
}
