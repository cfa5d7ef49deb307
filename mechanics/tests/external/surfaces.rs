//! Distances and registration on the surfaces of a real head: 40 000 triangles of skin, and a bone with holes and slivers.

use mechanics::mesh::{SurfaceSearch, TriangleSurface, Vector};
use mechanics::progress::Unobserved;
use mechanics::registration::{IterativeClosestPoint, RigidTransform};
use mechanics::validation::{Alignment, ComparisonSettings, compare};

use crate::samples::{read_default, surface};
use crate::support::external::{Missing, shared_data, trials};
use crate::support::surfaces::{Noise, brute_force_distance, difference, map, movement};

trials! {
    a_real_skin_that_moved_is_brought_back
    a_dirty_bone_has_a_nearest_point_for_everything
    a_real_skin_against_itself_moved_is_nothing_apart
    a_dirty_bone_is_compared_like_any_other
}

fn shared_surface(file: &str) -> Result<TriangleSurface, Missing> {
    let bytes = std::fs::read(shared_data(file)?).unwrap();
    Ok(surface(read_default(&bytes)))
}

fn closest_point() -> ComparisonSettings {
    ComparisonSettings {
        alignment: Alignment::ClosestPoint { mask: None },
        samples_per_mm2: 0.1,
        ..ComparisonSettings::default()
    }
}

fn a_real_skin_that_moved_is_brought_back() -> Result<(), Missing> {
    let skin = shared_surface("head_ct/headsq_quarter_skin.stl")?;
    let middle = skin.points.iter().sum::<Vector>() / skin.points.len() as f64;
    let turn = movement([5.0, -4.0, 6.0], [0.0; 3]).rotation;
    let wanted = RigidTransform::about(&middle, turn, Vector::new(3.0, -2.0, 4.0));
    let moving = map(&skin, |point| wanted.inverse().apply(point));
    let found = IterativeClosestPoint::default().align(&skin, &moving, &Unobserved).unwrap();
    let (degrees, shift) = difference(&found.transform, &wanted, &wanted.inverse().apply(&middle));
    assert!(degrees < 0.01 && shift < 0.01, "{degrees} degrees, {shift} mm, {found:?}");
    Ok(())
}

fn a_dirty_bone_has_a_nearest_point_for_everything() -> Result<(), Missing> {
    let bone = shared_surface("head_ct/headsq_quarter_bone.stl")?;
    let search = SurfaceSearch::new(&bone).unwrap();
    let (low, high) = bone.bounds();
    let mut random = Noise::new(5);
    for _ in 0..50 {
        let share = Vector::new(random.uniform(), random.uniform(), random.uniform());
        let point = low + (high - low).component_mul(&share);
        let closest = search.closest(&point);
        let tried = brute_force_distance(&bone, &point);
        assert!((closest.distance - tried).abs() < 1e-9, "{closest:?} {tried}");
        assert!(search.signed_distance(&point, &closest).is_finite());
    }
    Ok(())
}

fn a_real_skin_against_itself_moved_is_nothing_apart() -> Result<(), Missing> {
    let skin = shared_surface("head_ct/headsq_quarter_skin.stl")?;
    let actual = map(&skin, |point| movement([3.0, -2.0, 4.0], [1.0, -2.0, 3.0]).apply(point));
    let found = compare(&skin, &actual, &closest_point(), &Unobserved).unwrap();
    assert!(found.distances.both.hausdorff < 0.01, "{:?}", found.distances.both);
    assert!(found.unaligned.unwrap().both.unsigned.mean > 1.0);
    Ok(())
}

fn a_dirty_bone_is_compared_like_any_other() -> Result<(), Missing> {
    let bone = shared_surface("head_ct/headsq_quarter_bone.stl")?;
    let actual = map(&bone, |point| point + Vector::new(0.3, 0.0, 0.0));
    let found = compare(&bone, &actual, &closest_point(), &Unobserved).unwrap();
    assert!(found.distances.both.hausdorff < 0.01, "{:?}", found.distances.both);
    let unaligned = found.unaligned.unwrap().both;
    assert!(unaligned.unsigned.max <= 0.3 + 1e-6 && unaligned.unsigned.mean > 0.1);
    Ok(())
}
