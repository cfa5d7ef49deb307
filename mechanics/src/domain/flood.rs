//! Flood fill of voxels over their six neighbours.

/// Voxels along each axis; the first axis is fastest in memory.
pub(super) type Size = [usize; 3];

pub(super) fn place(voxel: usize, [nx, ny, _]: Size) -> [usize; 3] {
    [voxel % nx, voxel / nx % ny, voxel / (nx * ny)]
}

/// The voxels that share a face with a voxel.
pub(super) fn neighbours(voxel: usize, size: Size) -> impl Iterator<Item = usize> {
    let index = place(voxel, size);
    let step = [1, size[0], size[0] * size[1]];
    let beside: [Option<usize>; 6] = std::array::from_fn(|side| {
        let axis = side / 2;
        match side % 2 {
            0 => (index[axis] > 0).then(|| voxel - step[axis]),
            _ => (index[axis] + 1 < size[axis]).then(|| voxel + step[axis]),
        }
    });
    beside.into_iter().flatten()
}

/// How many axes see a voxel at their first or last place: 1 on a face of the image, 2 or 3 on its edges.
pub(super) fn borders(voxel: usize, size: Size) -> usize {
    let index = place(voxel, size);
    (0..3).filter(|&axis| index[axis] == 0 || index[axis] + 1 == size[axis]).count()
}

/// All voxels that hang together with a seed through voxels for which `passes` holds; seeds must pass themselves.
pub(super) fn flood(
    size: Size,
    seeds: impl Iterator<Item = usize>,
    passes: impl Fn(usize) -> bool,
) -> Vec<bool> {
    let mut reached = vec![false; size.iter().product()];
    let mut waiting = Vec::new();
    for seed in seeds {
        if passes(seed) && !std::mem::replace(&mut reached[seed], true) {
            waiting.push(seed);
        }
    }
    while let Some(voxel) = waiting.pop() {
        for next in neighbours(voxel, size) {
            if !reached[next] && passes(next) {
                reached[next] = true;
                waiting.push(next);
            }
        }
    }
    reached
}

/// The largest set of voxels that hang together and for which `counts` holds, the first of equal ones.
pub(super) fn largest_piece(size: Size, counts: impl Fn(usize) -> bool) -> Vec<bool> {
    let (piece_of, sizes) = pieces(size, counts);
    let most = sizes.iter().copied().max().unwrap_or(0);
    let largest = sizes.iter().position(|&size| size == most).map_or(u32::MAX, |n| n as u32);
    piece_of.iter().map(|&piece| piece != u32::MAX && piece == largest).collect()
}

/// In voxels, the sets that hang together and for which `counts` holds.
pub(super) fn piece_sizes(size: Size, counts: impl Fn(usize) -> bool) -> Vec<usize> {
    pieces(size, counts).1
}

/// The set of each voxel, `u32::MAX` for none, and how many voxels each has.
fn pieces(size: Size, counts: impl Fn(usize) -> bool) -> (Vec<u32>, Vec<usize>) {
    let mut piece_of = vec![u32::MAX; size.iter().product()];
    let mut sizes: Vec<usize> = Vec::new();
    let mut waiting = Vec::new();
    for first in 0..piece_of.len() {
        if piece_of[first] != u32::MAX || !counts(first) {
            continue;
        }
        let piece = sizes.len() as u32;
        sizes.push(0);
        piece_of[first] = piece;
        waiting.push(first);
        while let Some(voxel) = waiting.pop() {
            sizes[piece as usize] += 1;
            for next in neighbours(voxel, size) {
                if piece_of[next] == u32::MAX && counts(next) {
                    piece_of[next] = piece;
                    waiting.push(next);
                }
            }
        }
    }
    (piece_of, sizes)
}

/// Gives every voxel for which `passes` holds the mark of the nearest marked one, by steps from voxel to voxel. Where two
/// are equally near, that of the lower voxel of the earlier step counts.
pub(super) fn spread<M: Copy>(size: Size, marks: &mut [Option<M>], passes: impl Fn(usize) -> bool) {
    let mut front: Vec<usize> = (0..marks.len()).filter(|&voxel| marks[voxel].is_some()).collect();
    while !front.is_empty() {
        let mut next_front = Vec::new();
        for voxel in front {
            for next in neighbours(voxel, size) {
                if marks[next].is_none() && passes(next) {
                    marks[next] = marks[voxel];
                    next_front.push(next);
                }
            }
        }
        front = next_front;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn water_goes_through_open_voxels_alone() {
        let size = [5, 3, 2];
        // A wall at x = 2, open at one voxel.
        let open = |hole: bool| move |voxel: usize| voxel % 5 != 2 || (hole && voxel == 2);
        let count = |reached: Vec<bool>| reached.into_iter().filter(|&wet| wet).count();
        assert_eq!(count(flood(size, [0].into_iter(), open(false))), 12);
        assert_eq!(count(flood(size, [0].into_iter(), open(true))), 25);
        assert_eq!(count(flood(size, [2].into_iter(), open(false))), 0);
    }

    #[test]
    fn the_largest_piece_is_kept() {
        let size = [7, 2, 1];
        let piece = largest_piece(size, |voxel| voxel % 7 != 2);
        let kept: Vec<usize> = (0..14).filter(|&voxel| piece[voxel]).collect();
        assert_eq!(kept, [3, 4, 5, 6, 10, 11, 12, 13]);
        assert!(largest_piece(size, |_| false).iter().all(|&kept| !kept));
    }

    #[test]
    fn marks_meet_half_way() {
        let mut marks = [Some('a'), None, None, None, None, None, Some('b')];
        spread([7, 1, 1], &mut marks, |voxel| voxel != 5);
        assert_eq!(marks.map(|mark| mark.unwrap_or('-')), ['a', 'a', 'a', 'a', 'a', '-', 'b']);
    }
}
