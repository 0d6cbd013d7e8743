//! Names from files, made fit to print.

/// The text with what a terminal would obey or a reader not see written as `\u{…}`: control characters, line and paragraph
/// separators, and characters that are invisible or turn the direction of what follows.
///
/// For whatever is printed that a file chose: names of models, keys, quoted values, and paths.
pub fn escaped(text: &str) -> String {
    let mut printed = String::with_capacity(text.len());
    for c in text.chars() {
        if is_plain(c) { printed.push(c) } else { printed.extend(c.escape_unicode()) }
    }
    printed
}

fn is_plain(c: char) -> bool {
    let is_hidden = matches!(c,
        '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}'
        | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}');
    !c.is_control() && !is_hidden
}

#[cfg(test)]
mod tests {
    use super::escaped;

    #[test]
    fn what_a_terminal_would_obey_is_escaped_and_words_are_not() {
        assert_eq!(escaped("a\u{7}\u{1b}[2J\n\u{9b}0m\u{7f}"), r"a\u{7}\u{1b}[2J\u{a}\u{9b}0m\u{7f}");
        assert_eq!(
            escaped("x\u{202e}y\u{2066}\u{200b}\u{feff}\u{2028}"),
            r"x\u{202e}y\u{2066}\u{200b}\u{feff}\u{2028}"
        );
        let words = r#"Träger "1" <b>\ α 面 e\u0301 🚗"#;
        assert_eq!(escaped(words), words);
    }
}
