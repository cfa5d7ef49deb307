//! Downsampled images: means of blocks, for inspections of a scan that need no detail.

use rayon::prelude::*;

use super::volume::{ImageError, ImageVolume, Placement, Voxels};

/// The image with no more than so many voxels: pairs of voxels along the finest axis become one until it has. An axis
/// keeps two voxels at least; an odd last one is left out.
pub fn coarsened(image: &ImageVolume, most: usize) -> Result<ImageVolume, ImageError> {
    let mut blocks = [1; 3];
    loop {
        let size = sizes(image, blocks);
        if size.iter().product::<usize>() <= most {
            break;
        }
        let spacing = |axis: usize| image.spacing()[axis] * blocks[axis] as f64;
        let free = (0..3).filter(|&axis| size[axis] >= 4);
        let Some(finest) = free.min_by(|&a, &b| spacing(a).total_cmp(&spacing(b))) else { break };
        blocks[finest] *= 2;
    }
    if blocks == [1; 3] {
        return Ok(image.clone());
    }
    let voxels = match image.voxels() {
        Voxels::I16(values) => means(image, values, blocks),
        Voxels::F32(values) => means(image, values, blocks),
    };
    let Placement { origin, steps } = *image.placement();
    let half_block = |axis: usize| steps[axis] * ((blocks[axis] - 1) as f64 / 2.0);
    let origin = origin + half_block(0) + half_block(1) + half_block(2);
    let steps = [0, 1, 2].map(|axis| steps[axis] * blocks[axis] as f64);
    ImageVolume::new(sizes(image, blocks), Placement { origin, steps }, Voxels::F32(voxels))
}

fn sizes(image: &ImageVolume, blocks: [usize; 3]) -> [usize; 3] {
    [0, 1, 2].map(|axis| image.size()[axis] / blocks[axis])
}

fn means<T: Copy + Into<f64> + Sync>(
    image: &ImageVolume,
    values: &[T],
    blocks: [usize; 3],
) -> Vec<f32> {
    let (from, to) = (image.size(), sizes(image, blocks));
    let mut means = vec![0.0_f32; to.iter().product()];
    let share = 1.0 / blocks.iter().product::<usize>() as f64;
    means.par_chunks_mut(to[0]).enumerate().for_each(|(row, means)| {
        let [j, k] = [row % to[1] * blocks[1], row / to[1] * blocks[2]];
        for (i, mean) in means.iter_mut().enumerate() {
            let mut sum = 0.0;
            for (dj, dk) in (0..blocks[1] * blocks[2]).map(|n| (n % blocks[1], n / blocks[1])) {
                let start = i * blocks[0] + from[0] * (j + dj + from[1] * (k + dk));
                sum += values[start..start + blocks[0]].iter().map(|&v| v.into()).sum::<f64>();
            }
            *mean = (sum * share) as f32;
        }
    });
    means
}
