//! The table of support in the docs, against what the code lists and what a file with each kind shows.

use crate::table::assert_table_is_listed;
use formats::{FORMATS, Support};
use std::collections::BTreeMap;

#[test]
fn the_table_of_support_says_what_the_code_lists() {
    assert_table_is_listed("STEP");
}

/// Each surface that the table calls exact draws a face of its own, and each that it leaves out is noted.
#[test]
fn surfaces_are_taken_as_the_table_says() {
    let data = "#1=CARTESIAN_POINT('',(0.,0.,0.));\n#2=AXIS2_PLACEMENT_3D('',#1,$,$);\n#3=DIRECTION('',(0.,0.,1.));\n\
        #4=VECTOR('',#3,2.);\n#5=CARTESIAN_POINT('',(1.,0.,0.));\n#6=CARTESIAN_POINT('',(1.,0.,1.));\n\
        #7=CARTESIAN_POINT('',(0.,0.,1.));\n#8=BEZIER_CURVE('',1,(#5,#6),.UNSPECIFIED.,.F.,.F.);\n#9=CIRCLE('',#2,1.);\n\
        #10=AXIS1_PLACEMENT('',#1,#3);\n#11=CYLINDRICAL_SURFACE('',#2,1.);\n#12=PLANE('',#2);\n#13=SPHERICAL_SURFACE('',#2,1.);\n\
        #14=POLYLINE('',(#1,#5,#6,#1));\n#15=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#14);\n\
        #16=OUTER_BOUNDARY_CURVE('',(#15),.F.);\n#17=DIRECTION('',(0.,1.,0.));\n#18=AXIS2_PLACEMENT_3D('',#1,#17,$);\n#19=PLANE('',#18);\n\
        #20=CARTESIAN_TRANSFORMATION_OPERATOR_3D('',$,$,#5,2.,$);\n\
        #21=PARABOLA('',#2,1.);\n#22=SURFACE_OF_LINEAR_EXTRUSION('',#21,#4);\n\
        #23=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));\n\
        #24=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#23))REPRESENTATION_CONTEXT('',''));\n";
    let net = "((#1,#7),(#5,#6)),.UNSPECIFIED.,.F.,.F.,.F.";
    let bodies: BTreeMap<&str, String> = [
        ("SPHERICAL_SURFACE", "SPHERICAL_SURFACE('',#2,1.)".to_owned()),
        ("TOROIDAL_SURFACE", "TOROIDAL_SURFACE('',#2,2.,1.)".to_owned()),
        ("DEGENERATE_TOROIDAL_SURFACE", "DEGENERATE_TOROIDAL_SURFACE('',#2,1.,2.,.T.)".to_owned()),
        ("SURFACE_OF_REVOLUTION", "SURFACE_OF_REVOLUTION('',#8,#10)".to_owned()),
        (
            "B_SPLINE_SURFACE_WITH_KNOTS",
            format!("B_SPLINE_SURFACE_WITH_KNOTS('',1,1,{net},(2,2),(2,2),(0.,1.),(0.,1.),.UNSPECIFIED.)"),
        ),
        ("UNIFORM_SURFACE", format!("UNIFORM_SURFACE('',1,1,{net})")),
        ("QUASI_UNIFORM_SURFACE", format!("QUASI_UNIFORM_SURFACE('',1,1,{net})")),
        ("BEZIER_SURFACE", format!("BEZIER_SURFACE('',1,1,{net})")),
        (
            "RATIONAL_B_SPLINE_SURFACE",
            format!(
                "(BEZIER_SURFACE()B_SPLINE_SURFACE(1,1,{net})RATIONAL_B_SPLINE_SURFACE(((1.,2.),(2.,1.)))SURFACE())"
            ),
        ),
        ("OFFSET_SURFACE of plane, cylinder, cone, sphere, torus", "OFFSET_SURFACE('',#13,0.5,.F.)".to_owned()),
        ("OFFSET_SURFACE of others", "OFFSET_SURFACE('',#100,0.5,.F.)".to_owned()),
        (
            "OFFSET_SURFACE of what a parabola or a hyperbola sweeps, or of a surface with a crease",
            "OFFSET_SURFACE('',#22,0.5,.F.)".to_owned(),
        ),
        ("RECTANGULAR_TRIMMED_SURFACE", "RECTANGULAR_TRIMMED_SURFACE('',#11,0.5,2.,-1.,1.,.T.,.T.)".to_owned()),
        ("CURVE_BOUNDED_SURFACE", "CURVE_BOUNDED_SURFACE('',#19,(#16),.F.)".to_owned()),
        ("RECTANGULAR_COMPOSITE_SURFACE", "RECTANGULAR_COMPOSITE_SURFACE('',())".to_owned()),
        ("SURFACE_REPLICA", "SURFACE_REPLICA('',#13,#20)".to_owned()),
    ]
    .into();
    let step = FORMATS.iter().find(|format| format.name() == "STEP").expect("it is in the list");
    let mut tried = 0;
    for (name, support) in step.entities() {
        let Some(body) = bodies.get(name) else { continue };
        tried += 1;
        let text = format!(
            "DATA;\n{data}#50={body};\n#51=GEOMETRIC_SET('',(#50,#13));\n\
             #52=GEOMETRICALLY_BOUNDED_SURFACE_SHAPE_REPRESENTATION('',(#51),#24);\n#100=BEZIER_SURFACE('',1,1,{net});\nENDSEC;\n"
        );
        let document = step.read(text.as_bytes(), "part.step").unwrap_or_else(|error| panic!("{name}: {error}"));
        let losses: Vec<String> =
            document.notes.iter().filter(|note| note.kind.is_loss()).map(ToString::to_string).collect();
        // The sphere beside it is always drawn.
        if *support == Support::LeftOut {
            assert_eq!((document.model.faces().len(), losses.len()), (1, 1), "{name}: {losses:?}");
            assert!(losses[0].contains("#50"), "{losses:?}");
        } else {
            assert_eq!((document.model.faces().len(), losses.len()), (2, 0), "{name}: {losses:?}");
        }
    }
    assert_eq!(tried, bodies.len());
}
