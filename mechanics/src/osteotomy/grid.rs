//! Voxels by one number, the first axis fastest, and the voxels across their faces.

use crate::image::ImageVolume;
use crate::mesh::Vector;

/// The grid of an image.
pub(super) struct Grid<'a> {
    image: &'a ImageVolume,
    size: [usize; 3],
    strides: [usize; 3],
}

/// A voxel across a face, and the axis that the face lies across.
#[derive(Clone, Copy)]
pub(super) struct Neighbour {
    pub voxel: usize,
    pub axis: usize,
}

impl<'a> Grid<'a> {
    pub fn new(image: &'a ImageVolume) -> Self {
        let size = image.size();
        Grid { image, size, strides: [1, size[0], size[0] * size[1]] }
    }

    pub fn len(&self) -> usize {
        self.size.iter().product()
    }

    pub fn place(&self, voxel: usize) -> [usize; 3] {
        let [x, y, _] = self.size;
        [voxel % x, voxel / x % y, voxel / (x * y)]
    }

    /// The centre of a voxel in mm.
    pub fn centre(&self, voxel: usize) -> Vector {
        self.image.centre(self.place(voxel))
    }

    /// The voxels across the faces of one, six inside the image.
    pub fn neighbours(&self, voxel: usize) -> impl Iterator<Item = Neighbour> + use<> {
        let (place, size, strides) = (self.place(voxel), self.size, self.strides);
        (0..3).flat_map(move |axis| {
            let before = (place[axis] > 0).then(|| voxel - strides[axis]);
            let after = (place[axis] + 1 < size[axis]).then(|| voxel + strides[axis]);
            [before, after].into_iter().flatten().map(move |voxel| Neighbour { voxel, axis })
        })
    }

    /// The voxels across the faces of one that come after it, so that each pair is met once.
    pub fn later_neighbours(&self, voxel: usize) -> impl Iterator<Item = Neighbour> + use<> {
        self.neighbours(voxel).filter(move |neighbour| neighbour.voxel > voxel)
    }

    /// The face across an axis: along its normal, as long as its area in mm².
    pub fn face(&self, axis: usize) -> Vector {
        let steps = self.image.placement().steps;
        steps[(axis + 1) % 3].cross(&steps[(axis + 2) % 3])
    }
}
