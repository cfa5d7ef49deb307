//! Documents that are no JSON, or not the JSON that is asked for: each refused with its place.

use facies::schema::wire::strict;
use facies::schema::{Limits, PlanDocument};
use mechanics::prediction::Prescribed;

use crate::schema::documents::{one, plan, refused, settings};

#[test]
fn what_is_not_a_number_is_refused_with_its_place() {
    for value in ["NaN", "Infinity", "1e999", "-1e999"] {
        let text = format!(r#"{{"segments":[{{"name":"jaw","translation_mm":[0,{value},0]}}]}}"#);
        let problem = plan(&text).expect_err("refused");
        assert_eq!(problem.code.name(), "malformed-json");
        assert_eq!(problem.members["line"], 1);
        assert_eq!(problem.members["pointer"], "/segments/0/translation_mm/1", "{value}");
    }
    for value in ["null", "\"3\"", "[1]", "true"] {
        let text = format!(r#"{{"segments":[{{"name":"jaw","translation_mm":[0,{value},0]}}]}}"#);
        let place = "/segments/0/translation_mm/1";
        let wanted = one("validation-failed", "wrong-type", place);
        assert_eq!(refused(plan(&text)), wanted, "{value}");
    }
    for short in ["[0,0]", "[0,0,0,0]"] {
        let text = format!(r#"{{"segments":[{{"name":"jaw","translation_mm":{short}}}]}}"#);
        let wanted = one("validation-failed", "wrong-type", "/segments/0/translation_mm");
        assert_eq!(refused(plan(&text)), wanted, "{short}");
    }
}

#[test]
fn an_integer_may_be_written_with_a_decimal_point() {
    let limits = Limits::default();
    let read = strict::parse::<[i64; 3]>(b"[3.0, -2e1, 4]", &limits);
    assert_eq!(read.expect("accepted"), [3, -20, 4]);
    assert!(strict::parse::<[i64; 1]>(b"[3.5]", &limits).is_err());
}

#[test]
fn null_is_a_value_only_where_a_component_may_stay_free() {
    let text = r#"{"segments":[],"frame":null}"#;
    assert_eq!(refused(plan(text)), one("validation-failed", "null-value", "/frame"));
    let text = r#"{"prescribed":[{"nodes":{"node_set":"a"},"displacement_mm":[1,null,0]}]}"#;
    let Prescribed::Uniform { displacement, .. } = &plan(text).expect("accepted").prescribed[0]
    else {
        panic!("a uniform displacement");
    };
    assert_eq!(*displacement, [Some(1.0), None, Some(0.0)]);
}

#[test]
fn every_misspelt_field_is_named() {
    let text = r#"{"segments":[{"name":"jaw","translation":[0,5,0]},{"name":"chin","tranlation_mm":[0,1,0]}]}"#;
    let (code, errors) = refused(plan(text));
    assert_eq!(code, "validation-failed");
    let unknown = |place: &str| ("unknown-field".to_owned(), place.to_owned());
    let wanted = [unknown("/segments/0/translation"), unknown("/segments/1/tranlation_mm")];
    assert_eq!(errors, wanted);
}

#[test]
fn mistakes_of_every_kind_are_named_in_one_answer() {
    let text =
        r#"{"segments":[{"name":5,"translation_mm":"far"}],"loads":{},"frame":"XX","speed":1}"#;
    let (_, mut errors) = refused(plan(text));
    errors.sort();
    let wanted = [
        ("unknown-field", "/speed"),
        ("unknown-word", "/frame"),
        ("wrong-type", "/loads"),
        ("wrong-type", "/segments/0/name"),
        ("wrong-type", "/segments/0/translation_mm"),
    ];
    assert_eq!(errors, wanted.map(|(code, place)| (code.to_owned(), place.to_owned())));
}

#[test]
fn a_repeated_key_is_refused_in_objects_and_in_maps() {
    let in_object = r#"{"segments":[{"name":"jaw","name":"chin","translation_mm":[0,0,0]}]}"#;
    let wanted = one("validation-failed", "duplicate-key", "/segments/0/name");
    assert_eq!(refused(plan(in_object)), wanted);
    let in_map =
        r#"{"materials":{"soft":{"young_modulus_kpa":15},"soft":{"young_modulus_kpa":30}}}"#;
    let wanted = one("validation-failed", "duplicate-key", "/materials/soft");
    assert_eq!(refused(settings(in_map)), wanted);
}

#[test]
fn pointers_escape_what_stands_in_names() {
    let text = r#"{"materials":{"a/b~c":{"young_modulus":1}}}"#;
    let place = "/materials/a~1b~0c/young_modulus";
    assert_eq!(refused(settings(text)), one("validation-failed", "unknown-field", place));
}

#[test]
fn what_is_not_json_is_refused_with_line_and_column() {
    let deep = format!("{}{}", "[".repeat(100_000), "]".repeat(100_000));
    let utf16: Vec<u8> = "{}".encode_utf16().flat_map(u16::to_le_bytes).collect();
    let bodies: [&[u8]; 8] = [
        deep.as_bytes(),
        &utf16,
        b"\xef\xbb\xbf\xef\xbb\xbf{}",
        b"{\"frame\":\"\xff\"}",
        br#"{"name":"\ud800"}"#,
        b"{} {}",
        b"",
        b"{\"a\":1,}",
    ];
    for body in bodies {
        let result: Result<PlanDocument, _> = strict::parse(body, &Limits::default());
        let problem = result.expect_err("refused");
        assert_eq!(problem.code.name(), "malformed-json");
        assert!(problem.members.contains_key("line") && problem.members.contains_key("column"));
    }
    let marked: PlanDocument = strict::parse(b"\xef\xbb\xbf{}", &Limits::default()).unwrap();
    assert_eq!(marked, PlanDocument::default());
}

#[test]
fn thirty_two_levels_are_read_and_thirty_three_are_not() {
    let nested = |levels: usize| format!("{}{}", "[".repeat(levels), "]".repeat(levels));
    let limits = Limits::default();
    assert!(strict::parse_value(nested(32).as_bytes(), &limits).is_ok());
    let problem = strict::parse_value(nested(33).as_bytes(), &limits).expect_err("refused");
    assert!(problem.detail.contains("deeper than 32 levels"), "{}", problem.detail);
}

#[test]
fn the_place_of_a_byte_that_is_not_utf8_is_reported() {
    let problem = strict::parse_value(b"{\n \"a\":\"\xff\"}", &Limits::default()).expect_err("no");
    assert_eq!((&problem.members["line"], &problem.members["column"]), (&2.into(), &7.into()));
}

#[test]
fn a_body_larger_than_a_mebibyte_is_not_read() {
    let body = format!("{{\"a\":\"{}\"}}", "x".repeat(1 << 20));
    let problem = strict::parse_value(body.as_bytes(), &Limits::default()).expect_err("refused");
    assert_eq!(
        (problem.code.name(), &problem.members["limit"]),
        ("payload-too-large", &1_048_576.into())
    );
}
