//! The viewer of the HTML pages: pictures on canvases that zoom, pan and wipe. The page of a comparison and the live
//! page of a render contain it.

use crate::flip;
use crate::html::json;

/// JavaScript, to stand before a page's own: `class Viewer` and what goes with it.
pub const SCRIPT: &str = include_str!("viewer.js");

/// CSS, to stand before a page's own; for light and dark screens.
pub const STYLE: &str = include_str!("viewer.css");

/// The colours of error maps as JSON, for the element `magma` that the script reads.
pub fn magma() -> String {
    let colours: Vec<[u8; 3]> = (0..256).map(|i| flip::magma(i as f32 / 255.0)).collect();
    json(&colours)
}
