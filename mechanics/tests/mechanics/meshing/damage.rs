//! Surfaces of a head damaged at random: each ends in a right mesh, or is refused by name.

use crate::support::damage::Damage;
use crate::support::damaged::{Ending, Undamaged, made_head, print_counts, seeds};

#[test]
fn damaged_surfaces_give_right_meshes_or_are_refused_by_name() {
    let found = Undamaged::new("head", made_head(), 8.0).endings(seeds(1));
    print_counts(&found);
    for ((damage, ending), seeds) in &found {
        let must_end = matches!(damage, Damage::NoPlace | Damage::Cropped);
        let may_end = must_end || matches!(damage, Damage::HalfGone | Damage::Together);
        let wanted = match ending {
            Ending::Right => !must_end,
            Ending::Refused(_) => may_end,
            Ending::Told(_) | Ending::Silent(_) => false,
        };
        assert!(wanted, "{damage:?}: {ending:?} with seeds {seeds:?}");
    }
}
