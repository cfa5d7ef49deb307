//! Parameters of paths and queries.

use axum::extract::{FromRequestParts, Query, RawPathParams};
use axum::http::request::Parts;
use serde::de::DeserializeOwned;
use uuid::Uuid;

use super::error::{ApiError, ApiResult};
use crate::schema::ErrorCode;
use crate::schema::key::is_key_id;

/// The most rows of a page of a list.
pub const LONGEST_PAGE: u32 = 200;

/// The query; who reads it has a layer that refuses unknown parameters (`known_parameters`).
pub struct Parameters<T>(pub T);

impl<T: DeserializeOwned, S: Sync> FromRequestParts<S> for Parameters<T> {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, _state: &S) -> ApiResult<Self> {
        match Query::<T>::try_from_uri(&parts.uri) {
            Ok(Query(parameters)) => Ok(Parameters(parameters)),
            Err(error) => {
                let detail = error.body_text();
                let detail = detail.rsplit("query string: ").next().unwrap_or_default();
                let detail = detail.replace("unknown variant", "unknown word");
                if let Some(name) = repeated(&detail) {
                    let detail = format!("{name} is given more than once");
                    return Err(ApiError::invalid_parameter(name, detail));
                }
                if named(&detail) == "limit" {
                    let detail = format!("limit has to be a number from 1 to {LONGEST_PAGE}");
                    return Err(ApiError::invalid_parameter("limit", detail));
                }
                Err(ApiError::invalid_parameter(named(&detail), detail.clone()))
            }
        }
    }
}

/// The parameter that a refusal says is there twice.
fn repeated(detail: &str) -> Option<&str> {
    detail.split_once("duplicate field `")?.1.split('`').next()
}

/// The parameter that a refusal of the query begins with, or that it says is missing.
fn named(detail: &str) -> &str {
    let is_name = |text: &&str| {
        !text.is_empty() && text.chars().all(|letter| letter.is_alphanumeric() || letter == '_')
    };
    let first = detail.split_once(": ").map(|(name, _)| name).filter(is_name);
    let quoted =
        || detail.split('`').nth(1).filter(|_| detail.contains(" field `")).filter(is_name);
    first.or_else(quoted).unwrap_or("query")
}

/// The only id of the path. Other texts are not found.
pub struct Id(pub String);

impl<S: Send + Sync> FromRequestParts<S> for Id {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> ApiResult<Self> {
        let found = path_texts(parts, state).await?;
        let id = found.first().and_then(|text| id(text));
        id.map(Id).ok_or_else(|| ApiError::not_found("resource"))
    }
}

/// The id of a key: the part between its two `_`.
pub struct KeyId(pub String);

impl<S: Send + Sync> FromRequestParts<S> for KeyId {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> ApiResult<Self> {
        let id = path_texts(parts, state).await?.pop().unwrap_or_default();
        match is_key_id(&id) {
            true => Ok(KeyId(id)),
            false => Err(ApiError::not_found("key that is in force")),
        }
    }
}

/// The id of a case and that of one of its plans.
pub struct PlanPath {
    pub case: String,
    pub id: String,
}

impl<S: Send + Sync> FromRequestParts<S> for PlanPath {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> ApiResult<Self> {
        let found = path_texts(parts, state).await?;
        let mut ids = found.iter().map(|text| id(text));
        match (ids.next().flatten(), ids.next().flatten()) {
            (Some(case), Some(id)) => Ok(PlanPath { case, id }),
            _ => Err(ApiError::not_found("plan of this case")),
        }
    }
}

/// The name of a file of the clients or of the page.
pub struct ServedFile(pub String);

impl<S: Send + Sync> FromRequestParts<S> for ServedFile {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> ApiResult<Self> {
        Ok(ServedFile(path_texts(parts, state).await?.pop().unwrap_or_default()))
    }
}

/// The id of a job and the name of one of its files.
pub struct FileName {
    pub job: String,
    pub name: String,
}

impl<S: Send + Sync> FromRequestParts<S> for FileName {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> ApiResult<Self> {
        let mut found = path_texts(parts, state).await?.into_iter();
        let (job, name) = (found.next().unwrap_or_default(), found.next().unwrap_or_default());
        let job = id(&job).ok_or_else(no_such_job)?;
        Ok(FileName { job, name })
    }
}

/// The tag of a list, empty if none was asked for: an empty one would be a silent default.
pub fn listed_tag(tag: Option<String>) -> ApiResult<String> {
    match tag.as_deref().map(str::trim) {
        Some("") => Err(ApiError::invalid_parameter("tag", "no tag is empty")),
        Some(_) | None => Ok(tag.unwrap_or_default()),
    }
}

pub fn no_such_job() -> ApiError {
    ApiError::new(ErrorCode::NoSuchJob, "there is no such job")
}

async fn path_texts<S: Send + Sync>(parts: &mut Parts, state: &S) -> ApiResult<Vec<String>> {
    let parameters = RawPathParams::from_request_parts(parts, state).await;
    let parameters = parameters.map_err(|error| {
        ApiError::new(ErrorCode::MalformedRequest, format!("the path is not readable: {error}"))
    })?;
    Ok(parameters.iter().map(|(_, text)| text.to_owned()).collect())
}

/// An id in canonical form.
pub fn id(text: &str) -> Option<String> {
    let id = Uuid::try_parse(text).ok()?.to_string();
    id.eq_ignore_ascii_case(text).then_some(id)
}
