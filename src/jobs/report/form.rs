//! The forms in which a report is written.

use super::content::Report;
use super::html::html;
use super::pages::pdf;
use crate::schema::predict::output::OutputName;

/// The form of a report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReportForm {
    Html,
    Pdf,
}

impl ReportForm {
    /// That of a report file.
    pub fn of(output: OutputName) -> Option<Self> {
        match output {
            OutputName::ReportHtml => Some(ReportForm::Html),
            OutputName::ReportPdf => Some(ReportForm::Pdf),
            OutputName::SkinVtp
            | OutputName::SkinStl
            | OutputName::SkinPly
            | OutputName::SkinGlb
            | OutputName::SkinCsv
            | OutputName::VolumeVtu
            | OutputName::BonesVtp
            | OutputName::ClassesSvg
            | OutputName::DisplacementSvg
            | OutputName::GapsSvg
            | OutputName::MusclesSvg
            | OutputName::ResultJson => None,
        }
    }
}

impl Report {
    pub fn written(self, form: ReportForm) -> Vec<u8> {
        match form {
            ReportForm::Html => html(&self).into_bytes(),
            ReportForm::Pdf => pdf(self),
        }
    }
}
