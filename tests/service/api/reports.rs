//! Reports: for people, in two languages, of everything that has something to show.

use serde_json::{Value, json};

use crate::helpers::{Answer, SMALL, Server, ask, spec};

async fn report(server: &Server, job: &Value, name: &str, language: &str) -> Answer {
    let path = format!("/v1/jobs/{}/results/{name}", job["id"].as_str().unwrap());
    ask(server.get(&path).header("accept-language", language)).await
}

/// A job that has ended, however busy the machine is.
async fn ended(server: &Server, document: &Value) -> Value {
    let answer = server.job(document).await;
    assert!(answer.status.is_success(), "{}", text(&answer));
    let job: Value = serde_json::from_slice(&answer.bytes).unwrap();
    let ended = server.ended(job["id"].as_str().unwrap()).await;
    assert_eq!(ended["status"], "successful", "{ended}");
    ended
}

fn text(answer: &Answer) -> String {
    String::from_utf8_lossy(&answer.bytes).into_owned()
}

#[tokio::test]
async fn a_prediction_has_a_report_in_the_language_that_is_asked_for_and_it_needs_nothing_else() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let job = ended(&server, &spec(&case, 2.0)).await;
    let html = report(&server, &job, "report.html", "de-DE, en;q=0.5").await;
    assert_eq!(html.header("content-type"), "text/html; charset=utf-8");
    assert_eq!(html.header("vary"), "Accept-Language");
    let german = text(&html);
    let hash = job["results"]["provenance"]["spec_hash"].as_str().unwrap();
    for words in
        ["lang=\"de\"", "Vorhergesagtes Gesicht", "kein Medizinprodukt", hash, "bone", "2.0"]
    {
        assert!(german.contains(words), "{words}");
    }
    assert_eq!(german.matches("data:image/png;base64,").count(), 9);
    for foreign in ["<script", "src=", "<link", "@import", "url("] {
        assert!(!german.contains(foreign), "{foreign}");
    }
    let english = text(&report(&server, &job, "report.html", "fr").await);
    assert!(english.contains("lang=\"en\"") && english.contains("not a medical device"));
    let stated = text(&report(&server, &job, "report.html?lang=de", "en").await);
    assert!(stated == german);
    report(&server, &job, "report.html?lang=fr", "en").await.problem(400, "invalid-parameter");
    let pdf = report(&server, &job, "report.pdf", "en").await;
    assert_eq!(pdf.header("content-type"), "application/pdf");
    assert!(pdf.bytes.starts_with(b"%PDF-") && text(&pdf).contains("/Count 2"), "two pages");
}

#[tokio::test]
async fn a_report_among_the_outputs_is_a_file_of_the_result() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let mut spec = spec(&case, 1.0);
    spec["outputs"] = json!(["skin.vtp", "report.html", "report.pdf"]);
    let job = ended(&server, &spec).await;
    let files = job["results"]["files"].as_array().unwrap().iter();
    let types: Vec<&Value> = files
        .filter(|file| file["name"].as_str().unwrap().starts_with("report"))
        .map(|file| &file["media_type"])
        .collect();
    assert_eq!(types, ["text/html; charset=utf-8", "application/pdf"]);
    let html = text(&report(&server, &job, "report.html", "de").await);
    assert!(html.contains("lang=\"en\""), "files are in English");
    let pictures = job["results"]["pictures"].as_array().unwrap();
    assert_eq!(*pictures, [json!("classes.svg"), json!("displacement.svg")]);
}

#[tokio::test]
async fn comparisons_and_studies_have_reports_and_no_pictures_of_predictions() {
    let server = Server::start();
    let case = server.case(&SMALL).await;
    let predicted = ended(&server, &spec(&case, 2.0)).await;
    let mut kept = spec(&case, 1.0);
    kept["keep"] = json!(["skin"]);
    let kept = ended(&server, &kept).await;
    let compare = json!({
        "kind": "compare", "prediction": {"job": predicted["id"]},
        "actual": {"mesh": kept["results"]["kept"][0]["mesh"]},
    });
    let study = json!({
        "kind": "study", "scenes": ["slab"], "plans": ["patch 2 mm"], "methods": ["fem_linear"],
        "elements": ["plain"], "truth": {"refine": 1, "element": "stabilised"}, "repeats": 1,
    });
    for (document, words) in [(compare, "Registration"), (study, "Time against error")] {
        let job = ended(&server, &document).await;
        assert_eq!(job["results"]["pictures"], json!(["report.html", "report.pdf"]));
        let html = report(&server, &job, "report.html", "en").await;
        assert!(text(&html).contains(words), "{words}");
        let pdf = report(&server, &job, "report.pdf", "de").await;
        assert!(pdf.bytes.starts_with(b"%PDF-"));
        report(&server, &job, "displacement.svg", "en").await.problem(404, "no-such-output");
    }
}
