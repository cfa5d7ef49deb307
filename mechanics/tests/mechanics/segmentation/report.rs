//! What is said of a scan, each finding alone.

use mechanics::image::{ImageVolume, Placement, ScanReport, Voxels, scan_report};
use mechanics::mesh::{Frame, Vector, Warning};

use super::head::{Made, PLAIN, made};
use super::image;

/// What is said of every made head: it is cut below, and its voxels are 2 mm.
fn codes(report: &ScanReport) -> Vec<&str> {
    report.findings.iter().map(|finding| finding.code).collect()
}

fn finding<'a>(report: &'a ScanReport, code: &str) -> &'a Warning {
    let found = report.findings.iter().find(|finding| finding.code == code);
    found.unwrap_or_else(|| panic!("no {code}: {report:?}"))
}

fn number(warning: &Warning, name: &str) -> f64 {
    warning.numbers.iter().find(|(known, _)| *known == name).unwrap().1
}

#[test]
fn a_good_scan_of_a_head_is_cut_at_the_neck_and_nothing_else() {
    let report = scan_report(&made(PLAIN), Frame::Lps);
    assert_eq!(codes(&report), ["field-of-view-cut"], "{report:?}");
    let cut = finding(&report, "field-of-view-cut");
    assert_eq!(cut.numbers.len(), 1);
    let neck = std::f64::consts::PI * 35.0 * 35.0;
    assert!((number(cut, "bottom_mm2") / neck - 1.0).abs() < 0.03, "{cut:?}");
}

#[test]
fn a_head_that_leaves_the_image_at_the_side_is_reported_with_the_side() {
    for (aside, side) in [(45.0, "left_mm2"), (-45.0, "right_mm2")] {
        let report = scan_report(&made(Made { aside, ..PLAIN }), Frame::Lps);
        let cut = finding(&report, "field-of-view-cut");
        assert!(number(cut, side) > 5000.0, "{cut:?}");
    }
}

#[test]
fn an_open_mouth_is_reported_with_its_gap() {
    for gap in [4.0, 10.0] {
        let report = scan_report(&made(Made { gap, ..PLAIN }), Frame::Lps);
        let found = number(finding(&report, "mouth-open"), "gap_mm");
        assert!((found - gap).abs() <= 2.0, "{gap}: {found}");
    }
}

#[test]
fn a_table_is_reported_with_its_volume() {
    let report = scan_report(&made(Made { table: true, ..PLAIN }), Frame::Lps);
    let table = finding(&report, "objects-beside-head");
    assert_eq!(number(table, "objects"), 1.0);
    // Four layers of 1.5 mm, 150 mm wide and 200 mm high.
    assert!((number(table, "volume_mm3") / (6.0 * 150.0 * 200.0) - 1.0).abs() < 1e-9, "{table:?}");
}

#[test]
fn teeth_that_join_the_jaws_are_reported() {
    let report = scan_report(&made(Made { bite: true, ..PLAIN }), Frame::Lps);
    assert!(codes(&report).contains(&"jaws-touch"), "{report:?}");
}

#[test]
fn metal_is_reported_where_it_throws_streaks() {
    let report = scan_report(&made(Made { metal: true, ..PLAIN }), Frame::Lps);
    let metal = finding(&report, "metal-streaks");
    assert!(number(metal, "near_hu") > 5.0 * number(metal, "far_hu"), "{metal:?}");
}

#[test]
fn coarse_voxels_are_reported() {
    let fine = made(PLAIN);
    let mut placement = *fine.placement();
    placement.steps[2] *= 1.5;
    let coarse = ImageVolume::new(fine.size(), placement, fine.voxels().clone()).unwrap();
    let report = scan_report(&coarse, Frame::Lps);
    assert_eq!(number(finding(&report, "scan-coarse"), "largest_mm"), 3.0);
}

#[test]
fn values_that_are_no_hounsfield_units_are_reported_and_nothing_is_read_into_them() {
    let shifted = |by: f32| {
        let scan = made(PLAIN);
        let Voxels::F32(values) = scan.voxels() else { panic!() };
        let values = values.iter().map(|v| v + by).collect();
        ImageVolume::new(scan.size(), *scan.placement(), Voxels::F32(values)).unwrap()
    };
    for by in [1024.0, 150.0, 5000.0] {
        let report = scan_report(&shifted(by), Frame::Lps);
        assert_eq!(codes(&report), ["no-hounsfield"], "{by}: {report:?}");
    }
    let flat = image([10, 10, 10], [1.0; 3], |_| 7.0);
    assert_eq!(codes(&scan_report(&flat, Frame::Lps)), ["no-hounsfield"]);
}

#[test]
fn padding_is_told_and_hides_no_finding() {
    let scan = made(Made { gap: 6.0, table: true, ..PLAIN });
    let wanted = scan_report(&scan, Frame::Lps);
    let Voxels::F32(values) = scan.voxels() else { panic!() };
    let size = scan.size();
    for (padding, broken) in [(-3024.0, 1), (-3.4e38, 0)] {
        let mut values = values.clone();
        // Corners of each slice, around the field of view.
        let is_corner = |n: usize| {
            let way = |axis: usize, at: usize| at as f64 / (size[axis] - 1) as f64 - 0.5;
            way(0, n % size[0]).hypot(way(1, n / size[0] % size[1])) > 0.66
        };
        let mut count = 0;
        for n in (0..values.len()).filter(|&n| is_corner(n)) {
            values[n] = padding;
            count += 1;
        }
        if broken > 0 {
            values[0] = 1e12;
            count -= 1;
        }
        let padded = ImageVolume::new(size, *scan.placement(), Voxels::F32(values)).unwrap();
        let report = scan_report(&padded, Frame::Lps);
        let told = finding(&report, "values-implausible");
        assert_eq!(
            [number(told, "below"), number(told, "above")],
            [f64::from(count), f64::from(broken)]
        );
        let others = report.findings.iter().filter(|own| own.code != "values-implausible");
        assert_eq!(others.map(|own| own.code).collect::<Vec<_>>(), codes(&wanted), "{report:?}");
    }
}

#[test]
fn a_report_is_the_same_in_ras_and_with_turned_axes() {
    let scan = made(Made { gap: 6.0, table: true, ..PLAIN });
    let wanted = scan_report(&scan, Frame::Lps);
    let turned = scan.turned(Frame::Lps, Frame::Ras);
    assert_eq!(scan_report(&turned, Frame::Ras), wanted);
    // All axes the other way round.
    let Voxels::F32(values) = scan.voxels() else { panic!() };
    let ends = scan.size().map(|n| n - 1);
    let steps = scan.placement().steps.map(|step| -step);
    let placement = Placement { origin: scan.centre(ends), steps };
    let reversed = Voxels::F32(values.iter().rev().copied().collect());
    let reversed = ImageVolume::new(scan.size(), placement, reversed).unwrap();
    let found = scan_report(&reversed, Frame::Lps);
    assert_eq!(codes(&found), codes(&wanted));
    for (found, wanted) in found.findings.iter().zip(&wanted.findings) {
        for (name, value) in &wanted.numbers {
            assert!(
                (number(found, name) - value).abs() <= 1e-9 * value.abs(),
                "{found:?} {wanted:?}"
            );
        }
    }
}

#[test]
fn values_of_air_and_tissue_alone_without_any_between_are_hounsfield_units() {
    let made = image([40, 40, 40], [4.0; 3], |at| match (at - Vector::repeat(80.0)).norm() {
        r if r < 40.0 => 700.0,
        r if r < 70.0 => 40.0,
        _ => -1000.0,
    });
    let report = scan_report(&made, Frame::Lps);
    assert!(!codes(&report).contains(&"no-hounsfield"), "{report:?}");
    let thresholds = report.thresholds.unwrap();
    assert!((-900.0..0.0).contains(&thresholds.skin) && thresholds.bone < 700.0, "{thresholds:?}");
}
