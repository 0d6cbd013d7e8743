//! Text from outside, made safe to show: a name must not move the cursor, turn lines around or pass for another line.

use std::borrow::Cow;
use std::fmt::Write;

/// Whether a character shows nothing of itself and changes how others are shown: control characters, and those that
/// Unicode calls formats, which join, hide and reverse text.
fn is_hidden(c: char) -> bool {
    c.is_control()
        || matches!(c,
            '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}'
            | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{1d173}'..='\u{1d17a}' | '\u{e0000}'..='\u{e007f}')
}

fn replaced(text: &str, hidden: impl Fn(char) -> bool, write: impl Fn(&mut String, char)) -> Cow<'_, str> {
    if !text.contains(&hidden) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        if hidden(c) { write(&mut shown, c) } else { shown.push(c) }
    }
    Cow::Owned(shown)
}

/// A name, or other text of one line: hidden characters, line ends among them, stand as `\u{…}`.
pub fn escaped(text: &str) -> Cow<'_, str> {
    replaced(text, is_hidden, |shown, c| shown.extend(c.escape_unicode()))
}

/// Text of several lines: as [`escaped`], but line ends and tabs stay.
pub fn escaped_lines(text: &str) -> Cow<'_, str> {
    replaced(text, |c| is_hidden(c) && c != '\n' && c != '\t', |shown, c| shown.extend(c.escape_unicode()))
}

/// Text as HTML takes it: nothing in it passes for markup, and hidden characters are [`escaped`], but for line ends.
pub fn html(text: &str) -> String {
    let visible: Vec<_> = text.lines().map(escaped).collect();
    visible.join("\n").replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// The name that was most likely meant by a misspelt one: at most a third of its characters are wrong, missing, too many or
/// exchanged with their neighbours. `None` where none is that near. Text of over 64 characters is nobody's name.
pub fn nearest<'n>(text: &str, names: &[&'n str]) -> Option<&'n str> {
    let near = names.iter().map(|name| (edits(&text.to_lowercase(), name), *name));
    let allowed = text.chars().count().div_ceil(3);
    near.filter(|(edits, _)| text.len() <= 64 && *edits <= allowed)
        .min_by_key(|(edits, _)| *edits)
        .map(|(_, name)| name)
}

/// How many characters must be changed, put in, left out or exchanged with the next to make one text of the other (Damerau
/// 1964, doi:10.1145/363958.363994; no place is touched twice).
fn edits(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    let mut table = vec![vec![0; b.len() + 1]; a.len() + 1];
    for i in 0..=a.len() {
        for j in 0..=b.len() {
            table[i][j] = if i == 0 || j == 0 {
                i + j
            } else {
                let changed = table[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
                let exchanged = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
                let least = changed.min(table[i - 1][j] + 1).min(table[i][j - 1] + 1);
                if exchanged { least.min(table[i - 2][j - 2] + 1) } else { least }
            };
        }
    }
    table[a.len()][b.len()]
}

/// A count with its thousands apart.
pub fn grouped(count: usize) -> String {
    let digits = count.to_string();
    let first = digits.len() % 3;
    let groups = digits.as_bytes()[first..].chunks(3).map(|group| group.iter().map(|&b| char::from(b)).collect());
    let head = (first > 0).then(|| digits[..first].to_owned());
    head.into_iter().chain(groups).collect::<Vec<String>>().join(",")
}

/// A JSON document with the same meaning, in which hidden characters stand as `\uXXXX`: they occur in strings alone.
pub fn escaped_json(text: &str) -> Cow<'_, str> {
    replaced(
        text,
        |c| is_hidden(c) && !" \n\t\r".contains(c),
        |shown, c| {
            for unit in c.encode_utf16(&mut [0; 2]) {
                write!(shown, "\\u{unit:04x}").expect("a string takes all");
            }
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thousands_stand_apart() {
        let cases =
            [(0, "0"), (12, "12"), (999, "999"), (1_000, "1,000"), (92_011, "92,011"), (1_234_567, "1,234,567")];
        for (count, text) in cases {
            assert_eq!(grouped(count), text);
        }
    }

    const BAD: &str = "a\u{1b}]0;pwn\u{7}\u{1b}[2J\u{202e}b\u{9b}31m\u{2066}\u{200b}\nall agree\u{e0041}";

    #[test]
    fn nothing_hidden_is_left_of_a_name() {
        let shown = escaped(BAD);
        assert!(!shown.contains(is_hidden), "{shown}");
        assert!(shown.starts_with("a\\u{1b}]0;pwn\\u{7}") && shown.contains("\\u{202e}b\\u{9b}31m"), "{shown}");
        assert_eq!(escaped_lines(BAD).matches('\n').count(), 1);
        assert!(!escaped_lines(BAD).contains(|c| is_hidden(c) && c != '\n'));
    }

    #[test]
    fn what_is_plain_stays_as_it_is() {
        for text in ["", "teapot", "Köln – 東京 ±1e-5 │ 🫖", "a \"quoted\" <name>"] {
            assert_eq!((escaped(text), escaped_lines(text)), (text.into(), text.into()));
        }
    }

    #[test]
    fn a_misspelt_name_is_guessed_and_another_word_is_not() {
        let names = ["teapot", "sphere", "spoon", "plate", "teacup"];
        for (text, name) in [("teapto", "teapot"), ("tepot", "teapot"), ("Sphere", "sphere"), ("plats", "plate")] {
            assert_eq!(nearest(text, &names), Some(name), "{text}");
        }
        for text in ["wing", "", "qqqqqq", &"teapot".repeat(20)] {
            assert_eq!(nearest(text, &names), None, "{text}");
        }
        assert_eq!((edits("abcd", "acbd"), edits("", "abc"), edits("kitten", "sitting")), (1, 3, 3));
    }

    #[test]
    fn json_says_the_same() {
        let text = serde_json::to_string(&[BAD]).expect("JSON");
        let shown = escaped_json(&text);
        assert!(shown.chars().all(|c| !is_hidden(c)), "{shown}");
        assert_eq!(serde_json::from_str::<[String; 1]>(&shown).expect("JSON"), [BAD]);
    }
}
