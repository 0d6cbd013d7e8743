//! A writer of small STEP files: instances are numbered as they are added, and named by the number.

use std::fmt::{Display, Write};

/// A file that is being written.
pub struct Writer {
    data: String,
    next: u64,
    schema: &'static str,
}

/// What lengths and angles are counted in.
#[derive(Clone, Copy, PartialEq)]
pub enum Units {
    MillimetreRadian,
    InchDegree,
}

impl Writer {
    pub fn new(schema: &'static str) -> Self {
        Self { data: String::new(), next: 1, schema }
    }

    /// Adds an instance, and returns its number.
    pub fn add(&mut self, body: impl Display) -> u64 {
        let number = self.next;
        self.next += 1;
        writeln!(self.data, "#{number}={body};").unwrap();
        number
    }

    /// The whole file.
    pub fn file(&self) -> String {
        format!(
            "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\nFILE_SCHEMA(('{}'));\n\
             ENDSEC;\nDATA;\n{}ENDSEC;\nEND-ISO-10303-21;\n",
            self.schema, self.data
        )
    }

    pub fn point(&mut self, p: [f64; 3]) -> u64 {
        self.add(format_args!("CARTESIAN_POINT('',({:?},{:?},{:?}))", p[0], p[1], p[2]))
    }

    pub fn direction(&mut self, d: [f64; 3]) -> u64 {
        self.add(format_args!("DIRECTION('',({:?},{:?},{:?}))", d[0], d[1], d[2]))
    }

    /// A placement by origin, z and x.
    pub fn placement(&mut self, origin: [f64; 3], z: [f64; 3], x: [f64; 3]) -> u64 {
        let (origin, z, x) = (self.point(origin), self.direction(z), self.direction(x));
        self.add(format_args!("AXIS2_PLACEMENT_3D('',#{origin},#{z},#{x})"))
    }

    pub fn vertex(&mut self, p: [f64; 3]) -> u64 {
        let point = self.point(p);
        self.add(format_args!("VERTEX_POINT('',#{point})"))
    }

    pub fn line(&mut self, origin: [f64; 3], direction: [f64; 3]) -> u64 {
        let (origin, direction) = (self.point(origin), self.direction(direction));
        let vector = self.add(format_args!("VECTOR('',#{direction},1.)"));
        self.add(format_args!("LINE('',#{origin},#{vector})"))
    }

    /// A circle about +z, from +x.
    pub fn circle(&mut self, centre: [f64; 3], radius: f64) -> u64 {
        let placement = self.placement(centre, Z, X);
        self.add(format_args!("CIRCLE('',#{placement},{radius:?})"))
    }

    pub fn edge(&mut self, [start, end]: [u64; 2], curve: u64, sense: bool) -> u64 {
        self.add(format_args!("EDGE_CURVE('',#{start},#{end},#{curve},{})", flag(sense)))
    }

    /// A bound of edges, each with its orientation.
    pub fn bound(&mut self, keyword: &str, edges: &[(u64, bool)]) -> u64 {
        let uses: Vec<u64> = edges
            .iter()
            .map(|(edge, same)| self.add(format_args!("ORIENTED_EDGE('',*,*,#{edge},{})", flag(*same))))
            .collect();
        let boundary = self.add(format_args!("EDGE_LOOP('',{})", list(&uses)));
        self.add(format_args!("{keyword}('',#{boundary},.T.)"))
    }

    pub fn vertex_bound(&mut self, vertex: u64) -> u64 {
        let boundary = self.add(format_args!("VERTEX_LOOP('',#{vertex})"));
        self.add(format_args!("FACE_BOUND('',#{boundary},.T.)"))
    }

    pub fn face(&mut self, bounds: &[u64], surface: u64, same_sense: bool) -> u64 {
        self.add(format_args!("ADVANCED_FACE('',{},#{surface},{})", list(bounds), flag(same_sense)))
    }

    pub fn solid(&mut self, faces: &[u64]) -> u64 {
        let shell = self.add(format_args!("CLOSED_SHELL('',{})", list(faces)));
        self.add(format_args!("MANIFOLD_SOLID_BREP('',#{shell})"))
    }

    pub fn context(&mut self, units: Units) -> u64 {
        let millimetre = self.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))");
        let radian = self.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))");
        let (length, angle) = match units {
            Units::MillimetreRadian => (millimetre, radian),
            Units::InchDegree => {
                let inch = self.add(format_args!("LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#{millimetre})"));
                let degree = self.add(format_args!(
                    "PLANE_ANGLE_MEASURE_WITH_UNIT(PLANE_ANGLE_MEASURE({:?}),#{radian})",
                    1f64.to_radians()
                ));
                (
                    self.add(format_args!("(CONVERSION_BASED_UNIT('INCH',#{inch})LENGTH_UNIT()NAMED_UNIT($))")),
                    self.add(format_args!(
                        "(CONVERSION_BASED_UNIT('DEGREE',#{degree})NAMED_UNIT($)PLANE_ANGLE_UNIT())"
                    )),
                )
            }
        };
        let uncertainty =
            self.add(format_args!("UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-07),#{length},'','')"));
        self.add(format_args!(
            "(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#{uncertainty}))\
             GLOBAL_UNIT_ASSIGNED_CONTEXT((#{length},#{angle}))REPRESENTATION_CONTEXT('',''))"
        ))
    }

    pub fn representation(&mut self, items: &[u64], context: u64) -> u64 {
        self.add(format_args!("ADVANCED_BREP_SHAPE_REPRESENTATION('',{},#{context})", list(items)))
    }
}

pub const X: [f64; 3] = [1.0, 0.0, 0.0];
pub const Z: [f64; 3] = [0.0, 0.0, 1.0];
pub const DOWN: [f64; 3] = [0.0, 0.0, -1.0];

pub fn flag(value: bool) -> &'static str {
    if value { ".T." } else { ".F." }
}

pub fn list(numbers: &[u64]) -> String {
    let all: Vec<String> = numbers.iter().map(|n| format!("#{n}")).collect();
    format!("({})", all.join(","))
}
