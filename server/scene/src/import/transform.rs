//! Placements as affine maps.

use glam::{DAffine3, DMat3, DQuat, DVec3, EulerRot};

use crate::description::Transform;
use crate::description::geometry::TransformKeyframe;
use crate::scene::Placement;

/// Scale, then rotation about the fixed axes x, y, z in this order, then translation.
pub(super) fn affine(transform: Option<&Transform>) -> DAffine3 {
    transform.map_or(DAffine3::IDENTITY, |transform| {
        placement(transform).affine()
    })
}

/// Where an entry of `geometry` stands at time 0.
pub(super) fn initial(transform: Option<&Transform>, keyframes: &[TransformKeyframe]) -> DAffine3 {
    let first = keyframes.first().map(|key| &key.transform);
    affine(first.or(transform))
}

/// A transform with its rotation as a quaternion.
pub(super) fn placement(transform: &Transform) -> Placement {
    let [x, y, z] = transform.rotation_degrees.map(f64::to_radians);
    Placement {
        translation: DVec3::from_array(transform.translation),
        // Fixed axes x, y, z are the moving axes z, y, x.
        rotation: DQuat::from_euler(EulerRot::ZYX, z, y, x),
        scale: DVec3::from_array(transform.scale.0),
    }
}

/// Maps normals: the cofactor matrix, which needs no inverse and keeps the outside outside.
pub(super) fn normal_matrix(map: &DAffine3) -> DMat3 {
    let DMat3 {
        x_axis: x,
        y_axis: y,
        z_axis: z,
    } = map.matrix3;
    let sign = map.matrix3.determinant().signum();
    DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * sign
}
