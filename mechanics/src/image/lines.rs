//! Rows of voxels along one axis of a grid, each handled on its own and many at a time.

use rayon::prelude::*;

/// Voxels along each axis; the first axis is fastest in memory.
pub(crate) type Size = [usize; 3];

/// Calls `apply` with every row along `axis`, in place. `apply` sees one row and nothing else, so that the result does not
/// depend on the number of threads.
pub(crate) fn for_each_line<T: Copy + Default + Send + Sync>(
    values: &mut [T],
    size: Size,
    axis: usize,
    apply: impl Fn(&mut [T]) + Sync,
) {
    match axis {
        0 => values.par_chunks_mut(size[0]).for_each(&apply),
        1 => {
            values.par_chunks_mut(size[0] * size[1]).for_each(|slice| columns(slice, size, &apply))
        }
        _ => across_slices(values, size, &apply),
    }
}

/// The rows along the second axis of one slice.
fn columns<T: Copy + Default>(slice: &mut [T], [nx, ny, _]: Size, apply: &impl Fn(&mut [T])) {
    let mut line = vec![T::default(); ny];
    for x in 0..nx {
        for (y, value) in line.iter_mut().enumerate() {
            *value = slice[y * nx + x];
        }
        apply(&mut line);
        for (y, value) in line.iter().enumerate() {
            slice[y * nx + x] = *value;
        }
    }
}

fn across_slices<T: Copy + Default + Send + Sync>(
    values: &mut [T],
    [nx, ny, nz]: Size,
    apply: &(impl Fn(&mut [T]) + Sync),
) {
    let plane = nx * ny;
    let source = &*values;
    let row_of_lines = |y: usize| {
        let mut lines = vec![T::default(); nx * nz];
        for z in 0..nz {
            for x in 0..nx {
                lines[x * nz + z] = source[z * plane + y * nx + x];
            }
        }
        lines.chunks_mut(nz).for_each(apply);
        lines
    };
    let rows: Vec<Vec<T>> = (0..ny).into_par_iter().map(row_of_lines).collect();
    values.par_chunks_mut(plane).enumerate().for_each(|(z, slice)| {
        for (row, lines) in slice.chunks_mut(nx).zip(&rows) {
            for (x, value) in row.iter_mut().enumerate() {
                *value = lines[x * nz + z];
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_of_an_axis_is_seen_once_and_in_order() {
        let size = [3, 4, 5];
        let start: Vec<u32> = (0..60).collect();
        for (axis, step) in [1, 3, 12].into_iter().enumerate() {
            let mut values = start.clone();
            for_each_line(&mut values, size, axis, |line| {
                assert_eq!(line.len(), size[axis]);
                assert!(line.windows(2).all(|pair| pair[1] == pair[0] + step), "axis {axis}");
                line.iter_mut().for_each(|value| *value += 100);
            });
            assert!(values.iter().zip(&start).all(|(after, before)| *after == before + 100));
        }
    }
}
