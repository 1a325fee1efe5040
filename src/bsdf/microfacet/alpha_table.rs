//! Tables for one roughness, or for a row of them.

/// Tables with the α they are for, ascending.
#[derive(Clone, Debug)]
pub struct AlphaTable<T>(Vec<(f32, T)>);

impl<T> AlphaTable<T> {
    /// Of at least one row, by ascending α.
    pub fn new(rows: impl IntoIterator<Item = (f32, T)>) -> Self {
        Self(rows.into_iter().collect())
    }

    /// A number of the tables at α: linear between the two around it, that of the last beyond.
    pub fn at(&self, alpha: f32, number: impl Fn(&T) -> f32) -> f32 {
        let above = self.0.iter().position(|r| r.0 >= alpha).unwrap_or(self.0.len() - 1);
        let ((from, a), (to, b)) = (&self.0[above.saturating_sub(1)], &self.0[above]);
        let t = if to > from { ((alpha - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
        number(a) + (number(b) - number(a)) * t
    }
}

/// Entry below cosθ of `entries` from 0 to 1, and how far it is from there to the next.
pub fn cosine_entry(cos: f32, entries: usize) -> (usize, f32) {
    let x = cos.clamp(0.0, 1.0) * (entries - 1) as f32;
    let i = (x as usize).min(entries - 2);
    (i, x - i as f32)
}
