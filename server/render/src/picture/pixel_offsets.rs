//! Where in its pixel each sample of the running mean lies.
//!
//! All pixels of a frame share the place, so the sequence alone decides how an edge looks at rest: the
//! first two Sobol dimensions, Owen-scrambled by hashing (Burley 2020; the same as
//! `wesl/sampling/sobol.wesl`), shifted so that the first sample is the centre. Each power of two of
//! samples covers every edge better than a lattice does.

/// The best of 3000 for the share of a pixel on one side of an edge, over 2 to 256 samples.
const KEY: u32 = 0x3e7e_db00;

/// In the sequence's own order even samples lie in one half of the pixel and odd ones in the other, and an
/// edge would set them apart. Which of a pair comes first is the parity of these bits: of all masks one of the
/// two with which, of 2^m samples, every elementary interval of m − 2 digits holds as many even ones as odd
/// ones, m = 2 … 10.
const SPREADS_PAIRS: u32 = 0xdb6d_b6da;

/// The order in which even samples alone, and odd ones, spread over the pixel.
pub(crate) fn spread_pairs(index: u32) -> u32 {
    index ^ ((index & SPREADS_PAIRS).count_ones() & 1)
}

/// Position of sample `index` in its pixel, [0, 1)².
pub(crate) fn pixel_offset(index: u32) -> [f32; 2] {
    let first = scrambled(0);
    let own = scrambled(index);
    std::array::from_fn(|axis| {
        let place = (f64::from(own[axis]) - f64::from(first[axis])) / 2.0_f64.powi(32) + 0.5;
        // 24 bits, so that 1 is never reached.
        ((place.rem_euclid(1.0) * 16_777_216.0).floor() / 16_777_216.0) as f32
    })
}

/// Both coordinates, in units of 2⁻³².
fn scrambled(index: u32) -> [u32; 2] {
    [
        owen_hash(index, KEY).reverse_bits(),
        owen_hash(pascal(index), KEY.wrapping_mul(7919)).reverse_bits(),
    ]
}

/// Permutes so that a bit is flipped by the lower bits only: on reversed bits, an Owen scramble.
fn owen_hash(bits: u32, key: u32) -> u32 {
    let mut x = bits;
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(key);
    x = x.wrapping_mul((key >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

/// The second Sobol dimension with its bits reversed.
fn pascal(index: u32) -> u32 {
    let folds = [
        (1, 0x5555_5555),
        (2, 0x3333_3333),
        (4, 0x0f0f_0f0f),
        (8, 0x00ff_00ff),
        (16, 0x0000_ffff),
    ];
    folds
        .into_iter()
        .fold(index, |x, (shift, mask)| x ^ ((x >> shift) & mask))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn even_samples_are_as_many_as_odd_ones_in_every_elementary_interval() {
        for m in 2..=10_u32 {
            for across in 0..=m - 2 {
                let down = m - 2 - across;
                let mut more_even = vec![0_i32; 1 << (m - 2)];
                for sample in 0..1_u32 << m {
                    let own = scrambled(spread_pairs(sample)).map(u64::from);
                    let interval = ((own[0] << across) >> 32 << down) | ((own[1] << down) >> 32);
                    more_even[interval as usize] += if sample % 2 == 0 { 1 } else { -1 };
                }
                assert!(more_even.iter().all(|v| *v == 0), "{m}, {across}");
            }
        }
    }

    #[test]
    fn the_first_sample_is_the_centre() {
        assert_eq!(pixel_offset(0), [0.5, 0.5]);
    }

    /// Root mean square of (share of the samples − share of the pixel) on one side of an edge, over
    /// edges of many directions and places.
    fn edge_error(samples: &[[f32; 2]]) -> f64 {
        let (turns, places, fine) = (60, 40, 40);
        let mut squares = 0.0;
        for i in 0..turns * places {
            let angle = f64::from(i / places) / f64::from(turns) * std::f64::consts::PI;
            let edge = (f64::from(i % places) + 0.5) / f64::from(places) * 1.4 - 0.7;
            let below = |x: f64, y: f64| (x - 0.5) * angle.cos() + (y - 0.5) * angle.sin() < edge;
            let cell = |i: i32| (f64::from(i) + 0.5) / f64::from(fine);
            let inside = (0..fine * fine).filter(|j| below(cell(j / fine), cell(j % fine)));
            let exact = inside.count() as f64 / f64::from(fine * fine);
            let hit = samples
                .iter()
                .filter(|p| below(p[0].into(), p[1].into()))
                .count();
            squares += (hit as f64 / samples.len() as f64 - exact).powi(2);
        }
        (squares / f64::from(turns * places)).sqrt()
    }

    #[test]
    fn edges_are_covered_better_than_by_a_lattice() {
        for n in [4_u32, 16, 64] {
            let ours: Vec<_> = (0..n).map(pixel_offset).collect();
            // The R2 sequence (Roberts 2018).
            let step = |i: u32, a: f64| (0.5 + f64::from(i) * a).fract() as f32;
            let lattice: Vec<_> = (0..n)
                .map(|i| {
                    [
                        step(i, 0.754_877_666_246_693),
                        step(i, 0.569_840_290_998_053_3),
                    ]
                })
                .collect();
            let (error, by_lattice) = (edge_error(&ours), edge_error(&lattice));
            assert!(error < 0.75 * by_lattice, "{n}: {error} for {by_lattice}");
            // A random place in each of n strata of an axis leaves 1/(n·√6) of an edge along the other.
            assert!(error < 2.0 / f64::from(n).powf(0.75) / 6.0_f64.sqrt());
        }
    }
}
