//! Objects beside the head: table, head rest, bandages and tubes that stand off the skin.

use super::head::Head;
use crate::image::pieces::{Connection, Pieces};
use crate::mesh::Warning;

/// Smaller pieces are noise, in mm³.
const LEAST: f64 = 500.0;

pub(super) fn finding(head: &Head<'_>) -> Option<Warning> {
    let other = &head.skin.other;
    let volume = head.grid.voxel_volume();
    let sizes = Pieces::of(other, Connection::Corners).sizes;
    let volumes: Vec<f64> =
        sizes.iter().map(|&size| size as f64 * volume).filter(|volume| *volume >= LEAST).collect();
    let (pieces, all) = (volumes.len(), volumes.iter().sum::<f64>());
    let detail = format!(
        "{pieces} objects of {:.1} cm3 lie beside the head (table, head rest, bandage, tubes) and are left out",
        all / 1000.0
    );
    let warning = || Warning::new("objects-beside-head", detail).with("objects", pieces as f64);
    (pieces > 0).then(|| warning().with("volume_mm3", all))
}
