//! Options as they stand on a command line, so that a program can say which command does what it did.

use clap::ValueEnum;

/// The words of one option: its name, and its values.
pub type Words = Vec<String>;

/// An option with one value.
pub fn option(name: &str, value: impl ToString) -> Words {
    vec![name.to_owned(), value.to_string()]
}

/// An option without a value, where it is given.
pub fn flag(name: &str, is_given: bool) -> Option<Words> {
    is_given.then(|| vec![name.to_owned()])
}

/// An option whose values have names.
pub fn named(name: &str, value: &impl ValueEnum) -> Words {
    option(name, value_name(value))
}

/// The name of a value, as it is typed.
pub fn value_name(value: &impl ValueEnum) -> String {
    value.to_possible_value().map_or(String::new(), |value| value.get_name().to_owned())
}

/// An option of numbers, which are read back to the bit.
pub fn numbers(name: &str, values: &[f64]) -> Words {
    std::iter::once(name.to_owned()).chain(values.iter().map(|x| number(*x))).collect()
}

/// The shortest text of a number that is read back to the bit.
pub fn number(x: f64) -> String {
    let text = format!("{x:?}");
    text.strip_suffix(".0").map(str::to_owned).unwrap_or(text)
}

/// A command that a shell takes as these words.
pub fn line(words: impl IntoIterator<Item = String>) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./:=,+@%".contains(c);
    let quoted = |word: String| match !word.is_empty() && word.chars().all(is_plain) {
        true => word,
        false => format!("'{}'", word.replace('\'', "'\\''")),
    };
    words.into_iter().map(quoted).collect::<Vec<_>>().join(" ")
}

/// The command line of this very run, as a shell takes it.
pub fn again() -> String {
    let arguments = std::env::args_os().skip(1).map(|argument| argument.to_string_lossy().into_owned());
    line(std::iter::once("isophote".to_owned()).chain(arguments))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_back_to_the_bit() {
        for x in [0.1 + 0.2, -1.0, 1e-300, f64::MAX, -0.0, 5.0, 1.0 / 3.0] {
            assert_eq!(number(x).parse::<f64>().map(f64::to_bits), Ok(x.to_bits()), "{x}");
        }
        assert_eq!(numbers("--eye", &[1.0, -0.5, 1e21]), ["--eye", "1", "-0.5", "1e21"]);
    }

    #[test]
    fn a_shell_takes_the_line_for_the_words() {
        let words = ["a", "it's", "#102030", "", "x y", "$HOME;`ls`", "-1"].map(str::to_owned);
        let script = format!("printf '%s\\n' {}", line(words.clone()));
        let output = std::process::Command::new("sh").args(["-c", &script]).output().expect("a shell");
        let said = String::from_utf8(output.stdout).expect("UTF-8");
        assert_eq!(said.lines().collect::<Vec<_>>(), words.each_ref().map(String::as_str));
    }
}
