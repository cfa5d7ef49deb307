//! Reduction of an image by the means of blocks of voxels.

use rayon::prelude::*;

use super::volume::{ImageError, ImageVolume, Placement, Voxels};
use crate::mesh::Vector;

/// By how much a length grows until the voxels are few enough.
const GROWTH: f64 = 1.1;

/// The image itself where it has at most `most` voxels; otherwise blocks of whole voxels, about as long along each axis as
/// along the others. Voxels beyond the last whole block are left out.
pub fn reduced(image: &ImageVolume, most: usize) -> Result<ImageVolume, ImageError> {
    let block = block(image, most);
    if block == [1; 3] {
        return Ok(image.clone());
    }
    let fine = image.size();
    let size: [usize; 3] = std::array::from_fn(|axis| fine[axis] / block[axis]);
    let steps: [Vector; 3] =
        std::array::from_fn(|axis| image.placement().steps[axis] * block[axis] as f64);
    // The middle of the first block.
    let middle = image.placement().steps.iter().zip(block);
    let origin = middle.fold(image.placement().origin, |sum, (step, count)| {
        sum + step * (0.5 * (count - 1) as f64)
    });
    let mean = |n: usize| {
        let place = [n % size[0], n / size[0] % size[1], n / (size[0] * size[1])];
        let first: [usize; 3] = std::array::from_fn(|axis| place[axis] * block[axis]);
        block_mean(image, first, block)
    };
    let values = (0..size.iter().product()).into_par_iter().map(mean).collect();
    ImageVolume::new(size, Placement { origin, steps }, Voxels::F32(values))
}

/// Voxels of a block along each axis.
fn block(image: &ImageVolume, most: usize) -> [usize; 3] {
    let (size, spacing) = (image.size(), image.spacing());
    let mut length = spacing.iter().copied().fold(f64::INFINITY, f64::min);
    loop {
        let block: [usize; 3] = std::array::from_fn(|axis| {
            let count = (length / spacing[axis]).round() as usize;
            // Two blocks are the least that an image can have.
            count.clamp(1, (size[axis] / 2).max(1))
        });
        let voxels: usize = (0..3).map(|axis| size[axis] / block[axis]).product();
        let is_coarsest = (0..3).all(|axis| block[axis] >= (size[axis] / 2).max(1));
        if voxels <= most || is_coarsest {
            return block;
        }
        length *= GROWTH;
    }
}

fn block_mean(image: &ImageVolume, first: [usize; 3], block: [usize; 3]) -> f32 {
    let [nx, ny, _] = image.size();
    let mut sum = 0.0;
    for z in first[2]..first[2] + block[2] {
        for y in first[1]..first[1] + block[1] {
            let start = (z * ny + y) * nx + first[0];
            let row = start..start + block[0];
            sum += match image.voxels() {
                Voxels::I16(values) => {
                    values[row].iter().map(|&value| f64::from(value)).sum::<f64>()
                }
                Voxels::F32(values) => values[row].iter().map(|&value| f64::from(value)).sum(),
            };
        }
    }
    (sum / block.iter().product::<usize>() as f64) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A linear field, whose means are its values at the middles of the blocks.
    fn image() -> ImageVolume {
        let steps = [Vector::x() * 0.5, Vector::y() * 0.5, Vector::z() * 2.0];
        let placement = Placement { origin: Vector::new(3.0, -4.0, 5.0), steps };
        let values = (0..9 * 8 * 5).map(|n| (n % 9) as i16 + 20 * (n / 72) as i16).collect();
        ImageVolume::new([9, 8, 5], placement, Voxels::I16(values)).unwrap()
    }

    #[test]
    fn blocks_are_as_long_along_each_axis_and_keep_a_linear_field() {
        let image = image();
        let coarse = reduced(&image, 100).unwrap();
        assert_eq!(coarse.size(), [4, 4, 5]);
        assert_eq!(coarse.spacing(), [1.0, 1.0, 2.0]);
        for index in [[0, 0, 0], [1, 2, 3], [3, 3, 4]] {
            let centre = coarse.centre(index);
            let (found, wanted) = (coarse.at(&centre).unwrap(), image.at(&centre).unwrap());
            assert!((found - wanted).abs() < 1e-5, "{index:?}: {found} {wanted}");
        }
    }

    #[test]
    fn an_image_that_is_small_enough_stays_and_none_is_thinner_than_two_voxels() {
        let image = image();
        assert_eq!(reduced(&image, 360).unwrap(), image);
        assert_eq!(reduced(&image, 1).unwrap().size(), [2, 2, 2]);
    }
}
