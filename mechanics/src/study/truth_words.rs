//! Origin of a reference solution in words.

/// How often the edges of level 0 were halved.
pub(super) fn halved(times: u32) -> String {
    match times {
        0 => "on the mesh of level 0".to_owned(),
        1 => "every edge of level 0 halved once".to_owned(),
        2 => "every edge of level 0 halved twice".to_owned(),
        times => format!("every edge of level 0 halved {times} times"),
    }
}

/// A number with a space between groups of three digits.
pub(super) fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::grouped;

    #[test]
    fn numbers_are_grouped_by_three_digits() {
        assert_eq!([7, 693, 69_301, 1_234_567].map(grouped), ["7", "693", "69 301", "1 234 567"]);
    }
}
