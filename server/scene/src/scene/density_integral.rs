//! The density that a straight segment crosses, in closed form: for planning on the CPU, and what the device's
//! `shaders/wesl/medium/optical_depth.wesl` is measured by.
//!
//! Source: Quílez 2010 and 2015 for fog and spheres, Iser 2018 for fog in any direction, in the forms of
//! `em1(x) = (1 − e^−x)/x` that divide by no cosine.

use glam::DVec3;

use super::media::MediumShape;
use super::space::Aabb;

/// The exponent of a density grows no further, so that integrals stay finite far below a fog.
const LARGEST_EXPONENT: f64 = 80.0;

impl MediumShape {
    /// ∫ relative density from `origin` over `length` along the unit vector `direction`. Unit: m. `None` of a
    /// grid, whose density has no closed form.
    ///
    /// Relative error below 1e−12 for every direction and falloff ≥ 0; densities above e⁸⁰ count as e⁸⁰.
    pub fn density_integral(&self, origin: DVec3, direction: DVec3, length: f64) -> Option<f64> {
        match self {
            Self::Homogeneous { bounds } => {
                let [near, far] = inside(bounds.as_ref(), origin, direction, length);
                Some((far - near).max(0.0))
            }
            Self::HeightFog {
                up,
                falloff,
                origin: base,
                bounds,
            } => {
                let [near, far] = inside(bounds.as_ref(), origin, direction, length);
                let crossed = far - near;
                if crossed <= 0.0 {
                    return Some(0.0);
                }
                let (up, falloff) = (up.as_dvec3(), f64::from(*falloff));
                let climb = direction.dot(up);
                let start = (origin - *base).dot(up) + climb * near;
                let lowest = start.min(start + climb * crossed);
                let exponent = (-falloff * lowest).min(LARGEST_EXPONENT);
                Some(exponent.exp() * crossed * em1(falloff * climb.abs() * crossed))
            }
            Self::Sphere { center, radius } => {
                Some(sphere(origin - *center, direction, *radius, length))
            }
            Self::Grid { .. } => None,
        }
    }
}

/// ∫(1 − r²/R²) inside a sphere, about the closest approach: with the middle m and half the length d of the part
/// inside, and half the chord c, it is 2d(c² − m² − d²/3)/R².
fn sphere(offset: DVec3, direction: DVec3, radius: f64, length: f64) -> f64 {
    let closest = -offset.dot(direction);
    let chord_squared = radius * radius - offset.cross(direction).length_squared();
    if chord_squared <= 0.0 {
        return 0.0;
    }
    let chord = chord_squared.sqrt();
    let (near, far) = ((closest - chord).max(0.0), (closest + chord).min(length));
    if far <= near {
        return 0.0;
    }
    let (half, middle) = (0.5 * (far - near), 0.5 * (far + near) - closest);
    let bracket = (chord - middle) * (chord + middle) - half * half / 3.0;
    (2.0 * half * bracket / (radius * radius)).max(0.0)
}

/// The part of [0, `length`] inside `bounds`, or all of it; far < near where there is none.
fn inside(bounds: Option<&Aabb>, origin: DVec3, direction: DVec3, length: f64) -> [f64; 2] {
    let (mut near, mut far) = (0.0_f64, length);
    let Some(bounds) = bounds else {
        return [near, far];
    };
    for axis in 0..3 {
        let (low, high) = (
            bounds.min[axis] - origin[axis],
            bounds.max[axis] - origin[axis],
        );
        let slope = direction[axis];
        if slope == 0.0 {
            if low > 0.0 || high < 0.0 {
                return [0.0, -1.0];
            }
            continue;
        }
        let (a, b) = (low / slope, high / slope);
        near = near.max(a.min(b));
        far = far.min(a.max(b));
    }
    [near, far]
}

/// `(1 − e^−x)/x` for x ≥ 0.
fn em1(x: f64) -> f64 {
    if x < 1e-8 {
        1.0 - 0.5 * x
    } else {
        -(-x).exp_m1() / x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gauss–Legendre of 5 points on each of so many equal parts, which the density is smooth on.
    fn quadrature(density: impl Fn(f64) -> f64, near: f64, far: f64, parts: u32) -> f64 {
        const NODES: [[f64; 2]; 3] = [
            [0.0, 0.568_888_888_888_888_9],
            [0.538_469_310_105_683_1, 0.478_628_670_499_366_5],
            [0.906_179_845_938_664, 0.236_926_885_056_189_1],
        ];
        let half = 0.5 * (far - near) / f64::from(parts);
        (0..parts)
            .map(|part| {
                let middle = near + half * (2.0 * f64::from(part) + 1.0);
                let [centre, others @ ..] = NODES;
                let pairs = others
                    .map(|[x, w]| w * (density(middle - x * half) + density(middle + x * half)));
                half * (centre[1] * density(middle) + pairs.iter().sum::<f64>())
            })
            .sum()
    }

    fn fog(up: DVec3, falloff: f32, base: DVec3) -> MediumShape {
        MediumShape::HeightFog {
            up: up.as_vec3(),
            falloff,
            origin: base,
            bounds: None,
        }
    }

    #[test]
    fn fog_matches_quadrature_in_every_direction_at_every_height_and_falloff() {
        let up = glam::Vec3::new(0.6, 0.8, 0.0);
        let across = DVec3::new(-0.8, 0.6, 0.0);
        for falloff in [0.0_f32, 1e-9, 1e-3, 0.3, 1.0, 30.0, 1e3] {
            for tilt in [0.0, 1e-12, 1e-7, 1e-3, 0.4, 1.0, -1e-7, -0.4, -1.0] {
                for height in [-2.0, 0.0, 0.5, 40.0] {
                    let direction = (across * f64::sqrt(1.0 - tilt * tilt) + up.as_dvec3() * tilt)
                        .normalize_or_zero();
                    let origin = up.as_dvec3() * height / f64::from(falloff.max(1.0));
                    let length = 7.0 / f64::from(falloff.max(1.0)).sqrt();
                    let shape = fog(up.as_dvec3(), falloff, DVec3::ZERO);
                    let found = shape.density_integral(origin, direction, length).unwrap();
                    let density = |t: f64| {
                        let height = (origin + direction * t).dot(up.as_dvec3());
                        (-f64::from(falloff) * height).min(LARGEST_EXPONENT).exp()
                    };
                    let expected = quadrature(density, 0.0, length, 4000);
                    let steepest = f64::from(falloff) * tilt.abs() * length;
                    let overflows = -f64::from(falloff)
                        * (origin + direction * length).dot(up.as_dvec3())
                        > LARGEST_EXPONENT;
                    if !overflows && steepest < 300.0 {
                        assert!(
                            (found - expected).abs() <= 1e-9 * expected,
                            "falloff {falloff}, tilt {tilt}, height {height}: {found} for {expected}"
                        );
                    }
                    assert!(found.is_finite() && found >= 0.0);
                }
            }
        }
    }

    #[test]
    fn fog_seen_from_the_other_end_or_turned_over_is_the_same() {
        let (a, b) = (DVec3::new(1.0, 2.0, -0.5), DVec3::new(-3.0, 0.1, 4.0));
        let length = (b - a).length();
        let direction = (b - a) / length;
        let base = DVec3::new(0.2, -0.3, 0.7);
        let shape = fog(DVec3::Y, 0.8, base);
        let forth = shape.density_integral(a, direction, length).unwrap();
        let back = shape.density_integral(b, -direction, length).unwrap();
        assert!((forth - back).abs() <= 1e-13 * forth);
        let mirrored = |p: DVec3| DVec3::new(p.x, -p.y, p.z);
        let turned = fog(DVec3::NEG_Y, 0.8, mirrored(base))
            .density_integral(mirrored(a), mirrored(direction), length)
            .unwrap();
        assert!((forth - turned).abs() <= 1e-12 * forth);
    }

    #[test]
    fn a_sphere_matches_quadrature_from_outside_and_inside() {
        let shape = MediumShape::Sphere {
            center: DVec3::new(1e3, -2.0, 0.5),
            radius: 2.5,
        };
        for (offset, direction, length) in [
            (DVec3::new(-9.0, 0.0, 0.0), DVec3::X, 30.0),
            (DVec3::new(-9.0, 2.4, 0.0), DVec3::X, 30.0),
            (DVec3::new(0.3, 0.2, -0.4), DVec3::new(0.48, 0.6, 0.64), 1.0),
            (
                DVec3::new(0.3, 0.2, -0.4),
                DVec3::new(0.48, 0.6, 0.64),
                50.0,
            ),
            (DVec3::new(-9.0, 2.6, 0.0), DVec3::X, 30.0),
        ] {
            let origin = DVec3::new(1e3, -2.0, 0.5) + offset;
            let found = shape.density_integral(origin, direction, length).unwrap();
            let density =
                |t: f64| (1.0 - (offset + direction * t).length_squared() / 6.25).max(0.0);
            let expected = quadrature(density, 0.0, length, 200_000);
            assert!(
                (found - expected).abs() <= 1e-7 * expected.max(1e-9),
                "{found} for {expected}"
            );
        }
    }

    #[test]
    fn a_box_clips_what_lies_in_it() {
        let bounds = Some(Aabb {
            min: DVec3::new(-1.0, 0.0, -1.0),
            max: DVec3::new(1.0, 2.0, 1.0),
        });
        let shape = MediumShape::Homogeneous { bounds };
        let along =
            |origin, direction, length| shape.density_integral(origin, direction, length).unwrap();
        assert_eq!(along(DVec3::new(-5.0, 1.0, 0.0), DVec3::X, 100.0), 2.0);
        assert_eq!(along(DVec3::new(-5.0, 1.0, 0.0), DVec3::X, 4.5), 0.5);
        assert_eq!(along(DVec3::new(-5.0, 3.0, 0.0), DVec3::X, 100.0), 0.0);
        assert_eq!(along(DVec3::new(0.0, 1.0, 0.0), DVec3::X, 0.0), 0.0);
    }
}
