//! `eval`: S, derivatives, normal and curvatures at given parameters, as JSON.

use crate::terminal;
use crate::view::ModelArgs;
use anyhow::{Context, Result, bail};
use clap::Args;
use glam::DVec3;
use nurbs::{Direction, KnotVector, NormalStatus, Surface, SurfacePoint};
use serde::Deserialize;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Evaluate surfaces at given (u, v) in f64
#[derive(Debug, Args)]
pub struct EvalArgs {
    #[command(flatten)]
    model: ModelArgs,
    /// A JSON file {"queries": [{"surface": k, "uv": [[u, v], …], "sides": [[±1, ±1], …]}]}; "sides" is optional:
    /// −1 takes the limit from below at a knot [default: nine points of every surface]
    #[arg(long, value_name = "FILE")]
    queries: Option<PathBuf>,
}

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

/// Runs the command.
///
/// # Errors
/// Where the model or the queries cannot be read, or a query is outside its surface.
pub fn run(args: &EvalArgs) -> Result<()> {
    let model = args.model.open()?;
    let queries = match &args.queries {
        Some(path) => {
            let name = path.display();
            let bytes = files::read(path, MAX_QUERY_BYTES).with_context(|| name.to_string())?;
            serde_json::from_slice::<Queries>(&bytes).with_context(|| format!("{name}: not a list of queries"))?.queries
        }
        None => model.surfaces().iter().enumerate().map(|(k, s)| nine_points(k, s)).collect(),
    };
    let mut answers = vec![];
    for (index, query) in queries.iter().enumerate() {
        let Some(surface) = model.surfaces().get(query.surface) else {
            let count = model.surfaces().len();
            bail!("queries[{index}] names surface {}; the model has {count}", query.surface);
        };
        if query.sides.as_ref().is_some_and(|sides| sides.len() != query.uv.len()) {
            bail!("queries[{index}] has {} points and another number of sides", query.uv.len());
        }
        let mut results = vec![];
        for (i, &[u, v]) in query.uv.iter().enumerate() {
            let [[u0, u1], [v0, v1]] = surface.domain();
            if !((u0..=u1).contains(&u) && (v0..=v1).contains(&v)) {
                bail!("queries[{index}].uv[{i}] = ({u}, {v}) is outside the domain [{u0}, {u1}] x [{v0}, {v1}]");
            }
            let [side_u, side_v] = query.sides.as_ref().map_or([1, 1], |sides| sides[i]);
            let span_u = span(surface.knots(Direction::U), u, side_u);
            let span_v = span(surface.knots(Direction::V), v, side_v);
            results.push(answer(u, v, &surface.inspect_on(span_u, span_v, u, v)));
        }
        answers.push(json!({ "surface": query.surface, "results": results }));
    }
    terminal::json(&json!({ "queries": answers }))?;
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

fn answer(u: f64, v: f64, point: &SurfacePoint) -> Value {
    let d = &point.derivatives;
    let vector = |x: DVec3| x.to_array();
    let normal = point.normal.unit();
    let kind = match point.normal.status() {
        NormalStatus::Regular => "regular",
        NormalStatus::Limit => "limit",
        NormalStatus::Undefined => "none",
    };
    let forms = point
        .curvature
        .and(normal)
        .map(|n| [d.su.dot(d.su), d.su.dot(d.sv), d.sv.dot(d.sv), d.suu.dot(n), d.suv.dot(n), d.svv.dot(n)]);
    let form = |i: usize| forms.map(|f| f[i]);
    let k = point.curvature;
    json!({
        "u": u, "v": v,
        "S": vector(d.s), "Su": vector(d.su), "Sv": vector(d.sv),
        "Suu": vector(d.suu), "Suv": vector(d.suv), "Svv": vector(d.svv),
        "normal_kind": kind, "normal": normal.map(vector),
        "K": k.map(|k| k.gaussian), "H": k.map(|k| k.mean), "k1": k.map(|k| k.k1), "k2": k.map(|k| k.k2),
        "E": form(0), "F": form(1), "G": form(2), "L": form(3), "M": form(4), "N": form(5),
    })
}
