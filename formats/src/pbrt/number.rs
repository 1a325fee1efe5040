//! Lists of numbers, the bulk of a scene file, straight from bytes into vectors.

use super::token::Cursor;

/// A malformed number and its place.
pub(super) struct BadNumber {
    pub start: usize,
    pub end: usize,
    pub text: &'static str,
}

/// Kinds of number a list may hold.
pub(super) trait Number: Copy + std::fmt::Display {
    /// What the messages ask for.
    const WANTED: &'static str;
    /// The number at the start of `bytes` and its length.
    fn parse(bytes: &[u8]) -> Option<(Self, usize)>;
    /// What pbrt-v3 reads of a word that is not such a number, as C's `strtod` does, and whether that is all of it.
    fn leading(word: &[u8]) -> Option<(Self, bool)>;
}

/// Refuses `inf` and `nan`, which are words here.
fn starts_number(bytes: &[u8]) -> bool {
    let digits = match bytes.first() {
        Some(b'+' | b'-') => &bytes[1..],
        _ => bytes,
    };
    matches!(digits.first(), Some(b'0'..=b'9' | b'.'))
}

/// `0x1f` with a sign and up to 13 digits, which f64 holds exactly, and its length.
fn hexadecimal(bytes: &[u8]) -> Option<(f64, usize)> {
    let (sign, start) = match bytes.first()? {
        b'-' => (-1.0, 1),
        b'+' => (1.0, 1),
        _ => (1.0, 0),
    };
    let digits = bytes[start..].strip_prefix(b"0x").or_else(|| bytes[start..].strip_prefix(b"0X"))?;
    let count = digits.iter().take(13).take_while(|b| b.is_ascii_hexdigit()).count();
    let value = digits[..count]
        .iter()
        .fold(0.0, |v, b| v * 16.0 + f64::from(char::from(*b).to_digit(16).unwrap_or(0)));
    (count > 0).then_some((sign * value, start + 2 + count))
}

macro_rules! float {
    ($kind:ty) => {
        impl Number for $kind {
            const WANTED: &'static str = "a number";

            fn parse(bytes: &[u8]) -> Option<(Self, usize)> {
                if !starts_number(bytes) {
                    return None;
                }
                if let Some((value, length)) = hexadecimal(bytes) {
                    return Some((value as $kind, length));
                }
                let (value, length) = fast_float2::parse_partial::<$kind, _>(bytes).ok()?;
                (length > 0 && value.is_finite()).then_some((value, length))
            }

            fn leading(word: &[u8]) -> Option<(Self, bool)> {
                Self::parse(word).map(|(value, length)| (value, length == word.len()))
            }
        }
    };
}
float!(f32);
float!(f64);

impl Number for i32 {
    const WANTED: &'static str = "a whole number of 32 bits";

    fn parse(bytes: &[u8]) -> Option<(Self, usize)> {
        let (negative, start) = match bytes.first()? {
            b'-' => (true, 1),
            b'+' => (false, 1),
            _ => (false, 0),
        };
        let digits = bytes[start..].iter().take_while(|b| b.is_ascii_digit()).take(11);
        let mut value = 0_i64;
        let mut length = start;
        for digit in digits {
            value = value * 10 + i64::from(digit - b'0');
            length += 1;
        }
        let value = i32::try_from(if negative { -value } else { value }).ok()?;
        (length > start).then_some((value, length))
    }

    /// pbrt-v3 reads whole numbers as others and cuts their fraction off.
    fn leading(word: &[u8]) -> Option<(Self, bool)> {
        let (value, length) = f64::parse(word)?;
        let whole = value.trunc();
        let fits = whole >= f64::from(i32::MIN) && whole <= f64::from(i32::MAX);
        fits.then_some((whole as i32, length == word.len() && whole == value))
    }
}

fn ends_number(byte: Option<&u8>) -> bool {
    byte.is_none_or(|b| b.is_ascii_whitespace() || matches!(b, b'[' | b']' | b'"'))
}

/// The word at `start`, for a message.
fn word_end(bytes: &[u8], start: usize) -> usize {
    (start..bytes.len()).find(|&i| ends_number(bytes.get(i))).unwrap_or(bytes.len()).max(start + 1)
}

/// Appends the numbers up to the closing bracket (which is left), or one number without brackets.
/// At most `limit` are taken.
pub(super) fn list<N: Number>(
    cursor: &mut Cursor<'_>,
    out: &mut Vec<N>,
    limit: usize,
) -> Result<(), BadNumber> {
    let bytes = cursor.text.as_bytes();
    let mut at = cursor.position;
    let mut taken = 0;
    while taken < limit {
        while bytes.get(at).is_some_and(u8::is_ascii_whitespace) {
            at += 1;
        }
        match bytes.get(at) {
            None | Some(b']' | b'[' | b'"') => break,
            Some(b'#') => {
                cursor.position = at;
                cursor.skip_blank();
                at = cursor.position;
                continue;
            }
            Some(_) => {}
        }
        match N::parse(&bytes[at..]) {
            Some((value, length)) if ends_number(bytes.get(at + length)) => {
                out.push(value);
                taken += 1;
                at += length;
            }
            _ => {
                cursor.position = at;
                return Err(BadNumber { start: at, end: word_end(bytes, at), text: N::WANTED });
            }
        }
    }
    cursor.position = at;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all<N: Number>(text: &str) -> Result<Vec<N>, (usize, usize)> {
        let mut out = Vec::new();
        list(&mut Cursor::new(text), &mut out, usize::MAX).map_err(|e| (e.start, e.end))?;
        Ok(out)
    }

    #[test]
    fn numbers_and_comments() {
        assert_eq!(all::<f64>(" 1 -2.5e1 # x\n.5 +3. ]"), Ok(vec![1.0, -25.0, 0.5, 3.0]));
        assert_eq!(all::<f64>("1.e3 0x1F -0X10 +1e-2"), Ok(vec![1000.0, 31.0, -16.0, 0.01]));
        assert_eq!(all::<i32>("1 -2147483648 2147483647"), Ok(vec![1, i32::MIN, i32::MAX]));
    }

    #[test]
    fn what_is_no_number() {
        for bad in ["1.5x", ".5.", "0x", "inf", "nan", "-inf", "1e999", "--1", "a"] {
            assert_eq!(all::<f64>(bad), Err((0, bad.len())), "{bad}");
        }
        for bad in ["1.0", "1e3", "2147483648", "99999999999999999999", "-"] {
            assert_eq!(all::<i32>(bad), Err((0, bad.len())), "{bad}");
        }
    }

    #[test]
    fn what_strtod_reads_of_a_word() {
        assert_eq!(f64::leading(b".5."), Some((0.5, false)));
        assert_eq!(f64::leading(b"-0.23,"), Some((-0.23, false)));
        assert_eq!(f64::leading(b"x1"), None);
        assert_eq!(i32::leading(b"1e3"), Some((1000, true)));
        assert_eq!(i32::leading(b"-2.7"), Some((-2, false)));
        assert_eq!(i32::leading(b"3e9"), None);
    }
}
