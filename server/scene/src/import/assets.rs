//! What a description refers to besides geometry: grids and the environment map, read once a
//! load and kept by edits.

use std::collections::HashMap;
use std::sync::Arc;

use glam::DVec3;
use tyndall_volume::{Pattern, Procedural, ReadOptions, VolumeError, VolumeLimits, read};

use super::environment;
use super::transform::affine;
use crate::description::media::{GridMedium, ProceduralMedium, ProceduralPattern};
use crate::description::values::unit;
use crate::description::{
    Bounds, LightDescription, MediumDescription, SceneDescription, Transform,
};
use crate::error::{SceneError, abbreviate};
use crate::files::Folder;
use crate::json_path::JsonPath;
use crate::limits::Limits;
use crate::scene::{EnvironmentMap, MediumShape, Scene, SharedGrid};
use crate::validate;

/// The parts of a scene that come from files or take long to make.
#[derive(Debug)]
pub(crate) struct Assets {
    /// The environment's map, if it has one.
    pub(crate) map: Option<EnvironmentMap>,
    /// One a medium, in order.
    pub(crate) shapes: Vec<MediumShape>,
}

/// What procedural grids are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Grids {
    /// Made voxel by voxel.
    Made,
    /// Blocks of their largest density, for planning.
    Outlined,
}

/// What a grid is made from: media that agree share the grid.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
enum Key {
    /// Path and name of the grid in the file.
    File(String, Option<String>),
    Procedural(Procedural),
}

impl Assets {
    /// Reads the files of a validated description and makes its procedural grids.
    pub(crate) fn load(
        description: &SceneDescription,
        folder: &Folder,
        limits: &Limits,
        grids: Grids,
        warnings: &mut Vec<String>,
    ) -> Result<Self, SceneError> {
        let mut map = None;
        if let Some((path, file)) = map_file(description) {
            let (loaded, warning) = environment::load(&path, file, folder, limits)?;
            map = Some(loaded);
            warnings.extend(warning);
        }
        let mut loader = Loader {
            folder,
            limits,
            making: grids,
            warnings,
            grids: HashMap::new(),
            bytes: 0,
        };
        let shapes = shapes(description, |path, key| loader.grid(path, key))?;
        Ok(Self { map, shapes })
    }

    /// What an edited description refers to, taken from the scene before the edit.
    pub(crate) fn kept(
        before: &SceneDescription,
        scene: &Scene,
        after: &SceneDescription,
    ) -> Result<Self, SceneError> {
        let mut map = None;
        if let Some((path, file)) = map_file(after) {
            let held = scene.environment.as_ref().and_then(|held| held.map.clone());
            let known = map_file(before).is_some_and(|(_, known)| known == file);
            map = Some(
                held.filter(|_| known)
                    .ok_or_else(|| new_file(&path, file))?,
            );
        }
        let held: Vec<(Key, &SharedGrid)> = before
            .media
            .iter()
            .zip(&scene.media)
            .filter_map(|(description, medium)| match &medium.shape {
                MediumShape::Grid { grid, .. } => Some((key(description)?, grid)),
                _ => None,
            })
            .collect();
        let shapes = shapes(after, |path, key| {
            let known = held.iter().find(|(known, _)| *known == key);
            known.map(|(_, grid)| (*grid).clone()).ok_or_else(|| match &key {
                Key::File(file, None) => new_file(&format!("{path}.path"), file),
                Key::File(_, Some(name)) => new_file(&format!("{path}.grid"), name),
                Key::Procedural(_) => SceneError::invalid(
                    path,
                    "a procedural grid that the scene does not hold",
                    "pattern, seed, resolution and octaves as they are; open a scene to use others",
                ),
            })
        })?;
        Ok(Self { map, shapes })
    }
}

fn new_file(path: &str, name: &str) -> SceneError {
    SceneError::invalid(
        path,
        format!("\"{}\"", abbreviate(name)),
        "a file that the scene uses already; open a scene to use another",
    )
}

/// The environment's map with its JSON path.
fn map_file(description: &SceneDescription) -> Option<(String, &str)> {
    let mut lights = description.lights.iter().enumerate();
    lights.find_map(|(i, light)| match light {
        LightDescription::Environment(light) => {
            Some((format!("lights[{i}].map"), light.map.as_deref()?))
        }
        _ => None,
    })
}

fn key(medium: &MediumDescription) -> Option<Key> {
    match medium {
        MediumDescription::Grid(grid) => Some(file_key(grid)),
        MediumDescription::Procedural(medium) => Some(Key::Procedural(procedural(medium))),
        _ => None,
    }
}

fn file_key(grid: &GridMedium) -> Key {
    Key::File(grid.path.clone(), grid.grid.clone())
}

fn procedural(medium: &ProceduralMedium) -> Procedural {
    Procedural {
        pattern: match medium.pattern {
            ProceduralPattern::SmokePlume => Pattern::SmokePlume,
            ProceduralPattern::Cloud => Pattern::Cloud,
        },
        resolution: medium.resolution,
        octaves: medium.octaves,
        seed: medium.seed,
    }
}

/// The shapes of all media; `find` gives the grids.
fn shapes(
    description: &SceneDescription,
    mut find: impl FnMut(&str, Key) -> Result<SharedGrid, SceneError>,
) -> Result<Vec<MediumShape>, SceneError> {
    let media = description.media.iter().enumerate();
    media
        .map(|(i, medium)| {
            let mut placed = |key, transform| {
                let grid = find(&format!("media[{i}]"), key)?;
                placed_grid(medium, i, grid, transform)
            };
            match medium {
                MediumDescription::Homogeneous(medium) => Ok(MediumShape::Homogeneous {
                    bounds: medium.bounds.as_ref().map(Bounds::aabb),
                }),
                MediumDescription::HeightFog(medium) => Ok(MediumShape::HeightFog {
                    up: unit(medium.up).as_vec3(),
                    falloff: medium.falloff as f32,
                    origin: DVec3::from_array(medium.origin),
                    bounds: medium.bounds.as_ref().map(Bounds::aabb),
                }),
                MediumDescription::Sphere(medium) => Ok(MediumShape::Sphere {
                    center: DVec3::from_array(medium.center),
                    radius: medium.radius,
                }),
                MediumDescription::Grid(grid) => placed(file_key(grid), grid.transform.as_ref()),
                MediumDescription::Procedural(medium) => placed(
                    Key::Procedural(procedural(medium)),
                    medium.transform.as_ref(),
                ),
            }
        })
        .collect()
}

/// Places a grid and checks what only the grid tells.
fn placed_grid(
    medium: &MediumDescription,
    index: usize,
    grid: SharedGrid,
    transform: Option<&Transform>,
) -> Result<MediumShape, SceneError> {
    let world_from_lattice = affine(transform) * grid.world_from_lattice;
    let root = JsonPath::Root.field("media");
    validate::placed_grid(medium, &root.index(index), &grid, &world_from_lattice)?;
    Ok(MediumShape::Grid {
        grid,
        world_from_lattice,
    })
}

/// Reads each grid once.
struct Loader<'a> {
    folder: &'a Folder<'a>,
    limits: &'a Limits,
    making: Grids,
    warnings: &'a mut Vec<String>,
    grids: HashMap<Key, SharedGrid>,
    /// Memory of the grids so far.
    bytes: u64,
}

impl Loader<'_> {
    fn grid(&mut self, path: &str, mut key: Key) -> Result<SharedGrid, SceneError> {
        if let (Grids::Outlined, Key::Procedural(procedural)) = (self.making, &mut key) {
            // Neither shows in an outline: however many seeds there are, it is made once.
            (procedural.seed, procedural.octaves) = (0, 1);
        }
        if let Some(grid) = self.grids.get(&key) {
            return Ok(grid.clone());
        }
        let limits = VolumeLimits {
            file_bytes: self.limits.grid_file_bytes,
            grid_bytes: self.limits.grid_bytes.saturating_sub(self.bytes),
        };
        let grid = match &key {
            Key::File(file, name) => {
                let path = format!("{path}.path");
                let real = self.folder.locate(&path, file)?;
                // Raw voxels are described by a file beside them: fog.raw.json or fog.json.
                for companion in [
                    real.with_added_extension("json"),
                    real.with_extension("json"),
                ] {
                    self.folder.check_companion(&path, &companion)?;
                }
                let grid = read(&real, &ReadOptions { grid: name.clone() }, &limits)
                    .map_err(|error| self.refused(error, &path, file, limits.grid_bytes))?;
                let report = grid.report;
                if report.non_finite + report.negative > 0 {
                    self.warnings.push(format!(
                        "{path}: {file}: {} voxels were not finite and {} were negative; they \
                         count as 0",
                        report.non_finite, report.negative
                    ));
                }
                Arc::new(grid)
            }
            Key::Procedural(procedural) => match self.making {
                Grids::Made => procedural.grid(&limits),
                Grids::Outlined => procedural.outline(&limits).map(Arc::new),
            }
            .map_err(|error| self.refused(error, path, "procedural", limits.grid_bytes))?,
        };
        self.bytes += grid.bytes();
        let grid = SharedGrid::new(grid);
        self.grids.insert(key, grid.clone());
        Ok(grid)
    }

    fn refused(&self, error: VolumeError, path: &str, file: &str, left: u64) -> SceneError {
        let (path, file) = (path.to_owned(), file.to_owned());
        match error {
            VolumeError::Invalid {
                field,
                found,
                allowed,
            } => SceneError::Model {
                path,
                file,
                location: field,
                message: format!("found {found}, allowed {allowed}"),
            },
            VolumeError::Unsupported { field, what } => SceneError::Model {
                path,
                file,
                location: field,
                message: format!("{what} is not supported"),
            },
            // The limit is that of all grids together, not what the ones before left of it.
            VolumeError::Limit { what, found, limit } if limit == left => SceneError::Limit {
                path,
                what,
                found: found.saturating_add(self.bytes),
                limit: self.limits.grid_bytes,
            },
            VolumeError::Limit { what, found, limit } => SceneError::Limit {
                path,
                what,
                found,
                limit,
            },
            VolumeError::Decoder(failed) => SceneError::Model {
                path,
                file,
                location: "grid".to_owned(),
                message: failed.to_string(),
            },
            VolumeError::Io(source) => SceneError::Io { path, file, source },
        }
    }
}
