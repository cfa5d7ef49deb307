//! Writers of images for tests: NIfTI, MetaImage, DICOM and zip, by their definitions and not by our readers.

#![allow(dead_code, reason = "each target uses a part")]

use std::io::Write;

use flate2::Compression;
use flate2::write::{DeflateEncoder, ZlibEncoder};
use mechanics::image::Placement;
use mechanics::mesh::{Frame, Vector};

use super::gzip;

/// An image of integers in LPS.
#[derive(Clone)]
pub struct Scan {
    pub size: [usize; 3],
    pub values: Vec<i16>,
    pub placement: Placement,
}

/// 3 x 2 x 4 voxels, turned and not axis by axis.
pub fn small_scan() -> Scan {
    let (cos, sin) = (0.8, 0.6);
    let steps = [
        Vector::new(cos, sin, 0.0) * 1.5,
        Vector::new(-sin, cos, 0.0) * 2.0,
        Vector::new(0.0, 0.0, 2.5),
    ];
    let values = super::VOXELS.to_vec();
    let placement = Placement { origin: Vector::new(-10.0, 20.25, 3.5), steps };
    Scan { size: [3, 2, 4], values, placement }
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Ends {
    Little,
    Big,
}

/// Numbers that grow in one byte order.
struct Bytes {
    ends: Ends,
    bytes: Vec<u8>,
}

macro_rules! put {
    ($self:ident, $value:expr) => {
        match $self.ends {
            Ends::Little => $self.bytes.extend($value.to_le_bytes()),
            Ends::Big => $self.bytes.extend($value.to_be_bytes()),
        }
    };
}

impl Bytes {
    fn new(ends: Ends) -> Bytes {
        Bytes { ends, bytes: Vec::new() }
    }

    fn i16(&mut self, value: i16) -> &mut Self {
        put!(self, value);
        self
    }

    fn u16(&mut self, value: u16) -> &mut Self {
        put!(self, value);
        self
    }

    fn i32(&mut self, value: i32) -> &mut Self {
        put!(self, value);
        self
    }

    fn u32(&mut self, value: u32) -> &mut Self {
        put!(self, value);
        self
    }

    fn i64(&mut self, value: i64) -> &mut Self {
        put!(self, value);
        self
    }

    fn f32(&mut self, value: f64) -> &mut Self {
        put!(self, (value as f32));
        self
    }

    fn f64(&mut self, value: f64) -> &mut Self {
        put!(self, value);
        self
    }

    fn zeros_to(&mut self, length: usize) -> &mut Self {
        assert!(self.bytes.len() <= length, "{} {length}", self.bytes.len());
        self.bytes.resize(length, 0);
        self
    }

    fn all(&mut self, bytes: &[u8]) -> &mut Self {
        self.bytes.extend(bytes);
        self
    }
}

fn values(scan: &Scan, ends: Ends) -> Vec<u8> {
    let mut bytes = Bytes::new(ends);
    scan.values.iter().for_each(|&value| {
        bytes.i16(value);
    });
    bytes.bytes
}

/// Rows of the matrix from voxels to RAS.
fn rows(scan: &Scan) -> [[f64; 4]; 3] {
    let placement = scan.placement.turned(Frame::Lps, Frame::Ras);
    let [a, b, c] = placement.steps;
    [0, 1, 2].map(|row| [a[row], b[row], c[row], placement.origin[row]])
}

/// The name of a patient stands in the description.
pub fn nifti_1(scan: &Scan, ends: Ends) -> Vec<u8> {
    let mut bytes = Bytes::new(ends);
    bytes.i32(348).zeros_to(40).i16(3);
    scan.size.iter().for_each(|&size| {
        bytes.i16(size as i16);
    });
    bytes.i16(1).i16(1).i16(1).i16(1).zeros_to(70).i16(4).i16(16).zeros_to(76).f32(1.0);
    scan.placement.steps.iter().for_each(|step| {
        bytes.f32(step.norm());
    });
    bytes.zeros_to(108).f32(352.0).f32(1.0).f32(0.0).zeros_to(123).all(&[2]);
    bytes.zeros_to(148).all(b"Jane Roe").zeros_to(252).i16(0).i16(1).zeros_to(280);
    rows(scan).iter().flatten().for_each(|&number| {
        bytes.f32(number);
    });
    bytes.zeros_to(344).all(b"n+1\0").zeros_to(352).all(&values(scan, ends));
    bytes.bytes
}

pub fn nifti_2(scan: &Scan, ends: Ends) -> Vec<u8> {
    let mut bytes = Bytes::new(ends);
    bytes.i32(540).all(b"n+2\0\r\n\x1a\n").i16(4).i16(16).i64(3);
    scan.size.iter().for_each(|&size| {
        bytes.i64(size as i64);
    });
    (0..4).for_each(|_| {
        bytes.i64(1);
    });
    bytes.zeros_to(104).f64(1.0);
    scan.placement.steps.iter().for_each(|step| {
        bytes.f64(step.norm());
    });
    bytes.zeros_to(168).i64(544).f64(1.0).f64(0.0).zeros_to(240).all(b"Jane Roe");
    bytes.zeros_to(344).i32(0).i32(1).zeros_to(400);
    rows(scan).iter().flatten().for_each(|&number| {
        bytes.f64(number);
    });
    bytes.zeros_to(500).i32(2).zeros_to(544).all(&values(scan, ends));
    bytes.bytes
}

pub fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// The header of a MetaImage file up to the line that says where the voxels are.
pub fn metaimage_header(scan: &Scan) -> String {
    let words = |numbers: Vec<f64>| {
        let words: Vec<String> = numbers.iter().map(f64::to_string).collect();
        words.join(" ")
    };
    let [x, y, z] = scan.size;
    let steps = scan.placement.steps;
    let directions =
        steps.iter().flat_map(|step| step.normalize().iter().copied().collect::<Vec<_>>());
    format!(
        "ObjectType = Image\nNDims = 3\nComment = Jane Roe\nBinaryData = True\n\
         BinaryDataByteOrderMSB = False\nCompressedData = False\nTransformMatrix = {}\nOffset = {}\n\
         CenterOfRotation = 0 0 0\nElementSpacing = {}\nDimSize = {x} {y} {z}\nElementType = MET_SHORT\n",
        words(directions.collect()),
        words(scan.placement.origin.iter().copied().collect()),
        words(steps.iter().map(|step| step.norm()).collect()),
    )
}

pub fn metaimage(scan: &Scan) -> Vec<u8> {
    let header = metaimage_header(scan) + "ElementDataFile = LOCAL\n";
    [header.as_bytes(), &values(scan, Ends::Little)].concat()
}

pub fn metaimage_zlib(scan: &Scan) -> Vec<u8> {
    let stored = zlib(&values(scan, Ends::Little));
    let compressed = format!("CompressedData = True\nCompressedDataSize = {}", stored.len());
    let header = metaimage_header(scan).replace("CompressedData = False", &compressed);
    [(header + "ElementDataFile = LOCAL\n").as_bytes(), &stored].concat()
}

/// Header and voxels of a MetaImage in two files, in one archive.
pub fn metaimage_pair(scan: &Scan) -> Vec<u8> {
    let header = metaimage_header(scan) + "ElementDataFile = ct.raw\n";
    let voxels = values(scan, Ends::Little);
    zip(&[("scan/ct.mhd", header.as_bytes()), ("scan/ct.raw", &voxels)])
}

/// How a slice is encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coding {
    Implicit,
    Explicit,
    BigEndian,
    Rle,
    /// The number of the predictor, and rows between restarts; 0 for none.
    JpegLossless(u8, usize),
}

/// A file of a series.
#[derive(Clone)]
pub struct DicomSlice {
    pub coding: Coding,
    /// Overrides the transfer syntax of the coding.
    pub syntax: Option<&'static str>,
    pub series: String,
    pub modality: &'static str,
    pub kind: &'static str,
    pub position: [f64; 3],
    pub orientation: [f64; 6],
    /// Between rows, and between columns.
    pub spacing: [f64; 2],
    /// Along a row, and along a column.
    pub size: [usize; 2],
    pub stored: Vec<u16>,
    pub bits: u16,
    pub is_signed: bool,
    pub rescale: [f64; 2],
    pub frames: Option<u32>,
    /// Patient ID, Study Instance UID and Frame of Reference UID; those that are empty are left out.
    pub identity: [&'static str; 3],
    /// Pixel Padding Value and its limit, as they are stored.
    pub padding: Vec<u16>,
}

/// Slices of an image whose third axis is their normal or sheared against it.
pub fn dicom_slices(scan: &Scan, coding: Coding) -> Vec<DicomSlice> {
    let [columns, rows, count] = scan.size;
    let [across, down, step] = scan.placement.steps;
    let numbers = |v: Vector| [v.x, v.y, v.z];
    let directions = [numbers(across.normalize()), numbers(down.normalize())].concat();
    let slice = |k: usize| DicomSlice {
        coding,
        syntax: None,
        series: "1.2.3.4".into(),
        modality: "CT",
        kind: "ORIGINAL\\PRIMARY\\AXIAL",
        position: numbers(scan.placement.origin + step * k as f64),
        orientation: directions.clone().try_into().unwrap(),
        spacing: [down.norm(), across.norm()],
        size: [columns, rows],
        stored: scan.values[k * rows * columns..][..rows * columns]
            .iter()
            .map(|&value| (i32::from(value) + 1024) as u16)
            .collect(),
        bits: 12,
        is_signed: false,
        rescale: [1.0, -1024.0],
        frames: None,
        identity: [""; 3],
        padding: Vec::new(),
    };
    (0..count).map(slice).collect()
}

impl DicomSlice {
    fn syntax(&self) -> &'static str {
        self.syntax.unwrap_or(match self.coding {
            Coding::Implicit => "1.2.840.10008.1.2",
            Coding::Explicit => "1.2.840.10008.1.2.1",
            Coding::BigEndian => "1.2.840.10008.1.2.2",
            Coding::Rle => "1.2.840.10008.1.2.5",
            Coding::JpegLossless(1, _) => "1.2.840.10008.1.2.4.70",
            Coding::JpegLossless(..) => "1.2.840.10008.1.2.4.57",
        })
    }

    pub fn file(&self) -> Vec<u8> {
        let mut file = vec![0; 128];
        file.extend(b"DICM");
        let mut meta = Elements { explicit: true, bytes: Bytes::new(Ends::Little) };
        meta.text(0x0002_0010, b"UI", self.syntax());
        file.extend(meta.bytes.bytes);
        let ends = if self.coding == Coding::BigEndian { Ends::Big } else { Ends::Little };
        let explicit = self.coding != Coding::Implicit;
        let mut data = Elements { explicit, bytes: Bytes::new(ends) };
        self.write(&mut data);
        file.extend(data.bytes.bytes);
        file
    }

    fn write(&self, data: &mut Elements) {
        let words = |numbers: &[f64]| {
            let words: Vec<String> = numbers.iter().map(f64::to_string).collect();
            words.join("\\")
        };
        data.text(0x0008_0008, b"CS", self.kind);
        data.text(0x0008_0060, b"CS", self.modality);
        data.open_sequence(0x0008_1140);
        data.text(0x0010_0010, b"PN", "Roe^Jane");
        let [patient, study, frame_of_reference] = self.identity;
        data.text_if_any(0x0010_0020, b"LO", patient);
        data.text_if_any(0x0020_000D, b"UI", study);
        data.text(0x0020_000E, b"UI", &self.series);
        data.text(0x0020_0032, b"DS", &words(&self.position));
        data.text(0x0020_0037, b"DS", &words(&self.orientation));
        data.text_if_any(0x0020_0052, b"UI", frame_of_reference);
        data.short(0x0028_0002, 1);
        data.text(0x0028_0004, b"CS", "MONOCHROME2");
        if let Some(frames) = self.frames {
            data.text(0x0028_0008, b"IS", &frames.to_string());
        }
        data.short(0x0028_0010, self.size[1] as u16);
        data.short(0x0028_0011, self.size[0] as u16);
        data.text(0x0028_0030, b"DS", &words(&self.spacing));
        data.short(0x0028_0100, 16);
        data.short(0x0028_0101, self.bits);
        data.short(0x0028_0102, self.bits - 1);
        data.short(0x0028_0103, u16::from(self.is_signed));
        for (tag, &value) in [0x0028_0120, 0x0028_0121].into_iter().zip(&self.padding) {
            data.short(tag, value);
        }
        data.text(0x0028_1052, b"DS", &self.rescale[1].to_string());
        data.text(0x0028_1053, b"DS", &self.rescale[0].to_string());
        match self.coding {
            Coding::Implicit | Coding::Explicit | Coding::BigEndian => {
                let mut pixels = Bytes::new(data.bytes.ends);
                self.stored.iter().for_each(|&pixel| {
                    pixels.u16(pixel);
                });
                data.element(0x7FE0_0010, b"OW", &pixels.bytes);
            }
            Coding::Rle => data.encapsulated(&rle(&self.stored)),
            Coding::JpegLossless(predictor, restart) => {
                data.encapsulated(&jpeg_lossless(&self.stored, self.size[0], predictor, restart));
            }
        }
    }
}

/// A series in one archive.
pub fn series(slices: &[DicomSlice]) -> Vec<u8> {
    let files: Vec<Vec<u8>> = slices.iter().map(DicomSlice::file).collect();
    let names: Vec<String> = (0..files.len()).map(|n| format!("Roe_Jane/IM{n:04}")).collect();
    let entries = names.iter().map(String::as_str).zip(files.iter().map(Vec::as_slice));
    zip(&entries.collect::<Vec<_>>())
}

struct Elements {
    explicit: bool,
    bytes: Bytes,
}

impl Elements {
    fn head(&mut self, tag: u32, kind: &[u8; 2], length: u32) {
        self.bytes.u16((tag >> 16) as u16).u16(tag as u16);
        match (self.explicit, kind) {
            (false, _) => self.bytes.u32(length),
            (true, b"OW" | b"OB" | b"SQ" | b"UN") => self.bytes.all(kind).u16(0).u32(length),
            (true, _) => self.bytes.all(kind).u16(length as u16),
        };
    }

    fn element(&mut self, tag: u32, kind: &[u8; 2], value: &[u8]) {
        self.head(tag, kind, value.len() as u32);
        self.bytes.all(value);
    }

    fn text(&mut self, tag: u32, kind: &[u8; 2], value: &str) {
        let mut value = value.as_bytes().to_vec();
        if value.len() % 2 == 1 {
            value.push(if kind == b"UI" { 0 } else { b' ' });
        }
        self.element(tag, kind, &value);
    }

    fn text_if_any(&mut self, tag: u32, kind: &[u8; 2], value: &str) {
        if !value.is_empty() {
            self.text(tag, kind, value);
        }
    }

    fn short(&mut self, tag: u32, value: u16) {
        self.head(tag, b"US", 2);
        self.bytes.u16(value);
    }

    fn mark(&mut self, element: u16, length: u32) {
        self.bytes.u16(0xFFFE).u16(element).u32(length);
    }

    /// A sequence of undefined length with an item of undefined length, in which another stands.
    fn open_sequence(&mut self, tag: u32) {
        self.head(tag, b"SQ", u32::MAX);
        self.mark(0xE000, u32::MAX);
        self.text(0x0020_0032, b"DS", "1\\2\\3");
        self.head(0x0040_0275, b"SQ", u32::MAX);
        self.mark(0xE000, 4);
        self.bytes.u32(7);
        self.mark(0xE0DD, 0);
        self.mark(0xE00D, 0);
        self.mark(0xE0DD, 0);
    }

    /// One frame in two pieces.
    fn encapsulated(&mut self, frame: &[u8]) {
        self.head(0x7FE0_0010, b"OB", u32::MAX);
        self.mark(0xE000, 0);
        for piece in frame.chunks(frame.len() / 4 * 2 + 2) {
            self.mark(0xE000, piece.len() as u32 + piece.len() as u32 % 2);
            self.bytes.all(piece).all(&[0][..piece.len() % 2]);
        }
        self.mark(0xE0DD, 0);
    }
}

fn rle(pixels: &[u16]) -> Vec<u8> {
    let segments = [8, 0].map(|shift| {
        let bytes: Vec<u8> = pixels.iter().map(|&pixel| (pixel >> shift) as u8).collect();
        pack_bits(&bytes)
    });
    let mut bytes = Bytes::new(Ends::Little);
    bytes.u32(2).u32(64).u32(64 + segments[0].len() as u32).zeros_to(64);
    bytes.all(&segments[0]).all(&segments[1]);
    bytes.bytes
}

fn pack_bits(bytes: &[u8]) -> Vec<u8> {
    let mut packed = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let run = bytes[at..].iter().take(128).take_while(|&&byte| byte == bytes[at]).count();
        if run > 1 {
            packed.extend([(257 - run) as u8, bytes[at]]);
            at += run;
        } else {
            let literal = &bytes[at..bytes.len().min(at + 3)];
            packed.push(literal.len() as u8 - 1);
            packed.extend(literal);
            at += literal.len();
        }
    }
    if packed.len() % 2 == 1 {
        packed.push(128);
    }
    packed
}

/// Lengths 1 to 15 for the first categories, and 16 for the last two: words longer than eight bits are common.
const LENGTHS: [u8; 16] = [1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 2];

struct BitWriter {
    bytes: Vec<u8>,
    held: u64,
    count: u32,
}

impl BitWriter {
    fn put(&mut self, bits: u32, count: u32) {
        self.held = self.held << count | u64::from(bits);
        self.count += count;
        while self.count >= 8 {
            self.count -= 8;
            let byte = (self.held >> self.count) as u8;
            self.bytes.push(byte);
            if byte == 0xFF {
                self.bytes.push(0);
            }
        }
    }

    fn fill_up(&mut self) {
        let free = (8 - self.count % 8) % 8;
        self.put((1 << free) - 1, free);
    }
}

fn jpeg_lossless(pixels: &[u16], columns: usize, predictor: u8, restart_rows: usize) -> Vec<u8> {
    let rows = (pixels.len() / columns) as u16;
    let mut bytes = Bytes::new(Ends::Big);
    bytes.u16(0xFFD8).u16(0xFFC4).u16(2 + 17 + 17).all(&[0]).all(&LENGTHS);
    bytes.all(&(0..17).collect::<Vec<u8>>());
    bytes.u16(0xFFC3).u16(11).all(&[16]).u16(rows).u16(columns as u16).all(&[1, 1, 0x11, 0]);
    if restart_rows > 0 {
        bytes.u16(0xFFDD).u16(4).u16((restart_rows * columns) as u16);
    }
    bytes.u16(0xFFDA).u16(8).all(&[1, 1, 0, predictor, 0, 0]);
    let mut writer = BitWriter { bytes: bytes.bytes, held: 0, count: 0 };
    let mut first = 0;
    for (at, &pixel) in pixels.iter().enumerate() {
        let row = at / columns;
        if restart_rows > 0 && at > 0 && at % (restart_rows * columns) == 0 {
            writer.fill_up();
            writer.bytes.extend([0xFF, 0xD0 + ((row / restart_rows - 1) % 8) as u8]);
            first = at;
        }
        let near = |back: usize| i32::from(pixels[at - back]);
        let predicted = if at == first {
            1 << 15
        } else if at - first < columns {
            near(1)
        } else if at % columns == 0 {
            near(columns)
        } else {
            let [a, b, c] = [near(1), near(columns), near(columns + 1)];
            let all = [a, b, c, a + b - c, a + (b - c) / 2, b + (a - c) / 2, (a + b) / 2];
            // Halves are rounded down.
            match predictor {
                5 => a + (b - c).div_euclid(2),
                6 => b + (a - c).div_euclid(2),
                number => all[usize::from(number) - 1],
            }
        };
        put_difference(&mut writer, (i32::from(pixel) - predicted) as u16);
    }
    writer.fill_up();
    writer.bytes.extend([0xFF, 0xD9]);
    writer.bytes
}

fn put_difference(writer: &mut BitWriter, difference: u16) {
    let number = i32::from(difference as i16);
    let size = if difference == 1 << 15 { 16 } else { 32 - number.unsigned_abs().leading_zeros() };
    // Words are 0, 10, 110, ...; the last two have 16 bits.
    match size {
        16 => writer.put(0xFFFF, 16),
        size => writer.put((1 << (size + 1)) - 2, size + 1),
    }
    if (1..16).contains(&size) {
        let bits = if number < 0 { number + (1 << size) - 1 } else { number };
        writer.put(bits as u32, size);
    }
}

fn deflate(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = DeflateEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

/// An archive; every other file is stored as it is.
pub fn zip(files: &[(&str, &[u8])]) -> Vec<u8> {
    let mut archive = Bytes::new(Ends::Little);
    let mut directory = Bytes::new(Ends::Little);
    for (number, (name, bytes)) in files.iter().enumerate() {
        let (method, stored) =
            if number % 2 == 0 { (8, deflate(bytes)) } else { (0, bytes.to_vec()) };
        let mut crc = flate2::Crc::new();
        crc.update(bytes);
        let at = archive.bytes.len() as u32;
        let sizes = [crc.sum(), stored.len() as u32, bytes.len() as u32];
        let head = |out: &mut Bytes| {
            out.u16(20).u16(0).u16(method).u32(0);
            sizes.iter().for_each(|&size| {
                out.u32(size);
            });
            out.u16(name.len() as u16).u16(0);
        };
        archive.all(b"PK\x03\x04");
        head(&mut archive);
        archive.all(name.as_bytes()).all(&stored);
        directory.all(b"PK\x01\x02").u16(0x031E);
        head(&mut directory);
        directory.u16(0).u16(0).u16(0).u32(0o100_644 << 16).u32(at).all(name.as_bytes());
    }
    let (at, length) = (archive.bytes.len() as u32, directory.bytes.len() as u32);
    archive.all(&directory.bytes).all(b"PK\x05\x06").u32(0);
    archive.u16(files.len() as u16).u16(files.len() as u16).u32(length).u32(at).u16(0);
    archive.bytes
}

/// A small file of each format.
pub fn one_of_each() -> Vec<(&'static str, Vec<u8>)> {
    let scan = small_scan();
    vec![
        ("nifti", nifti_1(&scan, Ends::Little)),
        ("nifti 2 big endian", nifti_2(&scan, Ends::Big)),
        ("nifti gzip", gzip(&nifti_1(&scan, Ends::Big))),
        ("metaimage", metaimage(&scan)),
        ("metaimage zlib", metaimage_zlib(&scan)),
        ("metaimage pair", metaimage_pair(&scan)),
        ("dicom implicit", series(&dicom_slices(&scan, Coding::Implicit))),
        ("dicom rle", series(&dicom_slices(&scan, Coding::Rle)[..2])),
        ("dicom jpeg lossless", series(&dicom_slices(&scan, Coding::JpegLossless(4, 1))[..2])),
    ]
}
