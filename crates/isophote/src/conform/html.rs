//! A report as one HTML file that opens from disk: page, style, script and data, and nothing fetched.

use anyhow::Result;
use serde::Serialize;
use serde_json::Value;
use suite::report::{Report, State, Subject};
use suite::text::{escaped, escaped_lines};

const PAGE: &str = include_str!("../../assets/report.html");
const STYLE: &str = include_str!("../../assets/report.css");
const SCRIPT: &str = include_str!("../../assets/report.js");

/// What the page shows: the report, and what follows from it.
#[derive(Serialize)]
struct Data<'a> {
    report: &'a Report,
    state: &'static str,
    subjects: Vec<SubjectData<'a>>,
}

#[derive(Serialize)]
struct SubjectData<'a> {
    id: &'a str,
    state: &'static str,
    missing: Vec<String>,
}

/// The page.
///
/// # Errors
/// Where the report cannot be written as JSON.
pub fn page(report: &Report) -> Result<String> {
    let data = Data {
        report,
        state: word(report.state()),
        subjects: report.subjects.iter().map(|subject| subject_data(report, subject)).collect(),
    };
    // Inside a script element only `<` could end the data, in a driver's name or a message.
    let data = visible(serde_json::to_value(&data)?).to_string().replace('<', "\\u003c");
    // The data goes in last: nothing in it is taken for a place to fill.
    Ok(PAGE.replace("/*STYLE*/", STYLE).replace("/*SCRIPT*/", SCRIPT).replacen("/*DATA*/", &data, 1))
}

/// The same with the hidden characters of each text escaped: a page, too, can be turned around by a name.
fn visible(value: Value) -> Value {
    match value {
        Value::String(text) => Value::String(escaped_lines(&text).into_owned()),
        Value::Array(values) => values.into_iter().map(visible).collect(),
        Value::Object(members) => {
            members.into_iter().map(|(key, value)| (escaped(&key).into_owned(), visible(value))).collect()
        }
        other => other,
    }
}

fn subject_data<'a>(report: &'a Report, subject: &'a Subject) -> SubjectData<'a> {
    SubjectData {
        id: &subject.id,
        state: word(report.state_of(subject)),
        missing: report.missing(&subject.id).iter().map(|key| key.to_string()).collect(),
    }
}

fn word(state: State) -> &'static str {
    match state {
        State::Agree => "agree",
        State::Differ => "differ",
        State::NotRun => "partial",
    }
}
