//! Files of a result that are written from a scene and its predicted skin.

use super::input::Prepared;
use super::overlap::{bones_file, gaps_picture};
use crate::jobs::failure::JobError;
use crate::jobs::result::muscles::muscles_picture;
use crate::jobs::result::pictures::displacement_picture;
use crate::jobs::result::skin::PredictedSkin;
use crate::schema::compare::result::StatDocument;
use crate::schema::predict::document::OutputName;

impl Prepared {
    /// A file with this skin, whose displacement has these statistics; `None` if there is nothing to show. The moved volume and
    /// reports need more than that.
    pub fn encode(
        &self,
        name: OutputName,
        (skin, numbers): (&PredictedSkin, &StatDocument),
        field_data: &[(String, String)],
    ) -> Result<Option<Vec<u8>>, JobError> {
        let (case, scene) = (&self.case, &self.scene);
        Ok(match name {
            OutputName::BonesVtp => Some(bones_file(case, scene, field_data)?),
            OutputName::GapsSvg => gaps_picture(case, scene)?.map(String::into_bytes),
            OutputName::MusclesSvg => muscles_picture(case, scene)?.map(String::into_bytes),
            OutputName::ClassesSvg => Some(self.classes_picture()?.into_bytes()),
            OutputName::DisplacementSvg => {
                let shown = (case.frame, skin.range_mm);
                Some(displacement_picture(scene, &skin.surface, shown, numbers)?.into_bytes())
            }
            of_skin => skin.encode(of_skin, case.frame, field_data)?,
        })
    }
}
