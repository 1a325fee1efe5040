//! The page: one HTML file that needs no other. Its template, style and script are beside this file; the viewer in it
//! is that of `caustica compare`.

use caustica_tools::{html, viewer};

/// The page of a render that is described by `info`.
pub fn page(info: &serde_json::Value) -> String {
    html::fill(
        include_str!("template.html"),
        &[
            ("/*STYLE*/", &[viewer::STYLE, include_str!("style.css")].concat()),
            ("/*INFO*/", &html::json(info)),
            ("/*MAGMA*/", &viewer::magma()),
            ("/*SCRIPT*/", &[viewer::SCRIPT, include_str!("page.js")].concat()),
        ],
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_is_whole_and_names_cannot_leave_the_data() {
        let page = page(&serde_json::json!({ "scene": "</script><script>alert(1)</script>" }));
        assert!(!page.contains("</script><script>alert") && page.ends_with("</html>\n"));
        assert!(!page.contains("/*INFO*/") && !page.contains("/*SCRIPT*/"));
        // Nothing comes from elsewhere.
        assert!(!page.contains("src=") && !page.contains("https://") && !page.contains("@import"));
    }
}
