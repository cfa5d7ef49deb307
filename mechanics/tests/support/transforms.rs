//! What the texts of rigid movements for navigation say to who reads them.

use mechanics::plan::RigidMovement;

fn numbers(text: &str) -> Vec<f64> {
    text.split_whitespace().map(|word| word.parse().unwrap()).collect()
}

/// The movement of bone of a row-major matrix under comments.
pub fn of_matrix_text(text: &str) -> RigidMovement {
    let rows: Vec<&str> = text.lines().filter(|line| !line.starts_with('#')).collect();
    RigidMovement::from_matrix4(&numbers(&rows.join(" ")).try_into().unwrap()).unwrap()
}

/// The movement of bone of an ITK transform file, which holds its inverse, about a centre.
pub fn of_itk_text(text: &str) -> RigidMovement {
    let line = |name: &str| text.lines().find_map(|line| line.trim().strip_prefix(name)).unwrap();
    let (p, centre) = (numbers(line("Parameters:")), numbers(line("FixedParameters:")));
    let turned = |row: usize| (0..3).map(|i| p[3 * row + i] * centre[i]).sum::<f64>();
    let resampling =
        RigidMovement::from_matrix4(&std::array::from_fn(|place| match (place / 4, place % 4) {
            (3, column) => f64::from(u8::from(column == 3)),
            (row, 3) => p[9 + row] + centre[row] - turned(row),
            (row, column) => p[3 * row + column],
        }));
    resampling.unwrap().inverse()
}
