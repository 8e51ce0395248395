//! Where a file places its voxels: every transform is finite and invertible.

use glam::{DAffine3, DMat3, DVec3};

use crate::VolumeError;

/// `transform`, if it is finite and invertible.
pub(crate) fn checked(transform: DAffine3, field: &str) -> Result<DAffine3, VolumeError> {
    let allowed = "a finite, invertible transform";
    let found = |what: &str| format!("{what} {:?}", transform.to_cols_array());
    if !transform.is_finite() {
        return Err(VolumeError::invalid(
            field,
            found("a non-finite one:"),
            allowed,
        ));
    }
    let determinant = transform.matrix3.determinant();
    if !determinant.is_normal() || !transform.inverse().is_finite() {
        return Err(VolumeError::invalid(
            field,
            found("a singular one:"),
            allowed,
        ));
    }
    Ok(transform)
}

/// The lattice of cells that fill a box: the lattice transform and the clip of a grid that has
/// `cells` voxels and one copy of the edge voxels on each side.
///
/// Voxel i of N along an axis is the mean of cell i: its sample lies at lo + (i + ½)(hi − lo)/N,
/// lattice point i + 1. Between the outermost samples and the faces the edge value holds.
pub(crate) fn cells_in_box(
    cells: [u32; 3],
    bounds: [DVec3; 2],
) -> Result<(DAffine3, [DVec3; 2]), VolumeError> {
    let [low, high] = bounds;
    if !low.is_finite() || !high.is_finite() || low.cmpge(high).any() {
        return Err(VolumeError::invalid(
            "bounds",
            format!("{low} to {high}"),
            "finite corners, low below high along x, y and z",
        ));
    }
    let count = DVec3::from_array(cells.map(f64::from));
    let cell = (high - low) / count;
    let transform = DAffine3 {
        matrix3: DMat3::from_diagonal(cell),
        translation: low - 0.5 * cell,
    };
    let clip = [DVec3::splat(0.5), count + 0.5];
    Ok((checked(transform, "bounds")?, clip))
}
