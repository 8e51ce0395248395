//! Short words for the presets: boxes, quads, arches, prisms, and the parts around them.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::DVec3;

use crate::description::camera::up;
use crate::description::geometry::{
    BoxGeometry, MeshGeometry, QuadGeometry, SphereGeometry, TransformKeyframe,
};
use crate::description::lights::{
    DirectionalLightDescription, EnvironmentDescription, PointLightDescription,
    SpotLightDescription,
};
use crate::description::media::{
    HeightFogMedium, HomogeneousMedium, ProceduralMedium, ProceduralPattern,
};
use crate::description::render::{CorrectionMode, Technique};
use crate::description::{
    Bounds, CameraDescription, GeometryDescription, LightDescription, MaterialDescription,
    MediumDescription, RenderDescription, Rgb, Scale, SceneDescription, Transform, VERSION,
};

/// A diffuse surface.
pub(super) fn matte(rgb: [f64; 3]) -> MaterialDescription {
    MaterialDescription {
        base_color: Rgb(rgb),
        ..MaterialDescription::default()
    }
}

/// A surface with a highlight.
pub(super) fn glossy(rgb: [f64; 3], roughness: f64) -> MaterialDescription {
    MaterialDescription {
        roughness,
        ..matte(rgb)
    }
}

/// A surface that is seen glowing. Unit of `radiance`: W·m⁻²·sr⁻¹.
pub(super) fn glowing(radiance: [f64; 3]) -> MaterialDescription {
    MaterialDescription {
        emission: Rgb(radiance),
        ..matte([0.02; 3])
    }
}

/// Geometry under construction.
#[derive(Default)]
pub(super) struct Builder {
    geometry: Vec<GeometryDescription>,
}

impl Builder {
    /// A box from corner to corner.
    pub(super) fn cuboid(&mut self, min: [f64; 3], max: [f64; 3], material: &MaterialDescription) {
        self.geometry.push(GeometryDescription::Box(BoxGeometry {
            name: None,
            min,
            max,
            material: material.clone(),
            transform: None,
            keyframes: Vec::new(),
        }));
    }

    /// A box that stands on `foot`, the centre of its lower face.
    pub(super) fn block(&mut self, foot: [f64; 3], size: [f64; 3], material: &MaterialDescription) {
        let [x, y, z] = foot;
        let [w, h, d] = size;
        self.cuboid(
            [x - w / 2.0, y, z - d / 2.0],
            [x + w / 2.0, y + h, z + d / 2.0],
            material,
        );
    }

    /// A parallelogram.
    pub(super) fn quad(
        &mut self,
        corner: [f64; 3],
        edge_u: [f64; 3],
        edge_v: [f64; 3],
        material: &MaterialDescription,
    ) {
        self.geometry.push(GeometryDescription::Quad(QuadGeometry {
            name: None,
            corner,
            edge_u,
            edge_v,
            material: material.clone(),
            transform: None,
            keyframes: Vec::new(),
        }));
    }

    /// A sphere of 960 triangles.
    pub(super) fn sphere(&mut self, center: [f64; 3], radius: f64, material: &MaterialDescription) {
        self.geometry
            .push(GeometryDescription::Sphere(SphereGeometry {
                name: None,
                center,
                radius,
                material: material.clone(),
                transform: None,
                keyframes: Vec::new(),
            }));
    }

    /// Many triangles of one material, flat shaded.
    pub(super) fn mesh(&mut self, name: &str, mesh: Triangles, material: &MaterialDescription) {
        self.geometry.push(GeometryDescription::Mesh(MeshGeometry {
            name: Some(name.to_owned()),
            positions: mesh.positions,
            indices: mesh.indices,
            normals: None,
            texcoords: None,
            material: material.clone(),
            transform: None,
            keyframes: Vec::new(),
        }));
    }

    /// Lets the last entry move.
    pub(super) fn moves(&mut self, keyframes: Vec<TransformKeyframe>) {
        match self.geometry.last_mut() {
            Some(GeometryDescription::Box(entry)) => entry.keyframes = keyframes,
            Some(GeometryDescription::Sphere(entry)) => entry.keyframes = keyframes,
            Some(GeometryDescription::Mesh(entry)) => entry.keyframes = keyframes,
            Some(GeometryDescription::Quad(entry)) => entry.keyframes = keyframes,
            _ => {}
        }
    }

    /// The scene with this geometry.
    pub(super) fn scene(
        self,
        name: &str,
        camera: CameraDescription,
        lights: Vec<LightDescription>,
        media: Vec<MediumDescription>,
    ) -> SceneDescription {
        SceneDescription {
            version: VERSION,
            name: name.to_owned(),
            camera,
            navigation: None,
            geometry: Arc::new(self.geometry),
            lights,
            media,
            render: RenderDescription::default(),
            animation: None,
        }
    }
}

/// Quads and triangles for [`Builder::mesh`].
#[derive(Default)]
pub(super) struct Triangles {
    positions: Vec<[f64; 3]>,
    indices: Vec<[u32; 3]>,
}

impl Triangles {
    /// A quad, counter-clockwise seen from its front.
    pub(super) fn quad(&mut self, corners: [[f64; 3]; 4]) {
        let first = self.positions.len() as u32;
        self.positions.extend(corners);
        self.indices.push([first, first + 1, first + 2]);
        self.indices.push([first, first + 2, first + 3]);
    }

    /// The side of an upright prism with `sides` sides around the axis through `foot`.
    pub(super) fn prism(&mut self, foot: [f64; 3], radius: [f64; 2], height: f64, sides: u32) {
        let foot = DVec3::from_array(foot);
        let corner = |side: u32, radius: f64, y: f64| {
            let (sin, cos) = (f64::from(side) / f64::from(sides) * TAU).sin_cos();
            (foot + DVec3::new(radius * sin, y, radius * cos)).to_array()
        };
        let [low, high] = radius;
        for side in 0..sides {
            self.quad([
                corner(side, low, 0.0),
                corner(side + 1, low, 0.0),
                corner(side + 1, high, height),
                corner(side, high, height),
            ]);
        }
    }

    /// The wall above a round arch, between two heights, in a plane of constant z.
    pub(super) fn arch(&mut self, arch: &Arch) {
        const SEGMENTS: u32 = 10;
        let Arch {
            center_x,
            radius,
            spring,
            top,
            z: [back, front],
        } = *arch;
        let at = |i: u32| {
            let angle = f64::from(i) / f64::from(SEGMENTS) * (TAU / 2.0);
            let (sin, cos) = angle.sin_cos();
            [center_x - radius * cos, spring + radius * sin]
        };
        for i in 0..SEGMENTS {
            let ([x0, y0], [x1, y1]) = (at(i), at(i + 1));
            // Front, back, and the underside.
            self.quad([
                [x0, y0, front],
                [x1, y1, front],
                [x1, top, front],
                [x0, top, front],
            ]);
            self.quad([
                [x1, y1, back],
                [x0, y0, back],
                [x0, top, back],
                [x1, top, back],
            ]);
            self.quad([
                [x0, y0, back],
                [x1, y1, back],
                [x1, y1, front],
                [x0, y0, front],
            ]);
        }
    }
}

/// A round arch in a wall.
pub(super) struct Arch {
    pub(super) center_x: f64,
    pub(super) radius: f64,
    /// Height at which the arch begins.
    pub(super) spring: f64,
    /// Height of the wall.
    pub(super) top: f64,
    /// Back and front of the wall.
    pub(super) z: [f64; 2],
}

/// A camera without keyframes.
pub(super) fn camera(
    position: [f64; 3],
    target: [f64; 3],
    vertical_fov_degrees: f64,
    exposure_ev: f64,
) -> CameraDescription {
    CameraDescription {
        position,
        target,
        up: up(),
        vertical_fov_degrees,
        exposure_ev,
        keyframes: Vec::new(),
    }
}

/// Parallel light. Unit of `irradiance`: W·m⁻².
pub(super) fn sun(direction: [f64; 3], irradiance: [f64; 3]) -> LightDescription {
    LightDescription::Directional(DirectionalLightDescription {
        name: Some("sun".to_owned()),
        direction,
        irradiance: Rgb(irradiance),
        casts_shadows: true,
        keyframes: Vec::new(),
    })
}

/// Equal radiance from everywhere. Unit of `radiance`: W·m⁻²·sr⁻¹.
pub(super) fn sky(radiance: [f64; 3]) -> LightDescription {
    LightDescription::Environment(EnvironmentDescription {
        name: Some("sky".to_owned()),
        radiance: Rgb(radiance),
        map: None,
        rotation_degrees: 0.0,
    })
}

/// A point light. Unit of `intensity`: W·sr⁻¹.
pub(super) fn point(name: &str, position: [f64; 3], intensity: [f64; 3]) -> LightDescription {
    LightDescription::Point(PointLightDescription {
        name: Some(name.to_owned()),
        position,
        intensity: Rgb(intensity),
        radius: 0.05,
        casts_shadows: true,
        keyframes: Vec::new(),
    })
}

/// A spot light. Unit of `intensity`: W·sr⁻¹; of the angles: degree.
pub(super) fn spot(
    name: &str,
    position: [f64; 3],
    direction: [f64; 3],
    intensity: [f64; 3],
    [inner_angle_degrees, outer_angle_degrees]: [f64; 2],
) -> LightDescription {
    LightDescription::Spot(SpotLightDescription {
        name: Some(name.to_owned()),
        position,
        direction,
        intensity: Rgb(intensity),
        inner_angle_degrees,
        outer_angle_degrees,
        radius: 0.05,
        casts_shadows: true,
        keyframes: Vec::new(),
    })
}

/// Homogeneous fog in a box. Unit of `sigma_t`: m⁻¹.
pub(super) fn fog(sigma_t: f64, albedo: [f64; 3], g: f64, bounds: Bounds) -> MediumDescription {
    MediumDescription::Homogeneous(HomogeneousMedium {
        name: Some("fog".to_owned()),
        sigma_s: None,
        sigma_a: None,
        sigma_t: Some(Rgb::grey(sigma_t)),
        albedo: Some(Rgb(albedo)),
        g,
        phase: None,
        emission: Rgb::grey(0.0),
        density_scale: 1.0,
        bounds: Some(bounds),
    })
}

/// Height fog over y = 0 in a box. Unit of `sigma_t` and `falloff`: m⁻¹.
pub(super) fn height_fog(
    sigma_t: f64,
    albedo: [f64; 3],
    g: f64,
    falloff: f64,
    bounds: Bounds,
) -> MediumDescription {
    MediumDescription::HeightFog(HeightFogMedium {
        name: Some("height fog".to_owned()),
        sigma_s: None,
        sigma_a: None,
        sigma_t: Some(Rgb::grey(sigma_t)),
        albedo: Some(Rgb(albedo)),
        g,
        phase: None,
        emission: Rgb::grey(0.0),
        density_scale: 1.0,
        up: up(),
        falloff,
        origin: [0.0; 3],
        bounds: Some(bounds),
    })
}

/// A grid of a pattern whose longest side, `size`, is in metres; it stands on `foot`. Unit of
/// `sigma_t`: m⁻¹.
pub(super) fn procedural(
    pattern: ProceduralPattern,
    foot: [f64; 3],
    size: f64,
    [sigma_t, albedo, g]: [f64; 3],
) -> MediumDescription {
    MediumDescription::Procedural(ProceduralMedium {
        name: None,
        sigma_s: None,
        sigma_a: None,
        sigma_t: Some(Rgb::grey(sigma_t)),
        albedo: Some(Rgb::grey(albedo)),
        g,
        phase: None,
        emission: Rgb::grey(0.0),
        density_scale: 1.0,
        pattern,
        seed: 0,
        resolution: 128,
        octaves: 5,
        transform: Some(Transform {
            translation: foot,
            scale: Scale([size; 3]),
            ..Transform::default()
        }),
    })
}

/// The scene under the path tracer, its noise filtered by the correction: what a cloud scatters many times
/// is most of its light.
pub(super) fn by_reference(mut scene: SceneDescription) -> SceneDescription {
    scene.render.technique = Technique::Reference;
    scene.render.correction = Some(CorrectionMode::Always);
    scene
}
