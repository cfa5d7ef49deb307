//! Limits on the size of a mesh, checked before memory is taken.

use super::error::FormatError;

/// Deflate makes at most 1032 bytes of one; a header that promises more lies.
pub(super) const MOST_BYTES_OF_ONE: u64 = 1032;

/// Bounds of a reader. The defaults are the published limits of the service.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadLimits {
    pub nodes: u64,
    pub triangles: u64,
    pub cells: u64,
    /// Of an image.
    pub voxels: u64,
    /// Bytes that all compressed arrays of a file may decode to.
    pub decoded_bytes: u64,
    /// The same as a multiple of the whole file. No ratio is asked of a single array: a constant
    /// array of a good file reaches 1000:1.
    pub decoded_ratio: f64,
    /// Files that decode to no more than this pass whatever their ratio: sets of few nodes are almost all zeros, and a mesh with
    /// dozens of them compresses far better than 10:1.
    pub decoded_floor_bytes: u64,
    /// The same for the voxels of an image: a label map of a whole head compresses a hundred times.
    pub image_floor_bytes: u64,
    pub polygon_corners: u64,
    /// Characters in the name of a set or an array.
    pub name_length: u64,
    /// Distinct values of an integer array that makes regions or is selected by value; an array with
    /// more is ignored.
    pub label_values: u64,
}

impl Default for ReadLimits {
    fn default() -> Self {
        ReadLimits {
            nodes: 5_000_000,
            triangles: 10_000_000,
            cells: 4_000_000,
            voxels: 1 << 27,
            decoded_bytes: 512 << 20,
            decoded_ratio: 10.0,
            decoded_floor_bytes: 256 << 20,
            image_floor_bytes: 128 << 20,
            polygon_corners: 64,
            name_length: 128,
            label_values: 4096,
        }
    }
}

impl ReadLimits {
    pub(super) fn check_nodes(&self, declared: u64) -> Result<(), FormatError> {
        within("nodes", declared, self.nodes)
    }

    pub(super) fn check_triangles(&self, declared: u64) -> Result<(), FormatError> {
        within("triangles", declared, self.triangles)
    }

    pub(super) fn check_cells(&self, declared: u64) -> Result<(), FormatError> {
        within("cells", declared, self.cells)
    }

    pub(super) fn check_voxels(&self, declared: u64) -> Result<(), FormatError> {
        within("voxels", declared, self.voxels)
    }

    /// A table that mixes points, lines, polygons and cells cannot be longer than this.
    pub(super) fn check_elements(&self, declared: u64) -> Result<(), FormatError> {
        within("cells", declared, self.cells + self.triangles)
    }

    pub(super) fn check_corners(&self, declared: u64) -> Result<(), FormatError> {
        within("corners in one polygon", declared, self.polygon_corners)
    }

    pub(super) fn decode_budget(&self, file_bytes: usize) -> DecodeBudget {
        self.budget(file_bytes, self.decoded_floor_bytes)
    }

    pub(super) fn image_budget(&self, file_bytes: usize) -> DecodeBudget {
        self.budget(file_bytes, self.image_floor_bytes)
    }

    fn budget(&self, file_bytes: usize, floor: u64) -> DecodeBudget {
        let by_ratio = (file_bytes as f64 * self.decoded_ratio) as u64;
        DecodeBudget { limit: by_ratio.max(floor).min(self.decoded_bytes), used: 0 }
    }
}

fn within(what: &'static str, declared: u64, limit: u64) -> Result<(), FormatError> {
    if declared > limit {
        return Err(FormatError::Limits { what, declared, limit });
    }
    Ok(())
}

/// Remaining budget of bytes that a file may decode to.
pub(super) struct DecodeBudget {
    limit: u64,
    used: u64,
}

impl DecodeBudget {
    /// Of bytes that are in the file as they are.
    pub fn of_stored() -> DecodeBudget {
        DecodeBudget { limit: u64::MAX, used: 0 }
    }

    pub fn remaining(&self) -> u64 {
        self.limit - self.used
    }

    /// Takes `bytes` from the budget, before they are allocated.
    pub fn charge(&mut self, bytes: u64) -> Result<(), FormatError> {
        let declared = self.used.saturating_add(bytes);
        if declared > self.limit {
            return Err(FormatError::DecompressionLimit { declared, limit: self.limit });
        }
        self.used = declared;
        Ok(())
    }
}

/// An empty vector with room for `count` values, or an error where memory does not allow it.
pub(super) fn room_for<T>(count: usize) -> Result<Vec<T>, FormatError> {
    let mut values = Vec::new();
    values.try_reserve_exact(count).map_err(|_| FormatError::Memory { values: count as u64 })?;
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_decodes_to_what_is_harmless_to_ten_times_itself_and_never_to_more_than_any_file() {
        let limits = ReadLimits::default();
        for (file, most) in [(1000, 256 << 20), (40 << 20, 400 << 20), (200 << 20, 512 << 20)] {
            assert_eq!(limits.decode_budget(file).charge(most), Ok(()), "{file}");
            let refused = FormatError::DecompressionLimit { declared: most + 1, limit: most };
            assert_eq!(limits.decode_budget(file).charge(most + 1), Err(refused), "{file}");
        }
        // 4.2 MB of 30 sparse sets.
        assert_eq!(limits.decode_budget(4_200_000).charge(43_600_000), Ok(()));
    }
}
