//! Is the difference of two whole pictures noise?

use tyndall_quality::Image;

/// z-score of the picture's mean under both variances, and the ratio of the means, in one channel.
///
/// # Panics
/// If a picture comes without its variance.
pub fn picture_z(image: &Image, truth: &Image, channel: usize) -> (f64, f64) {
    let sum = |plane: &[[f32; 3]]| plane.iter().map(|p| f64::from(p[channel])).sum::<f64>();
    let own = |image: &Image| sum(image.variance().expect("a picture with its variance"));
    let (found, expected) = (sum(image.rgb()), sum(truth.rgb()));
    let deviation = (own(image) + own(truth)).sqrt();
    ((found - expected) / deviation, found / expected)
}
