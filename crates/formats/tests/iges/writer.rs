//! A writer of small IGES files: entities are numbered as they are added, and named by the number.

use std::fmt::Write;

/// A file that is being written.
#[derive(Clone)]
pub struct Writer {
    entities: Vec<Entity>,
    pub style: Style,
}

#[derive(Clone)]
struct Entity {
    kind: u16,
    form: i16,
    status: &'static str,
    matrix: usize,
    level: i32,
    parameters: String,
}

/// How a file is written.
#[derive(Clone)]
pub struct Style {
    /// Between parameters, and after the last.
    pub delimiters: [char; 2],
    pub line_end: &'static str,
    /// Whether exponents are Fortran's, and blanks at the ends of lines are left away.
    pub is_terse: bool,
    /// Unit flag, name, and model scale.
    pub unit: (i32, &'static str, f64),
}

impl Default for Style {
    fn default() -> Self {
        Self { delimiters: [',', ';'], line_end: "\n", is_terse: false, unit: (2, "MM", 1.0) }
    }
}

pub const INDEPENDENT: &str = "00000000";
pub const DEPENDENT: &str = "00010000";
pub const DEFINITION: &str = "00000200";
pub const BLANKED: &str = "01000000";

impl Writer {
    pub fn new() -> Self {
        Self { entities: vec![], style: Style::default() }
    }

    /// Adds an entity that is a part of others, and returns its number; parameters follow its type.
    pub fn add(&mut self, kind: u16, form: i16, parameters: &str) -> usize {
        self.entities.push(Entity {
            kind,
            form,
            status: DEPENDENT,
            matrix: 0,
            level: 0,
            parameters: parameters.to_owned(),
        });
        2 * self.entities.len() - 1
    }

    pub fn set_parameters(&mut self, number: usize, parameters: &str) {
        parameters.clone_into(&mut self.entities[number / 2].parameters);
    }

    pub fn set_status(&mut self, number: usize, status: &'static str) -> usize {
        self.entities[number / 2].status = status;
        number
    }

    pub fn set_matrix(&mut self, number: usize, matrix: usize) -> usize {
        self.entities[number / 2].matrix = matrix;
        number
    }

    /// Puts an entity on a level, or on those of a list.
    pub fn set_level(&mut self, number: usize, level: i32) -> usize {
        self.entities[number / 2].level = level;
        number
    }

    pub fn numbers(&mut self, kind: u16, form: i16, numbers: &[f64]) -> usize {
        self.add(kind, form, &list(numbers))
    }

    pub fn point(&mut self, p: [f64; 3]) -> usize {
        self.add(116, 0, &format!("{},0", list(&p)))
    }

    pub fn direction(&mut self, d: [f64; 3]) -> usize {
        self.numbers(123, 0, &d)
    }

    pub fn line(&mut self, a: [f64; 3], b: [f64; 3]) -> usize {
        self.numbers(110, 0, &[a, b].concat())
    }

    /// A circle about z, counter-clockwise from an angle to another one; the same twice for all of it.
    pub fn circle(&mut self, z: f64, radius: f64, [from, to]: [f64; 2]) -> usize {
        let at = |t: f64| [radius * t.cos(), radius * t.sin()];
        self.numbers(100, 0, &[&[z, 0.0, 0.0], &at(from)[..], &at(to)[..]].concat())
    }

    /// A matrix by its rows.
    pub fn matrix(&mut self, rows: [[f64; 4]; 3]) -> usize {
        self.numbers(124, 0, &rows.concat())
    }

    /// A curve on a surface, by curves in (u, v) and in space; 0 for none.
    pub fn on_surface(&mut self, surface: usize, plane: usize, space: usize) -> usize {
        self.add(142, 0, &format!("0,{surface},{plane},{space},0"))
    }

    pub fn composite(&mut self, parts: &[usize]) -> usize {
        self.add(102, 0, &counted(parts))
    }

    /// A trimmed surface; 0 for an outer boundary that is the surface's own.
    pub fn trimmed(&mut self, surface: usize, outer: usize, inner: &[usize]) -> usize {
        let inner: String = inner.iter().map(|curve| format!(",{curve}")).collect();
        let count = inner.matches(',').count();
        let face = self.add(144, 0, &format!("{surface},{},{count},{outer}{inner}", u8::from(outer != 0)));
        self.set_status(face, INDEPENDENT)
    }

    /// The whole file.
    pub fn file(&self) -> String {
        let Style { delimiters: [field, record], line_end, is_terse, unit: (flag, name, scale) } = &self.style;
        let mut cards: Vec<String> = vec![];
        let mut card = |text: &str, letter: char, number: usize| {
            let text = if *is_terse && letter != 'D' {
                format!("{text:72}{letter}{number}")
            } else {
                format!("{text:72}{letter}{number:7}")
            };
            cards.push(text);
        };
        card("isophote", 'S', 1);
        let global = [
            format!(
                "1H{field}{field}1H{record}{field}4Hpart{field}8Hpart.igs{field}8Hisophote{field}1H1{field}32{field}38{field}"
            ),
            format!(
                "6{field}308{field}15{field}{field}{scale:?}{field}{flag}{field}{}H{name}{field}1{field}0.01{field}",
                name.len()
            ),
            format!("15H20261126.120000{field}1.E-7{field}1.E3{field}{field}{field}11{field}0{field}{record}"),
        ];
        global.iter().enumerate().for_each(|(k, text)| card(text, 'G', k + 1));
        let (mut records, mut directory) = (vec![], vec![]);
        for (k, entity) in self.entities.iter().enumerate() {
            let first = records.len() + 1;
            let mut text = format!("{},{}", entity.kind, entity.parameters);
            if *is_terse {
                text = text.replace('e', "D");
            }
            let mut line = String::new();
            let last = text.split(',').count();
            for (i, word) in text.split(',').enumerate() {
                let end = if i + 1 == last { record } else { field };
                if 64 < line.len() + word.len() + 1 {
                    records.push((std::mem::take(&mut line), 2 * k + 1));
                }
                write!(line, "{word}{end}").unwrap();
            }
            records.push((line, 2 * k + 1));
            let count = records.len() + 1 - first;
            let Entity { kind, status, matrix, form, level, .. } = entity;
            directory.push(format!("{kind:8}{first:8}{:8}{:8}{level:8}{:8}{matrix:8}{:8}{status:8}", 0, 0, 0, 0));
            directory.push(format!("{kind:8}{:8}{:8}{count:8}{form:8}{:8}{:8}{:8}{:8}", 0, 0, "", "", "", 0));
        }
        directory.iter().enumerate().for_each(|(k, text)| card(text, 'D', k + 1));
        records.iter().enumerate().for_each(|(k, (text, entity))| card(&format!("{text:64}{entity:8}"), 'P', k + 1));
        card(&format!("S{:7}G{:7}D{:7}P{:7}", 1, global.len(), directory.len(), records.len()), 'T', 1);
        cards.into_iter().map(|card| card + line_end).collect()
    }
}

/// A shell that is being written: its vertices and edges come in lists.
pub struct Shell {
    vertex_list: usize,
    edge_list: usize,
    vertices: Vec<[f64; 3]>,
    edges: Vec<(usize, [usize; 2])>,
    faces: Vec<(usize, bool)>,
}

/// An edge, or a vertex, that a loop uses.
#[derive(Clone, Copy)]
pub enum Used {
    Forward(usize),
    Backward(usize),
    Vertex(usize),
}

impl Shell {
    pub fn new(w: &mut Writer) -> Self {
        let (vertex_list, edge_list) = (w.add(502, 1, ""), w.add(504, 1, ""));
        Self { vertex_list, edge_list, vertices: vec![], edges: vec![], faces: vec![] }
    }

    /// A vertex, and its number from 1.
    pub fn vertex(&mut self, p: [f64; 3]) -> usize {
        self.vertices.push(p);
        self.vertices.len()
    }

    pub fn edge(&mut self, curve: usize, vertices: [usize; 2]) -> usize {
        self.edges.push((curve, vertices));
        self.edges.len()
    }

    /// A circle about z as an edge from a vertex at `angle` to itself.
    pub fn ring(&mut self, w: &mut Writer, z: f64, radius: f64, angle: f64) -> (usize, usize) {
        let vertex = self.vertex([radius * angle.cos(), radius * angle.sin(), z]);
        let circle = w.circle(z, radius, [angle, angle]);
        (self.edge(circle, [vertex, vertex]), vertex)
    }

    /// A face; `out` says whether its surface's normal points out of the shell.
    pub fn face(&mut self, w: &mut Writer, surface: usize, loops: &[&[Used]], out: bool) {
        let mut numbers = vec![];
        for uses in loops {
            let one = |used: &Used| match used {
                Used::Forward(edge) => format!("0,{},{edge},1,0", self.edge_list),
                Used::Backward(edge) => format!("0,{},{edge},0,0", self.edge_list),
                Used::Vertex(vertex) => format!("1,{},{vertex},1,0", self.vertex_list),
            };
            let all: Vec<String> = uses.iter().map(one).collect();
            numbers.push(w.add(508, 1, &format!("{},{}", uses.len(), all.join(","))));
        }
        let all: Vec<String> = numbers.iter().map(usize::to_string).collect();
        self.faces.push((w.add(510, 1, &format!("{surface},{},1,{}", numbers.len(), all.join(","))), out));
    }

    /// A plane across z with a circle for its border, seen from above or from below.
    pub fn disc(&mut self, w: &mut Writer, z: f64, ring: usize, up: bool) {
        let (origin, normal) = (w.point([0.0, 0.0, z]), w.direction([0.0, 0.0, if up { 1.0 } else { -1.0 }]));
        let plane = w.add(190, 0, &format!("{origin},{normal}"));
        self.face(w, plane, &[&[if up { Used::Forward(ring) } else { Used::Backward(ring) }]], true);
    }

    /// The solid of this shell alone.
    pub fn solid(self, w: &mut Writer) -> usize {
        let vertices: Vec<f64> = self.vertices.concat();
        w.set_parameters(self.vertex_list, &format!("{},{}", self.vertices.len(), list(&vertices)));
        let edge = |(curve, [a, b]): &(usize, [usize; 2])| format!("{curve},{v},{a},{v},{b}", v = self.vertex_list);
        let edges: Vec<String> = self.edges.iter().map(edge).collect();
        w.set_parameters(self.edge_list, &format!("{},{}", edges.len(), edges.join(",")));
        let faces: Vec<String> = self.faces.iter().map(|(face, out)| format!("{face},{}", u8::from(*out))).collect();
        let shell = w.add(514, 1, &format!("{},{}", faces.len(), faces.join(",")));
        let solid = w.add(186, 0, &format!("{shell},1,0"));
        w.set_status(solid, INDEPENDENT)
    }
}

pub fn list(numbers: &[f64]) -> String {
    numbers.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(",")
}

/// A count, and so many numbers.
pub fn counted(numbers: &[usize]) -> String {
    std::iter::once(numbers.len()).chain(numbers.iter().copied()).map(|n| n.to_string()).collect::<Vec<_>>().join(",")
}
