//! Grids without a file: a smoke plume and a cloud, made from noise.
//!
//! The same parameters give the same bits on every machine: the generators use no function whose
//! rounding a platform chooses.

use std::sync::{Arc, Mutex, PoisonError};

use glam::{DAffine3, DVec3, UVec3, Vec2, Vec3};

use crate::noise::{Noise, smoothstep};
use crate::{BRICK_SIDE, BRICK_VOXELS, Grid, GridBuilder, VolumeError, VolumeLimits};

/// What is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Pattern {
    /// Smoke that rises from the origin, widens and rolls: 2/3 × 1 × 2/3 m.
    SmokePlume,
    /// A cumulus with a flat base: 1 × 5/8 × 1 m.
    Cloud,
}

impl Pattern {
    /// Sides of the box as parts of 24: all sizes are whole voxels if the resolution is.
    fn proportions(self) -> [u32; 3] {
        match self {
            Self::SmokePlume => [16, 24, 16],
            Self::Cloud => [24, 15, 24],
        }
    }
}

/// A grid to be made.
///
/// It stands on the plane y = 0, centred over the origin, with its longest side 1 m. Values lie
/// between 0 and 1, and are 0 at the faces.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Procedural {
    /// What is made.
    pub pattern: Pattern,
    /// Voxels along the longest side. Range: 8 to 256.
    pub resolution: u32,
    /// Octaves of noise, each of twice the frequency of the one before. Range: 1 to 8.
    pub octaves: u32,
    /// Another seed, another plume or cloud.
    pub seed: u64,
}

impl Procedural {
    /// Allowed values of `resolution`.
    pub const RESOLUTION: std::ops::RangeInclusive<u32> = 8..=256;
    /// Allowed values of `octaves`.
    pub const OCTAVES: std::ops::RangeInclusive<u32> = 1..=8;

    /// Voxels along x, y, z.
    pub fn size(&self) -> [u32; 3] {
        let parts = self.pattern.proportions();
        parts.map(|part| (self.resolution * part).div_ceil(24).max(1))
    }

    /// Makes the grid, or finds it among the last ones made.
    ///
    /// # Errors
    /// [`VolumeError::Invalid`] if a parameter is out of range, [`VolumeError::Limit`] if the grid
    /// would be too large.
    pub fn grid(&self, limits: &VolumeLimits) -> Result<Arc<Grid>, VolumeError> {
        let kept = lock().iter().find(|(key, _)| key == self).cloned();
        if let Some((_, grid)) = kept
            && grid.bytes() <= limits.grid_bytes
        {
            return Ok(grid);
        }
        let grid = Arc::new(self.generate(limits)?);
        keep(*self, &grid);
        Ok(grid)
    }

    /// A block of the largest density in place of the grid, which takes no time to make.
    ///
    /// # Errors
    /// As [`Self::grid`].
    pub fn outline(&self, limits: &VolumeLimits) -> Result<Grid, VolumeError> {
        let (size, mut builder) = self.lattice(limits)?;
        let bricks = size.map(|side| side.div_ceil(BRICK_SIDE));
        let whole = size / BRICK_SIDE;
        builder.set_uniform_bricks(UVec3::ZERO, whole, 1.0)?;
        for index in 0..bricks.element_product() {
            let brick = nth_brick(index, bricks);
            if brick.cmpge(whole).any() {
                builder.set_brick(brick, &[1.0; BRICK_VOXELS])?;
            }
        }
        Ok(self.place(size, builder))
    }

    /// The empty lattice of the grid, and its size. Unit: voxel.
    fn lattice(&self, limits: &VolumeLimits) -> Result<(UVec3, GridBuilder), VolumeError> {
        in_range("resolution", self.resolution, &Self::RESOLUTION)?;
        in_range("octaves", self.octaves, &Self::OCTAVES)?;
        let size = UVec3::from_array(self.size());
        Ok((size, GridBuilder::new(size.to_array(), limits)?))
    }

    /// The finished grid, placed over the origin.
    fn place(&self, size: UVec3, builder: GridBuilder) -> Grid {
        let scale = DVec3::splat(1.0 / f64::from(self.resolution));
        let size = size.as_dvec3();
        let corner = DVec3::new(-0.5, 0.0, -0.5) * size;
        let placed = DAffine3::from_scale(scale) * DAffine3::from_translation(corner + 0.5);
        let name = match self.pattern {
            Pattern::SmokePlume => "smoke_plume",
            Pattern::Cloud => "cloud",
        };
        builder.finish(name, placed, [DVec3::splat(-0.5), size - 0.5])
    }

    /// Makes the grid.
    fn generate(&self, limits: &VolumeLimits) -> Result<Grid, VolumeError> {
        let (size, mut builder) = self.lattice(limits)?;
        let density = match self.pattern {
            Pattern::SmokePlume => Density::Plume(Plume::new(self)),
            Pattern::Cloud => Density::Cloud(Cloud::new(self)),
        };
        let voxel = 1.0 / self.resolution as f32;
        let bricks = size.map(|side| side.div_ceil(BRICK_SIDE));
        // Where the low corner of the box lies.
        let low = Vec3::new(-0.5, 0.0, -0.5) * size.as_vec3();
        for index in 0..bricks.element_product() {
            let brick = nth_brick(index, bricks);
            let first = low + (brick * BRICK_SIDE).as_vec3();
            let center = (first + 4.0) * voxel;
            if density.is_empty_around(center, 7.0 * voxel) {
                continue;
            }
            let mut values = [0.0; BRICK_VOXELS];
            for (i, value) in values.iter_mut().enumerate() {
                let i = i as u32;
                let offset = UVec3::new(i % 8, i / 8 % 8, i / 64).as_vec3();
                *value = density.at((first + offset + 0.5) * voxel).clamp(0.0, 1.0);
            }
            builder.set_brick(brick, &values)?;
        }
        Ok(self.place(size, builder))
    }
}

/// The brick with this number, counted along x, then y, then z.
fn nth_brick(index: u32, bricks: UVec3) -> UVec3 {
    UVec3::new(
        index % bricks.x,
        index / bricks.x % bricks.y,
        index / (bricks.x * bricks.y),
    )
}

fn in_range(
    field: &str,
    found: u32,
    allowed: &std::ops::RangeInclusive<u32>,
) -> Result<(), VolumeError> {
    if allowed.contains(&found) {
        return Ok(());
    }
    let allowed = format!("{} to {}", allowed.start(), allowed.end());
    Err(VolumeError::invalid(field, found.to_string(), allowed))
}

/// The last grids made, the newest first.
static KEPT: Mutex<Vec<(Procedural, Arc<Grid>)>> = Mutex::new(Vec::new());
/// Memory of the grids that are kept without anyone using them. Unit: byte.
const KEPT_BYTES: u64 = 64 << 20;

fn lock() -> std::sync::MutexGuard<'static, Vec<(Procedural, Arc<Grid>)>> {
    KEPT.lock().unwrap_or_else(PoisonError::into_inner)
}

fn keep(key: Procedural, grid: &Arc<Grid>) {
    let mut kept = lock();
    kept.retain(|(other, _)| *other != key);
    kept.insert(0, (key, Arc::clone(grid)));
    let mut bytes = 0;
    kept.retain(|(_, grid)| {
        bytes += grid.bytes();
        bytes <= KEPT_BYTES
    });
}

enum Density {
    Plume(Plume),
    Cloud(Cloud),
}

impl Density {
    fn at(&self, p: Vec3) -> f32 {
        match self {
            Self::Plume(plume) => plume.at(p),
            Self::Cloud(cloud) => cloud.at(p),
        }
    }

    /// Whether a ball is certainly empty.
    fn is_empty_around(&self, center: Vec3, radius: f32) -> bool {
        match self {
            Self::Plume(plume) => plume.is_empty_around(center, radius),
            Self::Cloud(cloud) => cloud.depth(center) + radius < -Cloud::LUMPS,
        }
    }
}

/// A cone around a line that wanders, covered with lumps that grow with it.
struct Plume {
    layers: Vec<Layer>,
    rolls: Noise,
    swirl: [Noise; 2],
}

/// The plume at the height of one layer of voxels. Unit: m.
#[derive(Clone, Copy)]
struct Layer {
    radius: f32,
    middle: Vec3,
    /// Height in radii: the integral of 1/radius.
    travelled: f32,
    /// Octaves of lumps that are not lost between the voxels.
    octaves: u32,
}

impl Plume {
    /// How far the lumps reach beyond the cone, in parts of its radius.
    const LUMPS: f32 = 0.7;
    /// How far the swirl moves the lumps, in parts of the radius.
    const SWIRL: f32 = 0.45;

    fn new(parameters: &Procedural) -> Self {
        let noise = |salt| Noise::new(parameters.seed, salt);
        let wander = [noise(1), noise(2)];
        let step = 1.0 / parameters.resolution as f32;
        let mut travelled = 0.0;
        let layers = (0..parameters.resolution).map(|layer| {
            let y = (layer as f32 + 0.5) * step;
            let radius = 0.03 + 0.2 * y;
            travelled += step / radius;
            let along = Vec3::new(0.5, 2.4 * y, 0.5);
            let sway = 0.3 * y * (1.0 - 0.5 * y);
            let x = sway * wander[0].at(along) + 0.06 * y * y;
            let middle = Vec3::new(x, y, sway * wander[1].at(along));
            // The finest lumps span about three voxels.
            let mut octaves = 1;
            while octaves < parameters.octaves && (2 << octaves) as f32 * step < radius {
                octaves += 1;
            }
            Layer {
                radius,
                middle,
                travelled,
                octaves,
            }
        });
        Self {
            layers: layers.collect(),
            rolls: noise(5),
            swirl: [noise(3), noise(4)],
        }
    }

    fn layer(&self, y: f32) -> Layer {
        let count = self.layers.len();
        self.layers[((y.max(0.0) * count as f32) as usize).min(count - 1)]
    }

    fn is_empty_around(&self, center: Vec3, radius: f32) -> bool {
        let sideways = |y: f32| {
            let layer = self.layer(y);
            let away = (center - layer.middle) * Vec3::new(1.0, 0.0, 1.0);
            away.length() - layer.radius * (1.0 + Self::LUMPS + Self::SWIRL)
        };
        // The edge moves sideways less than it rises, so the three heights stand for all.
        let heights = [-radius, 0.0, radius].map(|step| sideways(center.y + step));
        heights.into_iter().fold(f32::MAX, f32::min) > 1.5 * radius
    }

    fn at(&self, p: Vec3) -> f32 {
        let y = p.y;
        let layer = self.layer(y);
        let away = (p - layer.middle) / layer.radius;
        let mut around = Vec3::new(away.x, 1.3 * layer.travelled, away.z);
        let far = Vec2::new(away.x, away.z).length();
        if far > 1.0 + Self::LUMPS + Self::SWIRL {
            return 0.0;
        }
        let [swirl_x, swirl_z] = self.swirl.map(|noise| noise.at(0.9 * around));
        around += Self::SWIRL * Vec3::new(swirl_x, 0.0, swirl_z);
        let inside = 1.0 - Vec2::new(around.x, around.z).length();
        if inside < -Self::LUMPS {
            return 0.0;
        }
        let lumps = self.rolls.billow(1.15 * around, layer.octaves);
        let torn = inside + Self::LUMPS * (4.0 * lumps - 1.0).clamp(-0.6, 1.0);
        let spread = 1.0 / (1.0 + 2.5 * y);
        let ends = smoothstep(0.0, 0.02, y) * (1.0 - smoothstep(0.7, 0.96, y + 0.2 * lumps));
        let sides = 1.0 - smoothstep(0.27, 0.325, p.x.abs().max(p.z.abs()));
        smoothstep(0.0, 0.5, torn) * spread * ends * sides
    }
}

/// Balls heaped on a flat base, covered with lumps.
struct Cloud {
    /// Centre and radius.
    balls: Vec<(Vec3, f32)>,
    lumps: Noise,
    base: Noise,
    octaves: u32,
}

impl Cloud {
    /// Height of the base above the lower face.
    const BASE: f32 = 0.05;
    /// Height of the lumps.
    const LUMPS: f32 = 0.06;
    /// Depth over which the edge gets dense.
    const EDGE: f32 = 0.03;

    fn new(parameters: &Procedural) -> Self {
        let noise = Noise::new(parameters.seed, 7);
        let mut balls = Vec::new();
        for i in 0..30_u32 {
            let random = |k: u32| noise.random(i * 8 + k);
            let (u, v) = (2.0 * random(0) - 1.0, 2.0 * random(1) - 1.0);
            let long = Vec2::new(u, v).length();
            let (u, v) = (u / long.max(1.0), v / long.max(1.0));
            let room = 1.0 - long.min(1.0) * long.min(1.0);
            let radius = 0.07 + 0.05 * random(2) + 0.025 * room;
            let reach = 0.48 - Self::LUMPS - radius;
            let y = Self::BASE + 0.5 * radius + 0.25 * room * random(3);
            balls.push((Vec3::new(reach * u, y, 0.85 * reach * v), radius));
        }
        Self {
            balls,
            lumps: Noise::new(parameters.seed, 8),
            base: Noise::new(parameters.seed, 9),
            octaves: parameters.octaves,
        }
    }

    /// Depth below the surface of the balls; negative outside.
    fn depth(&self, p: Vec3) -> f32 {
        let depths = self
            .balls
            .iter()
            .map(|(center, radius)| radius - (p - *center).length());
        depths.fold(-1.0, f32::max)
    }

    fn at(&self, p: Vec3) -> f32 {
        let depth = self.depth(p);
        if depth < -Self::LUMPS {
            return 0.0;
        }
        let lumps = self.lumps.billow(p * 8.0, self.octaves);
        let depth = depth + Self::LUMPS * (4.0 * lumps - 1.0).clamp(-0.8, 1.0);
        let ragged = 0.012 * self.base.fractal(p * 14.0, 2);
        let base = smoothstep(Self::BASE - 0.015, Self::BASE + 0.03, p.y + ragged);
        smoothstep(0.0, Self::EDGE, depth) * (0.7 + 0.3 * smoothstep(0.0, 0.12, depth)) * base
    }
}

#[cfg(test)]
mod tests;
