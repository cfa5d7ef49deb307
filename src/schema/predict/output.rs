//! The files of a result: their names and media types.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A file of a result.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, ToSchema,
)]
pub enum OutputName {
    #[serde(rename = "skin.vtp")]
    SkinVtp,
    #[serde(rename = "skin.stl")]
    SkinStl,
    #[serde(rename = "skin.ply")]
    SkinPly,
    #[serde(rename = "skin.glb")]
    SkinGlb,
    #[serde(rename = "skin.csv")]
    SkinCsv,
    #[serde(rename = "volume.vtu")]
    VolumeVtu,
    #[serde(rename = "bones.vtp")]
    BonesVtp,
    #[serde(rename = "classes.svg")]
    ClassesSvg,
    #[serde(rename = "displacement.svg")]
    DisplacementSvg,
    #[serde(rename = "gaps.svg")]
    GapsSvg,
    #[serde(rename = "muscles.svg")]
    MusclesSvg,
    #[serde(rename = "report.html")]
    ReportHtml,
    #[serde(rename = "report.pdf")]
    ReportPdf,
    #[serde(rename = "result.json")]
    ResultJson,
}

/// A picture or a report, which the service draws when first requested: pictures of predictions, reports of
/// predictions, comparisons and studies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub enum PictureName {
    #[serde(rename = "classes.svg")]
    Classes,
    #[serde(rename = "displacement.svg")]
    Displacement,
    #[serde(rename = "report.html")]
    ReportHtml,
    #[serde(rename = "report.pdf")]
    ReportPdf,
}

impl PictureName {
    pub const ALL: [PictureName; 4] = [
        PictureName::Classes,
        PictureName::Displacement,
        PictureName::ReportHtml,
        PictureName::ReportPdf,
    ];
    /// Those of comparisons and studies.
    pub const REPORTS: [PictureName; 2] = [PictureName::ReportHtml, PictureName::ReportPdf];

    /// Its file, if a spec names it.
    pub fn output(self) -> OutputName {
        match self {
            PictureName::Classes => OutputName::ClassesSvg,
            PictureName::Displacement => OutputName::DisplacementSvg,
            PictureName::ReportHtml => OutputName::ReportHtml,
            PictureName::ReportPdf => OutputName::ReportPdf,
        }
    }

    /// The sources of the drawing beside the input of a prediction.
    pub fn drawn_from(self) -> Option<OutputName> {
        match self {
            PictureName::Classes => None,
            PictureName::Displacement | PictureName::ReportHtml | PictureName::ReportPdf => {
                Some(OutputName::SkinVtp)
            }
        }
    }

    /// Those that can be drawn from a prediction with these files, and are not among them.
    pub fn beside(has: impl Fn(OutputName) -> bool) -> Vec<PictureName> {
        let is_left =
            |picture: &PictureName| !has(picture.output()) && picture.drawn_from().is_none_or(&has);
        PictureName::ALL.into_iter().filter(is_left).collect()
    }
}

impl OutputName {
    pub fn file_name(self) -> &'static str {
        match self {
            OutputName::SkinVtp => "skin.vtp",
            OutputName::SkinStl => "skin.stl",
            OutputName::SkinPly => "skin.ply",
            OutputName::SkinGlb => "skin.glb",
            OutputName::SkinCsv => "skin.csv",
            OutputName::VolumeVtu => "volume.vtu",
            OutputName::BonesVtp => "bones.vtp",
            OutputName::ClassesSvg => "classes.svg",
            OutputName::DisplacementSvg => "displacement.svg",
            OutputName::GapsSvg => "gaps.svg",
            OutputName::MusclesSvg => "muscles.svg",
            OutputName::ReportHtml => "report.html",
            OutputName::ReportPdf => "report.pdf",
            OutputName::ResultJson => "result.json",
        }
    }

    pub fn media_type(self) -> &'static str {
        media_type_of(self.file_name()).unwrap_or("application/octet-stream")
    }
}

/// The media type of a file of a result, by the ending of its name; `None` for one that no result has.
pub fn media_type_of(file: &str) -> Option<&'static str> {
    Some(match file.rsplit_once('.')?.1 {
        "vtp" | "vtu" => "application/vnd.vtk.xml",
        "stl" => "model/stl",
        "ply" => "application/vnd.ply",
        "glb" => "model/gltf-binary",
        "csv" => "text/csv; charset=utf-8",
        "svg" => "image/svg+xml",
        "html" => "text/html; charset=utf-8",
        "pdf" => "application/pdf",
        "json" => "application/json",
        "xml" => "application/xml",
        "f32" | "i16" => "application/octet-stream",
        _ => return None,
    })
}
