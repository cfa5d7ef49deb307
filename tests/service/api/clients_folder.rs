//! Packages of the clients are handed out from a folder, and nothing else is.

use reqwest::StatusCode;
use tempfile::TempDir;

use crate::helpers::{Server, ask};

/// A folder with a package, a page, a folder and a link that leads out of it.
fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    std::fs::create_dir(folder.path().join("clients")).unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("secret", "secret");
    write("clients/facies_client-0.1.0-py3-none-any.whl", "package");
    write("clients/sliders.html", "<p>page</p>");
    write("clients/.hidden", "secret");
    std::fs::create_dir(folder.path().join("clients/inner")).unwrap();
    write("clients/inner/deep", "secret");
    #[cfg(unix)]
    std::os::unix::fs::symlink("../secret", folder.path().join("clients/link")).unwrap();
    folder
}

#[tokio::test]
async fn a_service_without_a_folder_of_clients_says_so() {
    let server = Server::start();
    let empty = TempDir::new().unwrap();
    let other = Server::start_with(&["--clients-folder", empty.path().to_str().unwrap()]);
    ask(server.get("/clients/facies.js")).await.problem(404, "clients-not-built");
    ask(server.get("/clients")).await.problem(404, "clients-not-built");
    ask(other.get("/clients")).await.problem(404, "clients-not-built");
    let gone = empty.path().join("gone");
    let third = Server::start_with(&["--clients-folder", gone.to_str().unwrap()]);
    ask(third.get("/clients/facies.js")).await.problem(404, "clients-not-built");
}

#[tokio::test]
async fn clients_are_listed_and_served_to_everybody() {
    let folder = folder();
    let clients = folder.path().join("clients");
    let key = "0123456789abcdef";
    let arguments = ["--clients-folder", clients.to_str().unwrap(), "--api-key", key];
    let server = Server::start_with(&arguments);
    let page = ask(server.get("/clients")).await;
    assert_eq!(page.status, StatusCode::OK);
    let page = String::from_utf8(page.bytes).unwrap();
    let links: Vec<&str> =
        page.split("href=\"").skip(1).map(|rest| rest.split('"').next().unwrap()).collect();
    let wheel = "/clients/facies_client-0.1.0-py3-none-any.whl";
    assert_eq!(links, ["/", wheel, "/clients/sliders.html"]);
    let package = ask(server.get(wheel)).await;
    assert_eq!((package.status, package.bytes.as_slice()), (StatusCode::OK, &b"package"[..]));
    assert_eq!(package.header("content-type"), "application/zip");
    let known = server.get(wheel).header("if-none-match", package.header("etag"));
    assert_eq!(ask(known).await.status, StatusCode::NOT_MODIFIED);
    let page = ask(server.get("/clients/sliders.html")).await;
    assert_eq!(page.header("content-type"), "text/html; charset=utf-8");
    let policy = page.header("content-security-policy");
    assert!(policy.contains("script-src 'self';") && policy.contains("connect-src 'self';"));
}

#[tokio::test]
async fn nothing_but_the_files_of_the_folder_is_served() {
    let folder = folder();
    let clients = folder.path().join("clients");
    let server = Server::start_with(&["--clients-folder", clients.to_str().unwrap()]);
    for path in [
        "..%2Fsecret",
        "%2e%2e%2fsecret",
        ".hidden",
        "inner",
        "inner%2Fdeep",
        "link",
        "%00",
        "none.js",
    ] {
        ask(server.get(&format!("/clients/{path}"))).await.problem(404, "not-found");
    }
}
