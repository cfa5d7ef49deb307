//! Matches over methods, elements, cell shapes and kinds of jobs, held against wildcard arms: with one, a new member
//! would be taken for another in silence.

use crate::source::Crate;

/// Enumerations whose matches name every member.
const CLOSED: [&str; 7] =
    ["CellShape", "ElementChoice", "JobKind", "Method", "MethodKind", "MethodName", "Unknowns"];

#[test]
fn no_match_over_methods_elements_shapes_or_kinds_has_a_wildcard() {
    let mut broken = Vec::new();
    for folder in ["src", "mechanics/src"] {
        for file in Crate::read(folder).files.values() {
            let found = wildcards(&file.code);
            broken.extend(found.iter().map(|arm| format!("{}: {arm}", file.path.display())));
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

#[test]
fn wildcards_and_names_for_the_rest_are_found_and_other_matches_are_left_alone() {
    let of = |arms: &str| wildcards(&format!("let a = match b.c(|d| d) {{ {arms} }};"));
    assert_eq!(of("Method::FemLinear => 1, _ => 2"), ["_"]);
    assert_eq!(of("_ if d => {} Method::FemLinear => f(1, 2), Method::Other(_) => {}"), ["_ if d"]);
    assert_eq!(of("super::JobKind::Predict => {} other => other.name(),"), ["other"]);
    assert!(
        of("Method::FemLinear | Method::Other(_) => (), Method::Third { .. } => {}").is_empty()
    );
    assert!(of("ErrorMethod::Other => 1, _ => 2").is_empty());
    assert!(of("Method::GET => 1, _ => 2").is_empty());
    assert_eq!(of("1 => match e { CellShape::Tet4 => 1, _ => 2 }, _ => 3"), ["_"]);
    assert_eq!(wildcards("match a { _ => match b { Method::Any => 1, c => 2 } }"), ["c"]);
}

/// The wildcard arms of matches of which another arm names a member of a closed enumeration.
fn wildcards(code: &str) -> Vec<String> {
    let mut found = Vec::new();
    for (at, _) in code.match_indices("match ") {
        let is_word = !code[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_');
        let inside = inside_of(&code[at..]).filter(|_| is_word);
        let patterns = inside.map(|begin| patterns(&code[at + begin..])).unwrap_or_default();
        if patterns.iter().any(|pattern| names_closed(pattern)) {
            found.extend(patterns.iter().filter(|pattern| is_wildcard(pattern)).cloned());
        }
    }
    found
}

/// Where the arms of a match begin, behind the brace.
fn inside_of(code: &str) -> Option<usize> {
    let mut depth = 0;
    let opening = code.char_indices().find(|(_, c)| {
        depth += i32::from("([".contains(*c)) - i32::from(")]".contains(*c));
        depth == 0 && *c == '{'
    });
    opening.map(|(at, _)| at + 1)
}

/// What stands before each `=>` of a match, whose inside the text begins with.
fn patterns(inside: &str) -> Vec<String> {
    let (mut patterns, mut rest) = (Vec::new(), inside);
    while let Some((pattern, behind)) = rest.split_once("=>") {
        let pattern = pattern.trim_start_matches([',', ' ', '\n']).trim();
        if pattern.starts_with('}') {
            break;
        }
        patterns.push(pattern.split_whitespace().collect::<Vec<_>>().join(" "));
        rest = behind_arm(behind.trim_start());
    }
    patterns
}

/// The text behind what an arm does: a block, or an expression up to a comma or to the end of the match.
fn behind_arm(text: &str) -> &str {
    let is_block = text.starts_with('{');
    let mut depth = 0;
    for (at, c) in text.char_indices() {
        depth += i32::from("([{".contains(c)) - i32::from(")]}".contains(c));
        match c {
            '}' if is_block && depth == 0 => return &text[at + 1..],
            ',' if !is_block && depth == 0 => return &text[at..],
            '}' if depth < 0 => return &text[at..],
            _ => {}
        }
    }
    ""
}

/// Whether it names a member of a closed enumeration; `Method::GET` is a constant of another `Method`.
fn names_closed(pattern: &str) -> bool {
    let is_part = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    pattern.split(|c| !is_part(c)).filter_map(|path| path.rsplit_once("::")).any(|(of, member)| {
        let name = of.rsplit("::").next().unwrap_or_default();
        CLOSED.contains(&name) && member.contains(|c: char| c.is_lowercase())
    })
}

/// `_` or a name of its own, with or without a condition.
fn is_wildcard(pattern: &str) -> bool {
    let head = pattern.split(" if ").next().unwrap_or_default();
    let is_name = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    head.starts_with(|c: char| c.is_ascii_lowercase() || c == '_') && head.chars().all(is_name)
}
