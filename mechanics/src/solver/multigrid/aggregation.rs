//! Aggregates of neighbouring rows, the unknowns of a coarser level.

use super::strength_of_connection::StrengthOfConnection;

/// Not in a group yet.
const NONE: u32 = u32::MAX;

/// For each row its group: grown from the lowest free row over its neighbours up to `size` rows.
/// A group of less than a quarter of that joins the neighbour it is tied to most. Groups are numbered in the
/// order of their lowest rows.
pub(super) fn aggregate(strength: &StrengthOfConnection, size: usize) -> (Vec<u32>, usize) {
    let mut group = vec![NONE; strength.rows()];
    let mut sizes: Vec<usize> = Vec::new();
    let mut members: Vec<usize> = Vec::with_capacity(size);
    for seed in 0..strength.rows() {
        if group[seed] != NONE {
            continue;
        }
        let number = sizes.len() as u32;
        members.clear();
        members.push(seed);
        group[seed] = number;
        let mut next = 0;
        while next < members.len() && members.len() < size {
            for (column, tie) in strength.of(members[next]) {
                if members.len() < size && group[column] == NONE && tie > 0.0 {
                    group[column] = number;
                    members.push(column);
                }
            }
            next += 1;
        }
        sizes.push(members.len());
        if 4 * members.len() < size
            && let Some(host) = strongest_neighbour(strength, &members, &group, number)
        {
            members.iter().for_each(|&row| group[row] = host);
            sizes[host as usize] += members.len();
            sizes.pop();
        }
    }
    (group, sizes.len())
}

/// The group to which the members are tied most; `None` where they have no neighbour in another group.
fn strongest_neighbour(
    strength: &StrengthOfConnection,
    members: &[usize],
    group: &[u32],
    own: u32,
) -> Option<u32> {
    let mut sums: Vec<(u32, f32)> = Vec::new();
    for &row in members {
        for (column, tie) in strength.of(row) {
            let other = group[column];
            if other == NONE || other == own || tie == 0.0 {
                continue;
            }
            match sums.iter_mut().find(|(known, _)| *known == other) {
                Some((_, sum)) => *sum += tie,
                None => sums.push((other, tie)),
            }
        }
    }
    sums.into_iter().max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0))).map(|(other, _)| other)
}
