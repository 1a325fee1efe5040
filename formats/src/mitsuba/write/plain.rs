//! Mesh files that Mitsuba's readers take as ours do. Its readers are strict: they refuse indices that count
//! backwards or lie ahead, lines that go on in the next one, long lines, and lines of a PLY header they do not know.

/// Mitsuba's limit on a line of an OBJ.
const LONGEST_LINE: usize = 1000;

/// The keywords of a PLY header that Mitsuba knows.
const PLY_WORDS: [&str; 6] = ["ply", "format", "comment", "element", "property", "end_header"];

pub fn plain_ply(bytes: &[u8]) -> bool {
    let lines = bytes.split(|b| *b == b'\n').map(|line| String::from_utf8_lossy(line));
    let words = lines.map(|line| line.split_whitespace().next().unwrap_or_default().to_owned());
    for word in words {
        if word == "end_header" {
            return true;
        }
        if !PLY_WORDS.contains(&word.as_str()) {
            return false;
        }
    }
    false
}

pub fn plain_obj(bytes: &[u8]) -> bool {
    let mut known = [0usize; 3];
    let mut faces = 0;
    let mut wanted = [0usize; 3];
    for line in bytes.split(|b| *b == b'\n') {
        let Ok(text) = std::str::from_utf8(line) else { return false };
        if line.len() > LONGEST_LINE || text.trim_end().ends_with('\\') || text.trim_end().contains('\r') {
            return false;
        }
        let mut words = text.split_ascii_whitespace();
        let good = match words.next() {
            Some("v") => numbers(words, 3, &mut known[0]),
            Some("vt") => numbers(words, 2, &mut known[1]),
            Some("vn") => {
                text.bytes().any(|b| (b'1'..=b'9').contains(&b)) && numbers(words, 3, &mut known[2])
            }
            Some("f") => {
                faces += 1;
                face(words, known[0], &mut wanted)
            }
            Some(other) => !other.starts_with('\u{feff}'),
            None => true,
        };
        if !good {
            return false;
        }
    }
    // Texture coordinates and normals may follow the faces.
    faces > 0 && wanted[1] <= known[1] && wanted[2] <= known[2]
}

/// Whether the words begin with so many finite numbers; counts them as one more of their kind.
fn numbers<'a>(mut words: impl Iterator<Item = &'a str>, least: usize, count: &mut usize) -> bool {
    *count += 1;
    (0..least).all(|_| words.next().and_then(|word| word.parse::<f32>().ok()).is_some_and(f32::is_finite))
}

/// Whether the corners of a face count from 1 and name vertices that are known by then.
fn face<'a>(words: impl Iterator<Item = &'a str>, vertices: usize, wanted: &mut [usize; 3]) -> bool {
    let mut corners = 0;
    for word in words {
        corners += 1;
        for (place, index) in word.split('/').enumerate() {
            if index.is_empty() && place > 0 {
                continue;
            }
            match index.parse::<usize>() {
                Ok(index @ 1..) if place < 3 && (place > 0 || index <= vertices) => {
                    wanted[place] = wanted[place].max(index);
                }
                _ => return false,
            }
        }
    }
    corners > 2
}

#[cfg(test)]
mod tests {
    use super::{plain_obj, plain_ply};

    #[test]
    fn what_mitsuba_refuses_is_not_plain() {
        let v = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
        let good = [
            "f 1 2 3\n",
            "vt 0 1\nvn 0 0 1\nf 1/1/1 2/1/1 3//1\n",
            "# α\nusemtl x\nf 1 2 3",
            "f 1/1 2/1 3/1\nvt 0 0 0\n",
        ];
        for rest in good {
            assert!(plain_obj(format!("{v}{rest}").as_bytes()), "{rest}");
        }
        let bad = [
            "f -3 -2 -1\n",
            "f 1 2 \\\n3\n",
            "f 1 2 4\nv 0 1 0\n",
            "f 1/1 2/1 3/1\n",
            "vn 0 0 0\nf 1//1 2//1 3//1\n",
            "vt 0.5\nf 1 2 3\n",
            "f 1 2\nf 1 2 3\n",
            "f 0 1 2\n",
            "",
        ];
        for rest in bad {
            assert!(!plain_obj(format!("{v}{rest}").as_bytes()), "{rest}");
        }
        assert!(!plain_obj(format!("\u{feff}{v}f 1 2 3\n").as_bytes()));
        assert!(!plain_obj(format!("{v}#{}\nf 1 2 3\n", "x".repeat(2000)).as_bytes()));
        assert!(plain_obj(format!("{v}f 1 2 3\n").replace('\n', "\r\n").as_bytes()));
        assert!(!plain_obj(format!("{v}f 1 2 3\n").replace('\n', "\r").as_bytes()));
    }

    #[test]
    fn headers_of_plain_ply_have_known_words() {
        assert!(plain_ply(
            b"ply\nformat ascii 1.0\ncomment x\nelement vertex 0\nproperty float x\nend_header\n"
        ));
        assert!(!plain_ply(b"ply\nformat ascii 1.0\nobj_info x\nend_header\n"));
        assert!(!plain_ply(b"ply\nformat ascii 1.0\n"));
    }
}
