//! The predicted skin as files: the arrays of the API beside the moved points.

use crate::schema::predict::document::{OutputName, USUAL_RANGE_MM};
use mechanics::chart::colour::{Rgb, sequential};
use mechanics::format::vtk::vtp;
use mechanics::format::{
    ArrayValues, ColourScale, NamedValues, SurfaceOutput, WriteError, csv, glb, ply, stl,
};
use mechanics::mesh::{Frame, TriangleSurface, Vector};
use mechanics::prediction::{NumericalError, Prediction, Skin};

/// The gap in mm of a node without any surface near.
const NOTHING_FACED: f64 = 1000.0;

/// Contact at the points of a skin or the nodes of a mesh: pressure in kPa, gap in mm.
pub struct ContactArrays {
    pub pressure: Vec<f64>,
    pub gap: Vec<f64>,
}

impl ContactArrays {
    /// At some nodes of the mesh.
    pub fn new(prediction: &Prediction, nodes: impl Iterator<Item = u32> + Clone) -> Option<Self> {
        let touch = prediction.contact.as_ref()?;
        let gap = |node: u32| touch.contact.gaps.get(&node).copied().unwrap_or(NOTHING_FACED);
        Some(ContactArrays {
            pressure: nodes.clone().map(|node| touch.pressure[node as usize]).collect(),
            gap: nodes.map(gap).collect(),
        })
    }

    pub fn arrays(&self) -> [NamedValues<'_>; 2] {
        let named = |name, values| NamedValues { name, values: ArrayValues::Reals(values) };
        [named("contact_pressure_kpa", &self.pressure), named("contact_gap_mm", &self.gap)]
    }
}

/// The skin after the movement, one entry for each of its points.
pub struct PredictedSkin {
    /// Moved points, in mm.
    pub surface: TriangleSurface,
    pub displacement: Vec<Vector>,
    /// In mm.
    pub magnitude: Vec<f64>,
    /// To the surface it was compared with, in mm, positive outside.
    pub signed_distance: Option<Vec<f64>>,
    /// The linearisation error, in mm, if known.
    pub nonlinearity: Option<Vec<f64>>,
    /// The discretisation error, in mm, if estimated: vectors and their lengths.
    pub missing: Option<Vec<Vector>>,
    pub numerical_error: Option<Vec<f64>>,
    /// If there is contact.
    pub contact: Option<ContactArrays>,
    /// Named parts as arrays `set_NAME`, 1 at their points.
    pub sets: Vec<(String, Vec<i64>)>,
    /// The displacement in mm at the end of the colour scale: the same for every plan, so that plans can be compared.
    pub range_mm: f64,
}

impl PredictedSkin {
    pub fn new(skin: &Skin, prediction: &Prediction) -> Self {
        let nodes = skin.nodes().iter();
        let displacement = nodes.map(|&node| prediction.displacement[node as usize]).collect();
        let error = prediction.numerical_error.as_ref().ok();
        let of_skin = |error: &NumericalError| -> Vec<Vector> {
            skin.nodes().iter().map(|&node| error.missing[node as usize]).collect()
        };
        let missing = error.map(of_skin);
        let numerical_error = error.map(|error| skin.lengths(&error.missing));
        let contact = ContactArrays::new(prediction, skin.nodes().iter().copied());
        let moved = Self::of_displacement(skin, displacement);
        PredictedSkin { missing, numerical_error, contact, ..moved }
    }

    /// The skin with one displacement in mm for each of its points.
    pub fn of_displacement(skin: &Skin, displacement: Vec<Vector>) -> Self {
        let mut surface = skin.surface.clone();
        for (point, moved) in surface.points.iter_mut().zip(&displacement) {
            *point += moved;
        }
        PredictedSkin {
            surface,
            magnitude: displacement.iter().map(Vector::norm).collect(),
            displacement,
            signed_distance: None,
            nonlinearity: None,
            missing: None,
            numerical_error: None,
            contact: None,
            sets: skin.regions.iter().map(|(name, points)| set(name, points, skin)).collect(),
            range_mm: USUAL_RANGE_MM,
        }
    }

    /// The bytes of one of the skin files; `None` for names of other files.
    pub fn encode(
        &self,
        name: OutputName,
        frame: Frame,
        field_data: &[(String, String)],
    ) -> Result<Option<Vec<u8>>, WriteError> {
        let colours = self.colours();
        let mut output = SurfaceOutput::plain(&self.surface, frame);
        output.field_data = field_data.to_vec();
        output.point_arrays = vec![
            NamedValues {
                name: "displacement_mm",
                values: ArrayValues::Vectors(&self.displacement),
            },
            NamedValues {
                name: "displacement_magnitude_mm",
                values: ArrayValues::Reals(&self.magnitude),
            },
        ];
        if let Some(error) = &self.numerical_error {
            let values = ArrayValues::Reals(error);
            output.point_arrays.push(NamedValues { name: "numerical_error_mm", values });
        }
        if let Some(missing) = self.missing.as_ref().filter(|_| name == OutputName::SkinVtp) {
            let values = ArrayValues::Vectors(missing);
            output.point_arrays.push(NamedValues { name: "missing_mm", values });
        }
        if let Some(distance) = &self.signed_distance {
            let values = ArrayValues::Reals(distance);
            output.point_arrays.push(NamedValues { name: "signed_distance_mm", values });
        }
        if let Some(nonlinearity) =
            self.nonlinearity.as_ref().filter(|_| name == OutputName::SkinVtp)
        {
            let values = ArrayValues::Reals(nonlinearity);
            output.point_arrays.push(NamedValues { name: "nonlinearity_mm", values });
        }
        if let Some(contact) = self.contact.as_ref().filter(|_| name == OutputName::SkinVtp) {
            output.point_arrays.extend(contact.arrays());
        }
        for (set, belongs) in self.sets.iter().filter(|_| name == OutputName::SkinVtp) {
            let values = ArrayValues::Integers(belongs);
            output.point_arrays.push(NamedValues { name: set, values });
        }
        if matches!(name, OutputName::SkinGlb | OutputName::SkinPly) {
            output.colours = Some(&colours);
            let array = "displacement_magnitude_mm";
            output.colour_scale = Some(ColourScale { array, low: 0.0, high: self.range_mm });
        }
        match name {
            OutputName::SkinVtp => vtp::write(&output).map(Some),
            OutputName::SkinStl => stl::write(&output).map(Some),
            OutputName::SkinPly => ply::write(&output).map(Some),
            OutputName::SkinGlb => glb::write(&output).map(Some),
            OutputName::SkinCsv => csv::write(&output).map(Some),
            _ => Ok(None),
        }
    }

    /// Colours by the length of the displacement, from 0 to the end of the range.
    fn colours(&self) -> Vec<Rgb> {
        self.magnitude.iter().map(|length| sequential(length / self.range_mm)).collect()
    }
}

/// A part of the skin as an array, by the name of a set.
fn set(name: &str, points: &[u32], skin: &Skin) -> (String, Vec<i64>) {
    let mut belongs = vec![0; skin.surface.points.len()];
    points.iter().for_each(|&point| belongs[point as usize] = 1);
    (format!("set_{name}"), belongs)
}
