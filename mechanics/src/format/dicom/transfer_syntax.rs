//! Transfer syntaxes: how a file is encoded, and which of these ways are read.

use crate::format::scalar::ByteOrder;

/// How the pixels are encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PixelCoding {
    Native,
    Rle,
    JpegLossless,
}

/// A transfer syntax that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TransferSyntax {
    /// Elements name the type of their value.
    pub explicit: bool,
    pub order: ByteOrder,
    pub pixels: PixelCoding,
}

const READ: [(&str, bool, ByteOrder, PixelCoding); 6] = [
    ("1.2.840.10008.1.2", false, ByteOrder::Little, PixelCoding::Native),
    ("1.2.840.10008.1.2.1", true, ByteOrder::Little, PixelCoding::Native),
    ("1.2.840.10008.1.2.2", true, ByteOrder::Big, PixelCoding::Native),
    ("1.2.840.10008.1.2.5", true, ByteOrder::Little, PixelCoding::Rle),
    ("1.2.840.10008.1.2.4.57", true, ByteOrder::Little, PixelCoding::JpegLossless),
    ("1.2.840.10008.1.2.4.70", true, ByteOrder::Little, PixelCoding::JpegLossless),
];

/// PS3.6, table A-1, as far as scanners and archives use it.
const REFUSED: [(&str, &str); 19] = [
    ("1.2.840.10008.1.2.1.98", "Encapsulated Uncompressed"),
    ("1.2.840.10008.1.2.1.99", "Deflated Explicit VR Little Endian"),
    ("1.2.840.10008.1.2.4.50", "JPEG Baseline"),
    ("1.2.840.10008.1.2.4.51", "JPEG Extended"),
    ("1.2.840.10008.1.2.4.80", "JPEG-LS Lossless"),
    ("1.2.840.10008.1.2.4.81", "JPEG-LS Near-Lossless"),
    ("1.2.840.10008.1.2.4.90", "JPEG 2000 Lossless"),
    ("1.2.840.10008.1.2.4.91", "JPEG 2000"),
    ("1.2.840.10008.1.2.4.92", "JPEG 2000 Part 2 Lossless"),
    ("1.2.840.10008.1.2.4.93", "JPEG 2000 Part 2"),
    ("1.2.840.10008.1.2.4.100", "MPEG-2"),
    ("1.2.840.10008.1.2.4.102", "MPEG-4"),
    ("1.2.840.10008.1.2.4.110", "JPEG XL Lossless"),
    ("1.2.840.10008.1.2.4.111", "JPEG XL Recompression"),
    ("1.2.840.10008.1.2.4.112", "JPEG XL"),
    ("1.2.840.10008.1.2.4.201", "High-Throughput JPEG 2000 Lossless"),
    ("1.2.840.10008.1.2.4.202", "High-Throughput JPEG 2000 Lossless RPCL"),
    ("1.2.840.10008.1.2.4.203", "High-Throughput JPEG 2000"),
    ("1.2.840.10008.1.2.8.1", "Deflated Image Frame Compression"),
];

impl TransferSyntax {
    /// The syntax of this identifier, or a sentence with its name.
    pub fn of(uid: &str) -> Result<TransferSyntax, String> {
        if let Some(&(_, explicit, order, pixels)) = READ.iter().find(|(known, ..)| *known == uid) {
            return Ok(TransferSyntax { explicit, order, pixels });
        }
        let name = REFUSED.iter().find(|(known, _)| *known == uid).map(|(_, name)| *name);
        let shown: String =
            uid.chars().filter(|c| c.is_ascii_digit() || *c == '.').take(64).collect();
        Err(format!(
            "the transfer syntax {} ({shown}) is not read; uncompressed, RLE and JPEG Lossless are",
            name.unwrap_or("of this file")
        ))
    }
}
