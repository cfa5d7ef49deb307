//! A picture of many sections through meshes of damaged surfaces, held against the undamaged ones.

use std::path::Path;

use mechanics::mesh::{TriangleSurface, Vector};

use crate::chords::COUNT;
use crate::damage::Damage;
use crate::damaged::{Outcome, Undamaged, boundary};

pub const TILES: usize = 40;
const COLUMNS: usize = 8;
/// Pixels of the side of a tile.
const SIDE: usize = 200;

const AIR: [u8; 3] = [255, 255, 255];
const TISSUE: [u8; 3] = [190, 190, 190];
const LOST: [u8; 3] = [40, 80, 230];
const GAINED: [u8; 3] = [250, 150, 20];
const DAMAGED: [u8; 3] = [220, 30, 30];

/// A section across x, with y to the right and z upwards.
pub struct Tile(Vec<[u8; 3]>);

impl Tile {
    /// Through the place where the meshes differ most; through the middle where they do not.
    pub fn new(body: &Undamaged, damage: Damage, seed: u64) -> Tile {
        let Outcome { made, ending, off, elsewhere, .. } = body.outcome(damage, seed);
        let tissue = made.expect("a mesh that was made before").tissue;
        println!(
            "tile: {} {damage:?} seed {seed}: {ending:?}, {:+.2} %, {:.2} % elsewhere",
            body.name,
            100.0 * off,
            100.0 * elsewhere
        );
        let other = body.lines.chords(&boundary(&tissue));
        let length = |spans: &[[f64; 2]]| spans.iter().map(|[from, to]| to - from).sum::<f64>();
        let differs = |x: usize| -> f64 {
            let lines = (0..COUNT).map(|z| {
                (length(&body.chords.inside([x, z])) - length(&other.inside([x, z]))).abs()
            });
            lines.sum()
        };
        let all = (0..COUNT).map(|x| (x, differs(x))).filter(|(_, length)| *length > 0.0);
        let x = all.max_by(|a, b| a.1.total_cmp(&b.1)).map_or(COUNT / 2, |(x, _)| x);
        let [low, high] = tissue.volume.bounds();
        let frame = Frame::new(low, high);
        let mut pixels = vec![AIR; SIDE * SIDE];
        for row in 0..SIDE {
            let z = (row * COUNT / SIDE).min(COUNT - 1);
            let [before, after] = [body.chords.inside([x, z]), other.inside([x, z])];
            for column in 0..SIDE {
                let y = frame.low.y + (column as f64 + 0.5) * frame.step.y;
                let within = |spans: &[[f64; 2]]| spans.iter().any(|s| s[0] <= y && y < s[1]);
                pixels[(SIDE - 1 - row) * SIDE + column] = match (within(&before), within(&after)) {
                    (true, true) => TISSUE,
                    (true, false) => LOST,
                    (false, true) => GAINED,
                    (false, false) => AIR,
                };
            }
        }
        let at = body.lines.at([x, 0])[0];
        for surface in &body.damaged(damage, seed) {
            frame.draw(surface, at, &mut pixels);
        }
        Tile(pixels)
    }
}

/// What of space a tile shows.
struct Frame {
    low: Vector,
    step: Vector,
}

impl Frame {
    fn new(low: Vector, high: Vector) -> Frame {
        let margin = (high - low) * 0.02;
        Frame { low: low - margin, step: (high - low + margin * 2.0) / SIDE as f64 }
    }

    /// Where triangles meet the plane of a section.
    fn draw(&self, surface: &TriangleSurface, x: f64, pixels: &mut [[u8; 3]]) {
        for triangle in 0..surface.triangles.len() {
            let corners = surface.corners(triangle);
            let mut ends = Vec::new();
            for (from, to) in [(0, 1), (1, 2), (2, 0)] {
                let [a, b] = [corners[from], corners[to]];
                if (a.x > x) != (b.x > x) {
                    ends.push(a + (b - a) * ((x - a.x) / (b.x - a.x)));
                }
            }
            let [from, to] = ends[..] else { continue };
            for n in 0..=20 {
                let at = from + (to - from) * (f64::from(n) / 20.0);
                let place = (at - self.low).component_div(&self.step);
                let [column, row] = [place.y, place.z].map(|place| place as usize);
                if place.y >= 0.0 && place.z >= 0.0 && column < SIDE && row < SIDE {
                    pixels[(SIDE - 1 - row) * SIDE + column] = DAMAGED;
                }
            }
        }
    }
}

pub fn write(tiles: &[Tile], file: &Path) {
    let rows = tiles.len().div_ceil(COLUMNS).max(1);
    let width = COLUMNS * (SIDE + 2);
    let mut bytes = vec![0; 3 * width * rows * (SIDE + 2)];
    for (n, Tile(pixels)) in tiles.iter().enumerate() {
        let (left, top) = (n % COLUMNS * (SIDE + 2), n / COLUMNS * (SIDE + 2));
        for (pixel, colour) in pixels.iter().enumerate() {
            let at = 3 * ((top + pixel / SIDE) * width + left + pixel % SIDE);
            bytes[at..at + 3].copy_from_slice(colour);
        }
    }
    let out = std::fs::File::create(file).expect("a folder that can be written to");
    let mut encoder = png::Encoder::new(out, width as u32, (rows * (SIDE + 2)) as u32);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header().expect("a picture");
    writer.write_image_data(&bytes).expect("a picture");
    println!("{} sections in {}", tiles.len(), file.display());
}
