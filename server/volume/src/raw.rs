//! Bare voxels (`.raw`) and the JSON file beside them that says what they are.
//!
//! `fog.raw` is described by `fog.raw.json`, else `fog.json`, in one of two forms. The product's:
//!
//! ```json
//! {"size": [64, 64, 32], "type": "u8", "endian": "little",
//!  "bounds_min": [-1, -1, 0], "bounds_max": [1, 1, 1]}
//! ```
//!
//! and that of exports from OpenVDB, `dims_xyz`, `dtype` and, in world units, `voxel_size` with
//! the place of the first voxel, `world_of_ijk_min`. x changes fastest in both.

use std::io::Read;
use std::path::Path;

use glam::DVec3;
use serde::Deserialize;
use serde::de::IgnoredAny;
use tyndall_files::regular::{self, ReadError};

use crate::dense::Dense;
use crate::number::Number;
use crate::select::shown;
use crate::{Grid, VolumeError, VolumeLimits};

/// Longest description. Unit: byte.
const MAX_SIDECAR: u64 = 1 << 16;

/// The description in the product's form.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Description {
    /// Voxels along x, y, z.
    size: [u32; 3],
    #[serde(rename = "type")]
    kind: Kind,
    #[serde(default)]
    endian: Endian,
    /// Low corner of the box that the voxels fill; without it the origin. Unit: m.
    #[serde(default)]
    bounds_min: [f64; 3],
    /// High corner; without it (1, 1, 1). Unit: m.
    #[serde(default = "ones")]
    bounds_max: [f64; 3],
}

fn ones() -> [f64; 3] {
    [1.0; 3]
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Kind {
    U8,
    U16,
    F16,
    F32,
}

#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Default)]
#[serde(rename_all = "lowercase")]
enum Endian {
    #[default]
    Little,
    Big,
}

/// The description in the form of exports. What says nothing about the voxels' place is named so
/// that any other field is refused.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Export {
    dims_xyz: [u32; 3],
    dtype: String,
    order: String,
    voxel_size: Option<[f64; 3]>,
    world_of_ijk_min: Option<[f64; 3]>,
    #[serde(rename = "ijk_min")]
    _ijk_min: Option<IgnoredAny>,
    #[serde(rename = "source")]
    _source: Option<IgnoredAny>,
    #[serde(rename = "grid")]
    _grid: Option<IgnoredAny>,
    #[serde(rename = "min")]
    _min: Option<IgnoredAny>,
    #[serde(rename = "max")]
    _max: Option<IgnoredAny>,
    #[serde(rename = "mean")]
    _mean: Option<IgnoredAny>,
}

impl Description {
    fn dense(&self) -> Dense {
        let (number, scale) = match self.kind {
            Kind::U8 => (Number::U8, 1.0 / 255.0),
            Kind::U16 => (Number::U16, 1.0 / 65535.0),
            Kind::F16 => (Number::F16, 1.0),
            Kind::F32 => (Number::F32, 1.0),
        };
        Dense {
            size: self.size,
            number,
            big_endian: self.endian == Endian::Big,
            scale,
            x_fastest: true,
            bounds: [self.bounds_min, self.bounds_max].map(DVec3::from_array),
        }
    }
}

impl Export {
    fn description(self) -> Result<Description, VolumeError> {
        let (kind, endian) = self.dtype.split_once(' ').unwrap_or((&self.dtype, ""));
        let kind = match kind {
            "uint8" => Kind::U8,
            "uint16" => Kind::U16,
            "float16" => Kind::F16,
            "float32" => Kind::F32,
            _ => {
                return Err(VolumeError::unsupported("dtype", shown(&self.dtype)));
            }
        };
        let endian = match endian {
            "" | "little-endian" => Endian::Little,
            "big-endian" => Endian::Big,
            _ => {
                return Err(VolumeError::unsupported("dtype", shown(&self.dtype)));
            }
        };
        if !self.order.starts_with("x fastest") {
            return Err(VolumeError::unsupported("order", shown(&self.order)));
        }
        let (low, cell) = match (self.world_of_ijk_min, self.voxel_size) {
            (Some(first), Some(cell)) => {
                let cell = DVec3::from_array(cell);
                (DVec3::from_array(first) - 0.5 * cell, cell)
            }
            (None, None) => {
                let count = DVec3::from_array(self.dims_xyz.map(f64::from));
                (DVec3::ZERO, count.recip())
            }
            _ => {
                return Err(VolumeError::invalid(
                    "world_of_ijk_min and voxel_size",
                    "one of them",
                    "both or none",
                ));
            }
        };
        let high = low + cell * DVec3::from_array(self.dims_xyz.map(f64::from));
        Ok(Description {
            size: self.dims_xyz,
            kind,
            endian,
            bounds_min: low.to_array(),
            bounds_max: high.to_array(),
        })
    }
}

/// Reads voxels that are held whole, by their description.
///
/// N voxels along an axis fill the box: voxel i is at lo + (i + ½)(hi − lo)/N, and between the
/// outermost ones and the faces the edge value holds. Integers are fractions of their largest value.
///
/// # Errors
/// [`VolumeError::Invalid`] where the description has unknown fields or does not fit the voxels,
/// [`VolumeError::Unsupported`] for other kinds of numbers, [`VolumeError::Limit`] before more is
/// allocated than `limits` allow.
pub fn read_bytes(bytes: &[u8], sidecar: &str, limits: &VolumeLimits) -> Result<Grid, VolumeError> {
    let length = bytes.len() as u64;
    VolumeError::within("bytes of the file", length, limits.file_bytes)?;
    read_from(&mut { bytes }, length, sidecar, limits)
}

/// Reads voxels of `length` bytes.
pub(crate) fn read_from(
    source: &mut impl Read,
    length: u64,
    sidecar: &str,
    limits: &VolumeLimits,
) -> Result<Grid, VolumeError> {
    let dense = describe(sidecar)?.dense();
    dense.check_length(length)?;
    dense.read(source, "", limits)
}

fn describe(sidecar: &str) -> Result<Description, VolumeError> {
    let wrong = |error: serde_json::Error| {
        VolumeError::invalid(
            "description",
            error.to_string(),
            "size, type, endian, bounds_min and bounds_max",
        )
    };
    let value: serde_json::Value = serde_json::from_str(sidecar).map_err(wrong)?;
    if value.get("dims_xyz").is_some() {
        let export: Export = serde_json::from_value(value).map_err(wrong)?;
        return export.description();
    }
    serde_json::from_value(value).map_err(wrong)
}

/// The text of the file that describes the voxels at `path`.
pub(crate) fn sidecar(path: &Path) -> Result<String, VolumeError> {
    let mut longer = path.as_os_str().to_owned();
    longer.push(".json");
    let longer = Path::new(&longer);
    let shorter = path.with_extension("json");
    let chosen = if longer.exists() { longer } else { &shorter };
    let refused = |found: String| {
        let allowed = "a file of the same name and .json";
        VolumeError::invalid("description", found, allowed)
    };
    let bytes = regular::read(chosen, MAX_SIDECAR).map_err(|error| match error {
        ReadError::Io(error) => {
            let name = chosen.file_name().unwrap_or_default().to_string_lossy();
            refused(format!("{}: {error}", shown(&name)))
        }
        ReadError::TooLarge { found, limit } => VolumeError::Limit {
            what: "bytes of the description",
            found,
            limit,
        },
    })?;
    String::from_utf8(bytes).map_err(|error| refused(error.to_string()))
}
