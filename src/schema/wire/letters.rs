//! Letters that nobody sees, of which a text that people compare has none.

/// Whether a letter is one of format: of the general category Cf of Unicode 15, such as zero width spaces and changes of the
/// direction of writing, or a separator of lines or paragraphs, or one that is drawn as nothing: the fillers of Hangul and the blank
/// pattern of braille. Not the two joiners, with which some languages are written.
pub fn is_unseen(letter: char) -> bool {
    matches!(letter,
        '\u{ad}'
        | '\u{600}'..='\u{605}'
        | '\u{61c}'
        | '\u{6dd}'
        | '\u{70f}'
        | '\u{890}'..='\u{891}'
        | '\u{8e2}'
        | '\u{115f}'..='\u{1160}'
        | '\u{180e}'
        | '\u{200b}'
        | '\u{200e}'..='\u{200f}'
        | '\u{2028}'..='\u{202e}'
        | '\u{2060}'..='\u{2064}'
        | '\u{2066}'..='\u{206f}'
        | '\u{2800}'
        | '\u{3164}'
        | '\u{feff}'
        | '\u{ffa0}'
        | '\u{fff9}'..='\u{fffb}'
        | '\u{110bd}'
        | '\u{110cd}'
        | '\u{13430}'..='\u{1343f}'
        | '\u{1bca0}'..='\u{1bca3}'
        | '\u{1d173}'..='\u{1d17a}'
        | '\u{e0001}'
        | '\u{e0020}'..='\u{e007f}')
}

/// Whether nobody sees anything of a text: spaces, unseen letters, and joiners and selectors of variants, which change others.
pub fn is_blank(text: &str) -> bool {
    let changes_others = |letter: char| {
        matches!(letter,
            '\u{34f}'
            | '\u{17b4}'..='\u{17b5}'
            | '\u{180b}'..='\u{180f}'
            | '\u{200c}'..='\u{200d}'
            | '\u{fe00}'..='\u{fe0f}'
            | '\u{e0100}'..='\u{e01ef}')
    };
    text.chars().all(|letter| letter.is_whitespace() || is_unseen(letter) || changes_others(letter))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_blank_where_nothing_of_it_is_seen() {
        for text in ["", " \u{a0}", "\u{200d}", "\u{200b}\u{3164}", "\u{2800} \u{fe0f}", "\u{200f}"]
        {
            assert!(is_blank(text), "{text:?}");
        }
        // Hebrew with its marks of direction, Persian with a joiner, an emoji with its variant.
        for text in [
            "\u{200f}\u{5d0}\u{5d1}\u{200e}",
            "\u{645}\u{6cc}\u{200c}\u{62e}",
            "\u{2764}\u{fe0f}",
            "a",
        ] {
            assert!(!is_blank(text), "{text:?}");
        }
        // Hangul and braille that are seen.
        assert!(!['\u{1100}', '\u{1161}', '\u{3163}', '\u{2801}'].into_iter().any(is_unseen));
    }
}
