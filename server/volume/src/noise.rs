//! Gradient noise from integer hashes: additions and products only, so that every machine makes
//! the same bits.

use glam::{IVec3, Vec3};

/// One of many noises: equal seeds, equal values.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Noise(u32);

impl Noise {
    pub(crate) fn new(seed: u64, salt: u32) -> Self {
        let folded = (seed ^ (seed >> 32)) as u32;
        Self(mix(folded ^ salt.wrapping_mul(0x9e37_79b9)))
    }

    /// Gradient noise with unit lattice: mean 0, within [−1, 1], continuous second derivative.
    pub(crate) fn at(self, p: Vec3) -> f32 {
        let base = p.floor();
        let f = p - base;
        let base = base.as_ivec3();
        let fade = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
        let corner = |x: i32, y: i32, z: i32| {
            let offset = IVec3::new(x, y, z);
            gradient(self.hash(base + offset), f - offset.as_vec3())
        };
        let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
        let row = |y, z| mix(corner(0, y, z), corner(1, y, z), fade.x);
        let plane = |z| mix(row(0, z), row(1, z), fade.y);
        mix(plane(0), plane(1), fade.z)
    }

    /// Sum of octaves, each of twice the frequency and half the height. Within [−1, 1].
    pub(crate) fn fractal(self, p: Vec3, octaves: u32) -> f32 {
        self.octaves(p, octaves, |value| value)
    }

    /// [`Noise::fractal`] of magnitudes: round lumps between creases. Within [0, 1].
    pub(crate) fn billow(self, p: Vec3, octaves: u32) -> f32 {
        self.octaves(p, octaves, f32::abs)
    }

    /// A number in [0, 1) for a counter.
    pub(crate) fn random(self, counter: u32) -> f32 {
        (mix(self.0 ^ counter.wrapping_mul(0x85eb_ca6b)) >> 8) as f32 / 16_777_216.0
    }

    fn octaves(self, p: Vec3, octaves: u32, shape: impl Fn(f32) -> f32) -> f32 {
        let (mut sum, mut total, mut height, mut p) = (0.0, 0.0, 1.0, p);
        for octave in 0..octaves {
            sum += height * shape(Self(self.0.wrapping_add(octave)).at(p));
            total += height;
            height *= 0.5;
            // Turned, too (3-4-5 triangles), so that no direction of the lattice stands out.
            p = 2.0 * Vec3::new(0.6 * p.x + 0.8 * p.z, p.y + 17.3, 0.6 * p.z - 0.8 * p.x);
            p = Vec3::new(0.8 * p.x - 0.6 * p.y, 0.6 * p.x + 0.8 * p.y, p.z);
        }
        sum / total
    }

    fn hash(self, p: IVec3) -> u32 {
        let x = (p.x as u32).wrapping_mul(0x8da6_b343);
        let y = (p.y as u32).wrapping_mul(0xd816_3841);
        let z = (p.z as u32).wrapping_mul(0xcb1a_b31f);
        mix(x ^ y ^ z ^ self.0)
    }
}

/// Spreads every bit over all others.
fn mix(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7feb_352d);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

/// Product of an offset and one of the twelve directions to the edges of a cube.
fn gradient(hash: u32, d: Vec3) -> f32 {
    let (a, b) = match hash >> 4 & 3 {
        0 => (d.x, d.y),
        1 => (d.y, d.z),
        _ => (d.x, d.z),
    };
    let signed = |value: f32, bit: u32| if hash & bit == 0 { value } else { -value };
    signed(a, 1) + signed(b, 2)
}

/// 0 below `low`, 1 above `high`, smooth between.
pub(crate) fn smoothstep(low: f32, high: f32, value: f32) -> f32 {
    let t = ((value - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
