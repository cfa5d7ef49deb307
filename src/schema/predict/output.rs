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
    #[serde(rename = "result.json")]
    ResultJson,
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
            OutputName::ResultJson => "result.json",
        }
    }

    pub fn media_type(self) -> &'static str {
        match self {
            OutputName::SkinVtp | OutputName::VolumeVtu | OutputName::BonesVtp => {
                "application/vnd.vtk.xml"
            }
            OutputName::SkinStl => "model/stl",
            OutputName::SkinPly => "application/vnd.ply",
            OutputName::SkinGlb => "model/gltf-binary",
            OutputName::SkinCsv => "text/csv; charset=utf-8",
            OutputName::ClassesSvg | OutputName::DisplacementSvg => "image/svg+xml",
            OutputName::ResultJson => "application/json",
        }
    }
}
