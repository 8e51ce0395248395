//! glTF 2.0, `.gltf` and `.glb`.
//!
//! The `gltf` crate reads the JSON only. Its own validation and its accessors index without
//! asking, so every index, offset, stride and count is checked here before it is used.

mod accessor;
mod buffers;
mod container;
mod document;
mod file;
mod lights;
mod materials;
mod nodes;
mod primitives;
mod uri;

use gltf::json::Root;

use super::importer::Importer;
use super::transform::initial;
use crate::description::geometry::GltfGeometry;
use crate::error::{SceneError, abbreviate};
use buffers::Buffers;
use document::Document;
use file::File;

/// Required extensions that are honoured. Quantization needs no code beyond accessors that read
/// integers.
const KNOWN: &[&str] = &[
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_unlit",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// Imports the file of entry `index` of `geometry`.
pub(super) fn import(
    importer: &mut Importer,
    index: usize,
    entry: &GltfGeometry,
) -> Result<(), SceneError> {
    let file = File {
        path: format!("geometry[{index}].path"),
        name: &entry.path,
    };
    let bytes = importer.folder.read(&file.path, file.name)?;
    let container = container::read(&file, &bytes)?;
    let root: Root = container.root;
    required_extensions(&file, &root)?;
    let buffers = Buffers::load(&file, &root, container.blob, importer)?;
    let document = Document {
        file: &file,
        root: &root,
        normal_extensions: &container.normal_extensions,
        buffers: &buffers,
    };
    note_left_out(importer, &document);
    let mut walk = nodes::Walk::new(&document, entry, index);
    walk.run(
        importer,
        initial(entry.transform.as_ref(), &entry.keyframes),
    )
}

/// Refuses files that can't be understood without something unknown.
fn required_extensions(file: &File, root: &Root) -> Result<(), SceneError> {
    let unknown = root
        .extensions_required
        .iter()
        .enumerate()
        .find(|(_, name)| !KNOWN.contains(&name.as_str()));
    match unknown {
        None => Ok(()),
        Some((i, name)) => {
            let name = abbreviate(name);
            Err(file.refused(
                format!("extensionsRequired[{i}]"),
                format!(
                    "the file requires \"{name}\", which is not supported; supported are {}",
                    KNOWN.join(", ")
                ),
            ))
        }
    }
}

/// Warns of what a still picture of the file leaves out.
fn note_left_out(importer: &mut Importer, document: &Document) {
    let name = document.file.name;
    let root = document.root;
    if !root.animations.is_empty() {
        let count = root.animations.len();
        importer.warn(format!("{name}: {count} animations left out"));
    }
    if !root.skins.is_empty() {
        importer.warn(format!("{name}: skinned meshes are shown unposed"));
    }
    let morphs = root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    if morphs.clone().any(|primitive| primitive.targets.is_some()) {
        importer.warn(format!("{name}: morph targets left out"));
    }
    if root.samplers.iter().any(picks_texels) {
        importer.warn(format!(
            "{name}: NEAREST filters left out: textures are interpolated"
        ));
    }
    for extension in &root.extensions_used {
        if !KNOWN.contains(&extension.as_str()) {
            let extension = abbreviate(extension);
            importer.warn(format!("{name}: extension \"{extension}\" left out"));
        }
    }
}

/// Whether a sampler takes the nearest texel instead of interpolating.
fn picks_texels(sampler: &gltf::json::texture::Sampler) -> bool {
    use gltf::json::texture::{MagFilter, MinFilter};
    use gltf::json::validation::Checked::Valid;
    let near = sampler.mag_filter == Some(Valid(MagFilter::Nearest));
    let far = matches!(
        sampler.min_filter,
        Some(Valid(
            MinFilter::Nearest | MinFilter::NearestMipmapNearest | MinFilter::NearestMipmapLinear
        ))
    );
    near || far
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_samplers_that_interpolate_go_unremarked() {
        let picks = |json: &str| picks_texels(&serde_json::from_str(json).unwrap());
        assert!(!picks("{}") && !picks(r#"{"magFilter": 9729, "minFilter": 9987}"#));
        assert!(picks(r#"{"magFilter": 9728}"#) && picks(r#"{"minFilter": 9986}"#));
    }
}
