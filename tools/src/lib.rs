//! The judge: image metrics, comparison and reports. Never imports the renderer.
