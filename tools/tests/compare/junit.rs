//! JUnit XML and annotations of a run over two folders.

use crate::folder::{Folder, RGB, text};
use caustica_tools::compare::{CompareArgs, Status};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use std::collections::BTreeMap;

/// An element with everything in it.
#[derive(Debug, Default)]
struct Element {
    name: String,
    attributes: BTreeMap<String, String>,
    children: Vec<Element>,
    text: String,
}

impl Element {
    fn begin(start: &BytesStart<'_>) -> Self {
        let decoded = |a: Result<quick_xml::events::attributes::Attribute<'_>, _>| {
            let a = a.unwrap();
            let value = a.normalized_value(quick_xml::XmlVersion::Implicit1_0).unwrap().into_owned();
            (a.key.as_ref().to_owned(), value)
        };
        let attributes = start.attributes().map(decoded).collect();
        let name = start.name().as_ref().to_owned();
        Self { name, attributes, ..Self::default() }
    }

    fn parse(text: &str) -> Self {
        let mut reader = Reader::from_str(text);
        let mut open = vec![Self::default()];
        loop {
            match reader.read_event().unwrap() {
                Event::Start(start) => open.push(Self::begin(&start)),
                Event::Empty(start) => open.last_mut().unwrap().children.push(Self::begin(&start)),
                Event::Text(text) => open.last_mut().unwrap().text += &*text,
                Event::GeneralRef(name) => {
                    let name = format!("&{};", &*name);
                    open.last_mut().unwrap().text += &quick_xml::escape::unescape(&name).unwrap();
                }
                Event::End(_) => {
                    let done = open.pop().unwrap();
                    open.last_mut().unwrap().children.push(done);
                }
                Event::Eof => break,
                _ => {}
            }
        }
        assert_eq!(open.len(), 1, "an element is not closed");
        open.pop().unwrap().children.pop().unwrap()
    }

    fn at(&self, attribute: &str) -> &str {
        &self.attributes[attribute]
    }

    fn all<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a Element> {
        self.children.iter().filter(move |c| c.name == name)
    }
}

/// What both the schema of Jenkins and that of Apache Ant allow: of each element, the children in their order, the
/// attributes that must be there, and those that may.
const SCHEMA: &[(&str, &[&str], &[&str], &[&str])] = &[
    ("testsuites", &["testsuite"], &[], &[]),
    (
        "testsuite",
        &["properties", "testcase", "system-out", "system-err"],
        &["name", "package", "id", "timestamp", "hostname", "tests", "failures", "errors", "time"],
        &["skipped"],
    ),
    ("properties", &["property"], &[], &[]),
    ("property", &[], &["name", "value"], &[]),
    ("testcase", &["skipped", "error", "failure"], &["name", "classname", "time"], &[]),
    ("skipped", &[], &[], &["message"]),
    ("error", &[], &["type"], &["message"]),
    ("failure", &[], &["type"], &["message"]),
    ("system-out", &[], &[], &[]),
    ("system-err", &[], &[], &[]),
];

/// Fails on anything that one of the schemas does not allow.
fn valid(element: &Element) {
    let name = element.name.as_str();
    let (_, children, required, optional) = SCHEMA.iter().find(|row| row.0 == name).unwrap();
    for attribute in *required {
        assert!(element.attributes.contains_key(*attribute), "{name} lacks {attribute}");
    }
    for (attribute, value) in &element.attributes {
        assert!(required.iter().chain(*optional).any(|a| a == attribute), "{name} has {attribute}");
        match attribute.as_str() {
            "time" => {
                let (whole, part) = value.split_once('.').unwrap();
                assert!(part.len() == 3 && format!("{whole}{part}").bytes().all(|b| b.is_ascii_digit()));
            }
            "tests" | "failures" | "errors" | "skipped" | "id" => drop(value.parse::<u32>().unwrap()),
            "name" | "hostname" | "package" => assert!(!value.trim().is_empty(), "{name}: empty {attribute}"),
            _ => {}
        }
    }
    let places: Vec<usize> = element
        .children
        .iter()
        .map(|child| children.iter().position(|c| *c == child.name).expect("the child is allowed"))
        .collect();
    assert!(places.is_sorted(), "{name}: children out of order");
    assert!(name != "testcase" || places.len() <= 1, "a case ends in one way");
    element.children.iter().for_each(valid);
}

/// Two folders: a picture that holds, one that does not, one of another size, one that is missing, one that is too
/// much, and names that XML and GitHub cannot take as they are.
fn folders() -> (Folder, CompareArgs) {
    let f = Folder::new();
    for (name, value) in [("same", 0.5), ("deep/far", 0.6), ("odd,<&\"\u{1}>: 50%", 0.7), ("extra", 0.5)] {
        f.exr(&format!("images/{name}.exr"), &RGB, value);
    }
    f.sized("images/wide.exr", &RGB, 0.5, (21, 10));
    for name in ["same", "deep/far", "odd,<&\"\u{1}>: 50%", "wide", "gone"] {
        f.exr(&format!("references/{name}.ref.exr"), &RGB, 0.5);
    }
    let args = CompareArgs {
        max_rmse: Some(0.05),
        max_bias: Some(0.5),
        junit: Some(f.path("out.xml")),
        no_hdr: true,
        ..CompareArgs::new(f.path("images"), f.path("references"))
    };
    (f, args)
}

#[cfg(unix)]
#[test]
fn a_folder_is_a_suite_with_a_case_for_each_picture() {
    let (f, args) = folders();
    let (status, table) = text(&args);
    assert_eq!(status, Status::CouldNotCompare);
    let root = Element::parse(&std::fs::read_to_string(f.path("out.xml")).unwrap());
    valid(&root);
    let suite = &root.children[0];
    assert_eq!(suite.at("name"), f.path("references").to_str().unwrap());
    let counts = ["tests", "failures", "errors", "skipped"].map(|name| suite.at(name));
    assert_eq!(counts, ["6", "2", "2", "1"]);
    let ends: Vec<(&str, &str, &str)> = suite
        .all("testcase")
        .map(|case| {
            let end = case.children.first();
            let message = end.map_or("", |e| e.at("message"));
            (case.at("name"), end.map_or("passed", |e| e.name.as_str()), message)
        })
        .collect();
    assert_eq!(ends[0], ("deep/far", "failure", "rmse 0.100000 > 0.05"));
    assert_eq!(ends[1], ("odd,<&\"\u{FFFD}>: 50%", "failure", "rmse 0.200000 > 0.05"));
    assert_eq!(ends[2], ("same", "passed", ""));
    assert!(ends[3].0 == "wide" && ends[3].1 == "error" && ends[3].2.contains("has 21x10 pixels"));
    assert!(ends[4].0 == "gone" && ends[4].1 == "error" && ends[4].2.contains("has no image for"));
    assert!(ends[5].0 == "extra" && ends[5].1 == "skipped" && ends[5].2.contains("no reference for"));
    let kinds: Vec<_> = suite.all("testcase").flat_map(|c| c.all("error")).map(|e| e.at("type")).collect();
    assert_eq!(kinds, ["not-compared", "missing"]);
    let failure = suite.all("testcase").next().unwrap().all("failure").next().unwrap();
    assert_eq!(failure.text, "FAILS  rmse 0.100000 > 0.05\nholds  bias 0.200000 <= 0.5");
    let properties: BTreeMap<&str, &str> =
        suite.all("properties").flat_map(|p| &p.children).map(|p| (p.at("name"), p.at("value"))).collect();
    let rmse: f64 = properties["deep/far.rmse"].parse().unwrap();
    assert!((rmse - 0.1).abs() < 1e-6 && properties["same.rmse"] == "0", "{properties:?}");
    assert!(properties.contains_key("same.flip") && !properties.contains_key("same.psnr"));
    assert_eq!(suite.all("system-out").next().unwrap().text, table);
}

#[test]
fn two_files_are_a_suite_of_one_case_and_so_is_what_is_not_there() {
    let f = Folder::new();
    let (a, b) = (f.exr("a.exr", &RGB, 0.5), f.path("none.exr"));
    let junit = Some(f.path("out.xml"));
    for (reference, counts) in [(&a, ["1", "0", "0"]), (&b, ["1", "0", "1"])] {
        text(&CompareArgs { junit: junit.clone(), ..CompareArgs::new(&a, reference) });
        let root = Element::parse(&std::fs::read_to_string(f.path("out.xml")).unwrap());
        valid(&root);
        let suite = &root.children[0];
        assert_eq!(["tests", "failures", "errors"].map(|name| suite.at(name)), counts);
        assert_eq!(suite.all("testcase").next().unwrap().at("name"), "a.exr");
    }
    let lost = CompareArgs { junit: Some(f.path("none/out.xml")), ..CompareArgs::new(&a, &a) };
    let (status, table) = text(&lost);
    assert_eq!(status, Status::CouldNotCompare);
    assert!(table.contains("could not compare: ") && table.contains("none/out.xml: "), "{table}");
}

/// A file's name cannot pass for a command of the workflow.
#[cfg(unix)]
#[test]
fn names_of_files_are_no_commands() {
    let f = Folder::new();
    for folder in ["images", "references"] {
        f.exr(&format!("{folder}/a\n::stop-commands::x\r.exr"), &RGB, 0.5);
    }
    f.exr("images/b\n::error::c.exr", &RGB, 0.5);
    let folders = CompareArgs { github: true, ..CompareArgs::new(f.path("images"), f.path("references")) };
    let single = f.path("images/b\n::error::c.exr");
    let single = CompareArgs { github: true, ..CompareArgs::new(single.clone(), single) };
    for (args, ours) in [(folders, 1), (single, 0)] {
        let (_, printed) = text(&args);
        let commands: Vec<&str> = printed.lines().filter(|l| l.starts_with("::")).collect();
        assert_eq!(commands.len(), ours, "{printed}");
        assert!(commands.iter().all(|c| c.starts_with("::warning file=")), "{printed}");
    }
}

#[cfg(unix)]
#[test]
fn annotations_name_the_file_of_the_repository_that_is_wrong() {
    let (f, args) = folders();
    let (_, printed) = text(&CompareArgs { github: true, ..args });
    let commands: Vec<&str> = printed.lines().filter(|l| l.starts_with("::")).collect();
    let folder = f.0.path().display();
    assert_eq!(commands.len(), 5, "{printed}");
    // The temporary folder is not in the repository, so its path stays whole.
    let far = format!(
        "::error file={folder}/references/deep/far.ref.exr,title=deep/far::{folder}/images/deep/far.exr against \
         {folder}/references/deep/far.ref.exr: rmse 0.100000 > 0.05"
    );
    assert_eq!(commands[0], far);
    assert!(commands[1].contains("title=odd%2C<&\"\u{1}>%3A 50%25::"), "{}", commands[1]);
    assert!(commands[2].starts_with("::error") && commands[2].contains("::different sizes: "));
    assert!(commands[3].starts_with("::error") && commands[3].contains("has no image for"));
    assert!(commands[4].starts_with("::warning") && commands[4].contains("no reference for"));
}
