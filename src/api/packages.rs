//! Client packages and their example page, as files of a folder that the operator names.

use std::path::{Path, PathBuf};

use axum::http::{HeaderMap, header};
use axum::response::{Html, IntoResponse, Response};
use utoipa_axum::routes;

use super::error::{ApiError, ApiResult};
use super::headers::as_page;
use super::parameters::ServedFile;
use super::plain_page::plain_page;
use super::resources::Resources;
use super::{Service, conditional};
use crate::schema::ErrorCode;

pub fn router() -> Resources {
    Resources::new().open(routes!(clients)).open(routes!(client))
}

/// The installable packages, each as a link.
#[utoipa::path(
    get, path = "/clients", operation_id = "list_clients", tag = "about",
    responses(
        (status = 200, description = "the page", body = String, content_type = "text/html"),
        (status = 404, description = "the service has no folder of clients, or it is empty"),
    )
)]
async fn clients(service: Service) -> ApiResult {
    let folder = folder(&service)?;
    let names = tokio::task::spawn_blocking(move || names(&folder)).await;
    let names = names.map_err(ApiError::internal)?;
    if names.is_empty() {
        return Err(not_built("the folder of the clients is empty"));
    }
    let item = |name: &String| format!("<li><a href=\"/clients/{name}\">{name}</a></li>\n");
    let items: String = names.iter().map(item).collect();
    let body = format!("<h1>Clients</h1>\n<ul>\n{items}</ul>\n");
    Ok(Html(plain_page("clients", &body)).into_response())
}

/// A client file: a package for pip or npm, or a part of the example page.
#[utoipa::path(
    get, path = "/clients/{file}", operation_id = "download_client", tag = "about",
    params(("file" = String, Path, description = "a name of the list")),
    responses(
        (status = 200, description = "the file", content((Vec<u8> = "*/*")), headers(("ETag" = String, description = "the hash of the content"))),
        (status = 304, description = "the client has it already"),
        (status = 404, description = "there is no such file, or the service has no clients"),
    )
)]
async fn client(service: Service, ServedFile(name): ServedFile, headers: HeaderMap) -> ApiResult {
    let (folder, wanted) = (folder(&service)?, name.clone());
    let content = tokio::task::spawn_blocking(move || content(&folder, &wanted)).await;
    let content = content.map_err(ApiError::internal)?.map_err(ApiError::internal)?;
    let content = content.ok_or_else(|| ApiError::not_found("file of the clients"))?;
    let typed = ([(header::CONTENT_TYPE, media_type(&name))], content).into_response();
    let response: Response = conditional::document(&headers, typed).await?;
    Ok(as_page(response))
}

fn folder(service: &Service) -> ApiResult<PathBuf> {
    let folder = service.config.clients_folder.clone();
    folder.filter(|folder| folder.is_dir()).ok_or_else(|| {
        not_built("the service has no folder of clients: `clients-folder` names none that is there")
    })
}

fn not_built(detail: &str) -> ApiError {
    ApiError::new(ErrorCode::ClientsNotBuilt, detail)
}

/// The names of the files directly in the folder, in their order. Anything but a plain file with a name like packages
/// and pages have is not served: no link leads out of the folder.
fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok);
    let files = entries.filter(|entry| entry.file_type().is_ok_and(|kind| kind.is_file()));
    let names = files.filter_map(|entry| entry.file_name().into_string().ok());
    let mut names: Vec<String> = names.filter(|name| is_plain(name)).collect();
    names.sort_unstable();
    names
}

fn is_plain(name: &str) -> bool {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-_.+".contains(&byte);
    !name.starts_with('.') && name.bytes().all(plain)
}

/// The bytes of a file that is listed.
fn content(folder: &Path, name: &str) -> std::io::Result<Option<Vec<u8>>> {
    if !names(folder).iter().any(|listed| listed == name) {
        return Ok(None);
    }
    std::fs::read(folder.join(name)).map(Some)
}

fn media_type(name: &str) -> &'static str {
    match name.rsplit('.').next() {
        Some("html") => "text/html; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("ipynb" | "json") => "application/json",
        Some("whl") => "application/zip",
        Some("tgz") => "application/gzip",
        _ => "application/octet-stream",
    }
}
