//! XML text to an element tree. Entities of an author are refused.

use std::borrow::Cow;

use quick_xml::escape::{EscapeError, unescape};
use quick_xml::events::{BytesStart, Event};
use quick_xml::reader::Reader;

use super::tree::{Attribute, Element, MAX_DEPTH};
use crate::diagnostic::{Diagnostic, Span, char_floor};

/// Parses `text`, which is file `file` of the source map. `None` when it is not well-formed; then
/// an error was pushed.
pub(super) fn parse(file: u32, text: &str, problems: &mut Vec<Diagnostic>) -> Option<Element> {
    let parsed = Parser { file, text, problems: &mut *problems }.document();
    match parsed {
        Ok(root) => Some(root),
        Err(problem) => {
            problems.push(*problem);
            None
        }
    }
}

struct Parser<'a> {
    file: u32,
    text: &'a str,
    problems: &'a mut Vec<Diagnostic>,
}

impl Parser<'_> {
    fn document(&mut self) -> Result<Element, Box<Diagnostic>> {
        let mut reader = Reader::from_str(self.text);
        // End tags are matched here, to point at both places.
        reader.config_mut().check_end_names = false;
        reader.config_mut().allow_unmatched_ends = true;
        let mut open: Vec<Element> = Vec::new();
        let mut root: Option<Element> = None;
        loop {
            let start = reader.buffer_position();
            let event = reader.read_event();
            let whole = self.span(start, reader.buffer_position());
            let event = event.map_err(|e| {
                let at = reader.error_position();
                Box::new(Diagnostic::error(format!("malformed XML: {e}"), Some(self.span(at, at + 1))))
            })?;
            match event {
                Event::Start(tag) => {
                    if open.len() >= MAX_DEPTH {
                        return fail(format!("elements are nested more than {MAX_DEPTH} deep"), whole);
                    }
                    refuse_second_root(root.as_ref(), whole)?;
                    let element = self.element(&tag, whole)?;
                    open.push(element);
                }
                Event::Empty(tag) => {
                    refuse_second_root(root.as_ref(), whole)?;
                    let element = self.element(&tag, whole)?;
                    close(element, &mut open, &mut root);
                }
                Event::End(tag) => {
                    let found = tag.name().into_inner();
                    let Some(element) = open.pop() else {
                        return fail(format!("end tag </{found}> has no start tag"), whole);
                    };
                    if element.tag != found {
                        return Err(Box::new(mismatched(&element, found, whole)));
                    }
                    close(element, &mut open, &mut root);
                }
                Event::Text(text) => {
                    let content = text.into_inner();
                    if !content.trim().is_empty() {
                        let lead = content.len() - content.trim_start().len();
                        let from = u64::from(whole.start) + lead as u64;
                        let span = self.span(from, from + content.trim().len() as u64);
                        self.problems
                            .push(Diagnostic::warning("text between elements is ignored", Some(span)));
                    }
                }
                Event::CData(_) | Event::GeneralRef(_) => {
                    self.problems.push(Diagnostic::warning("text between elements is ignored", Some(whole)));
                }
                Event::DocType(text) if text.contains("<!ENTITY") => {
                    return fail("a document type may not define entities", whole);
                }
                Event::Decl(_) | Event::DocType(_) | Event::Comment(_) | Event::PI(_) => {}
                Event::Eof => break,
            }
        }
        if let Some(element) = open.last() {
            return fail(format!("<{}> is never closed", element.tag), element.tag_span);
        }
        root.ok_or_else(|| Box::new(Diagnostic::error("the file contains no element", Some(self.span(0, 0)))))
    }

    fn element(&self, tag: &BytesStart<'_>, whole: Span) -> Result<Element, Box<Diagnostic>> {
        let name = tag.name();
        let tag_span = self.span_of(name.0, whole);
        let mut attributes = Vec::new();
        for attribute in tag.attributes() {
            let attribute = match attribute {
                Ok(attribute) => attribute,
                Err(e) => return fail(format!("malformed attribute of <{}>: {e}", name.0), whole),
            };
            let name_span = self.span_of(attribute.key.0, whole);
            let value_span = self.span_of(&attribute.value, whole);
            let value = match unescape(&attribute.value) {
                Ok(value) => value.into_owned(),
                Err(e) => return Err(Box::new(bad_character(&e, value_span))),
            };
            attributes.push(Attribute { name: attribute.key.0.to_owned(), name_span, value, value_span });
        }
        Ok(Element { tag: name.0.to_owned(), tag_span, attributes, children: Vec::new(), broken: false })
    }

    /// Place of `part`, a slice of the text; `otherwise` when it is a copy.
    fn span_of(&self, part: &str, otherwise: Span) -> Span {
        let start = (part.as_ptr() as usize).wrapping_sub(self.text.as_ptr() as usize);
        match start.checked_add(part.len()) {
            Some(end) if end <= self.text.len() => self.span(start as u64, end as u64),
            _ => otherwise,
        }
    }

    fn span(&self, start: u64, end: u64) -> Span {
        let clamp = |offset: u64| char_floor(self.text, usize::try_from(offset).unwrap_or(usize::MAX)) as u32;
        Span { file: self.file, start: clamp(start), end: clamp(end) }
    }
}

fn mismatched(open: &Element, found: &str, place: Span) -> Diagnostic {
    let expected = &open.tag;
    let text = format!("mismatched end tag </{found}>, expected </{expected}>");
    Diagnostic::error(text, Some(place)).label(open.tag_span, format!("<{expected}> begins here"))
}

fn close(element: Element, open: &mut [Element], root: &mut Option<Element>) {
    match open.last_mut() {
        Some(parent) => parent.children.push(element),
        None => *root = Some(element),
    }
}

fn refuse_second_root(root: Option<&Element>, whole: Span) -> Result<(), Box<Diagnostic>> {
    match root {
        None => Ok(()),
        Some(root) => Err(Box::new(
            Diagnostic::error("a file may have only one root element; this is a second one", Some(whole))
                .label(root.tag_span, "the root"),
        )),
    }
}

fn bad_character(e: &EscapeError, span: Span) -> Diagnostic {
    let text = match e {
        EscapeError::UnrecognizedEntity(_, name) => format!("unknown character `&{name};`"),
        EscapeError::UnterminatedEntity(_) => {
            "`&` begins the name of a character, which ends with `;`".to_owned()
        }
        other => format!("malformed attribute value: {other}"),
    };
    Diagnostic::error(text, Some(span)).help("write `&amp;` for `&` itself")
}

fn fail<T>(message: impl Into<Cow<'static, str>>, span: Span) -> Result<T, Box<Diagnostic>> {
    Err(Box::new(Diagnostic::error(message.into(), Some(span))))
}
