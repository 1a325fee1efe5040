//! Where the numbers of a grid are.

/// Points along a side of a brick.
const SIDE: u32 = 8;

/// Marks the index of a brick as one of [`Bricks::constants`].
const CONSTANT: u32 = 1 << 31;

/// The numbers at the points of a grid.
#[derive(Clone, Debug)]
pub enum Values {
    /// All of them: x fastest, the channels of a point together.
    Dense(Vec<f32>),
    /// In bricks, most of which may be constant: one number a point.
    Sparse(Bricks),
}

/// Bricks of 8³ points.
#[derive(Clone, Debug)]
pub struct Bricks {
    /// Of the grid's first point in the first brick.
    pub offset: [u32; 3],
    /// Bricks along x, y and z.
    pub count: [u32; 3],
    /// For each brick, x fastest: the number of a full one, or of a constant with the uppermost bit set.
    pub index: Vec<u32>,
    /// With z fastest, then y, then x.
    pub full: Vec<[f32; 512]>,
    /// What constant bricks hold.
    pub constants: Vec<f32>,
}

impl Bricks {
    fn place(&self, at: [u32; 3]) -> usize {
        let [x, y, z] = at.map(|c| (c / SIDE) as usize);
        (z * self.count[1] as usize + y) * self.count[0] as usize + x
    }

    #[inline]
    fn value(&self, point: [u32; 3]) -> f32 {
        let at: [u32; 3] = std::array::from_fn(|axis| point[axis] + self.offset[axis]);
        let index = self.index[self.place(at)];
        if index & CONSTANT != 0 {
            self.constants[(index ^ CONSTANT) as usize]
        } else {
            self.within(index, at)
        }
    }

    #[inline]
    fn within(&self, index: u32, at: [u32; 3]) -> f32 {
        let [x, y, z] = at.map(|c| (c % SIDE) as usize);
        self.full[index as usize][x << 6 | y << 3 | z]
    }

    /// Calls `f` for the points from `low` to `high` inclusive, of constant bricks once with how many there are.
    fn each(&self, low: [u32; 3], high: [u32; 3], f: &mut impl FnMut(&[f32], u64)) {
        let from: [u32; 3] = std::array::from_fn(|axis| low[axis] + self.offset[axis]);
        let to: [u32; 3] = std::array::from_fn(|axis| high[axis] + self.offset[axis]);
        let bricks: [_; 3] = std::array::from_fn(|axis| from[axis] / SIDE..=to[axis] / SIDE);
        let [xs, ys, zs] = bricks;
        for z in zs {
            for y in ys.clone() {
                for x in xs.clone() {
                    self.brick([x, y, z], from, to, f);
                }
            }
        }
    }

    fn brick(&self, brick: [u32; 3], from: [u32; 3], to: [u32; 3], f: &mut impl FnMut(&[f32], u64)) {
        let corner = brick.map(|c| c * SIDE);
        let index = self.index[self.place(corner)];
        let part: [_; 3] =
            std::array::from_fn(|axis| from[axis].max(corner[axis])..=to[axis].min(corner[axis] + SIDE - 1));
        if index & CONSTANT != 0 {
            let points = part.iter().map(|range| u64::from(range.end() - range.start() + 1)).product();
            f(&[self.constants[(index ^ CONSTANT) as usize]], points);
            return;
        }
        let [xs, ys, zs] = part;
        for x in xs {
            for y in ys.clone() {
                for z in zs.clone() {
                    f(&[self.within(index, [x, y, z])], 1);
                }
            }
        }
    }
}

impl Values {
    /// The numbers of a point of a grid of this size, which has so many channels; one number stands for all.
    #[inline]
    pub(super) fn at<const N: usize>(&self, size: [u32; 3], channels: u32, point: [u32; 3]) -> [f32; N] {
        match self {
            Self::Dense(data) => {
                let [x, y, z] = point.map(|c| c as usize);
                let at = ((z * size[1] as usize + y) * size[0] as usize + x) * channels as usize;
                match data[at..at + channels as usize] {
                    [v] => [v; N],
                    ref values => std::array::from_fn(|c| values[c.min(values.len() - 1)]),
                }
            }
            Self::Sparse(bricks) => [bricks.value(point); N],
        }
    }

    /// Calls `f` for all points from `low` to `high` inclusive, with their channels and with how many of them there are
    /// with these.
    pub(super) fn each(
        &self,
        (size, channels): ([u32; 3], u32),
        [low, high]: [[u32; 3]; 2],
        mut f: impl FnMut(&[f32], u64),
    ) {
        match self {
            Self::Sparse(bricks) => bricks.each(low, high, &mut f),
            Self::Dense(data) => {
                let n = channels as usize;
                for z in low[2]..=high[2] {
                    for y in low[1]..=high[1] {
                        let row = (z as usize * size[1] as usize + y as usize) * size[0] as usize;
                        let part = &data[(row + low[0] as usize) * n..(row + high[0] as usize + 1) * n];
                        part.chunks_exact(n).for_each(|v| f(v, 1));
                    }
                }
            }
        }
    }

    /// Every number that is kept.
    pub(super) fn numbers(&mut self) -> impl Iterator<Item = &mut f32> {
        let (first, bricks) = match self {
            Self::Dense(data) => (data.as_mut_slice(), None),
            Self::Sparse(b) => (b.constants.as_mut_slice(), Some(b.full.as_flattened_mut())),
        };
        first.iter_mut().chain(bricks.into_iter().flatten())
    }

    /// All of them in a row, if they are kept so.
    pub fn dense(&self) -> Option<&[f32]> {
        match self {
            Self::Dense(data) => Some(data),
            Self::Sparse(_) => None,
        }
    }
}
