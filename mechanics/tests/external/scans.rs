//! A real CT: written in every format and read again, and what is said of it.

use std::fs;
use std::time::Instant;

use mechanics::format::{Mesh, ReadMesh};
use mechanics::image::{ImageVolume, Mask, Voxels, outer_skin, scan_report};
use mechanics::mesh::{Frame, Warning};

use crate::samples::scans::{
    Coding, Ends, Scan, dicom_slices, metaimage, metaimage_zlib, nifti_1, nifti_2, series,
};
use crate::samples::{gzip, read_default};
use crate::support::external::{Missing, shared_data, trials};

trials! {
    a_real_ct_is_the_same_from_every_format
    a_real_ct_says_what_a_technician_has_to_know
}

const CT: &str = "head_ct/headsq_quarter_hu.nrrd";

fn image(read: ReadMesh) -> ImageVolume {
    match read.mesh {
        Mesh::Image(image) => image,
        _ => panic!("an image was expected"),
    }
}

fn ct() -> Result<ImageVolume, Missing> {
    Ok(image(read_default(&fs::read(shared_data(CT)?).unwrap())))
}

fn a_real_ct_is_the_same_from_every_format() -> Result<(), Missing> {
    let ct = ct()?;
    let Voxels::I16(values) = ct.voxels() else { panic!("16 bits were expected") };
    let scan = Scan { size: ct.size(), values: values.clone(), placement: *ct.placement() };
    let dicom = |coding| series(&dicom_slices(&scan, coding));
    for (name, bytes) in [
        ("nifti", nifti_1(&scan, Ends::Little)),
        ("nifti 2", nifti_2(&scan, Ends::Big)),
        ("nifti gzip", gzip(&nifti_1(&scan, Ends::Little))),
        ("metaimage", metaimage(&scan)),
        ("metaimage zlib", metaimage_zlib(&scan)),
        ("dicom explicit", dicom(Coding::Explicit)),
        ("dicom implicit", dicom(Coding::Implicit)),
        ("dicom rle", dicom(Coding::Rle)),
        ("dicom jpeg lossless", dicom(Coding::JpegLossless(1, 0))),
    ] {
        let begun = Instant::now();
        let read = read_default(&bytes);
        println!("{name}: {} bytes in {:.3} s", bytes.len(), begun.elapsed().as_secs_f64());
        assert!(read.warnings.is_empty(), "{name}: {:?}", read.warnings);
        let frame = read.frame.unwrap();
        let read = image(read).turned(frame, Frame::Lps);
        assert_eq!((read.size(), read.voxels()), (ct.size(), ct.voxels()), "{name}");
        let off =
            [[0; 3], [63, 63, 92]].map(|corner| (read.centre(corner) - ct.centre(corner)).norm());
        // NIfTI-1 has single precision; 3.2 mm are none of its numbers.
        assert!(off.iter().all(|off| *off < 1e-4), "{name}: {off:?}");
    }
    Ok(())
}

fn number(warning: &Warning, name: &str) -> Option<f64> {
    warning.numbers.iter().find(|(known, _)| *known == name).map(|(_, value)| *value)
}

fn a_real_ct_says_what_a_technician_has_to_know() -> Result<(), Missing> {
    let ct = ct()?;
    let begun = Instant::now();
    let report = scan_report(&ct, Frame::Lps);
    println!("{:?} in {:.3} s", report.thresholds, begun.elapsed().as_secs_f64());
    for finding in &report.findings {
        println!("{}: {}", finding.code, finding.detail);
    }
    let thresholds = report.thresholds.unwrap();
    // The surfaces that came with the data were taken at -524 and 226 HU.
    assert!((-600.0..=-400.0).contains(&thresholds.skin), "{thresholds:?}");
    assert!((150.0..=450.0).contains(&thresholds.bone), "{thresholds:?}");
    let finding = |code: &str| report.findings.iter().find(|finding| finding.code == code);
    assert_eq!(number(finding("scan-coarse").unwrap(), "largest_mm"), Some(3.2));
    let cut = finding("field-of-view-cut").unwrap();
    assert!(
        number(cut, "top_mm2") > Some(10_000.0) && number(cut, "bottom_mm2") > Some(5_000.0),
        "{cut:?}"
    );
    assert!(finding("no-hounsfield").is_none());
    let begun = Instant::now();
    let skin = outer_skin(&Mask::above(&ct, thresholds.skin), 2, 4.0);
    println!(
        "head {:.0} cm3, airways {:.1} cm3, other {:.1} cm3 in {:.3} s",
        skin.head.volume() / 1e3,
        skin.airways.volume() / 1e3,
        skin.other.volume() / 1e3,
        begun.elapsed().as_secs_f64()
    );
    assert!((1e6..5e6).contains(&skin.head.volume()) && skin.airways.volume() > 2e4);
    Ok(())
}
