//! Security headers of responses: nothing is allowed to browsers, except on the pages of the documentation, of the
//! clients and for planners, which run their own scripts (W3C Content Security Policy 3).

use axum::extract::Request;
use axum::http::{HeaderName, HeaderValue, header};
use axum::middleware::Next;
use axum::response::Response;

/// No scripts, forms, fetches or frames. Styles and images within a report or a picture are inline.
const NOTHING: &str = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; \
     form-action 'none'; frame-ancestors 'none'";
/// Scripts, styles and pictures of this service, with requests to this service only.
const OWN: &str = "default-src 'none'; script-src 'self'; style-src 'self' 'unsafe-inline'; \
     img-src 'self' data:; connect-src 'self'; base-uri 'none'; form-action 'none'; \
     frame-ancestors 'none'";

/// The page for planners: no inline styles either; its pictures may be made in the browser.
const PLANNER: &str = "default-src 'none'; script-src 'self'; style-src 'self'; \
     img-src 'self' data: blob:; connect-src 'self'; base-uri 'none'; form-action 'none'; \
     frame-ancestors 'none'";

/// The headers of every response.
pub fn guarded(mut response: Response) -> Response {
    let fixed = [
        (header::CONTENT_SECURITY_POLICY, NOTHING),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        // Addresses hold ids, which lead to patients.
        (header::REFERRER_POLICY, "no-referrer"),
    ];
    for (name, value) in fixed {
        set_once(&mut response, name, value);
    }
    response
}

/// Those of the pages of the documentation.
pub async fn of_pages(request: Request, next: Next) -> Response {
    as_page(next.run(request).await)
}

/// A response that may run scripts of this service.
pub fn as_page(mut response: Response) -> Response {
    set_once(&mut response, header::CONTENT_SECURITY_POLICY, OWN);
    response
}

/// The page for planners and its files.
pub fn as_planner(mut response: Response) -> Response {
    set_once(&mut response, header::CONTENT_SECURITY_POLICY, PLANNER);
    response
}

fn set_once(response: &mut Response, name: HeaderName, value: &'static str) {
    let headers = response.headers_mut();
    headers.entry(name).or_insert(HeaderValue::from_static(value));
}
