//! VTK XML text with arrays in base64 over zlib blocks, as ParaView, vtk and meshio read it.
//!
//! The header `[blocks][bytes of a block][bytes of the last block, 0 if full][compressed bytes…]`
//! is encoded apart from the data, in UInt64.
//!
//! Source: VTK File Formats, docs.vtk.org, and vtkXMLWriter.cxx.

use std::io::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;

use super::output::{ArrayValues, NamedValues};
use crate::mesh::{Frame, Vector};

/// Large blocks compress a little better; readers hold one at a time.
const BLOCK_BYTES: usize = 1 << 18;

/// zlib level: beyond 4 the files shrink by a few per cent and take twice as long.
const LEVEL: u32 = 4;

/// The numbers of one array. Node numbers stay below 2³¹ by the limits of the readers.
pub(super) enum Numbers<'a> {
    Vectors(&'a [Vector]),
    Reals(&'a [f64]),
    Integers(&'a [i64]),
    Nodes(&'a [u32]),
    Bytes(&'a [u8]),
}

impl Numbers<'_> {
    fn type_name(&self) -> &'static str {
        match self {
            Numbers::Vectors(_) | Numbers::Reals(_) => "Float64",
            Numbers::Integers(_) => "Int64",
            Numbers::Nodes(_) => "Int32",
            Numbers::Bytes(_) => "UInt8",
        }
    }

    fn little_endian(&self) -> Vec<u8> {
        match self {
            Numbers::Vectors(values) => values
                .iter()
                .flat_map(|vector| [vector.x, vector.y, vector.z])
                .flat_map(f64::to_le_bytes)
                .collect(),
            Numbers::Reals(values) => values.iter().flat_map(|v| v.to_le_bytes()).collect(),
            Numbers::Integers(values) => values.iter().flat_map(|v| v.to_le_bytes()).collect(),
            Numbers::Nodes(values) => values.iter().flat_map(|v| v.to_le_bytes()).collect(),
            Numbers::Bytes(values) => values.to_vec(),
        }
    }
}

/// A VTK XML file while it is written.
pub(super) struct VtkFile {
    text: String,
    kind: &'static str,
}

impl VtkFile {
    pub fn new(kind: &'static str) -> Self {
        let mut file = VtkFile { text: "<?xml version=\"1.0\"?>\n".into(), kind };
        file.open(&format!(
            "VTKFile type=\"{kind}\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\""
        ));
        file.open(kind);
        file
    }

    pub fn open(&mut self, tag: &str) {
        self.text.push_str(&format!("<{tag}>\n"));
    }

    pub fn close(&mut self, name: &str) {
        self.text.push_str(&format!("</{name}>\n"));
    }

    pub fn section(&mut self, name: &str, content: impl FnOnce(&mut VtkFile)) {
        self.open(name);
        content(self);
        self.close(name);
    }

    pub fn finish(mut self) -> Vec<u8> {
        self.close(self.kind);
        self.close("VTKFile");
        self.text.into_bytes()
    }

    /// The frame under the name that 3D Slicer uses, then the texts of the caller.
    pub fn field_data(&mut self, frame: Frame, texts: &[(String, String)]) {
        self.section("FieldData", |file| {
            file.string("SPACE", frame.name());
            for (name, text) in texts {
                file.string(name, text);
            }
        });
    }

    /// VTK writes strings as the numbers of their bytes with a zero behind.
    fn string(&mut self, name: &str, text: &str) {
        let mut codes: String = text.bytes().map(|byte| format!("{byte} ")).collect();
        codes.push('0');
        let name = quick_xml::escape::escape(name);
        self.text.push_str(&format!(
            "<Array type=\"String\" Name=\"{name}\" NumberOfTuples=\"1\" format=\"ascii\">\n{codes}\n</Array>\n"
        ));
    }

    /// The members of a set as ones among zeros.
    pub fn set(&mut self, name: &str, members: &[u32], size: usize) {
        let mut inside = vec![0_u8; size];
        for &member in members {
            inside[member as usize] = 1;
        }
        self.array(name, 1, Numbers::Bytes(&inside));
    }

    pub fn named_values(&mut self, arrays: &[NamedValues]) {
        for array in arrays {
            let numbers = match array.values {
                ArrayValues::Reals(values) => Numbers::Reals(values),
                ArrayValues::Vectors(values) => Numbers::Vectors(values),
                ArrayValues::Integers(values) => Numbers::Integers(values),
            };
            self.array(array.name, array.values.components(), numbers);
        }
    }

    pub fn array(&mut self, name: &str, components: usize, numbers: Numbers) {
        let name = quick_xml::escape::escape(name);
        self.text.push_str(&format!(
            "<DataArray type=\"{}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"binary\">\n",
            numbers.type_name()
        ));
        let (header, data) = compressed(&numbers.little_endian());
        STANDARD.encode_string(header, &mut self.text);
        STANDARD.encode_string(data, &mut self.text);
        self.text.push_str("\n</DataArray>\n");
    }
}

/// The block header and the blocks.
fn compressed(bytes: &[u8]) -> (Vec<u8>, Vec<u8>) {
    let blocks = bytes.len().div_ceil(BLOCK_BYTES);
    let mut header = vec![blocks, BLOCK_BYTES, bytes.len() % BLOCK_BYTES];
    let mut data = Vec::new();
    for block in bytes.chunks(BLOCK_BYTES) {
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::new(LEVEL));
        let stored = encoder
            .write_all(block)
            .and_then(|()| encoder.finish())
            .expect("writing to memory does not fail");
        header.push(stored.len());
        data.extend_from_slice(&stored);
    }
    let header = header.iter().flat_map(|&number| (number as u64).to_le_bytes());
    (header.collect(), data)
}
