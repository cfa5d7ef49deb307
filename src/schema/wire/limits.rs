//! `GET /v1/limits`: every enforced bound.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use mechanics::format::ReadLimits;
use mechanics::image::MOST_SAMPLES;
use mechanics::plan::doubt::FARTHEST_MM;
use mechanics::prediction::{MOST_MUSCLE_WORK, MOST_SAMPLE_POINTS};

/// Bounds of requests. Defaults are those of the API's first version.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Limits {
    /// Largest mesh upload.
    pub upload_bytes: u64,
    /// Largest JSON body.
    pub json_bytes: u64,
    /// Deepest nesting of arrays and objects in JSON.
    pub json_depth: u32,
    /// Parts of a multipart body.
    pub multipart_parts: u32,
    pub mesh_nodes: u64,
    pub mesh_triangles: u64,
    pub mesh_cells: u64,
    /// Of an image.
    pub image_voxels: u64,
    /// Corners of one polygon of a surface file.
    pub polygon_corners: u32,
    /// Distinct values of an integer array of regions, or of one whose values select nodes; an
    /// array with more is ignored, as the report of the mesh states.
    pub label_values: u32,
    /// Decoded size of a file.
    pub decoded_bytes: u64,
    /// Decoded size of a file as a multiple of its size, beyond the 256 MiB (an image: 128 MiB) that any file may have.
    pub decoded_ratio: u32,
    /// Longest wait for a result within a request.
    pub wait_s: u32,
    /// Characters of a name.
    pub name_characters: u32,
    pub tags: u32,
    /// Segments, bones, sliding sets, prescribed sets, loads, steps of a sequence: of each.
    pub list_entries: u32,
    /// Landmarks, named regions and materials: of each.
    pub map_entries: u32,
    /// Length of the translation of one movement, displacement of the middle of a segment of a mesh by its total movement, and each
    /// component of a prescribed displacement.
    pub translation_mm: f64,
    /// Each angle of one movement, and the angle of the total movement of a segment.
    pub rotation_deg: f64,
    /// Displacement of the centre of the mesh's bounding box by the total movement of a segment.
    pub centre_displacement_mm: f64,
    /// Largest budget of time of one job.
    pub wall_s: f64,
    /// Largest budget of memory of one job.
    pub memory_mb: f64,
    /// Memory of the process of one job; a job expected to need more is refused.
    pub slot_memory_mb: f64,
    pub samples_per_mm2: f64,
    /// Scenes times plans times materials times levels times variants of a study.
    pub study_rows: u32,
    /// Comparisons that find the cells of the muscles of a case: cells near a muscle times its sample points, the pieces of its lines and
    /// 100 more; of a surface 2 million, and 100 a triangle.
    pub muscle_work: u64,
    /// `samples` of `muscle_mixing`.
    pub muscle_samples: u32,
    /// Sample points of an image in all cells of a case: its cells times `samples` of `hounsfield`.
    pub hounsfield_points: u64,
    /// Longest check of a case or a job before it is accepted; also of a picture or report drawn on request.
    pub check_s: f64,
    /// Requests of one client per minute; 0 for no limit.
    pub requests_per_minute: u32,
    /// Streams of events that one client may have open.
    pub event_streams: u32,
    /// Valid keys of a tenant.
    pub keys: u32,
    /// Requests of one tenant that may wait for a permit to parse, as many for one to check jobs, as
    /// many for one to list jobs, and as many for one to write.
    pub waiting_requests: u32,
    /// Bytes of bodies of one client in flight at the same time.
    pub client_bodies_bytes: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Limits {
            upload_bytes: 256 << 20,
            json_bytes: 1 << 20,
            json_depth: 32,
            multipart_parts: 32,
            mesh_nodes: 5_000_000,
            mesh_triangles: 10_000_000,
            mesh_cells: 4_000_000,
            image_voxels: 1 << 27,
            polygon_corners: 64,
            label_values: label_values(),
            decoded_bytes: 512 << 20,
            decoded_ratio: 10,
            wait_s: 30,
            name_characters: 128,
            tags: 32,
            list_entries: 100,
            map_entries: 1000,
            translation_mm: FARTHEST_MM,
            rotation_deg: 90.0,
            centre_displacement_mm: 250.0,
            wall_s: 86_400.0,
            memory_mb: 1_000_000.0,
            slot_memory_mb: 1_000_000.0,
            samples_per_mm2: 100.0,
            study_rows: 2000,
            muscle_work: MOST_MUSCLE_WORK,
            muscle_samples: MOST_SAMPLES as u32,
            hounsfield_points: MOST_SAMPLE_POINTS,
            check_s: 30.0,
            requests_per_minute: 60_000,
            event_streams: 8,
            keys: 100,
            waiting_requests: 256,
            client_bodies_bytes: 1 << 30,
        }
    }
}

fn label_values() -> u32 {
    ReadLimits::default().label_values as u32
}
