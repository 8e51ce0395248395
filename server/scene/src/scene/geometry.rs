//! Triangles of a scene: surfaces that stay as they are, instances that may move.

use std::ops::Deref;
use std::sync::{Arc, OnceLock};

use glam::{DAffine3, Vec3};

use super::space::{Aabb, Hull};
use super::tracks::{Placement, Track};

/// Geometry shared between scenes that differ in camera, lights or media only.
///
/// Equality is identity (`Arc::ptr_eq`): two loads of one file are different geometries.
#[derive(Debug, Clone)]
pub struct SharedGeometry(pub Arc<Geometry>);

impl PartialEq for SharedGeometry {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl Deref for SharedGeometry {
    type Target = Geometry;

    fn deref(&self) -> &Geometry {
        &self.0
    }
}

/// All triangles of a scene: what stays as it is, and where it stands.
#[derive(Debug, Clone, Default)]
pub struct Geometry {
    /// Meshes, materials and textures: shared by every placement of them.
    pub surfaces: Arc<Surfaces>,
    /// Placed meshes.
    pub instances: Vec<Instance>,
    /// How instances move; empty if all stand still.
    pub tracks: Arc<Vec<PlacementTrack>>,
}

/// Reads `geometry.meshes` and the like.
impl Deref for Geometry {
    type Target = Surfaces;

    fn deref(&self) -> &Surfaces {
        &self.surfaces
    }
}

impl Geometry {
    /// Whether two geometries are the same meshes, materials and textures in the same order of
    /// instances: at most their placement differs.
    pub fn same_surfaces(&self, other: &Self) -> bool {
        let meshes = self.instances.iter().map(|instance| instance.mesh);
        Arc::ptr_eq(&self.surfaces, &other.surfaces)
            && meshes.eq(other.instances.iter().map(|instance| instance.mesh))
    }

    /// Whether two geometries are the same surfaces in the same places.
    pub fn same_placement(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.surfaces, &other.surfaces) && self.instances == other.instances
    }

    /// Box around a placed instance; `None` for a mesh without vertices. Unit: m.
    pub fn instance_bounds(&self, instance: &Instance) -> Option<Aabb> {
        let local = self.surfaces.mesh_bounds()[instance.mesh]?;
        let mut hull = Hull::default();
        hull.add_placed(&local, &instance.world_from_object);
        hull.bounds()
    }

    /// Box around all instances as they stand; `None` without triangles. Boxes of meshes are placed,
    /// so it is a little too large around rotated ones. Unit: m.
    pub fn bounds(&self) -> Option<Aabb> {
        let mut hull = Hull::default();
        for instance in &self.instances {
            self.surfaces.grow(&mut hull, instance);
        }
        hull.padded()
    }

    /// Box around all instances at all times, the same at every one of them: [`Self::bounds`] if
    /// none moves. Unit: m.
    pub fn swept_bounds(&self) -> Option<Aabb> {
        let mut moves = vec![false; self.instances.len()];
        let mut hull = Hull::default();
        for track in self.tracks.iter() {
            for (index, _) in &track.instances {
                moves[*index] = true;
            }
            if let Some(swept) = track.swept {
                hull.add(swept.min);
                hull.add(swept.max);
            }
        }
        for (instance, moves) in self.instances.iter().zip(moves) {
            if !moves {
                self.surfaces.grow(&mut hull, instance);
            }
        }
        hull.padded()
    }

    /// The geometry at a time, its surfaces shared; `None` if every instance stands there already.
    /// Cost: one product an instance that moves. Unit: s.
    pub(crate) fn at(&self, seconds: f64) -> Option<Self> {
        let mut instances = None;
        for track in self.tracks.iter() {
            let world_from_entry = track.placement.at(seconds).affine();
            for (index, entry_from_object) in &track.instances {
                let world_from_object = world_from_entry * *entry_from_object;
                if self.instances[*index].world_from_object != world_from_object {
                    let moved = instances.get_or_insert_with(|| self.instances.clone());
                    moved[*index].world_from_object = world_from_object;
                }
            }
        }
        instances.map(|instances| Self {
            surfaces: Arc::clone(&self.surfaces),
            instances,
            tracks: Arc::clone(&self.tracks),
        })
    }
}

/// What of a geometry stays as it is wherever its instances stand.
#[derive(Debug, Default)]
pub struct Surfaces {
    /// Object-space triangle meshes.
    pub meshes: Vec<Mesh>,
    /// Surface materials, referred to by `Mesh::material`.
    pub materials: Vec<Material>,
    /// Decoded images, referred to by `TextureRef::texture`.
    pub textures: Vec<Texture>,
    /// Box around each mesh in its own space, found at the first question.
    boxes: OnceLock<Vec<Option<Aabb>>>,
}

impl Clone for Surfaces {
    /// Copies everything but the boxes: a copy is made to be changed.
    fn clone(&self) -> Self {
        Self::new(
            self.meshes.clone(),
            self.materials.clone(),
            self.textures.clone(),
        )
    }
}

impl Surfaces {
    /// Surfaces of checked parts: every index is in bounds.
    pub(crate) fn new(meshes: Vec<Mesh>, materials: Vec<Material>, textures: Vec<Texture>) -> Self {
        Self {
            meshes,
            materials,
            textures,
            boxes: OnceLock::new(),
        }
    }

    /// Box around each mesh in its own space; `None` for one without vertices. The first call
    /// passes over all vertices, the next ones cost nothing. Unit: m.
    pub fn mesh_bounds(&self) -> &[Option<Aabb>] {
        self.boxes.get_or_init(|| {
            let bounds = |mesh: &Mesh| {
                let mut hull = Hull::default();
                for position in &mesh.positions {
                    hull.add(Vec3::from_array(*position).as_dvec3());
                }
                hull.bounds()
            };
            self.meshes.iter().map(bounds).collect()
        })
    }

    /// Adds the box of an instance's mesh, as it is placed.
    fn grow(&self, hull: &mut Hull, instance: &Instance) {
        if let Some(bounds) = &self.mesh_bounds()[instance.mesh] {
            hull.add_placed(bounds, &instance.world_from_object);
        }
    }
}

/// Instances that move together: those of one entry of the description's `geometry`.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacementTrack {
    /// From the entry's space to the world.
    pub placement: Track<Placement>,
    /// Index into `Geometry::instances`, and from that object to the entry.
    pub instances: Vec<(usize, DAffine3)>,
    /// Box around them at all times. Unit: m.
    pub(crate) swept: Option<Aabb>,
}

/// An indexed triangle mesh in object space.
///
/// `normals` has one entry a vertex; `texcoords` and `colors` have either none or one a vertex.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// Name for messages.
    pub name: String,
    /// Vertex positions. Unit: m (before the instance's transform).
    pub positions: Vec<[f32; 3]>,
    /// Unit vertex normals.
    pub normals: Vec<[f32; 3]>,
    /// Two sets of texture coordinates, each empty or one a vertex.
    pub texcoords: [Vec<[f32; 2]>; 2],
    /// Linear vertex colours, 255 = 1; empty means white.
    pub colors: Vec<[u8; 4]>,
    /// Three a triangle; counter-clockwise seen from the front.
    pub indices: Vec<u32>,
    /// Index into `Geometry::materials`.
    pub material: usize,
}

/// A mesh placed in the world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instance {
    /// Index into `Geometry::meshes`.
    pub mesh: usize,
    /// Invertible affine transform.
    pub world_from_object: DAffine3,
}

/// Metallic-roughness surface material (glTF 2.0).
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Name for messages.
    pub name: String,
    /// Linear RGB reflectance and alpha, each in [0, 1]; multiplies the texture.
    pub base_color: [f32; 4],
    /// sRGB texture of base colour and alpha.
    pub base_color_texture: Option<TextureRef>,
    /// Emitted radiance; multiplies the texture. Unit: W·m⁻²·sr⁻¹. Front side only unless `double_sided`.
    pub emission: [f32; 3],
    /// sRGB texture of emission.
    pub emission_texture: Option<TextureRef>,
    /// Range: [0, 1].
    pub metallic: f32,
    /// Perceptual roughness. Range: [0, 1].
    pub roughness: f32,
    /// Linear texture: roughness in G, metallic in B.
    pub metallic_roughness_texture: Option<TextureRef>,
    /// Linear tangent-space normal map.
    pub normal_texture: Option<TextureRef>,
    /// Scale of the normal map's x and y.
    pub normal_scale: f32,
    /// Alpha below this is a hole; `None` is opaque. Range: [0, 1].
    pub alpha_cutoff: Option<f32>,
    /// Both sides reflect; otherwise triangles seen from behind are culled.
    pub double_sided: bool,
}

impl Material {
    /// Whether it is an ideal diffuser: neither metallic nor glossy anywhere.
    pub fn is_diffuse(&self) -> bool {
        self.metallic <= 0.0 && self.roughness >= 1.0 && self.metallic_roughness_texture.is_none()
    }
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: [0.8, 0.8, 0.8, 1.0],
            base_color_texture: None,
            emission: [0.0; 3],
            emission_texture: None,
            metallic: 0.0,
            roughness: 1.0,
            metallic_roughness_texture: None,
            normal_texture: None,
            normal_scale: 1.0,
            alpha_cutoff: None,
            double_sided: false,
        }
    }
}

/// A use of a texture by a material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TextureRef {
    /// Index into `Geometry::textures`.
    pub texture: usize,
    /// Which of `Mesh::texcoords`: 0 or 1.
    pub texcoord_set: u8,
    /// Rows of the 2×3 matrix applied to (u, v, 1): `KHR_texture_transform`.
    pub uv_transform: [[f32; 3]; 2],
}

/// A decoded 8-bit image with its sampler.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    /// Name for messages.
    pub name: String,
    /// Pixels; at least 1.
    pub width: u32,
    /// Pixels; at least 1.
    pub height: u32,
    /// RGBA, row 0 at the top, `4 · width · height` bytes.
    pub pixels: Vec<u8>,
    /// How RGB is encoded; alpha is always linear.
    pub color_space: ColorSpace,
    /// Addressing along u and v.
    pub wrap: [Wrap; 2],
}

/// Encoding of a texture's RGB.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ColorSpace {
    /// IEC 61966-2-1.
    Srgb,
    /// Values are used as they are.
    Linear,
}

/// Texture addressing outside [0, 1).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// Tiles.
    Repeat,
    /// Tiles, every other one mirrored.
    MirroredRepeat,
    /// Repeats the edge texel.
    ClampToEdge,
}
