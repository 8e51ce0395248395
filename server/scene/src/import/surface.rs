//! From raw triangles to a mesh that keeps its promises: finite, indices in range, no slivers
//! without area, unit normals.

use glam::{DVec3, Vec3};

use crate::scene::Mesh;

/// A triangle is dropped if `|e₁×e₂|² ≤ this · |e_max|⁴`: its normal would be noise.
const DEGENERATE: f64 = 1e-14;
/// Largest coordinate of a vertex; keeps squares finite in `f32`. Unit: m.
const COORDINATE: f32 = 1e9;

/// Triangles as a file gave them.
#[derive(Debug, Default)]
pub(super) struct RawMesh {
    pub(super) name: String,
    pub(super) positions: Vec<[f32; 3]>,
    /// One a vertex, or `None`: flat normals are computed.
    pub(super) normals: Option<Vec<[f32; 3]>>,
    pub(super) texcoords: [Vec<[f32; 2]>; 2],
    pub(super) colors: Vec<[u8; 4]>,
    pub(super) indices: Vec<u32>,
    pub(super) material: usize,
}

/// A mesh and what its cleaning left out.
#[derive(Debug)]
pub(super) struct Cleaned {
    /// `None` if no triangle is left.
    pub(super) mesh: Option<Mesh>,
    /// Triangles without area.
    pub(super) degenerate: usize,
    /// Normals that had no direction, replaced by the triangle's.
    pub(super) bad_normals: usize,
}

/// Why a mesh was refused: where in it, and what is wrong.
#[derive(Debug)]
pub(super) struct Refused {
    pub(super) part: &'static str,
    pub(super) message: String,
}

fn refused(part: &'static str, message: String) -> Refused {
    Refused { part, message }
}

/// Checks and cleans a mesh.
pub(super) fn clean(mut raw: RawMesh) -> Result<Cleaned, Refused> {
    check(&raw)?;
    let all = raw.indices.len() / 3;
    let positions = &raw.positions;
    let mut kept = Vec::with_capacity(raw.indices.len());
    for triangle in raw.indices.as_chunks::<3>().0 {
        if has_area(triangle.map(|i| positions[i as usize])) {
            kept.extend_from_slice(triangle);
        }
    }
    let degenerate = all - kept.len() / 3;
    raw.indices = kept;
    if raw.indices.is_empty() {
        return Ok(Cleaned {
            mesh: None,
            degenerate,
            bad_normals: 0,
        });
    }
    let (normals, bad_normals) = match raw.normals.take() {
        Some(normals) => unit_normals(normals, &raw.positions, &raw.indices),
        None => (flatten(&mut raw), 0),
    };
    let mesh = Mesh {
        name: raw.name,
        positions: raw.positions,
        normals,
        texcoords: raw.texcoords,
        colors: raw.colors,
        indices: raw.indices,
        material: raw.material,
    };
    Ok(Cleaned {
        mesh: Some(mesh),
        degenerate,
        bad_normals,
    })
}

/// Sizes agree, positions and texture coordinates are finite, indices are in range.
fn check(raw: &RawMesh) -> Result<(), Refused> {
    let vertices = raw.positions.len();
    for (i, position) in raw.positions.iter().enumerate() {
        if let Some(bad) = position
            .iter()
            .find(|c| !(-COORDINATE..=COORDINATE).contains(*c))
        {
            let message = format!("vertex {i} has the coordinate {bad}, allowed −1e9 to 1e9");
            return Err(refused("POSITION", message));
        }
    }
    let counts = [
        ("NORMAL", raw.normals.as_ref().map_or(vertices, Vec::len)),
        ("TEXCOORD_0", or_none(raw.texcoords[0].len(), vertices)),
        ("TEXCOORD_1", or_none(raw.texcoords[1].len(), vertices)),
        ("COLOR_0", or_none(raw.colors.len(), vertices)),
    ];
    for (part, count) in counts {
        if count != vertices {
            let message = format!("{count} entries, but POSITION has {vertices}");
            return Err(refused(part, message));
        }
    }
    for (part, texcoords) in ["TEXCOORD_0", "TEXCOORD_1"].iter().zip(&raw.texcoords) {
        if let Some(i) = texcoords
            .iter()
            .position(|uv| !uv.iter().all(|c| c.is_finite()))
        {
            return Err(refused(part, format!("vertex {i} is not finite")));
        }
    }
    if !raw.indices.len().is_multiple_of(3) {
        let message = format!("{} indices, not a multiple of 3", raw.indices.len());
        return Err(refused("indices", message));
    }
    match raw.indices.iter().find(|i| **i as usize >= vertices) {
        Some(index) => {
            let message = format!("index {index} is out of range, there are {vertices} vertices");
            Err(refused("indices", message))
        }
        None => Ok(()),
    }
}

/// An absent attribute counts as one of the right size.
fn or_none(count: usize, vertices: usize) -> usize {
    if count == 0 { vertices } else { count }
}

/// Whether a triangle's normal is more than rounding.
fn has_area(corners: [[f32; 3]; 3]) -> bool {
    let [a, b, c] = corners.map(|p| Vec3::from_array(p).as_dvec3());
    let (e1, e2, e3) = (b - a, c - a, c - b);
    let longest = [e1, e2, e3]
        .map(DVec3::length_squared)
        .into_iter()
        .fold(0.0, f64::max);
    e1.cross(e2).length_squared() > DEGENERATE * longest * longest
}

/// The unit normal of a triangle with area.
fn face_normal(corners: [[f32; 3]; 3]) -> [f32; 3] {
    let [a, b, c] = corners.map(|p| Vec3::from_array(p).as_dvec3());
    let normal = (b - a).cross(c - a);
    (normal / normal.length()).as_vec3().to_array()
}

/// Normalizes normals; those without a direction take their triangle's.
fn unit_normals(
    mut normals: Vec<[f32; 3]>,
    positions: &[[f32; 3]],
    indices: &[u32],
) -> (Vec<[f32; 3]>, usize) {
    let mut bad = vec![false; normals.len()];
    for (normal, bad) in normals.iter_mut().zip(&mut bad) {
        let wide = Vec3::from_array(*normal).as_dvec3();
        let length = wide.length();
        if length.is_finite() && length > 1e-12 {
            *normal = (wide / length).as_vec3().to_array();
        } else {
            *normal = [0.0, 1.0, 0.0];
            *bad = true;
        }
    }
    let mut replaced = 0;
    for triangle in indices.as_chunks::<3>().0 {
        for vertex in triangle.map(|i| i as usize) {
            if std::mem::take(&mut bad[vertex]) {
                normals[vertex] = face_normal(triangle.map(|i| positions[i as usize]));
                replaced += 1;
            }
        }
    }
    (normals, replaced)
}

/// Gives every triangle its own three vertices and returns their flat normals.
fn flatten(raw: &mut RawMesh) -> Vec<[f32; 3]> {
    let indices = std::mem::take(&mut raw.indices);
    raw.positions = spread(&raw.positions, &indices);
    raw.texcoords = [0, 1].map(|set| spread(&raw.texcoords[set], &indices));
    raw.colors = spread(&raw.colors, &indices);
    raw.indices = (0..indices.len() as u32).collect();
    let corners = raw.positions.as_chunks::<3>().0;
    corners.iter().flat_map(|c| [face_normal(*c); 3]).collect()
}

/// One entry an index; nothing from nothing.
fn spread<T: Copy>(values: &[T], indices: &[u32]) -> Vec<T> {
    if values.is_empty() {
        return Vec::new();
    }
    indices.iter().map(|i| values[*i as usize]).collect()
}
