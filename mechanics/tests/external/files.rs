//! Real files: a face, shells and a head, read as they came.

use mechanics::format::vtk::vtu;
use mechanics::format::{Mesh, ReadLimits, VolumeOutput, read};
use mechanics::mesh::{CellShape, Frame};

use crate::samples::{read_default, surface, volume, warning_codes};
use crate::support::external::{Missing, shared_data, trials};

trials! {
    the_face_has_its_cells_sets_and_nodes
    surfaces_of_the_face_and_the_head_are_read
    the_skin_of_the_face_knows_its_nodes
    a_file_of_muscle_fibres_is_no_mesh_and_says_what_it_holds
    shells_of_up_to_a_million_tetrahedra_are_read
}

fn the_face_has_its_cells_sets_and_nodes() -> Result<(), Missing> {
    for (file, set, size) in [
        ("face/subject_face.vtu", "jaw_attached", 329),
        ("face/template_face.vtu", "mandible_fixed", 322),
    ] {
        let path = shared_data(file)?;
        let read = read_default(&std::fs::read(path).unwrap());
        assert_eq!(warning_codes(&read), Vec::<&str>::new(), "{file}");
        assert!(read.ignored.names().contains(&"node_id".to_string()));
        let mesh = volume(read);
        let cells = |wanted| mesh.cells.iter().filter(|(shape, _)| *shape == wanted).count();
        assert_eq!((mesh.nodes.len(), mesh.cells.len()), (8720, 6024 + 318));
        assert_eq!((cells(CellShape::Hex8), cells(CellShape::Wedge6)), (6024, 318));
        assert_eq!(mesh.node_sets["outer_skin"].len(), 2180);
        assert_eq!(mesh.node_sets[set].len(), size);
        let bytes = vtu::write(&VolumeOutput::plain(&mesh, Frame::Lps)).unwrap();
        assert_eq!(read_default(&bytes).mesh, Mesh::Volume(mesh));
    }
    Ok(())
}

fn surfaces_of_the_face_and_the_head_are_read() -> Result<(), Missing> {
    for (file, triangles) in [
        ("face/subject_face_skin.vtp", 4122),
        ("face/template_face_skin.vtp", 4122),
        ("face/subject_face_skin.stl", 4122),
        ("face/subject_face_jaw.stl", 4184),
        ("face/subject_face_maxilla.stl", 5808),
        ("face/subject_face_cranium.stl", 1156),
        ("face/template_face_jaw.stl", 376),
        ("face/template_face_maxilla.stl", 572),
        ("head_ct/headsq_quarter_skin.stl", 40_000),
        ("head_ct/headsq_quarter_bone.stl", 59_998),
    ] {
        let path = shared_data(file)?;
        let read = read_default(&std::fs::read(path).unwrap());
        let dropped: f64 = read
            .warnings
            .iter()
            .filter(|warning| {
                warning.code.ends_with("triangles") && warning.code != "polygons-triangulated"
            })
            .flat_map(|warning| warning.numbers.iter().map(|(_, count)| *count))
            .sum();
        let skin = surface(read);
        assert_eq!(skin.triangles.len(), triangles - dropped as usize, "{file}");
    }
    Ok(())
}

fn the_skin_of_the_face_knows_its_nodes() -> Result<(), Missing> {
    let path = shared_data("face/subject_face_skin.vtp")?;
    let skin = surface(read_default(&std::fs::read(path).unwrap()));
    let ids = skin.node_ids.unwrap();
    assert_eq!((ids.len(), ids.iter().min(), ids.iter().max()), (2180, Some(&34), Some(&7693)));
    Ok(())
}

fn a_file_of_muscle_fibres_is_no_mesh_and_says_what_it_holds() -> Result<(), Missing> {
    let path = shared_data("face/subject_face_muscle_fibres.vtp")?;
    let error = read(&std::fs::read(path).unwrap(), &ReadLimits::default()).unwrap_err();
    assert_eq!(error.code(), "mesh-empty");
    assert!(error.to_string().contains("36 lines were skipped"), "{error}");
    Ok(())
}

fn shells_of_up_to_a_million_tetrahedra_are_read() -> Result<(), Missing> {
    for (file, cells) in
        [("shell/30k.vtu", 29_834), ("shell/300k.vtu", 302_265), ("shell/1M.vtu", 1_018_865)]
    {
        let path = shared_data(file)?;
        let read = read_default(&std::fs::read(path).unwrap());
        assert_eq!(warning_codes(&read), Vec::<&str>::new(), "{file}");
        let mesh = volume(read);
        assert_eq!(mesh.cells.len(), cells);
        assert!(mesh.node_labels.contains_key("tag") && mesh.cell_labels.contains_key("band"));
    }
    Ok(())
}
