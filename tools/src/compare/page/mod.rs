//! The HTML page of a run: one file that needs no other. Its template, style and script are beside this file.

mod view;
mod worst;

use super::comparison::Compared;
use super::report::Report;
use crate::html::{fill, json};
use crate::pixels::Pixels;
use crate::viewer;
use view::View;

/// Collects the pictures that the page shows.
#[derive(Debug, Default)]
pub struct Page {
    views: Vec<View>,
}

impl Page {
    /// Adds the pictures of a comparison, in the order of [`Report::comparisons`].
    pub fn add(&mut self, compared: &Compared, image: &Pixels, reference: &Pixels) {
        self.views.push(View::new(compared, image, reference));
    }

    /// The HTML.
    pub fn render(&self, report: &Report) -> String {
        let parts = [
            ("/*STYLE*/", &[viewer::STYLE, include_str!("style.css")].concat()),
            ("/*REPORT*/", &json(report)),
            ("/*VIEWS*/", &json(&self.views)),
            ("/*MAGMA*/", &viewer::magma()),
            ("/*SCRIPT*/", &[viewer::SCRIPT, include_str!("page.js")].concat()),
        ];
        fill(
            include_str!("template.html"),
            &parts.map(|(placeholder, content)| (placeholder, content.as_str())),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::report::Failure;

    #[test]
    fn names_cannot_leave_the_data() {
        let error = "</script><script>alert(1)</script>".to_string();
        let (name, image, reference) = (String::new(), String::new(), String::new());
        let failure = Failure { name, image, reference, error, missing: false, seconds: 0.0 };
        let report = Report { failures: vec![failure], ..Report::default() };
        let page = Page::default().render(&report);
        assert!(!page.contains("</script><script>alert"));
        assert!(!page.contains("/*VIEWS*/") && page.ends_with("</html>\n"));
    }
}
