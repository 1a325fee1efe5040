//! Lists of numbers, the bulk of a scene file, straight from bytes into vectors.

use super::token::Cursor;

/// A malformed number and its place.
pub(super) struct BadNumber {
    pub start: usize,
    pub end: usize,
    pub text: &'static str,
}

/// Kinds of number a list may hold.
pub(super) trait Number: Copy {
    /// What the messages ask for.
    const WANTED: &'static str;
    /// The number at the start of `bytes` and its length.
    fn parse(bytes: &[u8]) -> Option<(Self, usize)>;
}

/// Refuses `inf` and `nan`, which are words here.
fn starts_number(bytes: &[u8]) -> bool {
    let digits = match bytes.first() {
        Some(b'+' | b'-') => &bytes[1..],
        _ => bytes,
    };
    matches!(digits.first(), Some(b'0'..=b'9' | b'.'))
}

macro_rules! float {
    ($kind:ty) => {
        impl Number for $kind {
            const WANTED: &'static str = "a number";

            fn parse(bytes: &[u8]) -> Option<(Self, usize)> {
                if !starts_number(bytes) {
                    return None;
                }
                let (value, length) = fast_float2::parse_partial::<$kind, _>(bytes).ok()?;
                (length > 0 && value.is_finite()).then_some((value, length))
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
        assert_eq!(all::<i32>("1 -2147483648 2147483647"), Ok(vec![1, i32::MIN, i32::MAX]));
    }

    #[test]
    fn what_is_no_number() {
        for bad in ["1.5x", "inf", "nan", "-inf", "1e999", "--1", "a"] {
            assert_eq!(all::<f64>(bad), Err((0, bad.len())), "{bad}");
        }
        for bad in ["1.0", "1e3", "2147483648", "99999999999999999999", "-"] {
            assert_eq!(all::<i32>(bad), Err((0, bad.len())), "{bad}");
        }
    }
}
