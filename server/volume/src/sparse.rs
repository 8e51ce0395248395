//! From a tree of tiles and leaves, as OpenVDB and NanoVDB have them, to a grid.
//!
//! The trees of both formats have leaves of 8³ voxels below nodes of 128³ and 4096³. A voxel or a
//! tile has a value whether it is active or not, and renderers sample the value; the active ones
//! say how far the field reaches. So the field is: the stored values, active or not, inside the
//! bounding box of the active voxels and tiles; 0 beyond it. `clip` is that box and one voxel of 0
//! on each side, over which the trilinear field falls off. The lattice begins at a multiple of 8 of
//! the file's index space, so that a leaf is a brick.

use glam::{DAffine3, DVec3, I64Vec3, UVec3};

use crate::brick::voxel_index;
use crate::grid::GridBuilder;
use crate::placement;
use crate::{BRICK_SIDE, BRICK_VOXELS, Brick, Grid, VolumeError, VolumeLimits};

/// Values of a leaf in the order of the files: voxel (x, y, z) is entry `64x + 8y + z`.
pub(crate) type LeafValues = [f32; BRICK_VOXELS];

/// Which voxels of a leaf are active: voxel (x, y, z) is bit `8y + z` of word x.
pub(crate) type LeafMask = [u64; 8];

/// A cube of one value.
#[derive(Debug, Clone, Copy)]
struct Tile {
    origin: [i32; 3],
    side: u16,
    value: f32,
}

/// A leaf whose values lie elsewhere.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Leaf {
    /// Lowest voxel, in the file's index space.
    pub(crate) origin: [i32; 3],
    /// Where its values are: the reader's own number.
    pub(crate) source: u64,
}

/// What a tree holds, without the values of its leaves.
#[derive(Debug)]
pub(crate) struct SparseTree {
    low: I64Vec3,
    high: I64Vec3,
    tiles: Vec<Tile>,
    pub(crate) leaves: Vec<Leaf>,
    limit: u64,
}

impl SparseTree {
    pub(crate) fn new(limits: &VolumeLimits) -> Self {
        Self {
            low: I64Vec3::MAX,
            high: I64Vec3::MIN,
            tiles: Vec::new(),
            leaves: Vec::new(),
            limit: limits.grid_bytes,
        }
    }

    /// Adds a tile of `side` voxels along each edge, a multiple of 8.
    pub(crate) fn tile(
        &mut self,
        origin: [i32; 3],
        side: u16,
        value: f32,
        active: bool,
    ) -> Result<(), VolumeError> {
        if active {
            let low = I64Vec3::from_array(origin.map(i64::from));
            self.cover(low, low + i64::from(side) - 1);
        }
        if value != 0.0 {
            self.tiles.push(Tile {
                origin,
                side,
                value,
            });
            self.check()?;
        }
        Ok(())
    }

    /// Adds a leaf.
    pub(crate) fn leaf(
        &mut self,
        origin: [i32; 3],
        mask: &LeafMask,
        source: u64,
    ) -> Result<(), VolumeError> {
        if let Some((low, high)) = extent(mask) {
            let origin = I64Vec3::from_array(origin.map(i64::from));
            self.cover(origin + low, origin + high);
        }
        self.leaves.push(Leaf { origin, source });
        self.check()
    }

    fn cover(&mut self, low: I64Vec3, high: I64Vec3) {
        self.low = self.low.min(low);
        self.high = self.high.max(high);
    }

    fn check(&self) -> Result<(), VolumeError> {
        let tiles = self.tiles.len() * size_of::<Tile>();
        let leaves = self.leaves.len() * size_of::<Leaf>();
        VolumeError::within("bytes of nodes", (tiles + leaves) as u64, self.limit)
    }

    /// The grid; `read_leaf` fills in the values of each leaf, in the order of [`Self::leaves`].
    pub(crate) fn into_grid(
        self,
        name: &str,
        world_from_index: DAffine3,
        limits: &VolumeLimits,
        mut read_leaf: impl FnMut(&Leaf, &mut LeafValues) -> Result<(), VolumeError>,
    ) -> Result<Grid, VolumeError> {
        if self.low.cmpgt(self.high).any() {
            // No active voxel: a lattice of one 0.
            let grid = GridBuilder::new([1; 3], limits)?;
            let transform = placement::checked(world_from_index, "transform")?;
            return Ok(grid.finish(name, transform, [DVec3::ZERO; 2]));
        }
        let side = i64::from(BRICK_SIDE);
        let origin = (self.low - 1).map(|low| low.div_euclid(side) * side);
        let size = self.high + 2 - origin;
        let size = size.map(|side| side.min(i64::from(u32::MAX))).as_u64vec3();
        let mut builder = GridBuilder::new(size.as_uvec3().to_array(), limits)?;
        builder.reserve(self.leaves.len() as u64)?;
        let window = Window {
            origin,
            low: self.low,
            high: self.high,
        };
        for tile in &self.tiles {
            window.fill(&mut builder, tile)?;
        }
        let mut values = [0.0; BRICK_VOXELS];
        for leaf in &self.leaves {
            read_leaf(leaf, &mut values)?;
            window.set(&mut builder, leaf.origin, &values)?;
        }
        let moved = world_from_index * DAffine3::from_translation(origin.as_dvec3());
        let transform = placement::checked(moved, "transform")?;
        let clip = [
            (self.low - 1 - origin).as_dvec3(),
            (self.high + 1 - origin).as_dvec3(),
        ];
        Ok(builder.finish(name, transform, clip))
    }
}

/// The part of the file's index space that the lattice holds.
struct Window {
    /// Index-space voxel of lattice point 0; a multiple of 8.
    origin: I64Vec3,
    /// Lowest active voxel.
    low: I64Vec3,
    /// Highest active voxel.
    high: I64Vec3,
}

impl Window {
    /// Sets the brick of a leaf, 0 beyond the active voxels.
    fn set(
        &self,
        builder: &mut GridBuilder,
        origin: [i32; 3],
        values: &LeafValues,
    ) -> Result<(), VolumeError> {
        let origin = I64Vec3::from_array(origin.map(i64::from));
        let low = (self.low - origin).clamp(I64Vec3::ZERO, I64Vec3::splat(8));
        let end = (self.high + 1 - origin).clamp(I64Vec3::ZERO, I64Vec3::splat(8));
        if low.cmpge(end).any() {
            return Ok(());
        }
        let (low, end) = (low.as_uvec3(), end.as_uvec3());
        let mut brick: Brick = [0.0; BRICK_VOXELS];
        for x in low.x..end.x {
            for y in low.y..end.y {
                for z in low.z..end.z {
                    brick[voxel_index([x, y, z])] = values[(64 * x + 8 * y + z) as usize];
                }
            }
        }
        let at = (origin - self.origin) / i64::from(BRICK_SIDE);
        builder.set_brick(at.as_uvec3(), &brick)
    }

    /// Fills the bricks of a tile: those inside the active voxels' box whole, those across its
    /// faces voxel by voxel.
    fn fill(&self, builder: &mut GridBuilder, tile: &Tile) -> Result<(), VolumeError> {
        let side = i64::from(BRICK_SIDE);
        let origin = I64Vec3::from_array(tile.origin.map(i64::from));
        let low = origin.max(self.low);
        let end = (origin + i64::from(tile.side)).min(self.high + 1);
        if low.cmpge(end).any() {
            return Ok(());
        }
        let [low, end] = [low - self.origin, end - self.origin];
        let touched = [low / side, (end + side - 1) / side];
        let whole = [(low + side - 1) / side, end / side];
        builder.set_uniform_bricks(whole[0].as_uvec3(), whole[1].as_uvec3(), tile.value)?;
        if whole == touched {
            return Ok(());
        }
        let values = [tile.value; BRICK_VOXELS];
        for z in touched[0].z..touched[1].z {
            for y in touched[0].y..touched[1].y {
                let row_is_whole =
                    (whole[0].y..whole[1].y).contains(&y) && (whole[0].z..whole[1].z).contains(&z);
                for x in touched[0].x..touched[1].x {
                    if !(row_is_whole && (whole[0].x..whole[1].x).contains(&x)) {
                        let brick = UVec3::new(x as u32, y as u32, z as u32);
                        let origin = self.origin + brick.as_i64vec3() * side;
                        self.set(builder, origin.as_ivec3().to_array(), &values)?;
                    }
                }
            }
        }
        Ok(())
    }
}

/// Lowest and highest active voxel of a leaf.
fn extent(mask: &LeafMask) -> Option<(I64Vec3, I64Vec3)> {
    let all = mask.iter().fold(0, |all, word| all | word);
    if all == 0 {
        return None;
    }
    let x_low = mask.iter().position(|word| *word != 0).unwrap_or(0);
    let x_high = mask.iter().rposition(|word| *word != 0).unwrap_or(7);
    let z_bits = all.to_le_bytes().iter().fold(0_u8, |bits, row| bits | row);
    let low = I64Vec3::new(
        x_low as i64,
        i64::from(all.trailing_zeros() / 8),
        i64::from(z_bits.trailing_zeros()),
    );
    let high = I64Vec3::new(
        x_high as i64,
        i64::from(7 - all.leading_zeros() / 8),
        i64::from(z_bits.ilog2()),
    );
    Some((low, high))
}

/// The set bits of a mask of bytes, ascending.
pub(crate) fn set_bits(mask: &[u8]) -> impl Iterator<Item = usize> {
    mask.iter().enumerate().flat_map(|(byte, bits)| {
        (0..8)
            .filter(move |bit| bits >> bit & 1 == 1)
            .map(move |bit| byte * 8 + bit)
    })
}

/// Whether bit `at` of a mask of bytes is set.
pub(crate) fn bit(mask: &[u8], at: usize) -> bool {
    mask[at / 8] >> (at % 8) & 1 == 1
}

/// A leaf's mask from its 64 bytes.
pub(crate) fn leaf_mask(bytes: &[u8]) -> LeafMask {
    let mut mask = [0; 8];
    for (word, bytes) in mask.iter_mut().zip(bytes.chunks_exact(8)) {
        let mut array = [0; 8];
        array.copy_from_slice(bytes);
        *word = u64::from_le_bytes(array);
    }
    mask
}

/// The lowest voxel of child `at` of a node whose edge holds 2^`log2` children of `side` voxels.
pub(crate) fn child_origin(origin: [i32; 3], at: usize, log2: u32, side: i32) -> [i32; 3] {
    let mask = (1 << log2) - 1;
    let cell = [at >> (2 * log2), at >> log2 & mask, at & mask];
    let mut child = origin;
    for (axis, cell) in cell.into_iter().enumerate() {
        child[axis] = child[axis].wrapping_add(cell as i32 * side);
    }
    child
}
