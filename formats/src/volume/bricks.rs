//! A sparse grid of one channel, in bricks of 8³ points.

/// Points along a side of a brick.
pub(super) const SIDE: u32 = 8;

/// Values of a brick: z fastest, then y, then x.
pub(super) type Brick = [f32; 512];

/// More bricks than any grid has that fits in memory.
const MOST_BRICKS: u64 = 1 << 23;

/// Marks an index as one of `constants`.
const CONSTANT: u32 = 1 << 31;

/// Bricks of 8³ points.
#[derive(Clone, Debug, PartialEq)]
pub struct Bricks {
    /// Of the grid's first point in the first brick.
    pub offset: [u32; 3],
    /// Bricks along x, y and z.
    pub count: [u32; 3],
    /// For each brick, x fastest: the number of one of `full`, or of one of `constants` with the uppermost bit set.
    pub index: Vec<u32>,
    /// Values with z fastest, then y, then x.
    pub full: Vec<[f32; 512]>,
    /// What constant bricks hold; the first is that of bricks that no one put in.
    pub constants: Vec<f32>,
}

impl Bricks {
    /// For the points from `min` to `max` inclusive, all of which are `background`; `None` when there are too many.
    pub(super) fn new(min: [i32; 3], max: [i32; 3], background: f32) -> Option<Self> {
        let first = min.map(|c| c.div_euclid(SIDE as i32));
        let last = max.map(|c| c.div_euclid(SIDE as i32));
        let count: [u32; 3] = std::array::from_fn(|i| first[i].abs_diff(last[i]) + 1);
        let all = count.iter().try_fold(1u64, |all, &n| all.checked_mul(u64::from(n)))?;
        if all > MOST_BRICKS {
            return None;
        }
        let offset = min.map(|c| c.rem_euclid(SIDE as i32) as u32);
        let constants = vec![background];
        Some(Self { offset, count, index: vec![CONSTANT; all as usize], full: Vec::new(), constants })
    }

    /// Bricks in the grid.
    pub(super) fn len(&self) -> usize {
        self.index.len()
    }

    pub(super) fn value(&self, point: [u32; 3]) -> f32 {
        let at: [u32; 3] = std::array::from_fn(|i| point[i] + self.offset[i]);
        let index = self.index[self.place(at.map(|c| c / SIDE))];
        if index & CONSTANT != 0 {
            return self.constants[(index & !CONSTANT) as usize];
        }
        let [x, y, z] = at.map(|c| (c % SIDE) as usize);
        self.full[index as usize][x << 6 | y << 3 | z]
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(self.index.as_slice())
            + size_of_val(self.full.as_slice())
            + size_of_val(self.constants.as_slice())
    }

    /// Puts in the brick that is `at` of all.
    pub(super) fn set(&mut self, at: [u32; 3], brick: Brick) {
        let place = self.place(at);
        self.index[place] = self.full.len() as u32;
        self.full.push(brick);
    }

    /// Makes the bricks from `first` to `last` inclusive constant.
    pub(super) fn fill(&mut self, first: [u32; 3], last: [u32; 3], value: f32) {
        let index = CONSTANT | self.constants.len() as u32;
        self.constants.push(value);
        for z in first[2]..=last[2] {
            for y in first[1]..=last[1] {
                let start = self.place([first[0], y, z]);
                self.index[start..=start + (last[0] - first[0]) as usize].fill(index);
            }
        }
    }

    /// The value where nothing was put in.
    pub(super) fn background(&self) -> f32 {
        self.constants[0]
    }

    pub(super) fn count(&self) -> [u32; 3] {
        self.count
    }

    fn place(&self, [x, y, z]: [u32; 3]) -> usize {
        let [nx, ny, _] = self.count.map(|n| n as usize);
        (z as usize * ny + y as usize) * nx + x as usize
    }
}
