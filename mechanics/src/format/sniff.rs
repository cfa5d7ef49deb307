//! Detection of the format of a file from its bytes.

use super::cursor::find;
use super::file::MeshFormat;
use super::{archive, dicom, metaimage, nifti};

/// Files that are often sent by mistake, by their first bytes.
const FOREIGN: [(&[u8], &str); 11] = [
    (b"\x89PNG", "it is a PNG picture"),
    (b"\xff\xd8\xff", "it is a JPEG picture"),
    (b"GIF8", "it is a GIF picture"),
    (b"%PDF", "it is a PDF document"),
    (b"\x1f\x8b", "it is compressed with gzip and no NIfTI image"),
    (b"BZh", "it is compressed with bzip2"),
    (b"\x28\xb5\x2f\xfd", "it is compressed with zstd"),
    (b"NRRD", "it is an NRRD file of a version that is not read here"),
    (b"glTF", "it is a glTF file, which is written here but not read"),
    (b"{", "it is a JSON document"),
    (b"\x89HDF", "it is an HDF5 file"),
];

/// Words that start the lines of a Wavefront OBJ file.
const OBJ_WORDS: [&[u8]; 13] =
    [b"v", b"vn", b"vt", b"vp", b"f", b"l", b"p", b"o", b"g", b"s", b"mtllib", b"usemtl", b"deg"];

const STL_HEADER_BYTES: usize = 84;
const STL_TRIANGLE_BYTES: u64 = 50;

impl MeshFormat {
    /// The format by its content; names and extensions of files are never asked.
    pub fn sniff(bytes: &[u8]) -> Option<MeshFormat> {
        sniff(without_byte_order_mark(bytes))
    }
}

pub(super) fn sniff(bytes: &[u8]) -> Option<MeshFormat> {
    let text = bytes.trim_ascii_start();
    if is_binary_stl_of_exact_length(bytes) {
        // The length of 84 + 50 n bytes says more than a header that starts with "solid".
        return Some(MeshFormat::Stl);
    }
    if bytes.starts_with(b"NRRD000") {
        return Some(MeshFormat::Nrrd);
    }
    if nifti::is_nifti(bytes) {
        return Some(MeshFormat::Nifti);
    }
    if metaimage::is_metaimage(bytes) {
        return Some(MeshFormat::MetaImage);
    }
    if dicom::is_dicom(bytes) || archive::is_zip(bytes) {
        return Some(MeshFormat::Dicom);
    }
    if is_foreign(bytes) {
        return None;
    }
    if text.starts_with(b"# vtk DataFile") {
        return Some(MeshFormat::VtkLegacy);
    }
    if text.starts_with(b"<") {
        return xml_kind(text);
    }
    if text.starts_with(b"$MeshFormat") || text.starts_with(b"$Comments") {
        return Some(MeshFormat::Gmsh);
    }
    if text.starts_with(b"ply\n") || text.starts_with(b"ply\r") {
        return Some(MeshFormat::Ply);
    }
    if starts_with_word(text, b"solid") && is_text(text) {
        return Some(MeshFormat::Stl);
    }
    if is_text(text) {
        return starts_like_obj(text).then_some(MeshFormat::Obj);
    }
    looks_like_damaged_stl(bytes).then_some(MeshFormat::Stl)
}

/// A phrase about a file that is none of ours.
pub(super) fn foreign_kind(bytes: &[u8]) -> &'static str {
    let text = bytes.trim_ascii_start();
    for (magic, kind) in FOREIGN {
        if text.starts_with(magic) {
            return kind;
        }
    }
    let start: Vec<u8> = text.iter().take(9).map(u8::to_ascii_lowercase).collect();
    if start.starts_with(b"<html") || start.starts_with(b"<!doctype") {
        return "it is an HTML page";
    }
    if start.starts_with(b"<") {
        return "it is XML, but neither a VTK UnstructuredGrid nor a PolyData";
    }
    "expected one of VTU, VTP, VTK, Gmsh, STL, PLY, OBJ, NRRD, NIfTI, MetaImage, or DICOM"
}

fn is_foreign(bytes: &[u8]) -> bool {
    FOREIGN.iter().any(|(magic, _)| bytes.starts_with(magic))
}

fn declared_stl_triangles(bytes: &[u8]) -> Option<u64> {
    let count = bytes.get(80..STL_HEADER_BYTES)?;
    Some(u64::from(u32::from_le_bytes(count.try_into().ok()?)))
}

fn is_binary_stl_of_exact_length(bytes: &[u8]) -> bool {
    declared_stl_triangles(bytes).is_some_and(|count| {
        count > 0 && bytes.len() as u64 == STL_HEADER_BYTES as u64 + count * STL_TRIANGLE_BYTES
    })
}

/// A binary STL whose length is wrong still has a header of text, padded with zeros or spaces.
fn looks_like_damaged_stl(bytes: &[u8]) -> bool {
    bytes.get(..80).is_some_and(|header| {
        header.iter().all(|&byte| byte == 0 || byte == b'\t' || (b' '..=b'~').contains(&byte))
    }) && bytes.len() >= STL_HEADER_BYTES
}

/// No zero byte near the start.
fn is_text(bytes: &[u8]) -> bool {
    !bytes.iter().take(4096).any(|&byte| byte == 0)
}

fn starts_with_word(text: &[u8], word: &[u8]) -> bool {
    let Some(start) = text.get(..word.len()) else {
        return false;
    };
    let next = text.get(word.len());
    start.eq_ignore_ascii_case(word) && next.is_none_or(u8::is_ascii_whitespace)
}

fn xml_kind(text: &[u8]) -> Option<MeshFormat> {
    let start = find(text, b"<VTKFile")?;
    let tag = &text[start..];
    let tag = &tag[..tag.iter().position(|&byte| byte == b'>')?];
    let named = |kind: &str| {
        [format!("\"{kind}\""), format!("'{kind}'")]
            .iter()
            .any(|quoted| find(tag, quoted.as_bytes()).is_some())
    };
    if named("UnstructuredGrid") {
        Some(MeshFormat::Vtu)
    } else if named("PolyData") {
        Some(MeshFormat::Vtp)
    } else {
        None
    }
}

/// The first line that is neither empty nor a comment starts with a word of OBJ.
fn starts_like_obj(text: &[u8]) -> bool {
    let mut lines = text.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    let first = lines.find(|line| !line.is_empty() && !line.starts_with(b"#"));
    first.is_some_and(|line| {
        let words = OBJ_WORDS.iter();
        words.copied().any(|word| starts_with_word(line, word))
    })
}

pub(super) fn without_byte_order_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}
