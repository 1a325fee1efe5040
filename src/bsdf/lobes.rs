use std::ops::{Index, IndexMut};

/// A smooth lobe of a model that can be chosen when sampling.
#[derive(Clone, Copy, Debug, Default)]
pub struct Lobe {
    /// Among the smooth lobes.
    pub probability: f32,
    /// α of a microfacet lobe, [`super::Range::DIFFUSE`] of a diffuse one.
    pub roughness: f32,
}

/// The smooth lobes of a model, by number; those of probability 0 are never chosen. As many as there are: few are held
/// by value, and only coats over blends of many lobes need memory for more.
#[derive(Clone, Debug, Default)]
pub struct Lobes {
    few: [Lobe; FEW],
    len: usize,
    more: Vec<Lobe>,
}

/// As many as any model has that nests no others.
const FEW: usize = 4;

impl Lobes {
    /// A single lobe.
    #[inline]
    pub fn one(roughness: f32) -> Self {
        Self::from([Lobe { probability: 1.0, roughness }])
    }

    /// Adds the next one.
    pub fn push(&mut self, lobe: Lobe) {
        match self.few.get_mut(self.len) {
            Some(free) => *free = lobe,
            None => self.more.push(lobe),
        }
        self.len += 1;
    }

    /// All of them, in order.
    #[inline]
    pub fn iter(&self) -> impl Iterator<Item = &Lobe> {
        self.few[..self.len.min(FEW)].iter().chain(&self.more)
    }
}

impl<const N: usize> From<[Lobe; N]> for Lobes {
    #[inline]
    fn from(lobes: [Lobe; N]) -> Self {
        let mut list = Self::default();
        lobes.into_iter().for_each(|l| list.push(l));
        list
    }
}

impl IntoIterator for Lobes {
    type Item = Lobe;
    type IntoIter =
        std::iter::Chain<std::iter::Take<std::array::IntoIter<Lobe, FEW>>, std::vec::IntoIter<Lobe>>;

    fn into_iter(self) -> Self::IntoIter {
        self.few.into_iter().take(self.len).chain(self.more)
    }
}

impl Index<usize> for Lobes {
    type Output = Lobe;

    #[inline]
    fn index(&self, i: usize) -> &Lobe {
        if i < FEW { &self.few[i] } else { &self.more[i - FEW] }
    }
}

impl IndexMut<usize> for Lobes {
    fn index_mut(&mut self, i: usize) -> &mut Lobe {
        if i < FEW { &mut self.few[i] } else { &mut self.more[i - FEW] }
    }
}
