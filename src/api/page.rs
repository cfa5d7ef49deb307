//! Web page for planners: the bundle that `web/build` makes of `web/`, embedded in the program, so that it needs no other
//! host.

use axum::http::{HeaderMap, header};
use axum::response::{Html, IntoResponse, Response};
use utoipa_axum::routes;

use super::conditional;
use super::error::{ApiError, ApiResult};
use super::headers::as_planner;
use super::parameters::ServedFile;
use super::resources::Resources;

const INDEX: &str = include_str!("../../web/dist/index.html");

/// A file of the bundle.
struct Asset {
    name: &'static str,
    media_type: &'static str,
    content: &'static [u8],
}

const SCRIPT: &str = "text/javascript; charset=utf-8";
const ASSETS: [Asset; 5] = [
    Asset {
        name: "icon.svg",
        media_type: "image/svg+xml",
        content: include_bytes!("../../web/dist/assets/icon.svg"),
    },
    Asset {
        name: "index.css",
        media_type: "text/css; charset=utf-8",
        content: include_bytes!("../../web/dist/assets/index.css"),
    },
    Asset {
        name: "palette.css",
        media_type: "text/css; charset=utf-8",
        content: include_bytes!("../../web/dist/assets/palette.css"),
    },
    Asset {
        name: "page.js",
        media_type: SCRIPT,
        content: include_bytes!("../../web/dist/assets/page.js"),
    },
    Asset {
        name: "three.js",
        media_type: SCRIPT,
        content: include_bytes!("../../web/dist/assets/three.js"),
    },
];

pub fn router() -> Resources {
    Resources::new().open(routes!(asset))
}

/// The page itself.
pub fn page() -> Response {
    as_planner(Html(INDEX).into_response())
}

/// A script, style or picture of the page at `/`.
#[utoipa::path(
    get, path = "/assets/{file}", operation_id = "download_asset", tag = "about",
    params(("file" = String, Path, description = "as the page names it")),
    responses(
        (status = 200, description = "the file", content((Vec<u8> = "*/*")), headers(("ETag" = String, description = "the hash of the content"))),
        (status = 304, description = "the client has it already"),
        (status = 404, description = "there is no such file"),
    )
)]
async fn asset(ServedFile(name): ServedFile, headers: HeaderMap) -> ApiResult {
    let found = ASSETS.iter().find(|asset| asset.name == name);
    let asset = found.ok_or_else(|| ApiError::not_found("file of the page"))?;
    let kept = [
        (header::CONTENT_TYPE, asset.media_type),
        // Names stay the same from version to version.
        (header::CACHE_CONTROL, "no-cache"),
    ];
    let response = conditional::document(&headers, (kept, asset.content).into_response()).await?;
    Ok(as_planner(response))
}
