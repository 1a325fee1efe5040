//! Files that are something else than their name says, named for what they are.

/// Most bytes that are looked at.
const HEAD: usize = 1024;

/// What a file is that no reader can take, whatever its name: a pointer of version control in place of the file, or
/// the page of a failed download.
pub(crate) fn named(bytes: &[u8]) -> Option<&'static str> {
    let head = &bytes[..bytes.len().min(HEAD)];
    let head = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head).trim_ascii_start();
    let starts = |with: &[u8]| head.get(..with.len()).is_some_and(|start| start.eq_ignore_ascii_case(with));
    if starts(b"version https://git-lfs.github.com/spec/")
        || starts(b"version https://hawser.github.com/spec/")
    {
        Some("a Git LFS pointer: fetch the file with `git lfs pull`")
    } else if starts(b"/annex/objects/") || starts(b".git/annex/objects/") {
        Some("a git-annex pointer: fetch the file with `git annex get`")
    } else if starts(b"<!doctype html") || starts(b"<html") || starts(b"<head") || starts(b"<body") {
        Some("an HTML page, probably of a failed download")
    } else {
        None
    }
}

/// Whether a text begins with a tag, a comment or the like.
pub(crate) fn is_xml(bytes: &[u8]) -> bool {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start().starts_with(b"<")
}

/// [`named`], or text where bytes were expected, or another kind of file that is well known.
pub(crate) fn not_binary(bytes: &[u8]) -> Option<String> {
    if let Some(what) = named(bytes) {
        return Some(what.to_owned());
    }
    let kinds: [(&[u8], &str); 5] = [
        (b"PK\x03\x04", "a ZIP archive"),
        (b"\x1f\x8b", "a gzip archive"),
        (b"7z\xbc\xaf", "a 7z archive"),
        (b"Rar!", "a RAR archive"),
        (b"%PDF", "a PDF document"),
    ];
    if let Some((_, what)) = kinds.iter().find(|(magic, _)| bytes.starts_with(magic)) {
        return Some((*what).to_owned());
    }
    let line = first_line(bytes)?;
    Some(format!("a text that begins with \"{line}\""))
}

/// The first words of a text; `None` where the bytes are no text.
fn first_line(bytes: &[u8]) -> Option<String> {
    let head = &bytes[..bytes.len().min(HEAD)];
    let text = match std::str::from_utf8(head) {
        Ok(text) => text,
        // A letter that the limit cuts in two is no reason.
        Err(e) if e.error_len().is_none() => std::str::from_utf8(&head[..e.valid_up_to()]).ok()?,
        Err(_) => return None,
    };
    let control = |c: char| c.is_control() && !matches!(c, '\n' | '\r' | '\t' | '\u{c}');
    if text.contains(control) {
        return None;
    }
    let line = text.lines().map(str::trim).find(|line| !line.is_empty())?;
    let shown: String = line.chars().take(40).collect();
    Some(if shown.len() < line.len() { shown + "…" } else { shown })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pointers_pages_and_texts_are_named() {
        let lfs = b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n";
        assert_eq!(named(lfs), Some("a Git LFS pointer: fetch the file with `git lfs pull`"));
        let page = b"\xef\xbb\xbf\n<!DOCTYPE html>\n<title>404</title>";
        assert_eq!(named(page), Some("an HTML page, probably of a failed download"));
        assert_eq!(named(b"ply\nformat ascii 1.0\n"), None);
        let link = not_binary(b"../textures/wood.png");
        assert_eq!(link.as_deref(), Some("a text that begins with \"../textures/wood.png\""));
        assert_eq!(not_binary(b"PK\x03\x04").as_deref(), Some("a ZIP archive"));
        for bytes in [&b"\x00\x01\x02"[..], b"", b"GIF89a\x01\x00"] {
            assert_eq!(not_binary(bytes), None, "{bytes:?}");
        }
        // 1024 bytes end inside of a letter.
        let long = format!("x{}", "ä".repeat(600));
        assert!(not_binary(long.as_bytes()).is_some_and(|what| what.starts_with("a text")));
    }
}
