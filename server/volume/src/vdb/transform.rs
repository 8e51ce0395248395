//! The linear maps of OpenVDB. Points are rows there: p′ = p·M, with the translation in the last
//! row.

use glam::{DAffine3, DMat3, DVec3};

use crate::VolumeError;
use crate::cursor::Cursor;
use crate::placement;
use crate::select::shown;

const FIELD: &str = "transform";

/// Reads a map: from the index space of the grid to the world of the file.
pub(super) fn read(cursor: &mut Cursor<'_>) -> Result<DAffine3, VolumeError> {
    let kind = cursor.text("transform type")?;
    let map = match kind.as_str() {
        "UniformScaleMap" | "ScaleMap" => scale(cursor)?,
        "UniformScaleTranslateMap" | "ScaleTranslateMap" => {
            let translation = vector(cursor)?;
            DAffine3 {
                translation,
                ..scale(cursor)?
            }
        }
        "TranslationMap" => DAffine3::from_translation(vector(cursor)?),
        "UnitaryMap" | "AffineMap" => matrix(cursor)?,
        other => {
            let what = format!("a transform of type {}", shown(other));
            return Err(VolumeError::unsupported(FIELD, what));
        }
    };
    placement::checked(map, FIELD)
}

/// A scale, which the file repeats as voxel size and in three kinds of inverses.
fn scale(cursor: &mut Cursor<'_>) -> Result<DAffine3, VolumeError> {
    let scale = vector(cursor)?;
    for _ in 0..4 {
        vector(cursor)?;
    }
    Ok(DAffine3::from_mat3(DMat3::from_diagonal(scale)))
}

fn vector(cursor: &mut Cursor<'_>) -> Result<DVec3, VolumeError> {
    Ok(DVec3::from_array(cursor.f64s(FIELD)?))
}

fn matrix(cursor: &mut Cursor<'_>) -> Result<DAffine3, VolumeError> {
    let rows: [[f64; 4]; 4] = [
        cursor.f64s(FIELD)?,
        cursor.f64s(FIELD)?,
        cursor.f64s(FIELD)?,
        cursor.f64s(FIELD)?,
    ];
    let last = rows.map(|row| row[3]);
    if last != [0.0, 0.0, 0.0, 1.0] {
        let what = format!("a perspective transform (last column {last:?})");
        return Err(VolumeError::unsupported(FIELD, what));
    }
    let [x, y, z, translation] = rows.map(|[x, y, z, _]| DVec3::new(x, y, z));
    Ok(DAffine3 {
        matrix3: DMat3::from_cols(x, y, z),
        translation,
    })
}
