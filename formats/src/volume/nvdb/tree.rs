//! The tree of a grid.
//!
//! Everything it points at lies in the bytes of its grid: offsets that lead out of them are errors. A sound tree visits
//! each node once, so that more visits than there is room for nodes are an error as well.

use super::bytes::{Bytes, MAGIC, invalid};
use crate::ir::Transform;
use crate::volume::bricks::{Brick, Bricks, SIDE};
use crate::volume::{Grid, Store, VolumeError};

/// Sizes of nodes whose tiles are floats, and where their parts are.
const GRID: usize = 672;
const ROOT: usize = 64;
const ROOT_TILE: usize = 32;
const LEAF_MASKED: usize = 96;

/// A level of the tree between its root and its leaves.
struct Level {
    /// log2 of its children along an axis.
    children: u32,
    /// log2 of a child's points along an axis.
    child: u32,
    child_mask: usize,
    table: usize,
    size: usize,
}

const UPPER: Level = Level { children: 5, child: 7, child_mask: 4128, table: 8256, size: 270_400 };
const LOWER: Level = Level { children: 4, child: 3, child_mask: 544, table: 1088, size: 33_856 };

/// How the values of a leaf are stored.
#[derive(Clone, Copy)]
enum Values {
    Float,
    /// Steps between a minimum and a maximum, in so many bits; `None`: by leaf.
    Steps(Option<u32>),
}

pub(super) struct Tree<'a> {
    grid: Bytes<'a>,
    root: usize,
    values: Values,
    /// Corners of the box of active values, inclusive.
    min: [i32; 3],
    max: [i32; 3],
    bricks: Bricks,
    /// Nodes that may still be visited: upper, lower, leaves.
    left: [usize; 3],
    /// Bricks that tiles may still fill.
    fills: usize,
}

impl<'a> Tree<'a> {
    pub fn of(grid: &'a [u8]) -> Result<Self, VolumeError> {
        let bytes = Bytes(grid);
        if !bytes.array::<8>(0)?.starts_with(MAGIC) {
            return Err(invalid("a grid of the file does not begin with NanoVDB"));
        }
        let values = match bytes.u32(636)? {
            1 => Values::Float,
            13 => Values::Steps(Some(4)),
            14 => Values::Steps(Some(8)),
            15 => Values::Steps(Some(16)),
            16 => Values::Steps(None),
            kind => return Err(VolumeError::Unsupported(format!("with values of type {}", type_name(kind)))),
        };
        let root = bytes.target(GRID, GRID + 24)?;
        let (mut min, mut max) = (bytes.coordinate(root)?, bytes.coordinate(root + 12)?);
        let background = bytes.f32(root + 28)?;
        if !background.is_finite() {
            return Err(invalid(format!("the background of the grid is {background}")));
        }
        if (0..3).any(|i| min[i] > max[i]) {
            // No value is active.
            (min, max) = ([0; 3], [0; 3]);
        }
        let too_large = || invalid(format!("the grid reaches from {min:?} to {max:?}, which is too far"));
        let bricks = Bricks::new(min, max, background).ok_or_else(too_large)?;
        let room = |size: usize| grid.len() / size + 1;
        let left = [room(UPPER.size), room(LOWER.size), room(LEAF_MASKED)];
        let fills = bricks.len();
        Ok(Self { grid: bytes, root, values, min, max, bricks, left, fills })
    }

    pub fn read(mut self) -> Result<Grid, VolumeError> {
        let tiles = self.grid.u32(self.root + 24)? as usize;
        for tile in 0..tiles {
            let at = self.root + ROOT + tile * ROOT_TILE;
            let key = self.grid.u64(at)?;
            // Of each coordinate, the bits above those of an upper node.
            let origin = [42, 21, 0].map(|shift| (((key >> shift) as u32 & 0x1f_ffff) << 12).cast_signed());
            if self.grid.u64(at + 8)? == 0 {
                let value = self.grid.f32(at + 20)?;
                self.tile(origin, 12, value)?;
            } else {
                let node = self.grid.target(self.root, at + 8)?;
                self.upper(node, origin)?;
            }
        }
        let resolution = std::array::from_fn(|i| self.min[i].abs_diff(self.max[i]).saturating_add(1));
        let place = self.place(resolution)?;
        Ok(Grid { resolution, channels: 1, place, store: Store::Bricks(self.bricks) })
    }

    fn visit(&mut self, level: usize) -> Result<(), VolumeError> {
        let left = self.left[level].checked_sub(1);
        self.left[level] = left.ok_or_else(|| invalid("the nodes of the grid overlap"))?;
        Ok(())
    }

    fn upper(&mut self, node: usize, origin: [i32; 3]) -> Result<(), VolumeError> {
        self.visit(0)?;
        self.each(&UPPER, node, origin, |tree, node, origin| tree.lower(node, origin))
    }

    fn lower(&mut self, node: usize, origin: [i32; 3]) -> Result<(), VolumeError> {
        self.visit(1)?;
        self.each(&LOWER, node, origin, |tree, node, origin| tree.leaf(node, origin))
    }

    /// Does `below` to the children of a node, and fills in its tiles.
    fn each(
        &mut self,
        level: &Level,
        node: usize,
        origin: [i32; 3],
        below: fn(&mut Self, usize, [i32; 3]) -> Result<(), VolumeError>,
    ) -> Result<(), VolumeError> {
        let side = 1u32 << level.children;
        self.grid.slice(node, level.size)?;
        for n in 0..side * side * side {
            let along = [n >> (2 * level.children), (n >> level.children) % side, n % side];
            let corner =
                std::array::from_fn(|i| origin[i].wrapping_add((along[i] << level.child).cast_signed()));
            let entry = node + level.table + 8 * n as usize;
            let has_child = self.grid.0[node + level.child_mask + n as usize / 8] >> (n % 8) & 1 == 1;
            if has_child {
                let child = self.grid.target(node, entry)?;
                below(self, child, corner)?;
            } else {
                let value = self.grid.f32(entry)?;
                self.tile(corner, level.child, value)?;
            }
        }
        Ok(())
    }

    /// The bricks of a cube of 2^`size` points a side that are in the box; `None` when there are none.
    fn covered(&self, corner: [i32; 3], size: u32) -> Option<[[u32; 3]; 2]> {
        let count = self.bricks.count();
        let mut range = [[0; 3]; 2];
        for i in 0..3 {
            let side = SIDE as i32;
            let start = i64::from(corner[i].div_euclid(side)) - i64::from(self.min[i].div_euclid(side));
            let end = start + (1i64 << size) / i64::from(side) - 1;
            if end < 0 || start >= i64::from(count[i]) {
                return None;
            }
            range[0][i] = start.max(0) as u32;
            range[1][i] = end.min(i64::from(count[i]) - 1) as u32;
        }
        Some(range)
    }

    fn tile(&mut self, corner: [i32; 3], size: u32, value: f32) -> Result<(), VolumeError> {
        if !value.is_finite() {
            return Err(invalid(format!("a tile of the grid is {value}")));
        }
        let Some([first, last]) = self.covered(corner, size) else { return Ok(()) };
        if value == self.bricks.background() {
            return Ok(());
        }
        let bricks: usize = (0..3).map(|i| (last[i] - first[i] + 1) as usize).product();
        self.fills =
            self.fills.checked_sub(bricks).ok_or_else(|| invalid("the tiles of the grid overlap"))?;
        self.bricks.fill(first, last, value);
        Ok(())
    }

    fn leaf(&mut self, node: usize, corner: [i32; 3]) -> Result<(), VolumeError> {
        self.visit(2)?;
        let Some([at, _]) = self.covered(corner, 3) else { return Ok(()) };
        let brick = self.leaf_values(node)?;
        if let Some(bad) = brick.iter().find(|v| !v.is_finite()) {
            return Err(invalid(format!("a value of the grid is {bad}")));
        }
        self.bricks.set(at, brick);
        Ok(())
    }

    fn leaf_values(&self, node: usize) -> Result<Brick, VolumeError> {
        let bits = match self.values {
            Values::Float => {
                let values = self.grid.slice(node + LEAF_MASKED, 4 * 512)?.as_chunks::<4>().0;
                return Ok(std::array::from_fn(|i| f32::from_le_bytes(values[i])));
            }
            Values::Steps(Some(bits)) => bits,
            Values::Steps(None) => 1 << (self.grid.slice(node + 15, 1)?[0] >> 5).min(4),
        };
        let (minimum, step) = (self.grid.f32(node + 80)?, self.grid.f32(node + 84)?);
        let codes = self.grid.slice(node + LEAF_MASKED, 64 * bits as usize)?;
        Ok(std::array::from_fn(|i| {
            let code = match bits {
                16 => u16::from_le_bytes([codes[2 * i], codes[2 * i + 1]]),
                8 => u16::from(codes[i]),
                _ => {
                    let in_byte = 8 / bits as usize;
                    let shift = (i % in_byte) * bits as usize;
                    u16::from(codes[i / in_byte] >> shift) & ((1 << bits) - 1)
                }
            };
            f32::from(code) * step + minimum
        }))
    }

    /// From the unit cube, whose cells are centred at the points, to the world of the file.
    fn place(&self, resolution: [u32; 3]) -> Result<Option<Transform>, VolumeError> {
        const MATRIX: usize = 296 + 88;
        const OFFSET: usize = 296 + 232;
        let double = |at: usize| self.grid.array(at).map(f64::from_le_bytes);
        let mut rows = [[0.0; 4]; 4];
        for (row, line) in rows.iter_mut().take(3).enumerate() {
            for (column, entry) in line.iter_mut().take(3).enumerate() {
                *entry = double(MATRIX + 8 * (3 * row + column))?;
            }
            line[3] = double(OFFSET + 8 * row)?;
        }
        rows[3][3] = 1.0;
        let to_world = Transform(rows);
        let size = resolution.map(f64::from);
        let corner = self.min.map(|c| f64::from(c) - 0.5);
        let place = to_world.after(&Transform::translate(corner)).after(&Transform::scale(size));
        let sound = place.0.as_flattened().iter().all(|v| v.is_finite()) && place.inverse().is_some();
        Ok(sound.then_some(place))
    }
}

/// As NanoVDB calls it.
fn type_name(kind: u32) -> String {
    const NAMES: [&str; 27] = [
        "unknown",
        "float",
        "double",
        "int16",
        "int32",
        "int64",
        "vec3f",
        "vec3d",
        "mask",
        "half",
        "uint32",
        "bool",
        "rgba8",
        "fp4",
        "fp8",
        "fp16",
        "fpN",
        "vec4f",
        "vec4d",
        "index",
        "onIndex",
        "indexMask",
        "onIndexMask",
        "pointIndex",
        "vec3u8",
        "vec3u16",
        "uint8",
    ];
    NAMES.get(kind as usize).map_or_else(|| kind.to_string(), |name| (*name).to_owned())
}
