//! Radiance from infinity: equirectangular maps, and how to choose directions where they are bright.
//!
//! Map coordinates: u in [0, 1) runs from left to right, v in [0, 1] from the top; pixel (x, y)
//! covers u from x/width and v from y/height. With φ = 2π(u − ½) and θ = πv the direction is
//! (sin θ sin φ, cos θ, −sin θ cos φ): the top is +Y, the centre −Z, right of it +X.

use std::f64::consts::{PI, TAU};
use std::fmt;
use std::sync::Arc;

use glam::DVec3;

/// Radiance from infinity.
#[derive(Debug, Clone, PartialEq)]
pub struct Environment {
    /// Multiplies the map, or is the radiance itself. Unit: W·m⁻²·sr⁻¹.
    pub radiance: [f32; 3],
    /// Equirectangular map, if any.
    pub map: Option<EnvironmentMap>,
    /// Rotation of the map about +Y: a direction of the world is this rotation times a direction of
    /// the map, so a positive angle turns −Z toward −X. Unit: radian.
    pub rotation: f32,
}

/// Equirectangular radiance map; row 0 looks up (+Y), the centre column looks along −Z, and the
/// columns right of it toward +X.
#[derive(Clone)]
pub struct EnvironmentMap {
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// Linear RGB, `width · height` entries, finite and ≥ 0.
    pub pixels: Arc<Vec<[f32; 3]>>,
}

/// Without the pixels.
impl fmt::Debug for EnvironmentMap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "EnvironmentMap({} × {})", self.width, self.height)
    }
}

/// Equality is identity, as for [`crate::SharedGeometry`].
impl PartialEq for EnvironmentMap {
    fn eq(&self, other: &Self) -> bool {
        (self.width, self.height) == (other.width, other.height)
            && Arc::ptr_eq(&self.pixels, &other.pixels)
    }
}

impl EnvironmentMap {
    /// The unit direction, before the environment's rotation, at map coordinates.
    pub fn direction(u: f64, v: f64) -> DVec3 {
        let (sin_phi, cos_phi) = (TAU * (u - 0.5)).sin_cos();
        let (sin_theta, cos_theta) = (PI * v).sin_cos();
        DVec3::new(sin_theta * sin_phi, cos_theta, -sin_theta * cos_phi)
    }

    /// Map coordinates of a direction, which need not be unit; u in [0, 1), v in [0, 1].
    pub fn coordinates(direction: DVec3) -> [f64; 2] {
        let DVec3 { x, y, z } = direction;
        let u = 0.5 + x.atan2(-z) / TAU;
        let v = DVec3::new(x, 0.0, z).length().atan2(y) / PI;
        [if u < 1.0 { u } else { 0.0 }, v]
    }

    /// Solid angle of a pixel in a row. Unit: sr.
    pub fn solid_angle(&self, row: u32) -> f64 {
        let [top, bottom] = self.edges(row);
        TAU / f64::from(self.width) * (top - bottom)
    }

    /// Cosines from +Y at the upper and lower edge of a row.
    fn edges(&self, row: u32) -> [f64; 2] {
        let cosine = |row: u32| (PI * f64::from(row) / f64::from(self.height)).cos();
        [cosine(row), cosine(row + 1)]
    }

    fn luminance(&self, x: u32, y: u32) -> f64 {
        let [r, g, b] = self.pixels[(x + self.width * y) as usize].map(f64::from);
        0.2126 * r + 0.7152 * g + 0.0722 * b
    }
}

/// Chooses directions with a density in proportion to the map's luminance.
///
/// An alias table over the pixels. A pixel's weight is the mean luminance of the bilinear
/// interpolation over it (weights ⅛, ¾, ⅛ along each axis; columns wrap, rows end) times its solid
/// angle, so the density is positive wherever the interpolated map is, and within a pixel it is
/// uniform over solid angle. Directions are those of the map, before the environment's rotation.
#[derive(Debug, Clone, PartialEq)]
pub struct EnvironmentDistribution {
    /// Pixels of the map.
    pub width: u32,
    /// Pixels of the map.
    pub height: u32,
    /// Entry i is kept if a uniform number is below this, else `alias[i]` is taken. Range: [0, 1].
    pub threshold: Vec<f32>,
    /// The other pixel of each entry.
    pub alias: Vec<u32>,
    /// Density over solid angle in each pixel. Unit: sr⁻¹.
    pub pdf: Vec<f32>,
    /// Luminance integrated over all directions; 0 if the map is black. Unit: of the map, times sr.
    pub total: f64,
}

/// A chosen direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnvironmentSample {
    /// Unit direction toward the environment, before its rotation.
    pub direction: DVec3,
    /// Pixel that holds it: x + width · y.
    pub pixel: u32,
    /// Density over solid angle. Unit: sr⁻¹.
    pub pdf: f32,
}

impl EnvironmentDistribution {
    /// The distribution of a map. Cost: two passes over its pixels, 20 bytes a pixel.
    pub fn new(map: &EnvironmentMap) -> Self {
        let (width, height) = (map.width, map.height);
        let mut weights = vec![0.0; map.pixels.len()];
        for (row, weights) in (0..height).zip(weights.chunks_exact_mut(width as usize)) {
            let solid_angle = map.solid_angle(row);
            let rows = [row.saturating_sub(1), row, (row + 1).min(height - 1)];
            let column = |x: u32| {
                let [above, here, below] = rows.map(|y| map.luminance(x, y));
                0.125 * (above + below) + 0.75 * here
            };
            let (first, last) = (column(0), column(width - 1));
            let (mut left, mut here) = (last, first);
            for (x, weight) in (0..width).zip(weights) {
                let right = if x + 1 < width { column(x + 1) } else { first };
                *weight = (0.125 * (left + right) + 0.75 * here) * solid_angle;
                (left, here) = (here, right);
            }
        }
        let total: f64 = weights.iter().sum();
        let count = weights.len();
        let (threshold, alias) = alias_table(&weights, total);
        // The density of what the rounded table really gives.
        let mut share = vec![0.0_f64; count];
        for (i, (threshold, alias)) in threshold.iter().zip(&alias).enumerate() {
            share[i] += f64::from(*threshold);
            share[*alias as usize] += 1.0 - f64::from(*threshold);
        }
        let mut pdf = Vec::with_capacity(count);
        for (row, share) in (0..height).zip(share.chunks_exact(width as usize)) {
            let density = 1.0 / (count as f64 * map.solid_angle(row));
            pdf.extend(share.iter().map(|share| (share * density) as f32));
        }
        if total == 0.0 {
            pdf.fill(0.0);
        }
        Self {
            width,
            height,
            threshold,
            alias,
            pdf,
            total,
        }
    }

    /// The direction that three uniform numbers in [0, 1) choose; `None` if the map is black.
    pub fn sample(&self, [choice, across, down]: [f64; 3]) -> Option<EnvironmentSample> {
        if self.total == 0.0 {
            return None;
        }
        let scaled = choice * self.alias.len() as f64;
        let entry = (scaled as usize).min(self.alias.len() - 1);
        let pixel = if scaled - (entry as f64) < f64::from(self.threshold[entry]) {
            entry as u32
        } else {
            self.alias[entry]
        };
        let (x, y) = (pixel % self.width, pixel / self.width);
        let edge = |row: u32| (PI * f64::from(row) / f64::from(self.height)).cos();
        let cos_theta = edge(y) + (edge(y + 1) - edge(y)) * down;
        let sin_theta = ((1.0 - cos_theta) * (1.0 + cos_theta)).max(0.0).sqrt();
        let (sin_phi, cos_phi) =
            (TAU * ((f64::from(x) + across) / f64::from(self.width) - 0.5)).sin_cos();
        Some(EnvironmentSample {
            direction: DVec3::new(sin_theta * sin_phi, cos_theta, -sin_theta * cos_phi),
            pixel,
            pdf: self.pdf[pixel as usize],
        })
    }

    /// Density at a direction. Unit: sr⁻¹.
    pub fn pdf(&self, direction: DVec3) -> f32 {
        let [u, v] = EnvironmentMap::coordinates(direction);
        let x = ((u * f64::from(self.width)) as u32).min(self.width - 1);
        let y = ((v * f64::from(self.height)) as u32).min(self.height - 1);
        self.pdf[(x + self.width * y) as usize]
    }
}

/// Vose's alias table: each entry holds a part of its own share and fills up with another's.
fn alias_table(weights: &[f64], total: f64) -> (Vec<f32>, Vec<u32>) {
    let count = weights.len();
    let mut alias: Vec<u32> = (0..count as u32).collect();
    let mut threshold = vec![1.0_f32; count];
    if total <= 0.0 {
        return (threshold, alias);
    }
    let mut share: Vec<f64> = weights.iter().map(|w| w / total * count as f64).collect();
    let (mut poor, mut rich): (Vec<u32>, Vec<u32>) =
        (0..count as u32).partition(|i| share[*i as usize] < 1.0);
    while let (Some(low), Some(high)) = (poor.pop(), rich.pop()) {
        let (low_at, high_at) = (low as usize, high as usize);
        threshold[low_at] = share[low_at] as f32;
        alias[low_at] = high;
        share[high_at] -= 1.0 - share[low_at];
        if share[high_at] < 1.0 {
            poor.push(high);
        } else {
            rich.push(high);
        }
    }
    // What is left in either list is 1 but for rounding; a black pixel is never among it, as its
    // share is exactly 0 and others are paired with it while they last.
    for left in poor {
        if weights[left as usize] == 0.0 {
            threshold[left as usize] = 0.0;
            alias[left as usize] = brightest(weights);
        }
    }
    (threshold, alias)
}

fn brightest(weights: &[f64]) -> u32 {
    let best = weights.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
    best.map_or(0, |(i, _)| i as u32)
}

#[cfg(test)]
mod tests {
    use super::{Arc, DVec3, EnvironmentDistribution, EnvironmentMap, PI};

    fn map(width: u32, height: u32, pixel: impl Fn(u32, u32) -> f32) -> EnvironmentMap {
        let at = |i: u32| [pixel(i % width, i / width); 3];
        EnvironmentMap {
            width,
            height,
            pixels: Arc::new((0..width * height).map(at).collect()),
        }
    }

    fn random(state: &mut u64) -> f64 {
        *state = state
            .wrapping_mul(0x5851_f42d_4c95_7f2d)
            .wrapping_add(0x1405_7b7e_f767_814f);
        (*state >> 33) as f64 / (1_u64 << 31) as f64
    }

    fn integral(map: &EnvironmentMap, distribution: &EnvironmentDistribution) -> f64 {
        let pixels = distribution.pdf.iter().enumerate();
        pixels
            .map(|(i, pdf)| f64::from(*pdf) * map.solid_angle(i as u32 / map.width))
            .sum()
    }

    #[test]
    fn directions_and_coordinates_are_inverse() {
        for (u, v, direction) in [
            (0.5, 0.5, DVec3::NEG_Z),
            (0.75, 0.5, DVec3::X),
            (0.25, 0.5, DVec3::NEG_X),
            (0.0, 0.5, DVec3::Z),
            (0.3, 0.0, DVec3::Y),
            (0.3, 1.0, DVec3::NEG_Y),
        ] {
            assert!((EnvironmentMap::direction(u, v) - direction).length() < 1e-12);
        }
        for i in 0..200 {
            let (u, v) = (f64::from(i) / 200.0, (f64::from(i) * 0.618).fract());
            let [found_u, found_v] =
                EnvironmentMap::coordinates(3.0 * EnvironmentMap::direction(u, v));
            let around = (found_u - u).abs().min(1.0 - (found_u - u).abs());
            assert!(around < 1e-9 && (found_v - v).abs() < 1e-9, "{u} {v}");
        }
    }

    #[test]
    fn solid_angles_add_up_to_the_sphere() {
        let map = map(7, 5, |_, _| 1.0);
        let sum: f64 = (0..5).map(|row| 7.0 * map.solid_angle(row)).sum();
        assert!((sum - 4.0 * PI).abs() < 1e-12);
        let distribution = EnvironmentDistribution::new(&map);
        assert!((distribution.total - 4.0 * PI).abs() < 1e-9);
        for pdf in &distribution.pdf {
            assert!((f64::from(*pdf) * 4.0 * PI - 1.0).abs() < 1e-6, "{pdf}");
        }
    }

    #[test]
    fn densities_integrate_to_one() {
        let spiky = map(64, 32, |x, y| {
            if (x, y) == (40, 9) {
                1e8
            } else {
                (x * y % 7) as f32
            }
        });
        for map in [
            map(1, 1, |_, _| 2.0),
            map(1, 9, |_, y| y as f32),
            map(9, 1, |x, _| x as f32),
            map(128, 64, |x, y| ((x as f32 * 0.1).sin() * y as f32).abs()),
            spiky,
        ] {
            let distribution = EnvironmentDistribution::new(&map);
            let sum = integral(&map, &distribution);
            assert!((sum - 1.0).abs() < 1e-5, "{sum}");
            let mut state = 4;
            for _ in 0..500 {
                let numbers = std::array::from_fn(|_| random(&mut state));
                let sample = distribution.sample(numbers).unwrap();
                assert!(sample.pdf > 0.0);
                assert!((sample.direction.length() - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn samples_follow_the_density() {
        let map = map(16, 8, |x, y| {
            0.2 + ((x as f32 * 0.7).sin() * (y as f32 * 0.5).cos()).abs()
        });
        let distribution = EnvironmentDistribution::new(&map);
        let samples = 400_000_u32;
        let mut counts = vec![0_u32; 128];
        let mut state = 1;
        for _ in 0..samples {
            let numbers = std::array::from_fn(|_| random(&mut state));
            let sample = distribution.sample(numbers).unwrap();
            assert_eq!(distribution.pdf(sample.direction), sample.pdf);
            let [u, v] = EnvironmentMap::coordinates(sample.direction);
            counts[(u * 16.0) as usize + 16 * (v * 8.0) as usize] += 1;
        }
        let chi_squared: f64 = counts
            .iter()
            .enumerate()
            .map(|(i, count)| {
                let share = f64::from(distribution.pdf[i]) * map.solid_angle(i as u32 / 16);
                let expected = share * f64::from(samples);
                (f64::from(*count) - expected).powi(2) / expected
            })
            .sum();
        // 127 degrees of freedom: above 190 with probability 2e-4; the seed is fixed.
        assert!(chi_squared < 190.0, "χ² = {chi_squared}");
    }

    #[test]
    fn weights_are_those_of_the_interpolated_map() {
        let map = map(8, 8, |x, y| (1 + x * 3 + y * y) as f32);
        let distribution = EnvironmentDistribution::new(&map);
        let at = |x: u32, y: u32| f64::from(1 + (x % 8) * 3 + y * y);
        let blur = |x: u32, y: u32| {
            let row = |y| 0.125 * (at(x + 7, y) + at(x + 1, y)) + 0.75 * at(x, y);
            0.125 * (row(y.saturating_sub(1)) + row((y + 1).min(7))) + 0.75 * row(y)
        };
        for (x, y) in [(0, 0), (7, 3), (4, 7), (3, 4)] {
            let found = f64::from(distribution.pdf[(x + 8 * y) as usize]);
            let truth = blur(x, y) / distribution.total;
            assert!((found / truth - 1.0).abs() < 1e-5, "{x} {y}");
        }
    }

    #[test]
    fn a_black_map_gives_no_direction() {
        let distribution = EnvironmentDistribution::new(&map(8, 4, |_, _| 0.0));
        assert_eq!(distribution.total, 0.0);
        assert!(distribution.pdf.iter().all(|pdf| *pdf == 0.0));
        assert_eq!(distribution.sample([0.5; 3]), None);
        assert_eq!(distribution.pdf(DVec3::Y), 0.0);
    }

    #[test]
    fn a_single_bright_pixel_is_found() {
        for (x, y) in [(20, 8), (0, 8), (63, 31), (5, 0)] {
            let map = map(64, 32, |i, j| if (i, j) == (x, y) { 50.0 } else { 0.0 });
            let distribution = EnvironmentDistribution::new(&map);
            assert!((integral(&map, &distribution) - 1.0).abs() < 1e-5);
            let mut state = 3;
            let mut hits = 0;
            for _ in 0..10_000 {
                let numbers = std::array::from_fn(|_| random(&mut state));
                let sample = distribution.sample(numbers).unwrap();
                let (i, j) = (sample.pixel % 64, sample.pixel / 64);
                assert!((i + 65 - x) % 64 <= 2 && j.abs_diff(y) <= 1, "{i} {j}");
                hits += u32::from((i, j) == (x, y));
            }
            // 9/16 where the rows around are like it; at a pole the next row has thrice the angle.
            assert!((5000..8200).contains(&hits), "{hits}");
        }
    }
}
