//! Materials, textures and samplers.

use std::collections::HashMap;

use gltf::json::material::AlphaMode;
use gltf::json::texture::{Info, WrappingMode};
use gltf::json::validation::Checked;

use super::document::Document;
use super::uri;
use crate::error::SceneError;
use crate::import::images::{Image, Source};
use crate::import::importer::{IDENTITY_UV, Importer};
use crate::scene::{ColorSpace, Material, TextureRef, Wrap};

/// Alpha below this is a hole in a blended material.
const BLEND_CUTOFF: f32 = 0.5;
/// Largest emitted radiance. Unit: W·m⁻²·sr⁻¹.
const EMISSION: f32 = 1e9;

/// Materials of one file, converted at their first use.
#[derive(Default)]
pub(super) struct Materials {
    indices: HashMap<Option<usize>, usize>,
}

impl Materials {
    /// The index of a material in the geometry; `None` is glTF's default material.
    pub(super) fn index(
        &mut self,
        document: &Document,
        importer: &mut Importer,
        material: Option<usize>,
        location: &str,
    ) -> Result<usize, SceneError> {
        if let Some(index) = self.indices.get(&material) {
            return Ok(*index);
        }
        let converted = match material {
            None => Material {
                name: "default".to_owned(),
                base_color: [1.0; 4],
                metallic: 1.0,
                ..Material::default()
            },
            Some(index) => {
                let materials = &document.root.materials;
                let found = document
                    .file
                    .element(materials, "materials", index, location)?;
                let location = format!("materials[{index}]");
                let extensions = document.normal_extensions.get(index);
                Converter {
                    document,
                    importer,
                    location,
                    normal_extensions: extensions.cloned().flatten(),
                }
                .material(found)?
            }
        };
        importer.geometry.materials.push(converted);
        let index = importer.geometry.materials.len() - 1;
        self.indices.insert(material, index);
        Ok(index)
    }
}

/// A material under conversion.
struct Converter<'a, 'i> {
    document: &'a Document<'a>,
    importer: &'a mut Importer<'i>,
    location: String,
    /// What the crate does not read.
    normal_extensions: Option<gltf::json::extensions::texture::Info>,
}

impl Converter<'_, '_> {
    fn material(&mut self, json: &gltf::json::Material) -> Result<Material, SceneError> {
        let pbr = &json.pbr_metallic_roughness;
        let base_color = pbr.base_color_factor.0;
        self.unit("pbrMetallicRoughness.baseColorFactor", &base_color)?;
        let metallic = pbr.metallic_factor.0;
        self.unit("pbrMetallicRoughness.metallicFactor", &[metallic])?;
        let roughness = pbr.roughness_factor.0;
        self.unit("pbrMetallicRoughness.roughnessFactor", &[roughness])?;

        let extensions = json.extensions.as_ref();
        let strength = extensions
            .and_then(|extensions| extensions.emissive_strength.as_ref())
            .map_or(1.0, |strength| strength.emissive_strength.0);
        // Radiance, not nits: as exporters write it next to lights in candela.
        let emission = json.emissive_factor.0.map(|factor| factor * strength);
        if let Some(bad) = emission.iter().find(|e| !(0.0..=EMISSION).contains(*e)) {
            let message = format!("factor times strength is {bad}, allowed 0 to 1e9");
            return Err(self.refused("emissiveFactor", message));
        }
        if extensions.is_some_and(|extensions| extensions.unlit.is_some()) {
            self.warn("unlit: shaded like a lit one");
        }

        let (normal_texture, normal_scale) = match &json.normal_texture {
            None => (None, 1.0),
            Some(normal) => {
                let info = Info {
                    index: normal.index,
                    tex_coord: normal.tex_coord,
                    extensions: self.normal_extensions.clone(),
                    extras: normal.extras.clone(),
                };
                if !normal.scale.is_finite() || normal.scale.abs() > 1e3 {
                    let message = format!("{}, allowed −1000 to 1000", normal.scale);
                    return Err(self.refused("normalTexture.scale", message));
                }
                let texture = self.texture(Some(&info), "normalTexture", ColorSpace::Linear)?;
                (texture, normal.scale)
            }
        };
        Ok(Material {
            name: json.name.clone().unwrap_or_else(|| self.location.clone()),
            base_color,
            base_color_texture: self.texture(
                pbr.base_color_texture.as_ref(),
                "pbrMetallicRoughness.baseColorTexture",
                ColorSpace::Srgb,
            )?,
            emission,
            emission_texture: self.texture(
                json.emissive_texture.as_ref(),
                "emissiveTexture",
                ColorSpace::Srgb,
            )?,
            metallic,
            roughness,
            metallic_roughness_texture: self.texture(
                pbr.metallic_roughness_texture.as_ref(),
                "pbrMetallicRoughness.metallicRoughnessTexture",
                ColorSpace::Linear,
            )?,
            normal_texture,
            normal_scale,
            alpha_cutoff: self.alpha_cutoff(json)?,
            double_sided: json.double_sided,
        })
    }

    fn alpha_cutoff(&mut self, json: &gltf::json::Material) -> Result<Option<f32>, SceneError> {
        match json.alpha_mode {
            Checked::Valid(AlphaMode::Opaque) => Ok(None),
            Checked::Valid(AlphaMode::Mask) => {
                let cutoff = json.alpha_cutoff.map_or(0.5, |cutoff| cutoff.0);
                if !cutoff.is_finite() || cutoff < 0.0 {
                    let message = format!("{cutoff}, allowed at least 0");
                    return Err(self.refused("alphaCutoff", message));
                }
                // Above 1 the format means: nothing is visible.
                if cutoff > 1.0 {
                    self.warn("alphaCutoff above 1 taken as 1");
                }
                Ok(Some(cutoff.min(1.0)))
            }
            Checked::Valid(AlphaMode::Blend) => {
                self.warn("blending is approximated by holes where alpha is below 0.5");
                Ok(Some(BLEND_CUTOFF))
            }
            Checked::Invalid => Err(self.refused("alphaMode", "unknown".to_owned())),
        }
    }

    /// A use of a texture, its image decoded.
    fn texture(
        &mut self,
        info: Option<&Info>,
        part: &str,
        color_space: ColorSpace,
    ) -> Result<Option<TextureRef>, SceneError> {
        let Some(info) = info else { return Ok(None) };
        let extensions = info.extensions.as_ref();
        let transform = extensions.and_then(|extensions| extensions.texture_transform.as_ref());
        let set = transform
            .and_then(|transform| transform.tex_coord)
            .unwrap_or(info.tex_coord);
        if set > 1 {
            self.warn(&format!("{part} uses TEXCOORD_{set}: left out"));
            return Ok(None);
        }
        let uv_transform = match transform {
            None => IDENTITY_UV,
            Some(transform) => {
                let ([u, v], [x, y]) = (transform.offset.0, transform.scale.0);
                let (sin, cos) = transform.rotation.0.sin_cos();
                // Scale, then rotation (counter-clockwise in the image, v pointing down), then
                // offset.
                [[cos * x, sin * y, u], [-sin * x, cos * y, v]]
            }
        };
        if uv_transform.iter().flatten().any(|c| !c.is_finite()) {
            let message = "KHR_texture_transform is not finite".to_owned();
            return Err(self.refused(part, message));
        }
        let texture = self.image(info.index.value(), part, color_space)?;
        Ok(Some(TextureRef {
            texture,
            texcoord_set: set as u8,
            uv_transform,
        }))
    }

    /// The texture at `index` of the file as one of the geometry.
    fn image(
        &mut self,
        index: usize,
        part: &str,
        color_space: ColorSpace,
    ) -> Result<usize, SceneError> {
        let (file, root) = (self.document.file, self.document.root);
        let location = format!("{}.{part}", self.location);
        let texture = file.element(&root.textures, "textures", index, &location)?;
        let place = format!("textures[{index}]");
        let wrap = match texture.sampler {
            None => [Wrap::Repeat; 2],
            Some(sampler) => {
                let sampler = file.element(&root.samplers, "samplers", sampler.value(), &place)?;
                [sampler.wrap_s, sampler.wrap_t].map(wrap)
            }
        };
        let index = texture.source.value();
        let image = file.element(&root.images, "images", index, &place)?;
        let source = Source {
            path: file.path.clone(),
            file: file.name.to_owned(),
            location: format!("images[{index}]"),
        };
        let document = self.document;
        self.importer
            .texture(source, color_space, wrap, |importer, source| {
                let bytes = match (&image.uri, image.buffer_view) {
                    (Some(text), _) => {
                        let location = format!("{}.uri", source.location);
                        uri::read(file, importer, text, &location)?
                    }
                    (None, Some(view)) => {
                        let view = document.view(view.value(), &source.location)?;
                        view.bytes.to_vec()
                    }
                    (None, None) => {
                        return Err(
                            file.refused(&source.location, "has neither uri nor bufferView")
                        );
                    }
                };
                Ok(Image { source, bytes })
            })
    }

    /// Every factor in [0, 1].
    fn unit(&self, part: &str, factors: &[f32]) -> Result<(), SceneError> {
        match factors.iter().find(|factor| !(0.0..=1.0).contains(*factor)) {
            None => Ok(()),
            Some(bad) => Err(self.refused(part, format!("{bad}, allowed 0 to 1"))),
        }
    }

    fn refused(&self, part: &str, message: String) -> SceneError {
        let location = format!("{}.{part}", self.location);
        self.document.file.refused(location, message)
    }

    fn warn(&mut self, what: &str) {
        let (file, location) = (self.document.file.name, &self.location);
        let warning = format!("{file}: {location}: {what}");
        self.importer.warn(warning);
    }
}

/// Addressing; an unknown mode counts as the default.
fn wrap(mode: Checked<WrappingMode>) -> Wrap {
    match mode {
        Checked::Valid(WrappingMode::ClampToEdge) => Wrap::ClampToEdge,
        Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::MirroredRepeat,
        Checked::Valid(WrappingMode::Repeat) | Checked::Invalid => Wrap::Repeat,
    }
}
