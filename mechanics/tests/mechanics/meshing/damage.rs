//! Surfaces of a head damaged at random: each ends in a right mesh, or is refused by name.

use mechanics::mesh::Vector;

use crate::support::damage::{Damage, Ending, Undamaged, print_counts, seeds};
use crate::surfaces::{head, map};

/// A head cut flat at its neck, around a bone that is three quarters of it.
fn made() -> Undamaged {
    let skin = map(&head(5), |x| Vector::new(x.x, x.y, x.z.max(-90.0)));
    let bone = map(&head(4), |x| Vector::new(x.x, x.y, x.z * 0.9) * 0.75);
    Undamaged::new(skin, bone, 8.0)
}

#[test]
fn damaged_surfaces_give_right_meshes_or_are_refused_by_name() {
    let found = made().endings(seeds(2));
    print_counts(&found);
    for ((damage, ending), seeds) in &found {
        let must_end = matches!(damage, Damage::NoPlace | Damage::Cropped);
        let may_end = must_end || matches!(damage, Damage::HalfGone | Damage::Together);
        let wanted = match ending {
            Ending::Right => !must_end,
            Ending::Refused(_) => may_end,
            Ending::Wrong(_) => false,
        };
        assert!(wanted, "{damage:?}: {ending:?} with seeds {seeds:?}");
    }
}
