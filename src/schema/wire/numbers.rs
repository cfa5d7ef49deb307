//! Numbers in sentences: those with hundreds of digits in scientific notation.

/// Numbers with more characters are shortened; every integer of 64 bits has at most so many.
const LONGEST: usize = 20;

/// A sentence with each very long number in scientific notation, which means the same: 1e300 for a one with 300 zeros. Digits that are
/// part of a word, a path or a name in quotes stay.
pub fn with_short_numbers(text: &str) -> String {
    let mut short = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(first) = rest.find(|c: char| c.is_ascii_digit()) {
        let (before, from) = rest.split_at(first);
        let length = from.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(from.len());
        let number = from[..length].trim_end_matches('.');
        let after = &from[number.len()..];
        short.push_str(before);
        let lead = short.strip_suffix('-').unwrap_or(&short);
        let is_alone = !lead.chars().next_back().is_some_and(holds_number)
            && !after.trim_start_matches('.').chars().next().is_some_and(holds_number);
        match number.parse::<f64>() {
            Ok(value) if is_alone && number.len() > LONGEST && value.is_finite() => {
                short.push_str(&format!("{value:e}"));
            }
            _ => short.push_str(number),
        }
        rest = after;
    }
    short + rest
}

/// Whether digits beside this character are part of something else than a number.
fn holds_number(c: char) -> bool {
    c.is_alphanumeric() || "_./\\-\"'`".contains(c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_numbers_are_short_and_everything_else_stays() {
        for (value, wanted) in
            [(1e300, "1e300"), (-2.5e-40, "-2.5e-40"), (f64::MAX, "1.7976931348623157e308")]
        {
            let told = with_short_numbers(&format!("{value} mm is outside 0.5 to {value}."));
            assert_eq!(told, format!("{wanted} mm is outside 0.5 to {wanted}."));
        }
        let digits = "0123456789".repeat(4);
        for same in [
            "18446744073709551615 bytes, 0.12345678901234567 mm (1, 2, 3)",
            &format!("no mesh a{digits} and {digits}f, _{digits}"),
            &format!("1.2.840.{digits}.5 is no number"),
            &format!("/data/{digits}/x, scan-{digits}, {digits}.nrrd"),
            &format!("no region {digits:?} and no `{digits}`"),
            "",
        ] {
            assert_eq!(with_short_numbers(same), same);
        }
    }
}
