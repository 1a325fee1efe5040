//! Lines and columns of byte offsets, without reading the text before them again for each.

/// Where the lines of a text begin, and how many characters stand before each block of it.
#[derive(Clone, Debug)]
pub(super) struct Lines {
    /// Offset of the first byte of each line.
    starts: Vec<usize>,
    /// Characters before each block of [`BLOCK`] bytes: a line may be as long as the file.
    characters: Vec<usize>,
}

const BLOCK: usize = 1024;

/// Characters that begin in `bytes`.
fn begun(bytes: &[u8]) -> usize {
    bytes.iter().filter(|&&b| b & 0xc0 != 0x80).count()
}

impl Lines {
    pub fn of(text: &str) -> Self {
        let ends = text.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(at, _)| at + 1);
        let mut before = 0;
        let characters = text.as_bytes().chunks(BLOCK).map(|block| {
            let so_far = before;
            before += begun(block);
            so_far
        });
        Self { starts: [0].into_iter().chain(ends).collect(), characters: characters.collect() }
    }

    /// 1-based line, and column in characters, of an offset in the same text.
    pub fn place(&self, text: &str, offset: usize) -> (usize, usize) {
        let line = self.starts.partition_point(|start| *start <= offset);
        let start = self.starts[line - 1];
        (line, self.before(text, offset) - self.before(text, start) + 1)
    }

    fn before(&self, text: &str, offset: usize) -> usize {
        let block = (offset / BLOCK).min(self.characters.len().saturating_sub(1));
        let known = self.characters.get(block).copied().unwrap_or(0);
        known + begun(&text.as_bytes()[block * BLOCK..offset])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Counted from the beginning, at every character of texts with short, long and empty lines.
    #[test]
    fn places_are_those_that_counting_gives() {
        let long = "aé\u{4e2d}\u{1f600}".repeat(700);
        for text in ["", "\n", "a", "a\nb", "é\n\nb\n", &long, &format!("x\n{long}\n{long}y\n")] {
            let lines = Lines::of(text);
            let offsets = text.char_indices().map(|(at, _)| at).chain([text.len()]);
            let (mut line, mut column) = (1, 1);
            for (offset, c) in offsets.zip(text.chars().map(Some).chain([None])) {
                assert_eq!(lines.place(text, offset), (line, column), "{offset}");
                (line, column) = if c == Some('\n') { (line + 1, 1) } else { (line, column + 1) };
            }
        }
    }
}
