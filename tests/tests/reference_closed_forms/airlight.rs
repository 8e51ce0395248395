//! Light of a point scattered once in a homogeneous medium.

use std::f64::consts::PI;

use glam::DVec3;
use serde_json::json;
use tyndall_tests::estimate::{self, Estimate};

/// `σ_t`, albedo, g, distance along the ray to the light and its distance from the ray, end of the ray.
struct Airlight {
    sigma_t: f64,
    albedo: f64,
    g: f64,
    along: f64,
    across: f64,
    end: f64,
}

impl Airlight {
    /// ∫ over the angle under which the light sees the ray, by Simpson's rule. Unit: W·m⁻²·sr⁻¹ for a
    /// light of 1 W.
    fn radiance(&self) -> f64 {
        let low = (-self.along / self.across).atan();
        let high = ((self.end - self.along) / self.across).atan();
        let n = 4000;
        let step = (high - low) / f64::from(n);
        let sum: f64 = (0..=n)
            .map(|i| {
                let angle = low + step * f64::from(i);
                let depth =
                    self.sigma_t * (self.along + self.across * (0.25 * PI + 0.5 * angle).tan());
                let den = 1.0 + self.g * self.g + 2.0 * self.g * angle.sin();
                let phase = (1.0 - self.g * self.g) / (4.0 * PI * den.powf(1.5));
                let weight = match i {
                    0 => 1.0,
                    _ if i == n => 1.0,
                    _ if i % 2 == 1 => 4.0,
                    _ => 2.0,
                };
                weight * (-depth).exp() * phase
            })
            .sum();
        self.sigma_t * self.albedo / (4.0 * PI * self.across) * sum * step / 3.0
    }
}

const SIZE: u32 = 16;

#[test]
fn airlight_equals_its_closed_form() {
    // algorithms §7.1: (σt, albedo, δ, D, t1, g) and the radiance for a light of 1 W.
    let table = [
        (1.0, 1.0, 2.0, 1.0, 10.0, 0.0, 7.108_784_325_63e-4),
        (1.0, 1.0, 2.0, 1.0, 10.0, 0.9, 2.942_340_85e-4),
        (1.0, 1.0, 2.0, 1.0, 10.0, -0.5, 3.455_585_86e-4),
        (0.1, 1.0, 5.0, 0.5, 20.0, 0.5, 2.868_530_51e-3),
        (1e-6, 1.0, 5.0, 0.5, 20.0, 0.0, 3.810_415_98e-8),
        (10.0, 0.8, 1.0, 0.01, 3.0, 0.0, 5.915_595_63e-4),
        (1.0, 1.0, -1.0, 1.0, 10.0, 0.0, 2.815_300_80e-4),
    ];
    for (sigma_t, albedo, along, across, end, g, tabulated) in table {
        let at = |along, across, end| Airlight {
            sigma_t,
            albedo,
            g,
            along,
            across,
            end,
        };
        let axis = at(along, across, end).radiance();
        assert!(
            (axis / tabulated - 1.0).abs() < 1e-8,
            "{axis:e} for {tabulated:e}"
        );
        let still = estimate::render(&json!({
            "version": 1,
            "camera": { "position": [0, 0, 0], "target": [0, 0, -1], "vertical_fov_degrees": 0.1 },
            "geometry": [{ "kind": "quad", "corner": [-30, -30, -end], "edge_u": [60, 0, 0],
                "edge_v": [0, 60, 0], "material": { "base_color": 0 } }],
            "lights": [{ "kind": "point", "position": [0, across, -along],
                "intensity": 1.0 / (4.0 * PI), "radius": 1e-4 }],
            "media": [{ "kind": "homogeneous", "sigma_t": sigma_t, "albedo": albedo, "g": g }],
            "render": { "technique": "reference", "width": SIZE, "height": SIZE, "samples": 64,
                "reference": { "max_scatterings": 1 } },
        }));
        // Even 0.1° is wide for a light 1 cm off the axis: each pixel has its own closed form.
        let half = 0.05_f64.to_radians().tan();
        let place = |i: u32| half * (2.0 * (f64::from(i) + 0.5) / f64::from(SIZE) - 1.0);
        let mut expected = 0.0;
        for pixel in 0..SIZE * SIZE {
            let ray = DVec3::new(place(pixel % SIZE), -place(pixel / SIZE), -1.0);
            let direction = ray / ray.length();
            let light = DVec3::new(0.0, across, -along);
            let closest = light.dot(direction);
            let offset = light.cross(direction).length();
            expected += at(closest, offset, end * ray.length()).radiance();
        }
        expected /= f64::from(SIZE * SIZE);
        let name = format!("airlight sigma {sigma_t} along {along} across {across} g {g}");
        Estimate::of_pixels(&still).assert_near(&name, expected, 1e-3 * expected);
    }
}
