//! The plan of `examples/head_ct` on the head that it was made for.

use std::fs;

use facies::schema::{Faults, Limits, PlanDocument, Pointer};
use mechanics::format::Mesh;
use mechanics::image::ImageVolume;
use mechanics::mesh::surface_edges::count_edges;
use mechanics::mesh::{Frame, Vector};
use mechanics::osteotomy::label_surface::label_surface;
use mechanics::osteotomy::{BoneImage, Labelled, Osteotomy, Owner, label};

use crate::samples::read_default;
use crate::support::external::{Missing, shared_data, trials};

trials! {
    both_jaws_of_a_real_head_come_loose_at_the_cuts_of_its_plan
    the_jaws_of_a_real_head_are_closed_surfaces_of_their_volumes
    teeth_of_both_jaws_are_in_their_segments_and_the_joints_are_not
    one_jaw_of_a_real_head_without_the_other_is_found_the_same
}

fn osteotomy() -> Osteotomy {
    let mut plan: PlanDocument =
        serde_json::from_str(include_str!("../../../examples/head_ct/plan.json")).unwrap();
    let mut faults = Faults::default();
    let at = Pointer::root().key("plan");
    let planned = plan.take_osteotomy(&at, Frame::Lps, &Limits::default(), &mut faults);
    faults.into_result().unwrap();
    planned.unwrap().osteotomy
}

fn ct() -> Result<ImageVolume, Missing> {
    let bytes = fs::read(shared_data("head_ct/headsq_quarter_hu.nrrd")?).unwrap();
    let Mesh::Image(image) = read_default(&bytes).mesh else { panic!("an image was expected") };
    Ok(image)
}

fn parted(image: &ImageVolume, osteotomy: &Osteotomy) -> Labelled {
    label(&BoneImage { image, threshold: 200.0 }, osteotomy).unwrap()
}

fn both_jaws_of_a_real_head_come_loose_at_the_cuts_of_its_plan() -> Result<(), Missing> {
    let (image, osteotomy) = (ct()?, osteotomy());
    let found = parted(&image, &osteotomy);
    println!("{:#?}\n{:#?}\n{:?}", found.segments, found.contacts, found.loose);
    let voxels: Vec<_> =
        found.segments.iter().map(|segment| (segment.name.as_str(), segment.voxels)).collect();
    // By connected components of the half-spaces, by another program.
    assert_eq!(voxels, [("maxilla", 2525), ("mandible", 2625)]);
    assert!(found.bridges.is_empty());
    // Nothing of a jaw touches anything else but at a cut, and each cut parts bone.
    assert!(found.contacts.iter().all(|contact| contact.cut.is_some()), "{:?}", found.contacts);
    for cut in 0..osteotomy.cuts().len() {
        let parts: Vec<_> = found.contacts.iter().filter(|c| c.cut == Some(cut)).collect();
        let area: f64 = parts.iter().map(|contact| contact.area_mm2).sum();
        assert!((50.0..3000.0).contains(&area), "{}: {area} mm²", osteotomy.cuts()[cut].name);
    }
    Ok(())
}

fn the_jaws_of_a_real_head_are_closed_surfaces_of_their_volumes() -> Result<(), Missing> {
    let (image, osteotomy) = (ct()?, osteotomy());
    let found = parted(&image, &osteotomy);
    let bone = BoneImage { image: &image, threshold: 200.0 };
    for (number, segment) in found.segments.iter().enumerate() {
        let surface = label_surface(&bone, &osteotomy, &found.labels, number);
        let edges = count_edges(&surface.sorted_sides());
        assert_eq!((edges.open, edges.inconsistent, edges.nonmanifold), (0, 0, 0));
        let volume = surface.signed_volume();
        println!("{}: {} triangles, {volume} mm³", segment.name, surface.triangles.len());
        // 200 HU lie nearer to the voxel of soft tissue than to that of bone: the surface encloses more than voxels.
        let share = volume / segment.volume_mm3;
        assert!((0.9..1.6).contains(&share), "{volume} {segment:?}");
    }
    Ok(())
}

fn teeth_of_both_jaws_are_in_their_segments_and_the_joints_are_not() -> Result<(), Missing> {
    let image = ct()?;
    let found = parted(&image, &osteotomy());
    let owner = |place: [f64; 3]| {
        let nearest = found.labels.nearest(&Vector::from(place), &Vector::zeros(), 4.0);
        nearest.map(|bone| bone.owner)
    };
    for (place, wanted, what) in [
        ([102.4, 40.0, 48.0], Owner::Segment(0), "upper incisors"),
        ([83.2, 62.0, 52.0], Owner::Segment(0), "upper right molars"),
        ([128.0, 62.0, 52.0], Owner::Segment(0), "upper left molars"),
        ([102.4, 50.0, 33.0], Owner::Segment(1), "lower incisors"),
        ([83.2, 76.0, 46.0], Owner::Segment(1), "lower right molars"),
        ([128.0, 76.0, 46.0], Owner::Segment(1), "lower left molars"),
        ([102.4, 68.0, 10.0], Owner::Segment(1), "chin"),
        ([72.0, 100.0, 45.0], Owner::Rest, "right ramus"),
        ([134.0, 100.0, 45.0], Owner::Rest, "left ramus"),
        ([102.4, 118.0, 60.0], Owner::Rest, "spine"),
        ([60.0, 45.0, 95.0], Owner::Rest, "right cheek bone"),
        ([102.4, 92.0, 27.0], Owner::Loose, "hyoid"),
    ] {
        assert_eq!(owner(place), Some(wanted), "{what}");
    }
    Ok(())
}

fn one_jaw_of_a_real_head_without_the_other_is_found_the_same() -> Result<(), Missing> {
    let image = ct()?;
    let both = osteotomy();
    let rule = both.segments()[0].clone();
    let alone = Osteotomy::new(both.cuts()[..2].to_vec(), vec![rule]).unwrap();
    let [found, whole] = [&alone, &both].map(|osteotomy| parted(&image, osteotomy));
    assert_eq!(found.segments[0].voxels, whole.segments[0].voxels);
    Ok(())
}
