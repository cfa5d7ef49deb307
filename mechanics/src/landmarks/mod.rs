//! Landmarks of the skin on the profile of its mid-plane, and the parts of the face that they bound.

pub mod mid_plane;
pub mod profile;
pub mod skin_regions;

pub use mid_plane::{FaceAxes, MidPlane};
pub use profile::{Profile, ProfileError, ProfileLandmarks};
pub use skin_regions::skin_regions;
