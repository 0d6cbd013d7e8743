//! The text of ISO 10303-21: instances in order, and how values are spelled.

use std::fmt::Write;

/// A data section that grows: each instance has the next number.
#[derive(Default)]
pub(super) struct Text {
    text: String,
    last: u64,
}

impl Text {
    /// Adds an instance, `KEYWORD(…)` or `(A(…)B(…))`, and returns its number.
    pub fn add(&mut self, entity: &str) -> u64 {
        self.last += 1;
        writeln!(self.text, "#{}={entity};", self.last).expect("a string takes all");
        self.last
    }

    /// All instances, a line each.
    pub fn finish(self) -> String {
        self.text
    }
}

/// A real: the shortest digits that read back as the same f64, with the point that Part 21 asks for.
///
/// `1.0`, `1.5E-7`, `1.E300`.
pub(super) fn real(x: f64) -> String {
    let text = format!("{x:?}");
    match text.split_once('e') {
        None => text,
        Some((digits, power)) if digits.contains('.') => format!("{digits}E{power}"),
        Some((digits, power)) => format!("{digits}.E{power}"),
    }
}

/// A string: quotes and backslashes doubled, all that is not printable ASCII as `\X2\` or `\X4\`.
pub(super) fn string(text: &str) -> String {
    let mut out = String::from("'");
    for c in text.chars() {
        match c {
            '\'' => out.push_str("''"),
            '\\' => out.push_str("\\\\"),
            ' '..='~' => out.push(c),
            _ if (c as u32) < 0x1_0000 => write!(out, "\\X2\\{:04X}\\X0\\", c as u32).expect("a string takes all"),
            _ => write!(out, "\\X4\\{:08X}\\X0\\", c as u32).expect("a string takes all"),
        }
    }
    out.push('\'');
    out
}

/// A list of whatever prints.
pub(super) fn list<T: ToString>(items: impl IntoIterator<Item = T>) -> String {
    let items: Vec<String> = items.into_iter().map(|item| item.to_string()).collect();
    format!("({})", items.join(","))
}

/// A list of references.
pub(super) fn references(numbers: &[u64]) -> String {
    list(numbers.iter().map(|number| format!("#{number}")))
}

/// A list of reals.
pub(super) fn reals(numbers: impl IntoIterator<Item = f64>) -> String {
    list(numbers.into_iter().map(real))
}

/// A truth value.
pub(super) fn flag(is: bool) -> &'static str {
    if is { ".T." } else { ".F." }
}

/// Multiplicities and values of knots: those that are equal are one.
pub(super) fn knots(knots: &[f64]) -> [String; 2] {
    let runs = || knots.chunk_by(|a, b| a == b);
    [list(runs().map(<[f64]>::len)), reals(runs().map(|run| run[0]))]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_real_has_a_point_and_reads_back_as_it_was() {
        let cases = [(1.0, "1.0"), (1e-5, "1.E-5"), (1.5e-7, "1.5E-7"), (1e300, "1.E300"), (-0.0, "-0.0")];
        for (x, expected) in cases {
            assert_eq!(real(x), expected);
        }
        let mut bits = 0x9e37_79b9_7f4a_7c15u64;
        for _ in 0..10_000 {
            bits = bits.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(1);
            let x = f64::from_bits(bits);
            if x.is_finite() {
                let text = real(x);
                assert!(text.contains('.'), "{text}");
                assert_eq!(text.parse::<f64>().map(f64::to_bits), Ok(bits), "{text}");
            }
        }
    }

    #[test]
    fn a_string_holds_what_is_not_ascii() {
        assert_eq!(string("it's \\ é 𝄞\n"), r"'it''s \\ \X2\00E9\X0\ \X4\0001D11E\X0\\X2\000A\X0\'");
    }
}
