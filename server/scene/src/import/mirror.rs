//! Mirrored placements become mirrored meshes, so that every instance keeps the handedness:
//! the renderer may take counter-clockwise for front everywhere.

use glam::{DAffine3, DVec3};

use crate::scene::{Instance, Mesh};

/// Reflection at the plane x = 0; its own inverse.
const MIRROR: DVec3 = DVec3::new(-1.0, 1.0, 1.0);

/// Gives every instance a positive determinant.
pub(super) fn unmirror(meshes: &mut Vec<Mesh>, instances: &mut [Instance]) {
    let is_mirrored = |map: &DAffine3| map.matrix3.determinant() < 0.0;
    let mut used_as_is = vec![false; meshes.len()];
    for instance in instances.iter() {
        used_as_is[instance.mesh] |= !is_mirrored(&instance.world_from_object);
    }
    let mut mirrored: Vec<Option<usize>> = vec![None; meshes.len()];
    for instance in instances {
        if !is_mirrored(&instance.world_from_object) {
            continue;
        }
        instance.world_from_object *= DAffine3::from_scale(MIRROR);
        let original = instance.mesh;
        instance.mesh = *mirrored[original].get_or_insert_with(|| {
            if used_as_is[original] {
                let mut copy = meshes[original].clone();
                mirror(&mut copy);
                meshes.push(copy);
                meshes.len() - 1
            } else {
                mirror(&mut meshes[original]);
                original
            }
        });
    }
}

fn mirror(mesh: &mut Mesh) {
    for [x, _, _] in mesh.positions.iter_mut().chain(&mut mesh.normals) {
        *x = -*x;
    }
    for triangle in mesh.indices.chunks_exact_mut(3) {
        triangle.swap(1, 2);
    }
}
