//! Mutants: one small change each, generated from the WGSL, and which of them are legal.

use super::operator::{Site, sites};
use super::shown::Shown;
use super::way::Way;
use naga::valid::Capabilities;
use pipeline::wgsl::{self, COMMON, Part, Variant};
use pipeline::{Program, TrimMethod};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;

/// What a mutant is known by as long as its line stays as it is, wherever it moves.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Key {
    /// File in `shaders/`.
    pub file: String,
    /// The function, or the constant, that is changed.
    pub function: String,
    /// The line without its indentation.
    pub line: String,
    /// Where in it the change begins, characters from 0.
    pub at: usize,
    /// The mutation operator.
    pub operator: String,
    /// What stands there.
    pub original: String,
    /// What is put there.
    pub replacement: String,
    /// Which of several alike in one function.
    #[serde(default)]
    pub nth: usize,
}

/// A change of the source.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Mutant {
    /// What it is known by.
    pub key: Key,
    /// Line in the file, from 1.
    pub line: usize,
    /// Column in the line, from 1.
    pub column: usize,
    /// First byte of what is replaced.
    pub start: usize,
    /// The byte after it.
    pub end: usize,
}

/// All mutants of the sources.
#[derive(Debug, Clone, Default)]
pub struct Generated {
    /// Those that compile.
    pub mutants: Vec<Mutant>,
    /// Those that do not.
    pub stillborn: Vec<Mutant>,
}

impl Mutant {
    fn new(part: &Part, site: &Site, replacement: &str) -> Self {
        let before = &part.text[..site.range.start];
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        let line = part.text[line_start..].lines().next().unwrap_or_default();
        let indentation = line.len() - line.trim_start().len();
        let key = Key {
            file: part.file.to_owned(),
            function: site.function.clone(),
            line: line.trim().to_owned(),
            at: (site.range.start - line_start).saturating_sub(indentation),
            operator: site.operator.to_owned(),
            original: part.text[site.range.clone()].to_owned(),
            replacement: replacement.to_owned(),
            nth: 0,
        };
        Self {
            key,
            line: before.matches('\n').count() + 1,
            column: site.range.start - line_start + 1,
            start: site.range.start,
            end: site.range.end,
        }
    }

    /// The source of a variant with this change; as it is, where the variant does not hold the changed file.
    pub fn source(&self, variant: Variant) -> String {
        let part = self.part();
        let changed = [&part.text[..self.start], &self.key.replacement, &part.text[self.end..]].concat();
        wgsl::source(variant).replacen(part.text, &changed, 1)
    }

    /// Whether a scene can show it: its technique has the part, which is used there. No program of untrimmed faces asks
    /// for their edges, and without edges technique `fragment` needs no sight of its pixels. Parts that both techniques
    /// have are drawn by `exact` where faces meet, and not on all scenes that its own parts ask for.
    pub fn is_shown_by(&self, shown: &Shown) -> bool {
        let part = self.part();
        let is_used = match part.file {
            "edge.wgsl" => shown.plan.edges,
            "trim.wgsl" | "sight.wgsl" => shown.model.is_trimmed(),
            _ => true,
        };
        is_used && shown.is_of(tried_by(part)) && owner(part).is_none_or(|of| of == shown.way())
    }

    fn part(&self) -> &'static Part {
        self.key.part().expect("mutants are made of the parts")
    }

    /// Whether naga accepts it, in the program of the lowest degree: the one of the smallest arrays.
    fn compiles(&self) -> bool {
        is_legal(&self.source(Variant {
            parts: tried_by(self.part()).parts(),
            program: Program::Degree(3),
            curvature: true,
            vertex_normals: false,
            trims: TrimMethod::CurvesWithEdges,
        }))
    }
}

impl Key {
    /// The part that it changes. Of two that may stand in one place of a program, it is the one with the line.
    pub fn part(&self) -> Option<&'static Part> {
        parts().find(|part| part.file == self.file && part.text.contains(&self.line))
    }
}

/// All parts of all programs, each once: techniques share some.
fn parts() -> impl Iterator<Item = &'static Part> {
    let all = || COMMON.iter().chain(Way::all().flat_map(|way| way.parts()));
    all()
        .enumerate()
        .filter(move |(index, part)| all().take(*index).all(|earlier| earlier != *part))
        .map(|(_, part)| part)
}

/// The first way whose programs have a part; none for the parts of all.
fn owner(part: &Part) -> Option<Way> {
    Way::all().find(|way| way.parts().contains(part))
}

/// The way with whose mutants those of a part are tried: its own, the first for the parts of all.
pub fn tried_by(part: &Part) -> Way {
    owner(part).or_else(|| Way::all().next()).expect("there are techniques")
}

/// Whether a program parses and validates.
pub fn is_legal(source: &str) -> bool {
    // Kernels may use atomics of 64 bits.
    let wide = Capabilities::SHADER_INT64 | Capabilities::SHADER_INT64_ATOMIC_ALL_OPS;
    let capabilities = Capabilities::default() | wide;
    naga::front::wgsl::parse_str(source).is_ok_and(|module| {
        naga::valid::Validator::new(naga::valid::ValidationFlags::all(), capabilities).validate(&module).is_ok()
    })
}

/// The files whose mutants are tried by a way.
pub fn files(way: Way) -> impl Iterator<Item = &'static str> {
    parts().filter(move |part| tried_by(part) == way).map(|part| part.file)
}

/// All mutants of those parts that are tried by a way and whose files are wanted. At each site the first replacement that
/// compiles makes the mutant; where none does, the first is stillborn.
pub fn generate(way: Way, is_wanted: &dyn Fn(&str) -> bool) -> Generated {
    let all: Vec<(&Part, Site)> = parts()
        .filter(|part| tried_by(part) == way && is_wanted(part.file))
        .flat_map(|part| sites(part.text).into_iter().map(move |site| (part, site)))
        .collect();
    let born: Vec<(Mutant, bool)> = all
        .par_iter()
        .filter_map(|(part, site)| {
            let original = &part.text[site.range.clone()];
            let others = site.replacements.iter().filter(|text| *text != original);
            let candidates: Vec<Mutant> = others.map(|text| Mutant::new(part, site, text)).collect();
            match candidates.iter().position(Mutant::compiles) {
                Some(legal) => Some((candidates[legal].clone(), true)),
                None => Some((candidates.first()?.clone(), false)),
            }
        })
        .collect();
    let mut generated = Generated::default();
    let mut counts: HashMap<Key, usize> = HashMap::new();
    for (mut mutant, compiles) in born {
        let count = counts.entry(mutant.key.clone()).or_default();
        mutant.key.nth = *count;
        *count += 1;
        if compiles { generated.mutants.push(mutant) } else { generated.stillborn.push(mutant) }
    }
    generated
}

#[cfg(test)]
mod tests {
    use super::*;
    use isophote::stage::Path;
    use std::collections::HashSet;

    /// All that may be put anywhere, whether it compiles or not.
    fn all() -> impl Iterator<Item = Mutant> {
        parts().flat_map(|part| {
            let of_site =
                |site: Site| site.replacements.iter().map(|text| Mutant::new(part, &site, text)).collect::<Vec<_>>();
            sites(part.text).into_iter().flat_map(of_site)
        })
    }

    #[test]
    fn the_sources_are_legal_and_a_mutant_changes_what_it_says() {
        let variant = |way: Way| Variant {
            parts: way.parts(),
            program: Program::General,
            curvature: true,
            vertex_normals: false,
            trims: TrimMethod::CurvesWithEdges,
        };
        for way in Way::all() {
            assert!(is_legal(&wgsl::source(variant(way))));
        }
        let shortest = generate(Way { path: Path::Compute32, ..Way::all().next().unwrap() }, &|_| true);
        assert!(shortest.mutants.len() >= 40 && shortest.mutants.iter().all(Mutant::compiles));
        let keys: HashSet<&Key> = shortest.mutants.iter().map(|mutant| &mutant.key).collect();
        assert_eq!(keys.len(), shortest.mutants.len());
        for mutant in all() {
            let text = mutant.part().text;
            assert_eq!(text[mutant.start..mutant.end], mutant.key.original);
            let line = text.lines().nth(mutant.line - 1).unwrap();
            assert!(line[mutant.column - 1..].starts_with(mutant.key.original.lines().next().unwrap()), "{mutant:?}");
            if mutant.key.replacement != mutant.key.original {
                let variant = variant(tried_by(mutant.part()));
                assert!(mutant.source(variant) != wgsl::source(variant), "{mutant:?}");
            }
        }
    }

    #[test]
    fn every_reviewed_mutant_is_one_of_the_sources() {
        let known: HashSet<Key> = all().map(|mutant| mutant.key).collect();
        assert!(known.len() > 5000);
        let reviewed = crate::mutants::record::reviewed().unwrap();
        for key in reviewed.iter().flat_map(|group| &group.mutants) {
            assert!(known.contains(&Key { nth: 0, ..key.clone() }), "{key:?}");
        }
    }
}
