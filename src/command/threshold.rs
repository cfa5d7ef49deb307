//! `facies threshold`: the threshold of bone in one scan at which a bone that nobody moved is as large as in another scan
//! (Zachow et al. 2006).

use std::path::{Path, PathBuf};

use clap::Args;

use super::failure::CommandError;
use super::files::{FileSource, ScaleArguments};
use crate::jobs::{JobError, MeshSource, StoredShape};
use crate::schema::case::document::LengthUnit;
use mechanics::image::equal_volume::{BoneRegion, ThresholdVolume, equal_volume};
use mechanics::image::{Grid, ImageVolume, Mask};
use mechanics::mesh::{Frame, Vector};
use mechanics::registration::SphereOrBox;

#[derive(Debug, Args)]
pub struct Arguments {
    /// The scan whose threshold is known: NRRD, NIfTI, MetaImage or a zip archive of DICOM files
    before: PathBuf,
    /// The scan whose threshold is to be found
    after: PathBuf,
    /// Bone in the first scan is at and above this value
    #[arg(long, value_name = "HU", allow_negative_numbers = true)]
    bone_hu: f64,
    /// A box around a bone that nobody moved, such as the hyoid, in the first scan: its lowest and its highest corner in mm, LPS
    #[arg(long, value_name = "X,Y,Z,X,Y,Z", value_parser = corners, allow_hyphen_values = true)]
    box_before: [f64; 6],
    /// The same bone in the second scan
    #[arg(long, value_name = "X,Y,Z,X,Y,Z", value_parser = corners, allow_hyphen_values = true)]
    box_after: [f64; 6],
    #[command(flatten)]
    scale: ScaleArguments,
}

/// Finds the threshold and prints it with both volumes.
pub fn run(arguments: &Arguments) -> Result<(), CommandError> {
    let before = arguments.bone(&arguments.before, &arguments.box_before)?;
    let after = arguments.bone(&arguments.after, &arguments.box_after)?;
    let region = |(image, region)| BoneRegion { image, region };
    let [first, second] = [&before, &after].map(|(image, mask)| region((image, mask)));
    let found = equal_volume(first, arguments.bone_hu, second).ok_or_else(|| {
        let (hu, place) = (arguments.bone_hu, arguments.before.display());
        CommandError::Usage(format!(
            "no threshold of the second box has the volume of {place} above {hu} HU: there is nothing above it in the first box, the \
             second box is no larger than that, or does not hold the whole bone"
        ))
    })?;
    for (name, ThresholdVolume { threshold, volume }) in ["before", "after"].into_iter().zip(found)
    {
        println!("{name:<10} {threshold:.1} HU: {:.3} ml", volume / 1000.0);
    }
    let [_, after] = found;
    println!(
        "           \"thresholds_hu\": {{\"bone\": {:.1}}} for the second scan",
        after.threshold
    );
    Ok(())
}

impl Arguments {
    /// A scan in LPS, and its voxels in a box.
    fn bone(&self, path: &Path, corners: &[f64; 6]) -> Result<(ImageVolume, Mask), CommandError> {
        let sources = FileSource::new(Path::new(""), LengthUnit::Mm, self.scale);
        let stored = sources.mesh(&path.to_string_lossy()).map_err(JobError::Source)?;
        let StoredShape::Image(image) = &stored.shape else {
            let detail = format!("{} is a mesh, and an image is needed", path.display());
            return Err(CommandError::Usage(detail));
        };
        let image = image.turned(stored.frame.unwrap_or_default(), Frame::Lps);
        let [a, b] = [&corners[..3], &corners[3..]].map(Vector::from_column_slice);
        let region = SphereOrBox::Box { lower: a.inf(&b), upper: a.sup(&b) };
        let grid = Grid::of(&image);
        let is_inside = |voxel: usize| region.holds(&image.centre(grid.index(voxel)));
        let inside: Vec<bool> = (0..grid.len()).map(is_inside).collect();
        if !inside.contains(&true) {
            let (first, last) = image.bounds();
            let detail = format!(
                "no voxel of {} lies in the box {corners:?}: the scan reaches from {:.0?} to {:.0?} mm",
                path.display(),
                first.as_slice(),
                last.as_slice()
            );
            return Err(CommandError::Usage(detail));
        }
        Ok((image, Mask { grid, inside }))
    }
}

fn corners(text: &str) -> Result<[f64; 6], String> {
    let read = |number: &str| number.trim().parse().ok().filter(|value: &f64| value.is_finite());
    let numbers: Option<Vec<f64>> = text.split(',').map(read).collect();
    numbers
        .and_then(|numbers| numbers.try_into().ok())
        .ok_or_else(|| format!("six numbers in mm are needed, and this is {text:?}"))
}
