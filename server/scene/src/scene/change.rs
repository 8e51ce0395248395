//! What differs between two states of a scene, as one value.
//!
//! Whatever is kept from frame to frame names the flags it depends on and is made anew when one of them
//! is raised. The flags are fine enough that a change of power or of a coefficient can re-weight what was
//! traced, and that a light's move leaves the triangles alone. Names of lights and media, the picture's
//! size, tracks and the time itself raise nothing: none of them changes what is seen at this time.

use bitflags::bitflags;

use super::Scene;
use super::lights::Light;
use super::media::Medium;

bitflags! {
    /// What differs between two states of a scene.
    #[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
    pub struct ChangeSet: u16 {
        /// The camera's pose or lens.
        const CAMERA = 1;
        /// Triangles, materials or textures, or which of the meshes the instances show. Always together
        /// with [`Self::PLACEMENT`], since no new triangle was anywhere before.
        const SURFACES = 1 << 1;
        /// Where instances stand.
        const PLACEMENT = 1 << 2;
        /// How many lights there are, of which kind in which order, which of them cast shadows and which
        /// are lit at all. A light that is new, or of another kind at its index, raises this alone.
        const LIGHT_SET = 1 << 3;
        /// A light's position, direction, cone angles or radius.
        const LIGHT_POSE = 1 << 4;
        /// A light's intensity or irradiance. A light that goes on or off also raises
        /// [`Self::LIGHT_SET`].
        const LIGHT_POWER = 1 << 5;
        /// Scattering, absorption or emission of a medium. A medium that begins or ceases to do any of
        /// the three also raises [`Self::MEDIUM_SHAPE`].
        const MEDIUM_COEFFICIENTS = 1 << 6;
        /// The phase function of a medium.
        const MEDIUM_PHASE = 1 << 7;
        /// How many media there are, in which order, and where each is how dense: kind of shape, bounds,
        /// grid, transform and falloff, and whether it is there at all. A medium that is new raises this
        /// alone.
        const MEDIUM_SHAPE = 1 << 8;
        /// Radiance, map or rotation of the environment.
        const ENVIRONMENT = 1 << 9;
        /// Technique, its settings, correction, shadows or seed; neither size nor stop rule.
        const SETTINGS = 1 << 10;
        /// Only when the picture is finished.
        const STOP = 1 << 11;
        /// Only how the picture is displayed: its exposure.
        const DISPLAY = 1 << 12;
    }
}

impl ChangeSet {
    /// Everything about lights other than the environment.
    pub const LIGHTS: Self = Self::LIGHT_SET
        .union(Self::LIGHT_POSE)
        .union(Self::LIGHT_POWER);
    /// Everything about media.
    pub const MEDIA: Self = Self::MEDIUM_COEFFICIENTS
        .union(Self::MEDIUM_PHASE)
        .union(Self::MEDIUM_SHAPE);
    /// What leaves the picture as it is: when it is finished and how it is displayed.
    const SAME_PICTURE: Self = Self::STOP.union(Self::DISPLAY);

    /// Everything that differs from `old` to `new`. Geometries, grids and maps are compared by identity.
    /// Cost: one comparison an instance of another geometry, a light and a medium.
    pub fn between(old: &Scene, new: &Scene) -> Self {
        let mut changes = lights(&old.lights, &new.lights) | media(&old.media, &new.media);
        if old.geometry != new.geometry {
            let (old, new) = (&old.geometry, &new.geometry);
            changes.set(Self::SURFACES, !old.same_surfaces(new));
            changes.set(Self::PLACEMENT, !old.same_placement(new));
        }
        changes.set(Self::ENVIRONMENT, old.environment != new.environment);

        let mut displayed_alike = new.camera;
        displayed_alike.exposure_ev = old.camera.exposure_ev;
        changes.set(Self::CAMERA, displayed_alike != old.camera);
        let exposures = [old, new].map(|scene| scene.camera.exposure_ev.to_bits());
        changes.set(Self::DISPLAY, exposures[0] != exposures[1]);

        let mut stopped_alike = new.render.clone();
        stopped_alike.stop = old.render.stop;
        // The picture's size is the view's, not the scene's.
        (stopped_alike.width, stopped_alike.height) = (old.render.width, old.render.height);
        changes.set(Self::SETTINGS, stopped_alike != old.render);
        changes.set(Self::STOP, old.render.stop != new.render.stop);
        changes
    }

    /// Whether the picture is another one, so that its samples are counted from zero.
    pub fn restarts(self) -> bool {
        !Self::SAME_PICTURE.contains(self)
    }

    /// Whether the scene itself is another one, seen from elsewhere or not.
    pub fn beyond_camera(self) -> bool {
        !Self::SAME_PICTURE.union(Self::CAMERA).contains(self)
    }
}

/// What differs between two lists of lights, compared index by index.
fn lights(old: &[Light], new: &[Light]) -> ChangeSet {
    let mut changes = ChangeSet::empty();
    changes.set(ChangeSet::LIGHT_SET, old.len() != new.len());
    for (old, new) in old.iter().zip(new) {
        changes |= light(old, new);
    }
    changes
}

/// What differs between two lights at the same index.
fn light(old: &Light, new: &Light) -> ChangeSet {
    let (same_pose, same_power) = match (old, new) {
        (Light::Point(old), Light::Point(new)) => (
            (old.position, old.radius) == (new.position, new.radius),
            old.intensity == new.intensity,
        ),
        (Light::Spot(old), Light::Spot(new)) => (
            (old.position, old.direction, old.radius) == (new.position, new.direction, new.radius)
                && (old.inner_angle, old.outer_angle) == (new.inner_angle, new.outer_angle),
            old.intensity == new.intensity,
        ),
        (Light::Directional(old), Light::Directional(new)) => (
            old.direction == new.direction,
            old.irradiance == new.irradiance,
        ),
        _ => return ChangeSet::LIGHT_SET,
    };
    let same_role = (old.casts_shadows(), old.is_lit()) == (new.casts_shadows(), new.is_lit());
    let mut changes = ChangeSet::empty();
    changes.set(ChangeSet::LIGHT_SET, !same_role);
    changes.set(ChangeSet::LIGHT_POSE, !same_pose);
    changes.set(ChangeSet::LIGHT_POWER, !same_power);
    changes
}

/// What differs between two lists of media, compared index by index.
fn media(old: &[Medium], new: &[Medium]) -> ChangeSet {
    let mut changes = ChangeSet::empty();
    changes.set(ChangeSet::MEDIUM_SHAPE, old.len() != new.len());
    for (old, new) in old.iter().zip(new) {
        changes |= medium(old, new);
    }
    changes
}

/// What differs between two media at the same index.
fn medium(old: &Medium, new: &Medium) -> ChangeSet {
    let coefficients = |medium: &Medium| [medium.sigma_s, medium.sigma_a, medium.emission];
    let effects = |medium: &Medium| coefficients(medium).map(|effect| effect != [0.0; 3]);
    let same_shape = old.shape == new.shape && effects(old) == effects(new);
    let mut changes = ChangeSet::empty();
    changes.set(
        ChangeSet::MEDIUM_COEFFICIENTS,
        coefficients(old) != coefficients(new),
    );
    changes.set(ChangeSet::MEDIUM_PHASE, old.phase != new.phase);
    changes.set(ChangeSet::MEDIUM_SHAPE, !same_shape);
    changes
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{DVec3, Vec3};
    use serde_json::json;

    use super::*;
    use crate::description::SceneDescription;
    use crate::scene::PhaseFunction;
    use crate::scene::{
        CorrectionMode, Geometry, MediumOrder, MediumShape, PointLight, ShadowMode, SharedGrid,
        StopRule, Technique,
    };

    /// A scene with two boxes, every kind of light, every kind of medium and an environment.
    fn scene() -> Scene {
        let media = |kind: &str| json!({"kind": kind, "sigma_s": 0.5, "sigma_a": 0.1, "g": 0.2});
        let with = |kind: &str, more: serde_json::Value| {
            let mut medium = media(kind);
            let members = medium.as_object_mut().unwrap();
            members.extend(more.as_object().unwrap().clone());
            medium
        };
        let bounds = json!({"min": [-1, 0, -1], "max": [1, 2, 1]});
        let description = json!({
            "version": 1,
            "camera": {"position": [0, 1, 4], "target": [0, 1, 0]},
            "geometry": [
                {"kind": "box", "min": [0, 0, 0], "max": [1, 1, 1],
                 "keyframes": [{"time_seconds": 0, "transform": {}}]},
                {"kind": "box", "min": [2, 0, 0], "max": [3, 1, 1]},
            ],
            "lights": [
                {"kind": "point", "position": [0, 3, 0], "intensity": 10},
                {"kind": "spot", "position": [1, 3, 0], "direction": [0, -1, 0], "intensity": 10},
                {"kind": "directional", "direction": [0, -1, 0.1], "irradiance": 1},
                {"kind": "environment", "radiance": 0.1},
            ],
            "media": [
                with("homogeneous", json!({"bounds": bounds})),
                with("height_fog", json!({"falloff": 0.5, "bounds": bounds})),
                with("sphere", json!({"center": [0, 1, 0], "radius": 1})),
                with("procedural", json!({"pattern": "cloud", "resolution": 8})),
            ],
        });
        let description = SceneDescription::from_json(&description.to_string()).unwrap();
        crate::build(description, None).unwrap().scene
    }

    fn point(scene: &mut Scene) -> &mut PointLight {
        match &mut scene.lights[0] {
            Light::Point(light) => light,
            other => panic!("{other:?}"),
        }
    }

    fn changed_geometry(scene: &mut Scene, change: fn(&mut Geometry)) {
        change(Arc::make_mut(&mut scene.geometry.0));
    }

    /// An edit of a scene: its name, exactly the flags it raises, and what it does.
    type Edit = (&'static str, ChangeSet, fn(&mut Scene));

    const EDITS: &[Edit] = &[
        ("nothing", ChangeSet::empty(), |_| {}),
        ("names", ChangeSet::empty(), |scene| {
            scene.name = "another".to_owned();
            point(scene).name = "lamp".to_owned();
            scene.media[0].name = "fog".to_owned();
        }),
        ("size", ChangeSet::empty(), |scene| scene.render.width += 1),
        ("time", ChangeSet::empty(), |scene| scene.time_seconds = 2.0),
        ("a copy of the geometry", ChangeSet::empty(), |scene| {
            changed_geometry(scene, |_| {});
        }),
        ("pose of the camera", ChangeSet::CAMERA, |scene| {
            scene.camera.position.x += 1.0;
        }),
        ("lens of the camera", ChangeSet::CAMERA, |scene| {
            scene.camera.vertical_fov *= 0.5;
        }),
        ("exposure", ChangeSet::DISPLAY, |scene| {
            scene.camera.exposure_ev += 1.0;
        }),
        (
            "a material",
            ChangeSet::SURFACES.union(ChangeSet::PLACEMENT),
            |scene| {
                changed_geometry(scene, |geometry| {
                    Arc::make_mut(&mut geometry.surfaces).materials[0].roughness = 0.1;
                });
            },
        ),
        (
            "an instance less",
            ChangeSet::SURFACES.union(ChangeSet::PLACEMENT),
            |scene| {
                changed_geometry(scene, |geometry| {
                    geometry.instances.pop();
                });
            },
        ),
        ("a placed box", ChangeSet::PLACEMENT, |scene| {
            changed_geometry(scene, |geometry| {
                geometry.instances[0].world_from_object.translation.x += 1.0;
            });
        }),
        ("a light less", ChangeSet::LIGHT_SET, |scene| {
            scene.lights.pop();
        }),
        ("a light more", ChangeSet::LIGHT_SET, |scene| {
            scene.lights.push(scene.lights[0].clone());
        }),
        ("order of lights", ChangeSet::LIGHT_SET, |scene| {
            scene.lights.reverse();
            // The one in the middle stayed where it was.
            assert!(matches!(scene.lights[1], Light::Spot(_)));
        }),
        ("shadow casting", ChangeSet::LIGHT_SET, |scene| {
            point(scene).casts_shadows = false;
        }),
        (
            "a light off",
            ChangeSet::LIGHT_SET.union(ChangeSet::LIGHT_POWER),
            |scene| point(scene).intensity = [0.0; 3],
        ),
        ("position of a light", ChangeSet::LIGHT_POSE, |scene| {
            point(scene).position.y += 1.0;
        }),
        ("radius of a light", ChangeSet::LIGHT_POSE, |scene| {
            point(scene).radius *= 2.0;
        }),
        ("direction of a spot", ChangeSet::LIGHT_POSE, |scene| {
            let Light::Spot(spot) = &mut scene.lights[1] else {
                panic!("{:?}", scene.lights);
            };
            spot.direction = Vec3::X;
        }),
        ("cone of a spot", ChangeSet::LIGHT_POSE, |scene| {
            let Light::Spot(spot) = &mut scene.lights[1] else {
                panic!("{:?}", scene.lights);
            };
            spot.outer_angle *= 0.5;
        }),
        ("direction of a sun", ChangeSet::LIGHT_POSE, |scene| {
            let Light::Directional(sun) = &mut scene.lights[2] else {
                panic!("{:?}", scene.lights);
            };
            sun.direction = Vec3::NEG_Y;
        }),
        ("intensity", ChangeSet::LIGHT_POWER, |scene| {
            point(scene).intensity[1] *= 2.0;
        }),
        ("irradiance", ChangeSet::LIGHT_POWER, |scene| {
            let Light::Directional(sun) = &mut scene.lights[2] else {
                panic!("{:?}", scene.lights);
            };
            sun.irradiance[0] *= 2.0;
        }),
        ("scattering", ChangeSet::MEDIUM_COEFFICIENTS, |scene| {
            scene.media[3].sigma_s[0] *= 2.0;
        }),
        ("absorption", ChangeSet::MEDIUM_COEFFICIENTS, |scene| {
            scene.media[1].sigma_a = [0.3; 3];
        }),
        (
            "a medium that begins to glow",
            ChangeSet::MEDIUM_COEFFICIENTS.union(ChangeSet::MEDIUM_SHAPE),
            |scene| scene.media[0].emission = [1.0; 3],
        ),
        ("mean cosine", ChangeSet::MEDIUM_PHASE, |scene| {
            scene.media[2].phase = PhaseFunction::HenyeyGreenstein { g: -0.3 };
        }),
        ("a medium less", ChangeSet::MEDIUM_SHAPE, |scene| {
            scene.media.pop();
        }),
        ("order of media", ChangeSet::MEDIUM_SHAPE, |scene| {
            scene.media.reverse();
        }),
        ("kind of a medium", ChangeSet::MEDIUM_SHAPE, |scene| {
            scene.media[0].shape = MediumShape::Homogeneous { bounds: None };
        }),
        ("falloff of height fog", ChangeSet::MEDIUM_SHAPE, |scene| {
            let MediumShape::HeightFog { falloff, .. } = &mut scene.media[1].shape else {
                panic!("{:?}", scene.media);
            };
            *falloff *= 2.0;
        }),
        ("centre of a sphere", ChangeSet::MEDIUM_SHAPE, |scene| {
            let MediumShape::Sphere { center, .. } = &mut scene.media[2].shape else {
                panic!("{:?}", scene.media);
            };
            *center = DVec3::ZERO;
        }),
        ("place of a grid", ChangeSet::MEDIUM_SHAPE, |scene| {
            let MediumShape::Grid {
                world_from_lattice, ..
            } = &mut scene.media[3].shape
            else {
                panic!("{:?}", scene.media);
            };
            world_from_lattice.translation.x += 1.0;
        }),
        ("radiance of the sky", ChangeSet::ENVIRONMENT, |scene| {
            scene.environment.as_mut().unwrap().radiance = [1.0; 3];
        }),
        ("no sky", ChangeSet::ENVIRONMENT, |scene| {
            scene.environment = None;
        }),
        ("technique", ChangeSet::SETTINGS, |scene| {
            scene.render.technique = Technique::Reference;
        }),
        ("steps of the march", ChangeSet::SETTINGS, |scene| {
            scene.render.single_scattering.steps += 1;
        }),
        ("order of the reference", ChangeSet::SETTINGS, |scene| {
            scene.render.reference.medium_order = MediumOrder::Single;
        }),
        ("seed", ChangeSet::SETTINGS, |scene| scene.render.seed += 1),
        ("correction", ChangeSet::SETTINGS, |scene| {
            scene.render.correction = CorrectionMode::AtRest;
        }),
        ("shadows", ChangeSet::SETTINGS, |scene| {
            scene.render.shadows.mode = ShadowMode::Off;
        }),
        ("stop rule", ChangeSet::STOP, |scene| {
            scene.render.stop = StopRule::Seconds(3.0);
        }),
    ];

    #[test]
    fn an_edit_raises_the_flags_it_names_and_no_other() {
        let old = scene();
        let mut raised = ChangeSet::empty();
        for (name, flags, edit) in EDITS {
            let mut new = old.clone();
            edit(&mut new);
            assert_eq!(ChangeSet::between(&old, &new), *flags, "{name}");
            assert_eq!(ChangeSet::between(&new, &old), *flags, "{name}, undone");
            raised |= *flags;
        }
        assert_eq!(raised, ChangeSet::all());
    }

    #[test]
    fn edits_of_several_kinds_raise_all_their_flags() {
        let old = scene();
        let mut new = old.clone();
        let mut flags = ChangeSet::empty();
        // A light less and a camera moved after a power changed: none hides another.
        for name in [
            "intensity",
            "a light less",
            "mean cosine",
            "pose of the camera",
        ] {
            let (_, raised, edit) = EDITS.iter().find(|edit| edit.0 == name).unwrap();
            edit(&mut new);
            flags |= *raised;
        }
        assert_eq!(ChangeSet::between(&old, &new), flags);
    }

    #[test]
    fn grids_and_surfaces_are_compared_by_identity() {
        let old = scene();
        let mut new = old.clone();
        changed_geometry(&mut new, |geometry| {
            geometry.surfaces = Arc::new((*geometry.surfaces).clone());
        });
        let surfaces = ChangeSet::SURFACES | ChangeSet::PLACEMENT;
        assert_eq!(ChangeSet::between(&old, &new), surfaces);

        let mut new = old.clone();
        let MediumShape::Grid { grid, .. } = &mut new.media[3].shape else {
            panic!("{:?}", new.media);
        };
        *grid = SharedGrid::new(Arc::new((**grid.arc()).clone()));
        assert_eq!(ChangeSet::between(&old, &new), ChangeSet::MEDIUM_SHAPE);
    }

    #[test]
    fn only_stop_and_display_keep_the_picture() {
        for flag in ChangeSet::all().iter() {
            let kept = [ChangeSet::STOP, ChangeSet::DISPLAY].contains(&flag);
            assert_eq!(flag.restarts(), !kept, "{flag:?}");
            let camera = flag == ChangeSet::CAMERA;
            assert_eq!(flag.beyond_camera(), !kept && !camera, "{flag:?}");
            assert!((flag | ChangeSet::LIGHT_POSE).beyond_camera(), "{flag:?}");
        }
        assert!(!ChangeSet::empty().restarts());
        assert!(!ChangeSet::empty().beyond_camera());
    }
}
