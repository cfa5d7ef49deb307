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
use rayon::prelude::*;

use crate::format::output::{ArrayValues, NamedValues, TENSOR_COMPONENTS};
use crate::mesh::{Frame, Vector};

/// Large blocks compress a little better; readers hold one at a time.
const BLOCK_BYTES: usize = 1 << 18;

/// zlib level: beyond 4 the files shrink by a few per cent and take twice as long.
const LEVEL: u32 = 4;

/// The numbers of one array. Node numbers stay below 2³¹ by the limits of the readers.
pub(super) enum Numbers<'a> {
    Vectors(&'a [Vector]),
    Tensors(&'a [[f64; 6]]),
    Reals(&'a [f64]),
    Integers(&'a [i64]),
    Nodes(&'a [u32]),
    Bytes(&'a [u8]),
}

impl Numbers<'_> {
    fn type_name(&self) -> &'static str {
        match self {
            Numbers::Vectors(_) | Numbers::Tensors(_) | Numbers::Reals(_) => "Float64",
            Numbers::Integers(_) => "Int64",
            Numbers::Nodes(_) => "Int32",
            Numbers::Bytes(_) => "UInt8",
        }
    }

    fn little_endian(&self) -> Vec<u8> {
        match self {
            Numbers::Vectors(values) => {
                let mut bytes = Vec::with_capacity(24 * values.len());
                for number in values.iter().flat_map(|vector| vector.iter()) {
                    bytes.extend_from_slice(&number.to_le_bytes());
                }
                bytes
            }
            Numbers::Tensors(values) => {
                joined(values.as_flattened().iter().map(|value| value.to_le_bytes()))
            }
            Numbers::Reals(values) => joined(values.iter().map(|value| value.to_le_bytes())),
            Numbers::Integers(values) => joined(values.iter().map(|value| value.to_le_bytes())),
            Numbers::Nodes(values) => joined(values.iter().map(|value| value.to_le_bytes())),
            Numbers::Bytes(values) => values.to_vec(),
        }
    }
}

/// The bytes of numbers, one number after the other.
fn joined<const N: usize>(numbers: impl ExactSizeIterator<Item = [u8; N]>) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(N * numbers.len());
    for number in numbers {
        bytes.extend_from_slice(&number);
    }
    bytes
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

    /// The frame as 3D Slicer marks it, then the texts of the caller, all as string arrays.
    pub fn field_strings(&mut self, frame: Frame, texts: &[(String, String)]) {
        self.section("FieldData", |file| {
            for (name, text) in once_more(("SPACE", frame.name()), texts) {
                file.field(("Array", "String"), name, 1, &zero_ended(text));
            }
        });
    }

    /// The same without string arrays, which meshio refuses to read: the frame is the name of an
    /// array, and texts are arrays of their bytes.
    pub fn field_bytes(&mut self, frame: Frame, texts: &[(String, String)]) {
        self.section("FieldData", |file| {
            let mark = format!("SPACE={}", frame.name());
            file.field(("DataArray", "UInt8"), &mark, 1, "1");
            for (name, text) in texts {
                file.field(("DataArray", "UInt8"), name, text.len(), &codes(text));
            }
        });
    }

    fn field(&mut self, (tag, kind): (&str, &str), name: &str, tuples: usize, content: &str) {
        let name = quick_xml::escape::escape(name);
        self.text.push_str(&format!(
            "<{tag} type=\"{kind}\" Name=\"{name}\" NumberOfTuples=\"{tuples}\" format=\"ascii\">\n{content}\n</{tag}>\n"
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
                ArrayValues::Tensors(values) => Numbers::Tensors(values),
                ArrayValues::Integers(values) => Numbers::Integers(values),
            };
            self.array(array.name, array.values.components(), numbers);
        }
    }

    pub fn array(&mut self, name: &str, components: usize, numbers: Numbers) {
        let name = quick_xml::escape::escape(name);
        // One component is the default, and meshio makes columns of arrays that name it.
        let components = match components {
            1 => String::new(),
            several => format!(" NumberOfComponents=\"{several}\""),
        };
        let of_components = match numbers {
            Numbers::Tensors(_) => component_names(),
            Numbers::Vectors(_)
            | Numbers::Reals(_)
            | Numbers::Integers(_)
            | Numbers::Nodes(_)
            | Numbers::Bytes(_) => String::new(),
        };
        self.text.push_str(&format!(
            "<DataArray type=\"{}\" Name=\"{name}\"{components}{of_components} format=\"binary\">\n",
            numbers.type_name()
        ));
        let (header, data) = compressed(&numbers.little_endian());
        STANDARD.encode_string(header, &mut self.text);
        STANDARD.encode_string(data, &mut self.text);
        self.text.push_str("\n</DataArray>\n");
    }
}

/// ` ComponentName0="xx"` and so on, which ParaView shows.
fn component_names() -> String {
    let names = TENSOR_COMPONENTS.iter().enumerate();
    names.map(|(number, name)| format!(" ComponentName{number}=\"{name}\"")).collect()
}

fn once_more<'a>(
    first: (&'a str, &'a str),
    others: &'a [(String, String)],
) -> impl Iterator<Item = (&'a str, &'a str)> {
    let others = others.iter().map(|(name, text)| (name.as_str(), text.as_str()));
    std::iter::once(first).chain(others)
}

fn codes(text: &str) -> String {
    let codes: Vec<String> = text.bytes().map(|byte| byte.to_string()).collect();
    codes.join(" ")
}

/// VTK writes strings as the numbers of their bytes with a zero behind.
fn zero_ended(text: &str) -> String {
    format!("{} 0", codes(text)).trim_start().to_string()
}

/// The block header and the blocks, which are compressed on all threads.
fn compressed(bytes: &[u8]) -> (Vec<u8>, Vec<u8>) {
    let stored: Vec<Vec<u8>> = bytes.par_chunks(BLOCK_BYTES).map(deflated).collect();
    let mut header = vec![stored.len(), BLOCK_BYTES, bytes.len() % BLOCK_BYTES];
    header.extend(stored.iter().map(Vec::len));
    let header = header.iter().flat_map(|&number| (number as u64).to_le_bytes());
    (header.collect(), stored.concat())
}

fn deflated(block: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::new(LEVEL));
    encoder
        .write_all(block)
        .and_then(|()| encoder.finish())
        .expect("writing to memory does not fail")
}
