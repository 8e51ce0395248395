//! Pictures side by side: each truth, each technique, and where they are seen to differ.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use tyndall_picture::{display, encode_png};
use tyndall_quality::{Image, magma};

use super::escape::escape;
use crate::claim::Claim;
use crate::error::BenchError;
use crate::measures::error_map;
use crate::suite::SceneResult;

/// All pictures of a scene; each technique against the truth of its claim.
pub(super) fn strip(scene: &SceneResult) -> Result<String, BenchError> {
    let mut text = String::new();
    for claim in [Claim::Whole, Claim::OneScattering] {
        let truth = scene.truths.iter().find(|(known, ..)| *known == claim);
        let exhibits: Vec<_> = scene
            .exhibits
            .iter()
            .filter(|exhibit| exhibit.claim == claim)
            .collect();
        if exhibits.is_empty() && truth.is_none() {
            continue;
        }
        text += "<div class=\"strip\">\n";
        if let Some((_, image, origin)) = truth {
            let caption = format!("truth, {}: {origin}", claim.label());
            text += &figure(&[shown(image, scene.exposure_ev)], image, &caption)?;
        }
        for exhibit in exhibits {
            let image = &exhibit.image;
            let mut pictures = vec![shown(image, scene.exposure_ev)];
            let mut caption = exhibit.label.clone();
            if let Some((_, truth, _)) = truth {
                let map = error_map(image, truth)?;
                pictures.push(map.errors.iter().map(|e| magma(*e)).collect());
                caption += &format!("; below: HDR-FLIP, mean {:.4}", map.mean());
            }
            text += &figure(&pictures, image, &caption)?;
        }
        text += "</div>\n";
    }
    Ok(text)
}

fn shown(image: &Image, exposure_ev: f32) -> Vec<[u8; 3]> {
    display(image, exposure_ev)
}

/// Pictures of one size above one another, under one caption.
fn figure(pictures: &[Vec<[u8; 3]>], image: &Image, caption: &str) -> Result<String, BenchError> {
    let (width, height) = (image.width(), image.height());
    let caption = escape(caption);
    let mut text = String::from("<figure>");
    for pixels in pictures {
        text += &format!(
            "<img alt=\"{caption}\" width=\"{width}\" height=\"{height}\" src=\"data:image/png;base64,{}\">",
            STANDARD.encode(encode_png(width, height, pixels)?)
        );
    }
    Ok(format!(
        "{text}<figcaption>{caption}</figcaption></figure>\n"
    ))
}
