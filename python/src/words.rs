//! Messages of the library in the words of Python: it calls options as the command line does.

/// Options that messages name, and the arguments that are the same.
const ARGUMENTS: [(&str, &str); 9] = [
    ("allow-path", "allow_paths"),
    ("crop", "crop"),
    ("force", "force=True"),
    ("help-settings", "caustica.settings()"),
    ("layers", "layers"),
    ("lenient", "lenient=True"),
    ("resume", "resume=True"),
    ("sensor", "sensor"),
    ("size", "size"),
];

/// A message with keyword arguments in place of options. A whole command line that it recommends stays one.
pub fn in_python(text: &str) -> String {
    if text.contains("caustica render ") {
        return text.to_owned();
    }
    let mut words = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find('-') {
        let (before, option) = rest.split_at(at);
        words.push_str(before);
        let begins = before.chars().next_back().is_none_or(|c| " (`\n".contains(c));
        let (word, length) =
            begins.then(|| argument(option)).flatten().unwrap_or_else(|| ("-".to_owned(), 1));
        words.push_str(&word);
        rest = &option[length..];
    }
    words + rest
}

/// What the option at the head of `text` is in Python, and its length; `None` where there is none.
fn argument(text: &str) -> Option<(String, usize)> {
    if let Some(defined) = text.strip_prefix("-D") {
        // Of `-D name=value` the definition is left.
        return match defined.strip_prefix(' ') {
            Some(name) if name.contains('=') => Some((String::new(), 3)),
            _ => Some(("a keyword argument".to_owned(), 2)),
        };
    }
    let name = text.strip_prefix("--")?;
    let name = &name[..name.find(|c: char| !(c == '-' || c.is_ascii_lowercase())).unwrap_or(name.len())];
    let (_, argument) = ARGUMENTS.iter().find(|(option, _)| *option == name)?;
    Some(((*argument).to_owned(), 2 + name.len()))
}
