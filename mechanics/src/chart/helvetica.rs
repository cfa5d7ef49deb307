//! Letters of Helvetica, which every reader of PDF has: their codes and how wide they are.
//!
//! Codes are those of WinAnsiEncoding (ISO 32000-1, annex D.2), which holds the letters of western Europe. Widths are in
//! thousandths of the font size, from 32 on; those of Liberation Sans, which has the metrics of Helvetica.

const PLAIN: [u16; 224] = [
    278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333, 278, 278, 556, 556, 556,
    556, 556, 556, 556, 556, 556, 556, 278, 278, 584, 584, 584, 556, 1015, 667, 667, 722, 722, 667,
    611, 778, 722, 278, 500, 667, 556, 833, 722, 778, 667, 778, 722, 667, 611, 722, 667, 944, 667,
    667, 611, 278, 278, 278, 469, 556, 333, 556, 556, 500, 556, 556, 278, 556, 556, 222, 222, 500,
    222, 833, 556, 556, 556, 556, 333, 500, 278, 556, 500, 722, 500, 500, 500, 334, 260, 334, 584,
    350, 556, 350, 222, 556, 333, 1000, 556, 556, 333, 1000, 667, 333, 1000, 350, 611, 350, 350,
    222, 222, 333, 333, 350, 556, 1000, 333, 1000, 500, 333, 944, 350, 500, 667, 278, 333, 556,
    556, 556, 556, 260, 556, 333, 737, 370, 556, 584, 333, 737, 552, 400, 549, 333, 333, 333, 576,
    537, 278, 333, 333, 365, 556, 834, 834, 834, 611, 667, 667, 667, 667, 667, 667, 1000, 722, 667,
    667, 667, 667, 278, 278, 278, 278, 722, 722, 778, 778, 778, 778, 778, 584, 778, 722, 722, 722,
    722, 667, 667, 611, 556, 556, 556, 556, 556, 556, 889, 500, 556, 556, 556, 556, 278, 278, 278,
    278, 556, 556, 556, 556, 556, 556, 556, 549, 611, 556, 556, 556, 556, 500, 556, 500,
];

const BOLD: [u16; 224] = [
    278, 333, 474, 556, 556, 889, 722, 238, 333, 333, 389, 584, 278, 333, 278, 278, 556, 556, 556,
    556, 556, 556, 556, 556, 556, 556, 333, 333, 584, 584, 584, 611, 975, 722, 722, 722, 722, 667,
    611, 778, 722, 278, 556, 722, 611, 833, 722, 778, 667, 778, 722, 667, 611, 722, 667, 944, 667,
    667, 611, 333, 278, 333, 584, 556, 333, 556, 611, 556, 611, 556, 333, 611, 611, 278, 278, 556,
    278, 889, 611, 611, 611, 611, 389, 556, 333, 611, 556, 778, 556, 556, 500, 389, 280, 389, 584,
    350, 556, 350, 278, 556, 500, 1000, 556, 556, 333, 1000, 667, 333, 1000, 350, 611, 350, 350,
    278, 278, 500, 500, 350, 556, 1000, 333, 1000, 556, 333, 944, 350, 500, 667, 278, 333, 556,
    556, 556, 556, 280, 556, 333, 737, 370, 556, 584, 333, 737, 552, 400, 549, 333, 333, 333, 576,
    556, 278, 333, 333, 365, 556, 834, 834, 834, 611, 722, 722, 722, 722, 722, 722, 1000, 722, 667,
    667, 667, 667, 278, 278, 278, 278, 722, 722, 778, 778, 778, 778, 778, 584, 778, 722, 722, 722,
    722, 667, 667, 611, 556, 556, 556, 556, 556, 556, 889, 556, 556, 556, 556, 556, 278, 278, 278,
    278, 611, 611, 611, 611, 611, 611, 611, 549, 611, 611, 611, 611, 611, 556, 611, 556,
];

/// What a letter without a code is written as.
const UNKNOWN: u8 = b'?';

/// The codes of words. What has none is written by its nearest relative, or as `?`.
pub fn encoded(words: &str) -> Vec<u8> {
    let mut codes = Vec::with_capacity(words.len());
    for letter in words.chars() {
        match letter {
            ' '..='~' | '\u{a0}'..='\u{ff}' => codes.push(u32::from(letter) as u8),
            '€' => codes.push(0x80),
            '„' => codes.push(0x84),
            '…' => codes.push(0x85),
            '‘' => codes.push(0x91),
            '’' => codes.push(0x92),
            '“' => codes.push(0x93),
            '”' => codes.push(0x94),
            '•' => codes.push(0x95),
            '–' => codes.push(0x96),
            '—' => codes.push(0x97),
            '−' => codes.push(b'-'),
            '≤' => codes.extend(b"<="),
            '≥' => codes.extend(b">="),
            '→' => codes.extend(b"->"),
            '\t' | '\n' | '\r' => codes.push(b' '),
            _ => codes.push(UNKNOWN),
        }
    }
    codes
}

/// How wide words are at a font size, in its units.
pub fn width(words: &str, size: f64, bold: bool) -> f64 {
    let widths = if bold { &BOLD } else { &PLAIN };
    let thousandths =
        encoded(words).into_iter().map(|code| f64::from(widths[usize::from(code) - 32]));
    thousandths.sum::<f64>() * size / 1000.0
}

/// Breaks words at spaces, and those that are too long anywhere, into lines of at most `room`.
pub fn lines(words: &str, room: f64, size: f64, bold: bool) -> Vec<String> {
    let fits = |line: &str| width(line, size, bold) <= room;
    let mut lines: Vec<String> = Vec::new();
    for word in words.split_whitespace() {
        if let Some(line) = lines.last_mut().filter(|line| fits(&format!("{line} {word}"))) {
            line.push(' ');
            line.push_str(word);
            continue;
        }
        let mut line = String::new();
        for letter in word.chars() {
            if !line.is_empty() && !fits(&format!("{line}{letter}")) {
                lines.push(std::mem::take(&mut line));
            }
            line.push(letter);
        }
        lines.push(line);
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn german_and_degrees_have_codes_and_other_scripts_are_marked() {
        assert_eq!(encoded("Größe 3°"), b"Gr\xf6\xdfe 3\xb0");
        assert_eq!(encoded("a – b ≤ 脸"), b"a \x96 b <= ?");
    }

    #[test]
    fn widths_are_those_of_the_font() {
        // Adobe Font Metrics of Helvetica: H 722, e 556, l 222, o 556; bold H 722, e 556, l 278, o 611.
        assert!((width("Hello", 10.0, false) - 22.78).abs() < 1e-9);
        assert!((width("Hello", 10.0, true) - 24.45).abs() < 1e-9);
    }

    #[test]
    fn a_word_without_spaces_is_broken_where_its_room_ends() {
        let hash = "0123456789abcdef".repeat(4);
        let broken = lines(&hash, 100.0, 8.0, false);
        assert!(broken.len() > 2 && broken.iter().all(|line| width(line, 8.0, false) <= 100.0));
        assert_eq!(broken.concat(), hash);
    }
}
