//! Movements as text for navigation, and back.

use mechanics::mesh::Vector;
use mechanics::plan::RigidMovement;

use crate::support::transforms;

fn sample() -> RigidMovement {
    let angles = Vector::new(7.0, -5.0, 11.0).map(f64::to_radians);
    let pivot = Vector::new(3.0, 40.0, -50.0);
    RigidMovement::about_pivot(angles, pivot, Vector::new(1.5, -0.7, 5.0))
}

fn bits(entries: &[f64]) -> Vec<u64> {
    entries.iter().map(|entry| entry.to_bits()).collect()
}

fn parameters(text: &str) -> Vec<f64> {
    let line = text.lines().find_map(|line| line.strip_prefix("Parameters: ")).unwrap();
    line.split(' ').map(|word| word.parse().unwrap()).collect()
}

#[test]
fn a_matrix_is_equal_to_the_bit_when_it_is_read_again() {
    let text = sample().to_matrix_text("mandible");
    let again = transforms::of_matrix_text(&text);
    assert_eq!(bits(&again.matrix4()), bits(&sample().matrix4()));
    assert!(text.contains("direction: moves bone"), "{text}");
}

#[test]
fn a_transform_file_holds_the_inverse_to_the_bit_and_resamples() {
    let text = sample().to_itk_text("mandible");
    let (r, t) = (sample().rotation().transpose(), sample().inverse().translation());
    let rows = (0..9).map(|place| r[(place / 3, place % 3)]);
    let wanted: Vec<f64> = rows.chain(t.iter().copied()).collect();
    assert_eq!(bits(&parameters(&text)), bits(&wanted));
    // By the rule of who resamples the file takes where bone came to back to where it was.
    let at = Vector::new(10.0, -60.0, 20.0);
    let moved = sample().apply(&at);
    let p = parameters(&text);
    let back = |row: usize| (0..3).map(|i| p[3 * row + i] * moved[i]).sum::<f64>() + p[9 + row];
    assert!((Vector::new(back(0), back(1), back(2)) - at).amax() < 1e-12);
    // Read again it moves bone.
    let again = transforms::of_itk_text(&text);
    assert_eq!(again.rotation(), sample().rotation());
    assert!((again.apply(&at) - moved).amax() < 1e-12);
}
