//! Printed messages kept readable where a file has lines or names of thousands of characters.

/// Characters of a source line that are shown, and how many of them stand before what is marked.
const WIDTH: usize = 300;
const BEFORE: usize = 100;
/// Longest word of a message; of a longer one the two ends are shown.
const WORD: usize = 200;
const HEAD: usize = 100;
const TAIL: usize = 60;

/// `text` as codespan prints it, with over-long source lines cut around their marks and over-long words
/// cut in the middle.
pub(super) fn narrowed(text: &str) -> String {
    if text.lines().all(|line| line.len() <= WIDTH) {
        return text.to_owned();
    }
    let lines: Vec<&str> = text.lines().collect();
    let mut out = String::with_capacity(text.len().min(1 << 16));
    let mut start = 0;
    for (i, line) in lines.iter().enumerate() {
        match line.split_once("│ ") {
            Some((margin, source)) => {
                // A line of source has a number in its margin; the marks below it have none.
                if !margin.trim().is_empty() {
                    start = window(source, &lines[i + 1..]);
                }
                out.push_str(margin);
                out.push_str("│ ");
                out.push_str(&part(source, start));
            }
            None => out.push_str(&words(line)),
        }
        out.push('\n');
    }
    out
}

/// First character of `source` to show.
fn window(source: &str, below: &[&str]) -> usize {
    if source.chars().count() <= WIDTH {
        return 0;
    }
    let marks = below.iter().map_while(|line| line.split_once("│ ").filter(|(m, _)| m.trim().is_empty()));
    let marked = marks.filter_map(|(_, marks)| marks.chars().position(|c| c != ' ')).min();
    marked.map_or(0, |at| at.saturating_sub(BEFORE))
}

fn part(line: &str, start: usize) -> String {
    let shown: String = line.chars().skip(start).take(WIDTH).collect();
    let more = line.chars().count() > start + WIDTH;
    let is_source = !line.trim_start_matches([' ', '^', '-']).is_empty();
    let left = if start > 0 && is_source { "…" } else { "" };
    let skipped = if left.is_empty() { 0 } else { 1 };
    let shown: String = left.chars().chain(shown.chars().skip(skipped)).collect();
    if more { shown + "…" } else { shown }
}

fn words(line: &str) -> String {
    let cut = |word: &str| {
        let n = word.chars().count();
        if n <= WORD {
            return word.to_owned();
        }
        let head: String = word.chars().take(HEAD).collect();
        let tail: String = word.chars().skip(n - TAIL).collect();
        format!("{head}…{tail}")
    };
    line.split_inclusive(' ').map(cut).collect()
}

#[cfg(test)]
mod tests {
    use crate::diagnostic::{Diagnostic, SourceMap, Span};

    #[test]
    fn long_names_and_lines_are_cut_around_what_is_marked() {
        let mut sources = SourceMap::default();
        let text = format!("{}<ref id='{}'/>{}", "x".repeat(5000), "a".repeat(3000), "y".repeat(5000));
        let file = sources.add("s.xml".into(), text);
        let span = Span { file, start: 5009, end: 8009 };
        let message = format!("no object has the id `{}`", "a".repeat(3000));
        let shown = sources.render(&[Diagnostic::error(message, Some(span)).help("look again")]);
        assert!(shown.contains("s.xml:1:5010") && shown.contains("<ref id='aaa"), "{shown}");
        assert!(shown.contains("^^^") && shown.contains("help: look again"), "{shown}");
        assert!(shown.lines().all(|line| line.chars().count() <= 320), "{shown}");
        let column = |c: char| {
            let line = shown.lines().rfind(|l| l.contains(c)).expect("there");
            line.chars().position(|x| x == c).expect("there")
        };
        assert_eq!(column('^'), column('\'') + 1, "{shown}");
    }
}
