//! Each rounding rule, proven by a machine: Gappa reads `certificates/` of this crate, with the numbers that stand here.
//!
//! Three questions a certificate: the rule is proven; half of it is not; and where the worst operands meet, half of it is
//! exceeded. A fourth asks whether what it calls the charge is what this code charges. Where a rule is of f32's own lattice,
//! all mantissas are tried.

use super::basis::{Basis, DIVISORS_ACCURACY, Functions, differences, narrowing_of_reciprocal, reciprocal_accuracy};
use super::error::{Adjoint, Budget, DIVISION, Error, FLUSH, NARROWING, NEIGHBOUR, OUTPUTS, ROOT};
use super::place::{OnSpan, Parameter};
use super::tail::THRESHOLD;
use super::tape::{self, NODES, Number, Tape, plain, product};
use super::{COARSE, WIDENING, tensor};
use crate::eval::Span;
use std::collections::BTreeSet;
use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// Set where Gappa must be there.
const NEEDED: &str = "ISOPHOTE_NEED_GAPPA";

/// What certificates call by name.
const CONSTANTS: [(&str, f64); 9] = [
    ("$NEIGHBOUR", NEIGHBOUR),
    ("$FLUSH", FLUSH),
    ("$NARROWING", NARROWING),
    ("$COARSE", COARSE),
    ("$DIVISORS_ACCURACY", DIVISORS_ACCURACY),
    ("$DIVISION", DIVISION),
    ("$ROOT", ROOT),
    ("$WIDENING", WIDENING),
    ("$THRESHOLD", THRESHOLD),
];

/// One file of the folder.
struct Certificate {
    name: String,
    /// `C`, what the code charges, and `E`, what may be off.
    definitions: String,
    /// The same, what is claimed, and identities that lead there.
    whole: String,
    /// Operands at which E is more than half of C.
    worst: String,
}

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("certificates")
}

/// An exact number, as Gappa reads it.
fn literal(x: f64) -> String {
    let bits = x.abs().to_bits();
    let (mantissa, exponent) = ((bits & ((1 << 52) - 1)) | (1 << 52), (bits >> 52) as i32 - 1075);
    let sign = if x < 0.0 { "-" } else { "" };
    if x == 0.0 { "0".to_owned() } else { format!("{sign}{mantissa}b{exponent}") }
}

/// `a = 1, b = 2` as hypotheses.
fn hypotheses(operands: &str) -> String {
    let one = |operand: &str| {
        let (name, value) = operand.split_once(" = ").expect("an operand has a value");
        format!("{name} in [{value},{value}]")
    };
    operands.split(", ").map(one).collect::<Vec<_>>().join(" /\\ ")
}

impl Certificate {
    /// All of the folder.
    fn all() -> Vec<Self> {
        let files = std::fs::read_dir(folder()).expect("the folder of certificates");
        let files = files.map(|file| file.expect("an entry").path());
        let files: BTreeSet<PathBuf> = files.filter(|file| file.extension().is_some_and(|e| e == "gappa")).collect();
        files
            .into_iter()
            .map(|file| {
                let mut text = std::fs::read_to_string(&file).expect("a certificate");
                for (name, value) in CONSTANTS {
                    text = text.replace(name, &literal(value));
                }
                let worst = text.lines().find_map(|line| line.strip_prefix("# worst: ")).expect("the worst operands");
                Self {
                    name: file.file_stem().expect("a name").to_string_lossy().into_owned(),
                    definitions: text.split("\n{").next().expect("a text").to_owned(),
                    worst: worst.to_owned(),
                    whole: text,
                }
            })
            .collect()
    }

    /// Whether a share of what is charged is proven to be enough.
    fn is_enough(&self, share: f64) -> Result<bool, String> {
        proves(&self.whole.replace("$SHARE", &literal(share)))
    }

    /// Whether at given operands a claim is proven.
    fn holds_at(&self, operands: &str, claim: &str) -> Result<bool, String> {
        proves(&format!("{}\n{{ {} -> {claim} }}\n", self.definitions, hypotheses(operands)))
    }
}

/// Whether Gappa proves a text. A text that it does not take, or a rewriting that it does not follow, is an error.
fn proves(text: &str) -> Result<bool, String> {
    let mut command = Command::new("gappa");
    let child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
    let mut child = child.map_err(|error| error.to_string())?;
    child.stdin.take().expect("piped").write_all(text.as_bytes()).map_err(|error| error.to_string())?;
    let output = child.wait_with_output().map_err(|error| error.to_string())?;
    let said = String::from_utf8_lossy(&output.stderr);
    let is_doubted = said.contains("trivially equal") || said.contains("assumed to be nonzero");
    match output.status.code() {
        Some(0) if !is_doubted => Ok(true),
        Some(1) if !is_doubted && (said.contains("not satisfied") || said.contains("no contradiction")) => Ok(false),
        _ => Err(format!("{said}\n{text}")),
    }
}

/// Whether Gappa is there; where it is not, that is said, and an error where it must be.
fn is_there(claim: &str) -> bool {
    let is_there = Command::new("gappa").arg("--version").output().is_ok();
    assert!(is_there || std::env::var_os(NEEDED).is_none(), "{NEEDED} is set and there is no gappa");
    if !is_there {
        // Straight to standard error: what a passing test prints is not shown.
        let line = format!("NOT RUN: enclosure::certificates: {claim}: no gappa here; CI runs it\n");
        std::io::stderr().write_all(line.as_bytes()).expect("standard error takes a line");
    }
    is_there
}

#[test]
fn each_rule_is_proven_and_half_of_it_refuted() {
    if !is_there("each rule is proven") {
        return;
    }
    let mut wrong = vec![];
    for certificate in Certificate::all() {
        let proven = certificate.is_enough(1.0);
        let half = certificate.is_enough(0.5);
        let refuted = certificate.holds_at(&certificate.worst, "E - 0.5 * C >= 0");
        if (&proven, &half, &refuted) != (&Ok(true), &Ok(false), &Ok(true)) {
            wrong.push(format!("{}: proven {proven:?}, half {half:?}, refuted {refuted:?}", certificate.name));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_false_identity_and_a_missing_condition_prove_nothing() {
    if !is_there("a false identity proves nothing") {
        return;
    }
    let [right, wrong, open] = ["x * (x + 1)", "x * (x - 1)", "(x * x * x + x * x) / x"].map(|hint| {
        let text = format!("{{ x in [0,1] -> x * x + x in [0,2] }}\nx * x + x -> {hint};\n");
        proves(&text)
    });
    assert_eq!(right, Ok(true));
    assert!(wrong.is_err_and(|said| said.contains("not trivially equal")));
    assert!(open.is_err_and(|said| said.contains("assumed to be nonzero")));
}

/// What an operation is charged on the tape, of operands of given radii; the remainders alone where `beyond`.
fn charged(
    operation: impl Fn(&mut Tape, [Number; 4]) -> Option<Number>,
    operands: [(f64, f64); 4],
    beyond: bool,
) -> f64 {
    let mut tape = Tape::new();
    let leaves = operands.map(|(value, radius)| tape.leaf(value, radius).expect("small"));
    let mut results = [None; OUTPUTS];
    results[0] = operation(&mut tape, leaves);
    assert!(results[0].is_some());
    let mut budget = Budget::ZERO;
    tape.sweep(&results, &mut budget, &mut [Adjoint::ZERO; NODES]);
    let Error { rounding, packing } = budget.of(0);
    if beyond { packing } else { rounding }
}

/// What this code charges at some operands, beside the certificate that says so.
fn charges() -> Vec<(&'static str, String, f64)> {
    let one = (1.0, 0.0);
    let operands = |names: &[(&str, f64)]| {
        names.iter().map(|(name, x)| format!("{name} = {}", literal(*x))).collect::<Vec<_>>().join(", ")
    };
    let mut charges = vec![];
    let mut charge = |name, at: &[(&str, f64)], charged| charges.push((name, operands(at), charged));

    for (a, b, ra, rb) in [(0.75, 0.625, 0.0, 0.0), (0.75, 0.625, 1e-6, 1e-5), (0.0, 0.5, 0.25, 0.125)] {
        let at = [("A", a), ("B", b), ("ra", ra), ("rb", rb)];
        charge("product", &at, charged(|t, x| t.sum(&[product(x[0], x[1])]), [(a, ra), (b, rb), one, one], false));
    }
    for (a, b) in [(2f64.powi(-100), 2f64.powi(-100)), (2f64.powi(20), 2f64.powi(-150))] {
        let found = charged(|t, x| t.sum(&[product(x[0], x[1])]), [(a, 0.0), (b, 0.0), one, one], false);
        charge("flushed_product", &[("A", a), ("B", b)], found);
    }
    let text = charged(|t, x| t.sum(&[product(x[0], x[1])]), [one; 4], false);
    let other = charged(|t, x| t.sum(&[product(x[0], x[1]).of_three()]), [one; 4], false);
    charge("three_factors", &[], text + other);
    let four = |t: &mut Tape, x: [Number; 4]| t.sum(&x.map(plain));
    charge("sum", &[("b", 0.375)], charged(four, [(0.5, 0.0), (-0.25, 0.0), (0.5, 0.0), (-0.125, 0.0)], false));
    for b in [0.0, 0.375, 1.0] {
        charge("products", &[("b", b)], tensor::roundings(nurbs::MAX_ORDER - 1, 1.0 + b, 1.0 - b));
        let size = tensor::roundings(1, 1.0 + b, 1.0 - b) / (1.0 + NEIGHBOUR) / NEIGHBOUR - (1.0 + b);
        charge("partial_sum", &[("a", 1.0), ("b", b)], size);
    }
    for (a, ra, rb) in [(0.75, 0.125, 0.25), (0.5, 0.0, 0.75)] {
        let found = charged(|t, x| t.quotient(x[0], x[1]), [(a, ra), (1.0, rb), one, one], true);
        charge("quotient", &[("A", a), ("ra", ra), ("rb", rb)], found);
    }
    let nothing = charged(|t, x| t.quotient(x[0], x[1]), [(0.0, 0.0), (0.5, 0.0), one, one], false);
    charge("flushed_quotient", &[("V", 0.0), ("L", 0.5)], nothing);
    charge("division", &[("x", 1.5)], charged(|t, x| t.quotient(x[0], x[1]), [(1.5, 0.0), one, one, one], false));
    charge("root", &[], charged(|t, x| t.root(x[0]), [one; 4], false));
    let found = charged(|t, x| t.root(x[0]), [(1.0, 0.75), one, one, one], true);
    charge("root_remainder", &[("m", 0.5), ("h", 0.0), ("z", 0.0)], found);
    charge("hypotenuse", &[], tape::hypotenuse_rounding(1.0));
    charge("flushed_hypotenuse", &[], tape::hypotenuse_rounding(0.0) / FLUSH.sqrt());
    let found = charged(|t, x| t.hypotenuse(x[0], x[1]), [(1.0, 0.25), (0.0, 0.0), one, one], true);
    charge("hypotenuse_remainder", &[("e", 0.25)], found);
    charge("reciprocal", &[("dw", 0.0)], reciprocal_accuracy(1.0 / 1.5, true));
    charge("narrowed_reciprocal", &[("e", 0.25)], narrowing_of_reciprocal(0.25, 1.0));
    let terms = Functions { value: [0.5, 0.25, 0.0, 0.0], radius: [0.125, 0.0625, 0.0, 0.0], local: [Error::ZERO; 4] };
    let middle = differences(&terms, 3, 1.0, NEIGHBOUR).local[1].rounding;
    let [size, far] = [3.0 * (0.5 + 0.125 + 0.25 + 0.0625), 3.0 * (0.25 + 0.125 + 0.0625)];
    charge("differences", &[("size", size), ("far", far)], middle);
    basis(&mut charge);
    charges
}

/// What a basis of degree 2 charges on a span whose knots are 0, 0, 1, 1, at its middle.
fn basis(charge: &mut impl FnMut(&'static str, &[(&str, f64)], f64)) {
    let made = |degree: usize, lost: f64| {
        let knots = &[0.0, 0.0, 1.0, 1.0][2 - degree..2 + degree];
        let span = Span { start: 0.0, first: 0, length: 1.0, gain: 1.0, per_whole: 1.0, knots };
        let on = OnSpan { span: 0, t: Parameter::exact(0.5), lost };
        Basis::<4>::new(&span, degree, &on, false).expect("knots are apart")
    };
    for lost in [0.0, 0.0625] {
        // Column 2 rests on column 1, which is the basis of degree 1.
        let lower = made(1, lost).functions[0];
        let (value, radius, relative) = (lower.value[0], lower.radius[0], NEIGHBOUR);
        let most = value + radius + value * relative + radius * relative;
        let found = made(2, lost).functions[0].local[0].total();
        charge("part", &[("d", 0.5), ("e", lost), ("M", most), ("p", NEIGHBOUR * most)], found);
    }
    // Nothing is packed here but what each origin may have alone: the remainder of column 2, and the parameter.
    let lower = made(1, 0.0).functions[0];
    let mut budget = Budget::ZERO;
    let mut adjoints = [[Adjoint::ZERO; 4]; 3];
    adjoints[0][0].0[0] = 1.0;
    made(2, 0.0).sweep(&adjoints, false, &mut budget);
    let at = [("radius", lower.radius[0]), ("reciprocal", 1.0), ("relative", NEIGHBOUR)];
    charge("term", &at, budget.of(0).packing / 0.5);
}

#[test]
fn certificates_call_the_charge_what_this_code_charges() {
    if !is_there("certificates call the charge what this code charges") {
        return;
    }
    let certificates = Certificate::all();
    let mut left: BTreeSet<&str> = certificates.iter().map(|certificate| certificate.name.as_str()).collect();
    let mut wrong = vec![];
    for (name, operands, charged) in charges() {
        left.remove(name);
        let certificate = certificates.iter().find(|certificate| certificate.name == name).expect("a certificate");
        // f64 rounds the charge itself, and flushing is a rule of its own.
        let [low, high] = [-1e-9, 1e-9].map(|off| literal(charged * (1.0 + off)));
        let operands = if operands.is_empty() { "nothing = 0".to_owned() } else { operands };
        let same = certificate.holds_at(&operands, &format!("C in [{low},{high}]"));
        // The checker itself, on another charge.
        let other = certificate.holds_at(&operands, &format!("C in [{low},{low}]"));
        if (&same, &other) != (&Ok(true), &Ok(false)) {
            wrong.push(format!("{name} at {operands}, charged {charged:e}: {same:?}, {other:?}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    // These are made of constants alone, which are read from this code.
    let constants = ["flushed", "midpoint", "narrowing", "neighbour", "threshold"];
    assert_eq!(left.into_iter().collect::<Vec<_>>(), constants);
}

#[test]
fn the_readme_shows_each_rule_where_it_stands() {
    let readme = std::fs::read_to_string(folder().join("README.md")).expect("a README");
    let mut named = BTreeSet::new();
    for row in readme.lines().filter(|line| line.starts_with("| ") && line.contains(".rs")) {
        let cells: Vec<&str> = row.trim_matches('|').split(" | ").map(str::trim).collect();
        let [_, file, line, by] = cells[..] else { panic!("four cells: {row}") };
        let file = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("src").join(file.trim_matches('`'));
        let source = std::fs::read_to_string(&file).expect("a file of this crate");
        assert!(source.contains(line.trim_matches('`')), "{} lacks {line}", file.display());
        named.extend(by.split(", ").map(|by| by.trim_matches('`').to_owned()));
    }
    let exhaustive = ["one_over_a_width", "parameters_of_a_domain", "nearest_parameters"].map(str::to_owned);
    let files = Certificate::all().into_iter().map(|certificate| certificate.name).chain(exhaustive);
    assert_eq!(named, files.collect());
}

/// 2.5 ulp of 1 / width, for each mantissa of a width that is held exactly: every f32 so near is within what is charged.
#[test]
fn one_over_a_width() {
    let (mut closest, mut powers) = (0.0f64, 0);
    for mantissa in 0..1u32 << 23 {
        let width = f64::from(f32::from_bits(0x3f80_0000 | mantissa));
        let exact = 1.0 / width;
        let charged = reciprocal_accuracy(exact, false);
        // The distance of the neighbours on either side of the exact quotient; where it is one, the lesser of two.
        let nearest = exact as f32;
        let (below, above) = (nearest.next_down(), nearest.next_up());
        let ulp = if f64::from(nearest) == exact {
            f64::from(nearest - below).min(f64::from(above - nearest))
        } else if f64::from(nearest) > exact {
            f64::from(nearest - below)
        } else {
            f64::from(above - nearest)
        };
        powers += usize::from(f64::from(nearest) == exact);
        for far in [
            nearest.next_down().next_down().next_down(),
            below.next_down(),
            below,
            above,
            above.next_up(),
            above.next_up().next_up(),
        ] {
            let off = (f64::from(far) - exact).abs();
            if off <= 2.5 * ulp {
                let share = off / exact / charged;
                assert!(share <= 1.0 + 1e-9, "1 / {width}: {far} is {share} of what is charged");
                closest = closest.max(share);
            }
        }
    }
    assert!(powers == 1 && closest > 0.99, "{powers} powers, {closest}");
}

/// Whether a number is among those that a parameter may be.
fn holds(known: Parameter, x: f32) -> bool {
    (f64::from(x) - known.middle()).abs() <= known.radius()
}

/// A parameter of the knot domain, taken back to its span: the f32 that it was made of is among those that it may have been.
#[test]
fn parameters_of_a_domain() {
    let (mut exact, mut many) = (0usize, 0usize);
    // All mantissas of the widest binade on one span, and numbers of any size on each.
    for ([start, end], step) in [([0.0, 1.0], 64), ([0.3, 0.7], 1), ([-1e3, -999.9], 64), ([1e4, 1e4 + 1e-2], 64)] {
        let lost = 2.0 * f64::EPSILON * (1.0 + (f64::abs(start) + f64::abs(end)) / (end - start));
        let numbers = (0x3f00_0000u32..=0x3f80_0000).step_by(step).chain((0..0x3f00_0000).step_by(4096));
        for x in numbers.map(f32::from_bits) {
            let t = if x >= 1.0 { end } else { start + (end - start) * f64::from(x) };
            let known = Parameter::of(t, [start, end], lost);
            assert!(holds(known, x), "{x} of {start} … {end}: {known:?}");
            exact += usize::from(known.is_exact());
            // The nearest and its neighbours alone would be a wrong rule: near the start of a span they are too few.
            let nearest = ((t - start) / (end - start)) as f32;
            many += usize::from(x < nearest.next_down() || x > nearest.next_up());
        }
    }
    assert!(exact > 8_000_000 && many > 1_000, "{exact} exact, {many} farther than a neighbour");
}

/// A local parameter in f64: an f32 is itself, and of any other both neighbours are known.
#[test]
fn nearest_parameters() {
    for bits in 0x3f00_0000u32..0x3f80_0000 {
        let (x, above) = (f32::from_bits(bits), f32::from_bits(bits + 1));
        assert_eq!(Parameter::nearest(f64::from(x)), Parameter::exact(x));
        let between = Parameter::nearest(f64::from(x) + 2f64.powi(-26));
        assert!(holds(between, x) && holds(between, above) && !holds(between, f32::from_bits(bits - 1)), "{between:?}");
    }
}
