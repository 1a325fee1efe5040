//! What numbers of materials may be. Renderers take others too, without a word, and make something of them that nobody
//! asked for.

/// Roughnesses and widths.
const POSITIVE: [&str; 7] =
    ["alpha", "alpha_u", "alpha_v", "roughness", "uroughness", "vroughness", "thickness"];

/// Shares of a whole.
const SHARES: [&str; 11] = [
    "amount",
    "anisotropic",
    "clearcoat",
    "clearcoat_gloss",
    "flatness",
    "metallic",
    "opacity",
    "sheen_tint",
    "spec_tint",
    "spec_trans",
    "weight",
];

/// The warning that parameter `name` of a material has a value that makes no sense, if it does not. `name` may have a
/// prefix such as `interface.`.
pub fn doubt(name: &str, value: f64) -> Option<String> {
    let (_, last) = name.rsplit_once('.').unwrap_or(("", name));
    if POSITIVE.contains(&last) && value < 0.0 {
        return Some(format!("`{name}` should not be negative; it is {value}"));
    }
    let whole = SHARES.contains(&last) && !(0.0..=1.0).contains(&value);
    whole.then(|| format!("`{name}` should lie between 0 and 1; it is {value}"))
}
