//! The deformed surface for CAD: STEP (ISO 10303-21), as the NURBS surface that it is.
//!
//! Of the formats that have NURBS, STEP is the one that every CAD system and mesher reads today (CATIA, NX, SolidWorks, Rhino,
//! FreeCAD and Gmsh by Open CASCADE); IGES is no longer kept up and says less of what bounds a surface, and the XML of G+Smo is read by
//! G+Smo. The schema is AP214 (`AUTOMOTIVE_DESIGN`), whose part for surfaces AP242 took over, so that older systems read it as well: for
//! each shell one face of a `B_SPLINE_SURFACE_WITH_KNOTS`, bounded by its four edges, in an open shell, in mm.

use std::fmt::Write as _;

use crate::shell::{norm, sub};
use crate::spline::{Grid, Patch};

/// Distance within which readers take points for one, mm.
const UNCERTAINTY_MM: f64 = 1e-6;

/// What stands before the geometry, up to entity 14.
const PRODUCT: &str = "\
#1=APPLICATION_CONTEXT('core data for automotive mechanical design processes');
#2=APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,#1);
#3=PRODUCT_CONTEXT('',#1,'mechanical');
#4=PRODUCT('NAME','NAME','',(#3));
#5=PRODUCT_DEFINITION_FORMATION('','',#4);
#6=PRODUCT_DEFINITION_CONTEXT('part definition',#1,'design');
#7=PRODUCT_DEFINITION('design','',#5,#6);
#8=PRODUCT_DEFINITION_SHAPE('','',#7);
#9=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));
#10=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));
#11=(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT());
#12=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(UNCERTAINTY),#9,'distance_accuracy_value','');
#13=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#12))GLOBAL_UNIT_ASSIGNED_CONTEXT((#9,#10,#11))REPRESENTATION_CONTEXT('',''));
";

/// Entities of a file, numbered as they come.
struct Entities {
    text: String,
    last: usize,
}

impl Entities {
    /// Adds an entity, and gives its name.
    fn add(&mut self, entity: &str) -> String {
        self.last += 1;
        // Writing to a string does not fail.
        let _ = writeln!(self.text, "#{}={entity};", self.last);
        format!("#{}", self.last)
    }
}

/// Formats surfaces as the text of a STEP file, each with the name of its shell, if it has one; `name` names the product and says what
/// state it is of.
pub fn step(surfaces: &[(&Patch, Option<&str>)], name: &str) -> String {
    let name = string(name);
    let product = PRODUCT
        .replace("'NAME'", &format!("'{name}'"))
        .replace("(UNCERTAINTY)", &format!("({})", real(UNCERTAINTY_MM)));
    let mut entities = Entities { text: product, last: 13 };
    let mut shells = Vec::new();
    for (surface, of_shell) in surfaces {
        let points: Vec<String> =
            surface.points().map(|point| entities.add(&format!("CARTESIAN_POINT('',({}))", reals(&point)))).collect();
        let face = face(&mut entities, surface, &points);
        let of_shell = string(of_shell.unwrap_or_default());
        shells.push(entities.add(&format!("OPEN_SHELL('{of_shell}',({face}))")));
    }
    let model = entities.add(&format!("SHELL_BASED_SURFACE_MODEL('',({}))", shells.join(",")));
    let shape = entities.add(&format!("MANIFOLD_SURFACE_SHAPE_REPRESENTATION('{name}',({model}),#13)"));
    entities.add(&format!("SHAPE_DEFINITION_REPRESENTATION(#8,{shape})"));
    format!(
        "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('deformed shell, mm'),'2;1');\n\
         FILE_NAME('{name}','',(''),(''),'foldline','foldline','');\n\
         FILE_SCHEMA(('AUTOMOTIVE_DESIGN {{ 1 0 10303 214 1 1 1 1 }}'));\nENDSEC;\nDATA;\n{}ENDSEC;\nEND-ISO-10303-21;\n",
        entities.text
    )
}

/// The surface, bounded by its edges.
fn face(entities: &mut Entities, surface: &Patch, points: &[String]) -> String {
    let grid = surface.grid();
    let [n1, n2] = grid.counts;
    let corners = [[0, 0], [n1 - 1, 0], [n1 - 1, n2 - 1], [0, n2 - 1]].map(|place| grid.index(place));
    let vertices = corners.map(|corner| entities.add(&format!("VERTEX_POINT('',{})", points[corner])));
    // Around the surface: v = 0, u = 1, and v = 1 and u = 0 against their parameter.
    let sides = [(1, 0, [0, 1]), (0, n1 - 1, [1, 2]), (1, n2 - 1, [3, 2]), (0, 0, [0, 3])];
    let mut around = Vec::new();
    for (side, (constant, line, [from, to])) in sides.into_iter().enumerate() {
        let controls: Vec<usize> = grid.line(constant, line).collect();
        if controls.iter().all(|k| norm(sub(surface.point(*k), surface.point(controls[0]))) <= UNCERTAINTY_MM) {
            // A pole is no edge.
            continue;
        }
        let curve = curve(entities, surface, 1 - constant, &controls, points);
        let edge = entities.add(&format!("EDGE_CURVE('',{},{},{curve},.T.)", vertices[from], vertices[to]));
        let sense = if side < 2 { ".T." } else { ".F." };
        around.push(entities.add(&format!("ORIENTED_EDGE('',*,*,{edge},{sense})")));
    }
    let geometry = nurbs(entities, surface, grid, points);
    let around = entities.add(&format!("EDGE_LOOP('',({}))", around.join(",")));
    let bound = entities.add(&format!("FACE_OUTER_BOUND('',{around},.T.)"));
    entities.add(&format!("ADVANCED_FACE('',({bound}),{geometry},.T.)"))
}

fn curve(entities: &mut Entities, surface: &Patch, direction: usize, controls: &[usize], points: &[String]) -> String {
    let (times, knots) = multiplicities(&surface.knots[direction]);
    let names: Vec<&str> = controls.iter().map(|k| &points[*k][..]).collect();
    let weights: Vec<f64> = controls.iter().map(|k| surface.control_points[*k][3]).collect();
    entities.add(&format!(
        "(BOUNDED_CURVE()B_SPLINE_CURVE({},({}),.UNSPECIFIED.,.F.,.U.)B_SPLINE_CURVE_WITH_KNOTS(({times}),({knots}),.UNSPECIFIED.)\
         CURVE()GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_CURVE(({}))REPRESENTATION_ITEM(''))",
        surface.degree[direction],
        names.join(","),
        reals(&weights)
    ))
}

fn nurbs(entities: &mut Entities, surface: &Patch, grid: Grid, points: &[String]) -> String {
    let [(times_u, knots_u), (times_v, knots_v)] = [0, 1].map(|direction| multiplicities(&surface.knots[direction]));
    let rows = |of_row: &dyn Fn(Vec<usize>) -> String| {
        let row = |i| format!("({})", of_row(grid.line(0, i).collect()));
        (0..grid.counts[0]).map(row).collect::<Vec<_>>().join(",")
    };
    let names = rows(&|row| row.iter().map(|k| &points[*k][..]).collect::<Vec<_>>().join(","));
    let weights = rows(&|row| reals(&row.iter().map(|k| surface.control_points[*k][3]).collect::<Vec<_>>()));
    let [p, q] = surface.degree;
    entities.add(&format!(
        "(BOUNDED_SURFACE()B_SPLINE_SURFACE({p},{q},({names}),.UNSPECIFIED.,.F.,.F.,.U.)\
         B_SPLINE_SURFACE_WITH_KNOTS(({times_u}),({times_v}),({knots_u}),({knots_v}),.UNSPECIFIED.)\
         GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_SURFACE(({weights}))REPRESENTATION_ITEM('')SURFACE())"
    ))
}

/// Multiplicities of the knots that differ, and these knots, as lists.
fn multiplicities(knots: &[f64]) -> (String, String) {
    let groups: Vec<&[f64]> = knots.chunk_by(|a, b| a == b).collect();
    let times: Vec<String> = groups.iter().map(|group| group.len().to_string()).collect();
    let knots: Vec<f64> = groups.iter().map(|group| group[0]).collect();
    (times.join(","), reals(&knots))
}

fn reals(numbers: &[f64]) -> String {
    numbers.iter().map(|number| real(*number)).collect::<Vec<_>>().join(",")
}

/// A number with a point, as STEP wants it, and all its digits.
fn real(number: f64) -> String {
    let text = format!("{number:?}");
    match text.split_once('e') {
        Some((digits, exponent)) if digits.contains('.') => format!("{digits}E{exponent}"),
        Some((digits, exponent)) => format!("{digits}.E{exponent}"),
        None => text,
    }
}

/// Text between apostrophes: those are doubled, and what is not ASCII has no place.
fn string(text: &str) -> String {
    let plain = text.chars().map(|c| if matches!(c, ' '..='~') { c } else { '_' });
    plain.collect::<String>().replace('\'', "''").replace('\\', "\\\\")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entities_have_a_name_each_and_refer_to_those_before() {
        let knots = || vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
        let point = |k: usize| [(k / 3) as f64, (k % 3) as f64, 0.0, 1.0];
        let plane = Patch { degree: [2, 2], knots: [knots(), knots()], control_points: (0..9).map(point).collect() };
        let text = step(&[(&plane, None)], "a \"shell's\" plane, 5°");
        assert!(text.contains("PRODUCT('a \"shell''s\" plane, 5_',"));
        let (_, data) = text.split_once("DATA;\n").unwrap();
        for (index, line) in data.lines().take_while(|line| *line != "ENDSEC;").enumerate() {
            let (name, entity) = line.split_once('=').unwrap();
            assert_eq!(name, format!("#{}", index + 1));
            let references = entity.split('#').skip(1).map(|rest| {
                let end = rest.find(|c: char| !c.is_ascii_digit()).unwrap();
                rest[..end].parse::<usize>().unwrap()
            });
            assert!(references.into_iter().all(|reference| reference <= index), "{line}");
        }
    }

    #[test]
    fn numbers_have_a_point() {
        let written = [0.5, 1.0, 1e-7, -2.5e300].map(real);
        assert_eq!(written, ["0.5", "1.0", "1.E-7", "-2.5E300"]);
    }
}
