//! Byte order marks of text files, and the encoding that an XML file declares.

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

/// XML that declares ISO-8859-1 or Windows-1252 as UTF-8; anything else is left unchanged.
pub(crate) fn as_declared(bytes: Vec<u8>) -> Vec<u8> {
    let declared = declaration(&bytes).map(str::to_ascii_lowercase);
    match declared.as_deref() {
        Some("iso-8859-1" | "iso8859-1" | "latin1" | "latin-1" | "windows-1252" | "cp1252") => {
            let text: String = bytes.iter().map(|&byte| western(byte)).collect();
            text.into_bytes()
        }
        _ => bytes,
    }
}

/// The encoding that `<?xml … encoding="…"?>` names.
fn declaration(bytes: &[u8]) -> Option<&str> {
    let head = bytes.strip_prefix(b"<?xml")?;
    let head = &head[..head.windows(2).position(|pair| pair == b"?>")?];
    let rest = std::str::from_utf8(head).ok()?.split_once("encoding")?.1;
    let rest = rest.trim_start().strip_prefix('=')?.trim_start();
    let quote = rest.chars().next().filter(|c| matches!(c, '"' | '\''))?;
    rest[1..].split_once(quote).map(|(name, _)| name.trim())
}

/// A byte of Windows-1252, which has letters and marks where ISO-8859-1 has control codes that no text uses.
fn western(byte: u8) -> char {
    const MARKS: [char; 32] = [
        '€', '\u{81}', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\u{8d}', 'Ž', '\u{8f}',
        '\u{90}', '‘', '’', '“', '”', '•', '–', '—', '˜', '™', 'š', '›', 'œ', '\u{9d}', 'ž', 'Ÿ',
    ];
    MARKS.get(usize::from(byte).wrapping_sub(0x80)).copied().unwrap_or(char::from(byte))
}

#[cfg(test)]
mod tests {
    use super::{as_declared, to_utf8};

    #[test]
    fn declared_encodings_are_converted() {
        let text = |encoding: &str| {
            [b"<?xml version='1.0' encoding='", encoding.as_bytes(), b"'?><a b='\xe4\x80'/>"].concat()
        };
        for encoding in ["ISO-8859-1", "latin1", "windows-1252"] {
            assert!(String::from_utf8(as_declared(text(encoding))).unwrap().ends_with("<a b='ä€'/>"));
        }
        assert_eq!(as_declared(text("utf-8")), text("utf-8"));
    }

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
