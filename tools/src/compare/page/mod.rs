//! The HTML page of a run: one file that needs no other. Its template, style and script are beside this file.

mod view;
mod worst;

use super::comparison::Compared;
use super::report::Report;
use crate::flip::magma;
use crate::pixels::Pixels;
use serde::Serialize;
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
        let colours: Vec<[u8; 3]> = (0..256).map(|i| magma(i as f32 / 255.0)).collect();
        let mut page = String::new();
        let mut rest = include_str!("template.html");
        let parts = [
            ("/*STYLE*/", include_str!("style.css").to_string()),
            ("/*REPORT*/", json(report)),
            ("/*VIEWS*/", json(&self.views)),
            ("/*MAGMA*/", json(&colours)),
            ("/*SCRIPT*/", include_str!("page.js").to_string()),
        ];
        for (placeholder, content) in parts {
            let (before, after) = rest.split_once(placeholder).expect("the template has every placeholder");
            page.push_str(before);
            page.push_str(&content);
            rest = after;
        }
        page.push_str(rest);
        page
    }
}

/// JSON that cannot end the `script` element around it.
fn json(value: &impl Serialize) -> String {
    let text = serde_json::to_string(value).expect("a page holds only numbers and strings");
    text.replace('<', "\\u003c")
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
