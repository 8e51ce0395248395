//! The mixture of visible GGX normals and cosine.

use std::f64::consts::PI;

use glam::DVec3;
use tyndall_tests::chi_squared::{assert_fits, bin};

use super::{AXIS, COUNT, Which, assert_density, direction, sample, turn, with};

const RINGS: usize = 16;
const SECTORS: usize = 24;

/// A surface of equal channels, in f64 and in textbook form.
struct Oracle {
    diffuse: f64,
    alpha: f64,
    f0: f64,
    viewer: DVec3,
}

impl Oracle {
    fn schlick(&self, cosine: f64) -> f64 {
        self.f0 + (1.0 - self.f0) * (1.0 - cosine).powi(5)
    }

    fn glossy_share(&self) -> f64 {
        let glossy = self.schlick(self.viewer.z);
        (glossy / (glossy + self.diffuse)).clamp(0.1, 1.0)
    }

    /// Smith's Λ (Heitz 2014).
    fn lambda(&self, cosine: f64) -> f64 {
        let tan2 = 1.0 / (cosine * cosine) - 1.0;
        0.5 * ((1.0 + self.alpha * self.alpha * tan2).sqrt() - 1.0)
    }

    fn normals(&self, cosine: f64) -> f64 {
        let tan2 = 1.0 / (cosine * cosine) - 1.0;
        let a2 = self.alpha * self.alpha;
        1.0 / (PI * a2 * cosine.powi(4) * (1.0 + tan2 / a2).powi(2))
    }

    /// BSDF · cosine and density of leaving along `light`, about z.
    fn evaluate(&self, light: DVec3) -> (f64, f64) {
        let half = (self.viewer + light).normalize_or_zero();
        let (o, i) = (self.viewer.z, light.z);
        let fresnel = self.schlick(light.dot(half));
        let d = self.normals(half.z);
        let masking = 1.0 / (1.0 + self.lambda(o) + self.lambda(i));
        let value = (1.0 - fresnel) * self.diffuse / PI + fresnel * d * masking / (4.0 * o * i);
        let visible = d / (1.0 + self.lambda(o)) / (4.0 * o);
        let share = self.glossy_share();
        (value * i, share * visible + (1.0 - share) * i / PI)
    }

    /// Integrals of both over each bin of (cosine, azimuth).
    fn integrate(&self) -> Vec<(f64, f64)> {
        let fine = 24;
        let (dz, dt) = (1.0 / (RINGS * fine) as f64, 1.0 / (SECTORS * fine) as f64);
        let mut bins = vec![(0.0, 0.0); RINGS * SECTORS];
        for i in 0..RINGS * fine {
            let z = (i as f64 + 0.5) * dz;
            let sine = (1.0 - z * z).sqrt();
            for j in 0..SECTORS * fine {
                let angle = 2.0 * PI * (j as f64 + 0.5) * dt;
                let light = DVec3::new(sine * angle.cos(), sine * angle.sin(), z);
                let (value, density) = self.evaluate(light);
                let bin = &mut bins[i / fine * SECTORS + j / fine];
                bin.0 += value * 2.0 * PI * dz * dt;
                bin.1 += density * 2.0 * PI * dz * dt;
            }
        }
        bins
    }
}

#[test]
fn reflected_directions_follow_their_density_and_carry_the_right_weight() {
    // Diffuse reflectance, width of the lobe, reflectance at normal incidence, angle of view.
    let cases = [
        (0.8, 1.0, 0.04, 10.0_f64),
        (0.4, 0.5, 0.04, 40.0),
        (0.0, 0.25, 0.9, 70.0),
        (0.2, 0.1, 0.3, 60.0),
        (0.5, 0.6, 0.04, 88.0),
        (0.0, 0.05, 1.0, 30.0),
    ];
    let n = AXIS.as_dvec3();
    let (x, y) = (
        n.any_orthonormal_vector(),
        n.cross(n.any_orthonormal_vector()),
    );
    for (seed, (diffuse, alpha, f0, angle)) in cases.into_iter().enumerate() {
        let angle = angle.to_radians();
        let oracle = Oracle {
            diffuse,
            alpha,
            f0,
            viewer: DVec3::new(angle.sin(), 0.0, angle.cos()),
        };
        let viewer = (n * angle.cos() + x * angle.sin()).as_vec3();
        let parameters = [
            with(AXIS, 0.0),
            with(viewer, 0.0),
            [diffuse as f32, alpha as f32, f0 as f32, 0.0],
        ];
        let name = format!("bsdf diffuse {diffuse} alpha {alpha} f0 {f0} angle {angle:.2}");
        // The last bin takes what leaves below the surface: it is sampled, and reflects nothing.
        let mut counts = vec![0; RINGS * SECTORS + 1];
        let (mut sum, mut squares) = (0.0, 0.0);
        for [first, second] in sample(Which::Bsdf, 60 + seed as u32, parameters) {
            if first[3] <= 0.0 {
                counts[RINGS * SECTORS] += 1;
                continue;
            }
            let v = direction(first);
            let local = DVec3::new(v.dot(x), v.dot(y), v.dot(n));
            assert!(local.z > 0.0, "{name}: below the surface");
            let (value, density) = oracle.evaluate(local);
            // Grazing directions lose digits of their cosine, narrow lobes of the half vector's.
            if local.z > 1e-3 {
                let digits = 2e-3 + 2e-5 / (alpha * alpha);
                assert_density(&name, first[3], density, digits);
                assert_density(&name, second[1], value, digits);
            }
            assert_density(&name, second[2], f64::from(first[3]), 1e-6);
            let weight = f64::from(second[0]);
            assert!(
                (weight * f64::from(first[3]) - f64::from(second[1])).abs()
                    <= 1e-5 * weight * f64::from(first[3])
            );
            sum += weight;
            squares += weight * weight;
            counts[bin(local.z, RINGS) * SECTORS + bin(turn(n, v), SECTORS)] += 1;
        }
        let integrals = oracle.integrate();
        let total: f64 = integrals.iter().map(|b| b.1).sum();
        assert!(total <= 1.0 + 1e-3, "{name}: density integrates to {total}");
        let all = COUNT as f64;
        let mut expected: Vec<f64> = integrals.iter().map(|b| b.1 * all).collect();
        expected.push((1.0 - total).max(0.0) * all);
        assert_fits(&name, &counts, &expected);
        let reflected: f64 = integrals.iter().map(|b| b.0).sum();
        let mean = sum / all;
        let error = ((squares / all - mean * mean) / all).sqrt();
        println!("{name}: reflects {mean:.5} ± {error:.1e} for {reflected:.5}");
        assert!(
            reflected <= 1.0 + 1e-3 && (mean - reflected).abs() < 4.0 * error + 1e-3 * reflected
        );
    }
}
