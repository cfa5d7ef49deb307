//! The anatomical frame of a set of coordinates.

use std::fmt;

/// Which way the axes point: LPS is left, posterior, superior; RAS is right, anterior, superior.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Frame {
    Lps,
    Ras,
    #[default]
    Unspecified,
}

impl Frame {
    /// Itself, if it says where the axes of the patient are.
    pub fn known(self) -> Option<Frame> {
        Some(self).filter(|frame| *frame != Frame::Unspecified)
    }

    /// The word used in JSON documents and `SPACE=` marks.
    pub fn name(self) -> &'static str {
        match self {
            Frame::Lps => "LPS",
            Frame::Ras => "RAS",
            Frame::Unspecified => "unspecified",
        }
    }

    /// The frame a `SPACE=` mark names, whatever its case; `None` for any other word.
    pub fn from_name(name: &str) -> Option<Frame> {
        [Frame::Lps, Frame::Ras, Frame::Unspecified]
            .into_iter()
            .find(|frame| frame.name().eq_ignore_ascii_case(name.trim()))
    }
}

impl fmt::Display for Frame {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}
