//! What file a still is to become.

use std::path::Path;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// File format of a still.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Format {
    /// The displayed picture, 8-bit sRGB, lossless.
    #[default]
    Png,
    /// Linear radiance and the other layers, 32-bit float.
    Exr,
    /// The displayed picture, 8-bit sRGB, compressed with quality 95 and full colour detail.
    Jpeg,
}

impl Format {
    /// Every format.
    pub const ALL: [Self; 3] = [Self::Png, Self::Exr, Self::Jpeg];

    /// The format of a file name, by its extension.
    pub fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()? {
            "png" => Some(Self::Png),
            "exr" => Some(Self::Exr),
            "jpg" | "jpeg" => Some(Self::Jpeg),
            _ => None,
        }
    }

    /// The extension of its files.
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::Exr => "exr",
            Self::Jpeg => "jpg",
        }
    }

    /// Its media type.
    pub const fn media_type(self) -> &'static str {
        match self {
            Self::Png => "image/png",
            Self::Exr => "image/x-exr",
            Self::Jpeg => "image/jpeg",
        }
    }
}

/// A plane of an OpenEXR file besides the radiance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Layer {
    /// The technique's own radiance, before traced samples corrected it.
    Base,
    /// The traced radiance.
    Traced,
    /// Error that the correction expects. Unit: as the radiance.
    EstimatedError,
    /// Mean transmittance to the first surface.
    Transmittance,
    /// Variance of each pixel's mean.
    Variance,
    /// Samples of each pixel.
    Samples,
    /// Distance along the view axis to the first surface. Unit: m.
    Depth,
    /// Normal of the first surface in world axes.
    Normal,
    /// Base colour of the first surface.
    Albedo,
}

/// What file is wanted.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Output {
    /// File format.
    pub format: Format,
    /// Layers besides the radiance, of those that the technique yields; all of them if left out. Only an
    /// `exr` has layers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layers: Option<Vec<Layer>>,
}

impl Output {
    /// Everything that a format can hold.
    pub fn whole(format: Format) -> Self {
        Self {
            format,
            layers: None,
        }
    }

    /// Whether a layer is wanted.
    pub fn wants(&self, layer: Layer) -> bool {
        self.layers
            .as_ref()
            .is_none_or(|layers| layers.contains(&layer))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_name_tells_its_format() {
        for format in Format::ALL {
            let name = format!("picture.{}", format.extension());
            assert_eq!(Format::of(Path::new(&name)), Some(format));
        }
        assert_eq!(Format::of(Path::new("a.jpeg")), Some(Format::Jpeg));
        for other in ["a.bmp", "png", ""] {
            assert_eq!(Format::of(Path::new(other)), None, "{other}");
        }
    }
}
