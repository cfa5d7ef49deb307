//! `distance.svg`: the prediction coloured by signed distance, with a histogram by area.

use crate::jobs::report::SIGNED_RANGE_MM;
use crate::jobs::result::pictures::face_direction;
use crate::schema::compare::result::ComparisonDocument;
use mechanics::chart::drawing::{Document, Rectangle, Style};
use mechanics::chart::svg::svg;
use mechanics::chart::{HistogramPicture, PngError, ViewRow, ViewValues, ViewsPicture};
use mechanics::mesh::{Frame, TriangleSurface};

/// The file and its media type.
pub const DISTANCE_PICTURE: &str = "distance.svg";
pub const DISTANCE_MEDIA_TYPE: &str = "image/svg+xml";

const MARGIN: f64 = 28.0;
const HEAD: f64 = 84.0;
const GAP: f64 = 18.0;
const TITLE: &str = "Signed distance from the actual skin";

/// Three views and a histogram of one fixed range, which is that of the spec.
pub fn distance_picture(
    surface: &TriangleSurface,
    signed_distance: &[f64],
    (frame, range_mm): (Frame, Option<f64>),
    found: &ComparisonDocument,
) -> Result<String, PngError> {
    let range_mm = range_mm.unwrap_or(SIGNED_RANGE_MM);
    let values = |name| ViewValues { values: signed_distance, range_mm, is_signed: true, name };
    let points = &surface.points;
    let values_of_views = Some(values("distance, mm"));
    let rows = [ViewRow { name: "Prediction", points, values: values_of_views, outline_of: None }];
    let columns = ["Front", "Three-quarter", "Side"];
    let face_direction = face_direction(frame, surface);
    let views =
        ViewsPicture { triangles: &surface.triangles, rows: &rows, face_direction, columns }
            .to_drawing()?;
    let weights = surface.point_areas();
    let name = "signed distance, mm: below 0 inside the actual skin, above 0 outside";
    let histogram = HistogramPicture { values: values(name), weights: &weights }.to_drawing();
    let (width, height) = (views.width, views.height);
    let whole = HEAD + height + GAP + histogram.height + 12.0;
    let mut document = Document::new(width + 2.0 * MARGIN, whole);
    document.text([MARGIN, 38.0], width, Style::of(20.0).bold(), TITLE);
    let both = &found.both;
    let numbers = format!(
        "Both ways, by area: mean {:.2} mm, rms {:.2} mm, median {:.2} mm, p95 {:.2} mm, largest {:.2} mm; {:.1} % below 1 mm",
        both.mean,
        both.rms,
        both.median,
        both.p95,
        both.max,
        100.0 * both.share_below_1_mm.max(0.0)
    );
    document.text([MARGIN, 62.0], width, Style::of(13.0).faint(), &numbers);
    let [below, ends] = [HEAD + height + GAP, histogram.height];
    document.drawing(Rectangle { x: MARGIN, y: HEAD, width, height }, views);
    let place = Rectangle { x: MARGIN, y: below, width: histogram.width, height: ends };
    document.drawing(place, histogram);
    Ok(svg(&document, TITLE))
}
