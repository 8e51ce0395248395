//! Pairs of random numbers: every prefix of a sequence is spread like a net, and sequences of
//! different pixels, dimensions and halves know nothing of one another.

use tyndall_tests::chi_squared::{assert_uniform, bin};
use tyndall_tests::gpu;

use super::DEVICE;

/// Two consecutive pairs for each (pixel, sample, dimension).
fn pairs(inputs: &[[u32; 4]]) -> Vec<[f64; 4]> {
    let buffers = [("inputs", bytemuck::cast_slice(inputs))];
    gpu::probe_vec4(&DEVICE, "probe_sobol", 0, &buffers, inputs.len())
        .into_iter()
        .map(|found| found.map(f64::from))
        .collect()
}

#[test]
fn every_prefix_of_a_half_is_a_net() {
    // Of 2^k samples of one half, each elementary interval of area 2^−k gets one: no chance in it.
    for (pixel, dimension) in [([0, 0], 0), ([3, 5], 1), ([1000, 7], 20), ([17, 4000], 333)] {
        for half in 0..2 {
            let k = 10_u32;
            let inputs: Vec<_> = (0..1 << k)
                .map(|i| [pixel[0], pixel[1], 2 * i + half, dimension])
                .collect();
            let found = pairs(&inputs);
            for length in 0..=k {
                for columns in 0..=length {
                    let mut seen = vec![false; 1 << length];
                    for point in &found[..1 << length] {
                        let x = bin(point[0], 1 << columns);
                        let y = bin(point[1], 1 << (length - columns));
                        let place = &mut seen[(x << (length - columns)) + y];
                        assert!(
                            !*place,
                            "pixel {pixel:?} half {half}: two of {} in one",
                            1 << length
                        );
                        *place = true;
                    }
                }
            }
        }
    }
}

/// Joint counts of two coordinates in 16 × 16 bins.
fn joint(points: impl Iterator<Item = (f64, f64)>) -> Vec<u32> {
    let mut counts = vec![0; 256];
    for (x, y) in points {
        counts[16 * bin(x, 16) + bin(y, 16)] += 1;
    }
    counts
}

#[test]
fn pixels_are_independent_and_uniform() {
    let size = 256;
    for (sample, dimension) in [(0, 0), (1, 0), (2, 1), (5, 9), (1000, 2)] {
        let inputs: Vec<_> = (0..size * size)
            .map(|i| [i % size, i / size, sample, dimension])
            .collect();
        let found = pairs(&inputs);
        let name = format!("sample {sample} dimension {dimension}");
        assert_uniform(
            &format!("{name}, pair"),
            &joint(found.iter().map(|p| (p[0], p[1]))),
        );
        assert_uniform(
            &format!("{name}, next pair x"),
            &joint(found.iter().map(|p| (p[0], p[2]))),
        );
        assert_uniform(
            &format!("{name}, next pair y"),
            &joint(found.iter().map(|p| (p[1], p[3]))),
        );
        // Every other pixel with its right neighbour: no number is counted twice.
        let beside = found.as_chunks::<2>().0.iter().map(|[a, b]| (a[0], b[0]));
        assert_uniform(&format!("{name}, neighbours"), &joint(beside));
        // And rows with the next.
        let rows = found.chunks_exact(2 * size as usize).flat_map(|two| {
            let (upper, lower) = two.split_at(size as usize);
            upper.iter().zip(lower).map(|(a, b)| (a[1], b[1]))
        });
        assert_uniform(&format!("{name}, rows"), &joint(rows));
    }
}

#[test]
fn dimensions_and_halves_of_a_pixel_are_decorrelated() {
    // Well-spread samples scatter less than chance: only too large a sum is a fault. 64 pixels make
    // up for what one scramble can do to a joint count.
    let samples = 1024;
    let inputs: Vec<_> = (0..64 * samples)
        .map(|i| [i / samples * 13, 77, i % samples, 4])
        .collect();
    let found = pairs(&inputs);
    assert_uniform("dimensions x", &joint(found.iter().map(|p| (p[0], p[2]))));
    assert_uniform("dimensions xy", &joint(found.iter().map(|p| (p[0], p[3]))));
    assert_uniform("dimensions y", &joint(found.iter().map(|p| (p[1], p[3]))));
    let halves = found
        .as_chunks::<2>()
        .0
        .iter()
        .map(|[even, odd]| (even[0], odd[0]));
    assert_uniform("halves x", &joint(halves));
    let halves = found
        .as_chunks::<2>()
        .0
        .iter()
        .map(|[even, odd]| (even[1], odd[1]));
    assert_uniform("halves y", &joint(halves));
    // The scatter of a pixel's own joint counts, of 4 × 4 bins: about that of chance or below it.
    let mut above = 0;
    for pixel in found.chunks_exact(samples as usize) {
        let mut own = [0_u32; 16];
        for p in pixel {
            own[4 * bin(p[0], 4) + bin(p[2], 4)] += 1;
        }
        let expected = f64::from(samples) / 16.0;
        let sum: f64 = own
            .iter()
            .map(|c| (f64::from(*c) - expected).powi(2) / expected)
            .sum();
        assert!(sum < 75.0, "chi squared {sum} of 15 degrees within a pixel");
        above += u32::from(sum > 25.0);
    }
    // P(χ²₁₅ > 25) = 0.05: of 64 pixels 3.2, above 14 once in 1e6 trials.
    assert!(above <= 14, "{above} pixels with correlated dimensions");
}
