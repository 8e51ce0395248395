//! What a still consists of, whichever technique made it.

use tyndall_quality::Image;

use crate::PictureError;

/// The planes of a still, row 0 at the top; each optional one is there if the renderer yields it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Layers {
    /// Unit: pixel.
    pub width: u32,
    /// Unit: pixel.
    pub height: u32,
    /// Mean radiance. Unit: W·m⁻²·sr⁻¹ per linear Rec. 709 channel.
    pub beauty: Vec<[f32; 3]>,
    /// The technique's own mean radiance, where `beauty` is that corrected.
    pub base: Option<Vec<[f32; 3]>>,
    /// Mean radiance of the traced samples that corrected it; `variance` is of this one then.
    pub traced: Option<Vec<[f32; 3]>>,
    /// Root of the square error that the correction expects, over the channels. Unit: as `beauty`.
    pub estimated_error: Option<Vec<f32>>,
    /// Mean transmittance to the first surface. Range: [0, 1].
    pub transmittance: Option<Vec<f32>>,
    /// Variance of each pixel's mean: the squared standard error of `beauty`, or of `traced` if that is
    /// there.
    pub variance: Option<Vec<[f32; 3]>>,
    /// Samples in each pixel's mean.
    pub samples: Option<Vec<f32>>,
    /// Distance along the view axis to the first surface; 0 where there is none. Unit: m.
    pub depth: Option<Vec<f32>>,
    /// Unit normal of the first surface in world space; 0 where there is none.
    pub normal: Option<Vec<[f32; 3]>>,
    /// Reflectance of the first surface. Range: [0, 1].
    pub albedo: Option<Vec<[f32; 3]>>,
}

impl Layers {
    /// Radiance and its variance, as measures take it.
    ///
    /// # Errors
    /// [`PictureError::Image`] if the counts of pixels differ.
    pub fn image(&self) -> Result<Image, PictureError> {
        let image = Image::new(self.width, self.height, self.beauty.clone())?;
        let own = self.variance.as_ref().filter(|_| self.traced.is_none());
        Ok(match own {
            Some(variance) => image.with_variance(variance.clone())?,
            None => image,
        })
    }

    /// Only what measures know of a picture.
    pub fn from_image(image: &Image) -> Self {
        Self {
            width: image.width(),
            height: image.height(),
            beauty: image.rgb().to_vec(),
            variance: image.variance().map(<[_]>::to_vec),
            ..Self::default()
        }
    }

    /// Every plane has width × height pixels.
    pub(crate) fn check(&self) -> Result<(), PictureError> {
        let expected = self.width as usize * self.height as usize;
        let lengths = [
            ("beauty", Some(self.beauty.len())),
            ("base", self.base.as_ref().map(Vec::len)),
            ("traced", self.traced.as_ref().map(Vec::len)),
            (
                "estimated_error",
                self.estimated_error.as_ref().map(Vec::len),
            ),
            ("transmittance", self.transmittance.as_ref().map(Vec::len)),
            ("variance", self.variance.as_ref().map(Vec::len)),
            ("samples", self.samples.as_ref().map(Vec::len)),
            ("depth", self.depth.as_ref().map(Vec::len)),
            ("normal", self.normal.as_ref().map(Vec::len)),
            ("albedo", self.albedo.as_ref().map(Vec::len)),
        ];
        for (layer, found) in lengths {
            if let Some(found) = found
                && found != expected
            {
                return Err(PictureError::Layer {
                    layer,
                    found,
                    expected,
                });
            }
        }
        Ok(())
    }
}

/// Where a picture comes from; written as attributes `tyndall.*`.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Metadata {
    /// Name of the scene.
    pub scene: String,
    /// [`crate::scene_hash`] of its description.
    pub scene_hash: String,
    /// What transported the light, by its JSON name.
    pub technique: String,
    /// Seed of every random number.
    pub seed: u64,
    /// Samples a pixel (the mean if they differ, rounded).
    pub samples: u32,
    /// Version of the program.
    pub version: String,
    /// Adapter and driver.
    pub adapter: String,
}

impl Metadata {
    /// The attributes without their prefix.
    pub(crate) fn entries(&self) -> [(&'static str, String); 7] {
        [
            ("scene", self.scene.clone()),
            ("scene_hash", self.scene_hash.clone()),
            ("technique", self.technique.clone()),
            ("seed", self.seed.to_string()),
            ("samples", self.samples.to_string()),
            ("version", self.version.clone()),
            ("adapter", self.adapter.clone()),
        ]
    }

    /// Sets the attribute of this name, if there is one.
    pub(crate) fn set(&mut self, name: &str, value: String) {
        match name {
            "scene" => self.scene = value,
            "scene_hash" => self.scene_hash = value,
            "technique" => self.technique = value,
            "seed" => self.seed = value.parse().unwrap_or_default(),
            "samples" => self.samples = value.parse().unwrap_or_default(),
            "version" => self.version = value,
            "adapter" => self.adapter = value,
            _ => {}
        }
    }
}
