//! Values that a mesh carries besides its shape.

/// A value per vertex (`vertex_…`) or per triangle (`face_…`); a single number is repeated.
#[derive(Clone, Debug, PartialEq)]
pub struct Attribute {
    /// With `vertex_` or `face_` before the file's own name.
    pub name: String,
    /// One for each vertex or triangle; a single number is repeated.
    pub values: Vec<[f32; 3]>,
    /// What an author should know of the file's values before they are shown.
    pub note: Option<&'static str>,
}

impl Attribute {
    /// Whether its values belong to triangles and not to vertices.
    pub fn is_per_face(&self) -> bool {
        self.name.starts_with(FACE)
    }
}

pub(super) const VERTEX: &str = "vertex_";
pub(super) const FACE: &str = "face_";

/// The attributes among the properties of an element.
pub(super) struct Columns {
    /// Names and numbers of components.
    found: Vec<(String, usize)>,
    /// For every property, the attribute and component it is part of, if any.
    pub places: Vec<Option<(usize, usize)>>,
    /// Names and numbers of components of those that do not have one or three.
    pub skipped: Vec<(String, usize)>,
    /// What is to be said of each attribute.
    pub notes: Vec<Option<&'static str>>,
}

/// Mitsuba 3 warns of whole numbers and takes them as they are.
pub(super) const WHOLE: &str = "the file has whole numbers, which Mitsuba takes as they are: 255 is no white, but 255 times \
                                as bright; write floats from 0 to 1";
/// Mitsuba 3 shows such colours as black.
pub(super) const FOUR: &str =
    "the file has an alpha beside the colour, which Mitsuba does not show: here the alpha is left out";

/// The attribute a property is part of: `color` for `color_0`, `r` and `red`.
fn stem(property: &str) -> Option<&str> {
    if matches!(property, "r" | "g" | "b" | "red" | "green" | "blue") {
        return Some("color");
    }
    let (stem, component) = property.rsplit_once('_')?;
    let known = ["0", "1", "2", "3", "x", "y", "z", "w", "r", "g", "b", "a"];
    (!stem.is_empty() && known.contains(&component)).then_some(stem)
}

impl Columns {
    /// Groups the free properties (the others are `None`) into attributes of one or three components.
    pub fn new<'a>(prefix: &str, properties: impl Iterator<Item = Option<&'a str>>) -> Self {
        let stems: Vec<Option<&str>> = properties.map(|p| p.and_then(stem)).collect();
        let count = |stem: &str| stems.iter().flatten().filter(|s| **s == stem).count();
        let mut columns =
            Columns { found: Vec::new(), places: Vec::new(), skipped: Vec::new(), notes: Vec::new() };
        let mut next = Vec::new();
        for stem in &stems {
            if let Some(odd) = stem.filter(|s| !matches!(count(s), 1 | 3)) {
                let entry = (format!("{prefix}{odd}"), count(odd));
                if !columns.skipped.contains(&entry) {
                    columns.skipped.push(entry);
                }
            }
            let place = stem.filter(|s| matches!(count(s), 1 | 3)).map(|stem| {
                let name = format!("{prefix}{stem}");
                let index = columns.found.iter().position(|(n, _)| *n == name).unwrap_or_else(|| {
                    columns.found.push((name, count(stem)));
                    columns.notes.push(None);
                    next.push(0);
                    next.len() - 1
                });
                next[index] += 1;
                (index, next[index] - 1)
            });
            columns.places.push(place);
        }
        columns
    }

    /// A row to be filled in.
    pub fn row(&self) -> Vec<[f32; 3]> {
        vec![[0.0; 3]; self.found.len()]
    }

    /// Lists to be filled by [`Columns::push`].
    pub fn lists(&self) -> Vec<Attribute> {
        let named = self.found.iter().zip(&self.notes);
        named
            .map(|((name, _), note)| Attribute { name: name.clone(), values: Vec::new(), note: *note })
            .collect()
    }

    pub fn push(&self, lists: &mut [Attribute], row: &[[f32; 3]]) {
        for ((list, value), (_, size)) in lists.iter_mut().zip(row).zip(&self.found) {
            let value = if *size == 1 { [value[0]; 3] } else { *value };
            list.values.push(value.map(|x| if x.is_finite() { x } else { 0.0 }));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn properties_are_gathered_by_their_stem() {
        let names = ["color_0", "heat_x", "color_1", "odd_0", "color_2", "odd_1", "label"];
        let columns = Columns::new(VERTEX, names.iter().map(|n| Some(*n)));
        let place = [Some((0, 0)), Some((1, 0)), Some((0, 1)), None, Some((0, 2)), None, None];
        assert_eq!(columns.places, place);
        assert_eq!(columns.skipped, [("vertex_odd".to_owned(), 2)]);
        let mut lists = columns.lists();
        columns.push(&mut lists, &[[1.0, 2.0, f32::NAN], [4.0, 0.0, 0.0]]);
        assert_eq!(
            lists[0],
            Attribute { name: "vertex_color".into(), values: vec![[1.0, 2.0, 0.0]], note: None }
        );
        assert_eq!(lists[1].values, [[4.0; 3]]);
    }
}
