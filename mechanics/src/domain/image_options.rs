//! What is tissue in an image: thresholds, smoothing, what counts as closed.

use super::limit::Limit;

/// What is tissue in an image. Lengths in mm, values in those of the image.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageOptions {
    /// Below this value there is air.
    pub skin_threshold: f64,
    /// From this value on there is bone.
    pub bone_threshold: f64,
    /// Standard deviation of the Gaussian that smooths the image; 0 for none.
    pub smoothing: f64,
    /// Openings of the skin narrower than this lead into an airway.
    pub airway_opening: f64,
    /// Passages through bone narrower than this lead into a cavity, which counts as bone.
    pub bone_gap: f64,
    /// Where the body is cut off besides the border of the image.
    pub limits: Vec<Limit>,
}

impl Default for ImageOptions {
    /// For Hounsfield units.
    fn default() -> Self {
        ImageOptions {
            skin_threshold: -300.0,
            bone_threshold: 250.0,
            smoothing: 0.8,
            airway_opening: 10.0,
            bone_gap: 5.0,
            limits: Vec::new(),
        }
    }
}
