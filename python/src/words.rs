//! Messages of the library in the words of Python: it calls options as the command line does.

/// Options whose value is a keyword argument that is true or false.
const FLAGS: [&str; 4] = ["force", "lenient", "resume", "allow-missing"];

/// Options that take a value, and the names of the arguments.
const VALUES: [(&str, &str); 9] = [
    ("allow-path", "allow_paths"),
    ("checkpoint", "checkpoint"),
    ("crop", "crop"),
    ("filter", "filter"),
    ("layers", "layers"),
    ("sensor", "sensor"),
    ("set", "set"),
    ("size", "size"),
    ("spp", "passes"),
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
    let flag = FLAGS.contains(&name).then(|| format!("{}=True", name.replace('-', "_")));
    let value = VALUES.iter().find(|(option, _)| *option == name).map(|(_, argument)| (*argument).to_owned());
    Some((flag.or(value)?, 2 + name.len()))
}
