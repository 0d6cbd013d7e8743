//! `eval`: S, derivatives, normal and curvatures at given parameters, as JSON.

use crate::view::ModelArgs;
use crate::{output, terminal};
use anyhow::{Context, Result, anyhow, bail};
use clap::Args;
use glam::DVec3;
use nurbs::{Direction, KnotVector, NormalStatus, Surface, SurfacePoint};
use scene::Model;
use serde::Deserialize;
use serde_json::{Value, json};
use std::io::{BufRead, Read};
use std::path::PathBuf;

/// Evaluate surfaces at given (u, v) in f64
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  isophote eval teapot --queries points.json
  isophote eval teapot --queries - < points.txt     a line SURFACE U V each, answered in a line each")]
pub struct EvalArgs {
    #[command(flatten)]
    model: ModelArgs,
    /// A JSON file of parameters, or lines of standard input (`-`) [default: nine points of every surface]
    ///
    /// Standard input holds a line SURFACE U V for each point, as in `0 0.25 0.5`. Each is answered at once in a line of JSON, so that any
    /// number of points takes no more memory than one. A file is
    /// {"queries": [{"surface": k, "uv": [[u, v], …], "sides": [[±1, ±1], …]}]}; "sides" is optional: −1 takes the limit from
    /// below at a knot.
    #[arg(long, value_name = "FILE")]
    queries: Option<PathBuf>,
}

/// Of `testdata/schema/eval-1.json`.
const SCHEMA_VERSION: u32 = 1;

/// The largest file of queries that is read, bytes: 64 MiB, some two million points.
const MAX_QUERY_BYTES: u64 = 1 << 26;

#[derive(Deserialize)]
struct Queries {
    queries: Vec<Query>,
}

#[derive(Deserialize)]
struct Query {
    surface: usize,
    uv: Vec<[f64; 2]>,
    sides: Option<Vec<[i8; 2]>>,
}

/// The longest line of standard input, bytes.
const MAX_LINE_BYTES: u64 = 1 << 12;

/// Answers that are written together, bytes, while there is more to read.
const WRITTEN_BYTES: usize = 1 << 16;

/// Runs the command.
///
/// # Errors
/// Where the model or the queries cannot be read, or a query is outside its surface.
pub fn run(args: &EvalArgs) -> Result<()> {
    let model = args.model.open()?;
    let queries = match &args.queries {
        Some(path) if output::is_standard(path) => {
            return stream(&model, &mut std::io::stdin().lock(), terminal::bytes);
        }
        Some(path) => {
            let name = path.display();
            let bytes = files::read(path, MAX_QUERY_BYTES).with_context(|| name.to_string())?;
            serde_json::from_slice::<Queries>(&bytes).with_context(|| format!("{name}: not a list of queries"))?.queries
        }
        None => model.surfaces().iter().enumerate().map(|(k, s)| nine_points(k, s)).collect(),
    };
    let mut answers = vec![];
    for (index, query) in queries.iter().enumerate() {
        let surface = surface(&model, query.surface).with_context(|| format!("queries[{index}]"))?;
        if query.sides.as_ref().is_some_and(|sides| sides.len() != query.uv.len()) {
            bail!("queries[{index}] has {} points and another number of sides", query.uv.len());
        }
        let mut results = vec![];
        for (i, &[u, v]) in query.uv.iter().enumerate() {
            check(surface, u, v).with_context(|| format!("queries[{index}].uv[{i}]"))?;
            let [side_u, side_v] = query.sides.as_ref().map_or([1, 1], |sides| sides[i]);
            let span_u = span(surface.knots(Direction::U), u, side_u);
            let span_v = span(surface.knots(Direction::V), v, side_v);
            let name = || format!("queries[{index}].uv[{i}] = ({u}, {v}) on surface {}", query.surface);
            results.push(answer(u, v, &surface.inspect_on(span_u, span_v, u, v)).with_context(name)?);
        }
        answers.push(json!({ "surface": query.surface, "results": results }));
    }
    terminal::json(&json!({ "schema_version": SCHEMA_VERSION, "queries": answers }))?;
    Ok(())
}

/// Answers each line of a text as it comes; what was answered before an error stays written.
fn stream(model: &Model, lines: &mut impl BufRead, mut write: impl FnMut(&[u8]) -> Result<()>) -> Result<()> {
    let mut written = vec![];
    let mut result = Ok(());
    for number in 1u64.. {
        let mut line = String::new();
        let read = lines.take(MAX_LINE_BYTES).read_line(&mut line);
        result = match read.context("standard input") {
            Ok(0) => break,
            Ok(_) if line.len() as u64 == MAX_LINE_BYTES => Err(anyhow!("it is longer than {MAX_LINE_BYTES} bytes")),
            Ok(_) if line.trim().is_empty() => continue,
            Ok(_) => answer_line(model, &line, &mut written),
            Err(error) => Err(error),
        }
        .with_context(|| format!("line {number}"));
        if result.is_err() {
            break;
        }
        // Who waits for an answer before the next question gets it.
        if WRITTEN_BYTES <= written.len() || !lines.fill_buf().is_ok_and(|more| more.contains(&b'\n')) {
            write(&written)?;
            written.clear();
        }
    }
    write(&written)?;
    result
}

fn answer_line(model: &Model, line: &str, written: &mut Vec<u8>) -> Result<()> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let number = |text: &str| text.parse::<f64>().ok().filter(|x| x.is_finite());
    let parsed = match words[..] {
        [index, u, v] => index.parse::<usize>().ok().zip(number(u)).zip(number(v)),
        _ => None,
    };
    let Some(((index, u), v)) = parsed else { bail!("it is not SURFACE U V, as in `0 0.25 0.5`") };
    let surface = surface(model, index)?;
    check(surface, u, v)?;
    let mut fields = answer(u, v, &surface.inspect(u, v))?;
    fields["surface"] = json!(index);
    serde_json::to_writer(&mut *written, &fields)?;
    written.push(b'\n');
    Ok(())
}

fn surface(model: &Model, index: usize) -> Result<&Surface> {
    let count = model.surfaces().len();
    model.surfaces().get(index).with_context(|| format!("it names surface {index}; the model has {count}"))
}

/// Whether a surface has these parameters.
///
/// # Errors
/// Where they are outside its domain.
pub fn check(surface: &Surface, u: f64, v: f64) -> Result<()> {
    let [[u0, u1], [v0, v1]] = surface.domain();
    if !((u0..=u1).contains(&u) && (v0..=v1).contains(&v)) {
        bail!("({u}, {v}) is outside the domain [{u0}, {u1}] x [{v0}, {v1}]");
    }
    Ok(())
}

fn nine_points(index: usize, surface: &Surface) -> Query {
    let [us, vs] = surface.domain().map(|[start, end]| [start, start + 0.5 * (end - start), end]);
    let uv = us.iter().flat_map(|&u| vs.iter().map(move |&v| [u, v])).collect();
    Query { surface: index, uv, sides: None }
}

/// The span on a side of a knot: above (and at the domain's end below), or below.
fn span(knots: &KnotVector, t: f64, side: i8) -> usize {
    let above = knots.find_span(t);
    if side >= 0 {
        return above;
    }
    knots.spans().filter(|&k| knots.knots()[k] < t).last().unwrap_or(above)
}

/// What is known of a point.
///
/// # Errors
/// Where a value leaves f64: JSON has no infinity, and `null` would say that there is none.
fn answer(u: f64, v: f64, point: &SurfacePoint) -> Result<Value> {
    let normal = point.normal.unit();
    let kind = match point.normal.status() {
        NormalStatus::Regular => "regular",
        NormalStatus::Limit => "limit",
        NormalStatus::Undefined => "none",
    };
    let mut fields = json!({ "u": u, "v": v, "normal_kind": kind });
    for (name, x) in vectors(point) {
        fields[name] = json!(x.to_array().map(|x| finite(name, x)).into_iter().collect::<Result<Vec<f64>>>()?);
    }
    fields["normal"] = json!(normal.map(|n| n.to_array()));
    for (name, x) in scalars(point) {
        fields[name] = json!(x.map(|x| finite(name, x)).transpose()?);
    }
    Ok(fields)
}

/// S and its derivatives by their names, model units.
pub fn vectors(point: &SurfacePoint) -> [(&'static str, DVec3); 6] {
    let d = &point.derivatives;
    [("S", d.s), ("Su", d.su), ("Sv", d.sv), ("Suu", d.suu), ("Suv", d.suv), ("Svv", d.svv)]
}

/// Curvatures and the coefficients of both fundamental forms by their names; `None` where the normal is not regular.
pub fn scalars(point: &SurfacePoint) -> [(&'static str, Option<f64>); 10] {
    let d = &point.derivatives;
    let known = point.curvature.zip(point.normal.unit());
    [
        ("K", known.map(|(k, _)| k.gaussian)),
        ("H", known.map(|(k, _)| k.mean)),
        ("k1", known.map(|(k, _)| k.k1)),
        ("k2", known.map(|(k, _)| k.k2)),
        ("E", known.map(|_| d.su.dot(d.su))),
        ("F", known.map(|_| d.su.dot(d.sv))),
        ("G", known.map(|_| d.sv.dot(d.sv))),
        ("L", known.map(|(_, n)| d.suu.dot(n))),
        ("M", known.map(|(_, n)| d.suv.dot(n))),
        ("N", known.map(|(_, n)| d.svv.dot(n))),
    ]
}

/// The value, if f64 holds it.
///
/// # Errors
/// Where it does not: which one.
pub fn finite(name: &str, x: f64) -> Result<f64> {
    if !x.is_finite() {
        bail!("{name} leaves the range of f64 (about 1.8e308): measure the knots, or the model, in larger units");
    }
    Ok(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_answered_in_lines_and_an_error_names_its_line() {
        let model = models::builtin("teapot").expect("built in");
        let answered = |text: &str| {
            let mut written = vec![];
            let result = stream(&model, &mut text.as_bytes(), |bytes| {
                written.extend_from_slice(bytes);
                Ok(())
            });
            (String::from_utf8(written).expect("UTF-8"), result.err().map(|error| format!("{error:#}")))
        };
        let (text, error) = answered("0 0.25 0.5\n\n3 1 0\n");
        assert_eq!((text.lines().count(), error), (2, None));
        let first: Value = serde_json::from_str(text.lines().next().expect("a line")).expect("JSON");
        let point = model.surfaces()[0].point(0.25, 0.5);
        assert_eq!(first["S"], json!(point.to_array()));
        for (text, expected) in [
            ("0 0 0\n0 2 0\n", "line 2: (2, 0) is outside the domain"),
            ("0 0 0\n99 0 0\n", "line 2: it names surface 99; the model has 32"),
            ("0 0 0\n0 nan 0\n", "line 2: it is not SURFACE U V"),
            ("0 0 0\n{\"queries\"", "line 2: it is not SURFACE U V"),
        ] {
            let (written, error) = answered(text);
            assert_eq!(written.lines().count(), 1, "what was answered stays");
            assert!(error.is_some_and(|error| error.starts_with(expected)), "{text}");
        }
        let (_, error) = answered(&"0".repeat(1 << 13));
        assert!(error.is_some_and(|error| error.contains("longer than 4096 bytes")));
    }

    #[test]
    fn what_overflows_is_an_error_that_names_it() {
        let knots = |length: f64| KnotVector::new(1, vec![0.0, 0.0, length, length]).expect("legal");
        let points = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]].map(|[x, y]| DVec3::new(x, y, x * y)).to_vec();
        let at = |length: f64| {
            let surface = Surface::new(knots(length), knots(length), points.clone(), None).expect("legal");
            answer(0.0, 0.0, &surface.inspect(0.0, 0.0))
        };
        let fields = at(1.0).expect("finite");
        assert_eq!((fields["Suv"][2].as_f64(), fields["k1"].as_f64()), (Some(1.0), Some(1.0)));
        let error = at(1e-200).expect_err("Suv is 1e400").to_string();
        assert!(error.starts_with("Suv leaves the range of f64"), "{error}");
    }
}
