//! A report as JUnit XML, in the dialect of Jenkins' schema (`testdata/schema/junit-10.xsd`): a test suite for each
//! subject, a test case for each comparison.

use anyhow::Result;
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesText, Event};
use std::io;
use suite::bits::Bits;
use suite::report::{Case, Outcome, Pair, Report, Subject};
use suite::text::escaped;
use suite::wrong::Vacuity;

/// A test case before it is written.
struct TestCase {
    name: String,
    class: String,
    seconds: f64,
    outcome: Finding,
}

/// How a test case ended; words for the attribute, and lines of [`plain`] words for the body.
enum Finding {
    Passed,
    Failed(String, String),
    Error(String, String),
}

/// The document.
///
/// # Errors
/// None but those of writing to memory.
pub fn xml(report: &Report) -> Result<Vec<u8>> {
    let suites: Vec<(&Subject, Vec<TestCase>)> =
        report.subjects.iter().map(|subject| (subject, test_cases(report, subject))).collect();
    let all = || suites.iter().flat_map(|(_, cases)| cases);
    let mut writer = Writer::new_with_indent(Vec::new(), b' ', 2);
    writer.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    writer
        .create_element("testsuites")
        .with_attributes([
            ("name", plain(&format!("isophote conform {}", report.suite.name())).as_str()),
            ("time", time(all().map(|case| case.seconds).sum()).as_str()),
            ("tests", all().count().to_string().as_str()),
            ("failures", failures(all()).to_string().as_str()),
            ("errors", errors(all()).to_string().as_str()),
        ])
        .write_inner_content(|writer| suites.iter().try_for_each(|(subject, cases)| suite(writer, subject, cases)))?;
    let mut bytes = writer.into_inner();
    bytes.push(b'\n');
    Ok(bytes)
}

fn suite(writer: &mut Writer<Vec<u8>>, subject: &Subject, cases: &[TestCase]) -> io::Result<()> {
    let facts = [("driver", &subject.driver), ("backend", &subject.backend), ("kind", &subject.kind)];
    writer
        .create_element("testsuite")
        .with_attributes([
            ("name", plain(&subject.id).as_str()),
            ("tests", cases.len().to_string().as_str()),
            ("failures", failures(cases.iter()).to_string().as_str()),
            ("errors", errors(cases.iter()).to_string().as_str()),
            ("time", time(cases.iter().map(|case| case.seconds).sum()).as_str()),
            ("hostname", plain(&subject.host).as_str()),
        ])
        .write_inner_content(|writer| {
            writer.create_element("properties").write_inner_content(|writer| {
                facts.iter().try_for_each(|(name, value)| {
                    let attributes = [("name", *name), ("value", &plain(value))];
                    writer.create_element("property").with_attributes(attributes).write_empty().map(|_| ())
                })
            })?;
            cases.iter().try_for_each(|case| test_case(writer, case))
        })?;
    Ok(())
}

fn test_case(writer: &mut Writer<Vec<u8>>, case: &TestCase) -> io::Result<()> {
    let element = writer.create_element("testcase").with_attributes([
        ("name", plain(&case.name).as_str()),
        ("classname", plain(&case.class).as_str()),
        ("time", time(case.seconds).as_str()),
    ]);
    let (tag, message, body) = match &case.outcome {
        Finding::Passed => return element.write_empty().map(|_| ()),
        Finding::Failed(message, body) => ("failure", message, body),
        Finding::Error(message, body) => ("error", message, body),
    };
    element.write_inner_content(|writer| {
        let child = writer.create_element(tag).with_attribute(("message", plain(message).as_str()));
        child.write_text_content(BytesText::new(body)).map(|_| ())
    })?;
    Ok(())
}

fn test_cases(report: &Report, subject: &Subject) -> Vec<TestCase> {
    let mut cases = vec![];
    for (case, outcome) in report.outcomes(&subject.id) {
        // The time of an outcome is that of its first comparison: drawing is most of it.
        for (number, pair) in outcome.pairs.iter().enumerate() {
            let seconds = if number == 0 { outcome.seconds } else { 0.0 };
            cases.push(of_pair(case, pair, seconds));
        }
        cases.extend(outcome.bits.as_ref().map(|bits| of_bits(case, bits)));
        cases.extend(outcome.wrong.as_ref().map(|wrong| of_wrong(case, wrong)));
        if let Some(error) = &outcome.error {
            cases.push(of_error(case, outcome, error));
        }
    }
    for key in report.missing(&subject.id) {
        let broken = report.case(key).and_then(|case| case.error.as_deref());
        let why = broken.or(subject.failure.as_deref()).unwrap_or("not run: the report is partial");
        let (name, class) = (key.to_string(), class(&key.scene));
        let outcome = Finding::Error(why.to_owned(), String::new());
        cases.push(TestCase { name, class, seconds: 0.0, outcome });
    }
    cases
}

fn of_pair(case: &Case, pair: &Pair, seconds: f64) -> TestCase {
    let name = format!("{}: {} | {}", case.key, pair.reference, pair.candidate);
    let outcome = if pair.agree {
        Finding::Passed
    } else {
        let mut body: Vec<String> =
            pair.worst.iter().map(|p| format!("({}, {}) {}: {}", p.x, p.y, p.cause, p.detail)).collect();
        body.push(format!("again: isophote compare {}", case.options));
        let body: Vec<String> = body.iter().map(|line| plain(line)).collect();
        Finding::Failed(pair.reasons.join(", "), body.join("\n"))
    };
    TestCase { name, class: class(&case.key.scene), seconds, outcome }
}

fn of_bits(case: &Case, bits: &Bits) -> TestCase {
    let outcome = match &bits.first {
        None => Finding::Passed,
        Some(first) => {
            let again = plain(&format!("{first}\nagain: isophote compare {}", case.options));
            Finding::Failed(format!("{} pixels have other bits than the CPU rasterizer's", bits.unlike), again)
        }
    };
    let (name, class) = (format!("{}: the same bits", case.key), class(&case.key.scene));
    TestCase { name, class, seconds: 0.0, outcome }
}

fn of_wrong(case: &Case, wrong: &Vacuity) -> TestCase {
    let outcome = if wrong.missed.is_empty() {
        Finding::Passed
    } else {
        let message = format!("{} of {} pictures made wrong do not differ", wrong.missed.len(), wrong.made);
        Finding::Failed(message, wrong.missed.join("\n"))
    };
    TestCase {
        name: format!("{}: pictures made wrong", case.key),
        class: class(&case.key.scene),
        seconds: 0.0,
        outcome,
    }
}

fn of_error(case: &Case, outcome: &Outcome, error: &str) -> TestCase {
    let again = plain(&format!("again: isophote compare {}", case.options));
    let finding = Finding::Error(error.to_owned(), again);
    let (name, class) = (case.key.to_string(), class(&case.key.scene));
    TestCase { name, class, seconds: outcome.seconds, outcome: finding }
}

fn class(scene: &str) -> String {
    format!("isophote.conform.{scene}")
}

fn failures<'a>(cases: impl Iterator<Item = &'a TestCase>) -> usize {
    cases.filter(|case| matches!(case.outcome, Finding::Failed(..))).count()
}

fn errors<'a>(cases: impl Iterator<Item = &'a TestCase>) -> usize {
    cases.filter(|case| matches!(case.outcome, Finding::Error(..))).count()
}

/// Seconds to the millisecond, as the schema's pattern wants them.
fn time(seconds: f64) -> String {
    format!("{seconds:.3}")
}

/// A driver's words on one line, with those characters escaped that XML 1.0 has no way to hold or that show nothing of themselves.
fn plain(text: &str) -> String {
    escaped(text).chars().filter(|&c| c != '\u{fffe}' && c != '\u{ffff}').collect()
}
