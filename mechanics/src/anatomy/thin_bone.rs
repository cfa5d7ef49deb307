//! Bone thinner than cells: tissue is joined to it all the same, and what of its surface has no node is told.

use crate::domain::Domain;
use crate::mesh::{Vector, Warning};
use crate::osteotomy::Labelled;
use crate::osteotomy::classes::{ClassRules, NodeClasses, Role, TissueBoundary};
use crate::osteotomy::coverage::{Coverage, coverage};
use crate::osteotomy::joining::{MissedBone, join_missed};
use crate::osteotomy::voxel_cells::VoxelCells;

/// A bone without nodes on this share of its surface holds tissue as if it were another.
const MOST_BARE: f64 = 0.1;
/// As does one with such a patch, in mm².
const LARGEST_PATCH: f64 = 200.0;
/// Less surface is noise, in mm².
const LEAST: f64 = 50.0;
/// A bone of which this share is in cells of tissue is thinner than they are, unless that is less than so much, in mm³.
const MOST_IN_CELLS: f64 = 0.1;
const LEAST_IN_CELLS: f64 = 500.0;
const MM2_IN_CM2: f64 = 100.0;
const MM3_IN_ML: f64 = 1000.0;

/// Joins nodes to bone that no cell resolved; returns warnings on bone with surface that no node is near.
pub(super) fn join_thin_bone(
    tissue: TissueBoundary<'_>,
    domain: &dyn Domain,
    (bone, slides): (&Labelled, &(dyn Fn(&Vector) -> bool + Sync)),
    (rules, classes): (&ClassRules, &mut NodeClasses),
) -> Vec<Warning> {
    let cells = VoxelCells::new(tissue.mesh, &bone.labels);
    let missed = MissedBone { labels: &bone.labels, cells: &cells, domain, slides };
    let joined = join_missed(tissue, &missed, rules, classes);
    let segments = bone.segments.len();
    let found = coverage(tissue, (&bone.labels, &cells), slides, (classes, segments));
    let told = |(number, found): (usize, &Coverage)| {
        let (name, role, volume) = match bone.segments.get(number) {
            Some(segment) => {
                let name = format!("segment `{}`", segment.name);
                (name, Role::Joined(number), segment.volume_mm3)
            }
            None => {
                let of_segments: f64 = bone.segments.iter().map(|segment| segment.volume_mm3).sum();
                ("bone that stays".to_owned(), Role::Fixed, bone.labels.volume() - of_segments)
            }
        };
        let joined = joined.iter().filter(|node| classes.roles[**node as usize] == role).count();
        warning(&name, found, volume, joined)
    };
    found.iter().enumerate().filter_map(told).collect()
}

/// On a bone of some volume, and of so many nodes that were joined to it.
fn warning(name: &str, found: &Coverage, volume: f64, joined: usize) -> Option<Warning> {
    let Coverage { area, bare, patch, patch_at, in_cells } = *found;
    let share = bare / area.max(f64::MIN_POSITIVE);
    let is_bare = patch > LARGEST_PATCH || share > MOST_BARE && bare > LEAST;
    let is_lost = in_cells > MOST_IN_CELLS * volume && in_cells > LEAST_IN_CELLS;
    let [x, y, z] = patch_at.into();
    let held = match is_bare {
        true => format!(
            "{:.1} of {:.1} cm² of its surface beside tissue ({:.0} %) have no node of it within one and a half cells, the largest patch \
             {:.1} cm² around ({x:.0}, {y:.0}, {z:.0}) mm: it neither holds nor moves tissue there",
            bare / MM2_IN_CM2,
            area / MM2_IN_CM2,
            100.0 * share,
            patch / MM2_IN_CM2
        ),
        false => "they hold and move the tissue around it, but it has no wall and no volume there"
            .to_owned(),
    };
    let detail = format!(
        "{name}: {:.1} of {:.1} ml of bone are thinner than cells and meshed as tissue, with {joined} nodes of it joined to the bone; {held}; \
         more tetrahedra, or `size.fine` there, resolve it",
        in_cells / MM3_IN_ML,
        volume / MM3_IN_ML
    );
    let warning = || {
        let warning =
            Warning::new("thin-bone-lost", detail).with("volume_ml", in_cells / MM3_IN_ML);
        warning.with("uncovered_mm2", bare).with("share", share).with("nodes", joined as f64)
    };
    (is_bare || is_lost).then(warning)
}
