//! Trusted hosts and origins if no key is required: those of this machine, and those in the settings. A page of
//! another site reaches a loopback address through the browser of its reader, by a form, or under a name of its own
//! that it lets resolve to 127.0.0.1 (DNS rebinding).

use std::net::IpAddr;

use axum::extract::Request;
use axum::http::uri::Authority;
use axum::http::{HeaderMap, Version, header};

use super::error::ApiResult;
use crate::schema::ErrorCode;
use crate::schema::wire::problem::Problem;

/// The browser's header of the origin of a request (W3C Fetch Metadata).
const FETCH_SITE: &str = "sec-fetch-site";

/// Host names of the service, and origins whose pages may call it, beside those of this machine.
#[derive(Clone, Debug)]
pub struct Hosts {
    names: Vec<String>,
    origins: Vec<String>,
}

impl Hosts {
    pub fn new(names: &[String], origins: &[String]) -> Hosts {
        Hosts { names: names.to_vec(), origins: origins.to_vec() }
    }

    /// Refuses a request with a foreign host name, or from a page of another site. A
    /// request without a Host (HTTP/1.0) or without the headers that browsers add is neither.
    pub fn check(&self, request: &Request) -> ApiResult<()> {
        let authority = request.uri().authority().map(Authority::as_str);
        let hosts = texts(request.headers(), header::HOST.as_str());
        let hosts: Vec<&str> = hosts.into_iter().chain(authority).collect();
        for host in &hosts {
            self.check_host(host)?;
        }
        self.check_page(request.headers(), &hosts)
    }

    fn check_host(&self, host: &str) -> ApiResult<()> {
        let is_known = name_of(host)
            .is_some_and(|name| is_of_this_machine(&name) || self.names.contains(&name));
        if is_known {
            return Ok(());
        }
        let detail = "this service requires no key and serves localhost, loopback addresses and the names of the \
             setting allowed-hosts only";
        Err(Problem::new(ErrorCode::UnknownHost, detail).with("host", host).into())
    }

    fn check_page(&self, headers: &HeaderMap, hosts: &[&str]) -> ApiResult<()> {
        let origins = texts(headers, header::ORIGIN.as_str());
        let is_named = |origin: &&str| self.origins.iter().any(|known| known == origin);
        if !origins.is_empty() && origins.iter().all(is_named) {
            return Ok(());
        }
        let is_own = |origin: &&str| {
            let page = origin.split_once("://").map(|(_, authority)| authority);
            page.is_some_and(|page| hosts.iter().any(|host| host.eq_ignore_ascii_case(page)))
        };
        let is_cross_site = texts(headers, FETCH_SITE).contains(&"cross-site");
        if !is_cross_site && origins.iter().all(is_own) {
            return Ok(());
        }
        let detail = "this service requires no key and serves its own pages and those of the setting \
             allowed-origins only";
        let problem = Problem::new(ErrorCode::ForeignOrigin, detail);
        Err(problem.with("origin", origins.join(", ")).into())
    }
}

/// Refuses a request of HTTP/1.1 without a host, or with several (RFC 9112, section 3.2), and one with several keys.
pub fn check_named_once(request: &Request) -> ApiResult<()> {
    let keys = request.headers().get_all(header::AUTHORIZATION).iter().count();
    if keys > 1 {
        let detail = format!("a request has one header Authorization, and this one has {keys}");
        return Err(Problem::new(ErrorCode::MalformedRequest, detail).into());
    }
    let count = request.headers().get_all(header::HOST).iter().count();
    if count == 1 || request.version() != Version::HTTP_11 {
        return Ok(());
    }
    let detail = format!("a request of HTTP/1.1 has one header Host, and this one has {count}");
    Err(Problem::new(ErrorCode::MalformedRequest, detail).into())
}

/// The values of a header; one that is not text is an unknown name.
fn texts<'a>(headers: &'a HeaderMap, name: &str) -> Vec<&'a str> {
    headers.get_all(name).iter().map(|value| value.to_str().unwrap_or("?")).collect()
}

/// The host without its port, in lower case.
fn name_of(host: &str) -> Option<String> {
    let authority: Authority = host.parse().ok()?;
    let name = authority.host().to_ascii_lowercase();
    (!host.contains('@')).then_some(name)
}

fn is_of_this_machine(name: &str) -> bool {
    let address = name.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')).unwrap_or(name);
    name == "localhost" || address.parse().is_ok_and(|address: IpAddr| address.is_loopback())
}

#[cfg(test)]
mod tests {
    use axum::body::Body;

    use super::*;

    fn code(uri: &str, headers: &[(&str, &str)]) -> Option<&'static str> {
        let hosts = Hosts::new(&["planning".into()], &["https://planning.example".into()]);
        let request = Request::builder().uri(uri);
        let request =
            headers.iter().fold(request, |request, (name, value)| request.header(*name, *value));
        let checked = hosts.check(&request.body(Body::empty()).unwrap());
        checked.err().map(|error| error.problem.code.name())
    }

    #[test]
    fn only_names_of_this_machine_and_of_the_settings_are_answered_to() {
        for host in [
            "localhost",
            "LOCALHOST:8080",
            "127.0.0.1:8080",
            "127.8.9.1",
            "[::1]:8080",
            "[::1]",
            "Planning:80",
        ] {
            assert_eq!(code("/v1/cases", &[("host", host)]), None, "{host}");
        }
        for host in [
            "evil.example:8080",
            "localhost.evil.example",
            "127.0.0.1.evil.example",
            "127.0.0.1@evil.example",
            "evil@127.0.0.1",
            "10.0.0.1",
            "0.0.0.0:8080",
            "[::2]:80",
            "",
            "a b",
        ] {
            assert_eq!(code("/v1/cases", &[("host", host)]), Some("unknown-host"), "{host}");
        }
        let two = [("host", "localhost"), ("host", "evil.example")];
        assert_eq!(code("/v1/cases", &two), Some("unknown-host"));
        assert_eq!(code("http://evil.example/v1/cases", &[]), Some("unknown-host"));
        assert_eq!(code("/v1/cases", &[]), None, "HTTP/1.0 has no Host");
    }

    #[test]
    fn a_page_of_another_site_is_refused_and_one_that_a_setting_names_is_not() {
        let from = |headers: &[(&str, &str)]| {
            let all: Vec<_> = [("host", "localhost:8080")].iter().chain(headers).copied().collect();
            code("/v1/meshes", &all)
        };
        let foreign = Some("foreign-origin");
        assert_eq!(from(&[("origin", "http://localhost:8080")]), None);
        assert_eq!(from(&[("sec-fetch-site", "same-origin")]), None);
        assert_eq!(from(&[("sec-fetch-site", "none")]), None, "typed by a person");
        let ours = ("origin", "https://planning.example");
        assert_eq!(from(&[ours, ("sec-fetch-site", "cross-site")]), None);
        assert_eq!(from(&[("origin", "http://localhost:3000")]), foreign);
        assert_eq!(from(&[("origin", "http://evil.example:8080")]), foreign);
        assert_eq!(from(&[("origin", "null")]), foreign);
        assert_eq!(from(&[("sec-fetch-site", "cross-site")]), foreign);
        assert_eq!(from(&[ours, ("origin", "http://evil.example")]), foreign);
    }
}
