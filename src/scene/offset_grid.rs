//! A measured grid of offsets, in a CSV file or in the scene.

use std::path::Path;

use super::data::OffsetGrid;
use super::keys::number;
use super::nurbs::read_text;

/// First line of a file.
const HEADER: &str = "u,v,offset_mm";

/// Most values of u or of v: the spline through them takes the third power of this in time.
const MOST: usize = 1000;

/// What is wrong with a grid, and how to mend it.
pub(super) struct Wrong {
    /// Key of a grid in the scene that is wrong.
    pub key: &'static str,
    pub problem: String,
    pub remedy: &'static str,
}

const FORM: &str =
    "the path is relative to the scene file; its first line is u,v,offset_mm, and each line below a point";
const FULL: &str = "a full grid has the same values of v for each u, in ascending order, v running fastest: 0,0 then 0,0.5 then 0,1 then 0.5,0";

/// Reads the grid of a file.
pub(super) fn read(path: &Path) -> Result<OffsetGrid, Wrong> {
    let wrong = |problem: String, remedy| Wrong { key: "file", problem, remedy };
    let text = read_text(path).map_err(|problem| wrong(problem, FORM))?;
    let at = |line: usize, problem: &str| format!("{} line {line}: {problem}", path.display());
    let mut lines = text.lines().enumerate().map(|(index, line)| (index + 1, line.trim()));
    let header = lines.next().map_or("", |(_, line)| line);
    if header.split(',').map(str::trim).ne(HEADER.split(',')) {
        return Err(wrong(at(1, &format!("the header is \"{}\", and not {HEADER}", shortened(header))), FORM));
    }
    let mut rows = Rows::default();
    let mut last = 1;
    let ends = |line: &str| line.is_empty();
    let written: Vec<(usize, &str)> = lines.collect();
    let used = written.iter().rposition(|(_, line)| !ends(line)).map_or(0, |last| last + 1);
    for (line, text) in &written[..used] {
        let point = numbers(text).map_err(|problem| wrong(at(*line, &problem), FORM))?;
        rows.take(point).map_err(|problem| wrong(at(*line, &problem), FULL))?;
        last = *line;
    }
    let grid = rows.end().map_err(|problem| wrong(at(last, &problem), FULL))?;
    match check(&grid) {
        Ok(()) => Ok(grid),
        Err(found) => Err(wrong(format!("{}: {}", path.display(), found.problem), found.remedy)),
    }
}

/// The first characters of a line.
fn shortened(line: &str) -> String {
    line.chars().take(40).collect()
}

/// The three numbers of a line.
fn numbers(line: &str) -> Result<[f64; 3], String> {
    let fields: Vec<&str> = line.split(',').map(str::trim).collect();
    let [u, v, offset] = fields[..] else {
        return Err(format!("it has {} fields, and not three", if line.is_empty() { 0 } else { fields.len() }));
    };
    let read = |name: &str, text: &str| match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value + 0.0),
        Ok(value) => Err(format!("{name} is {value}: a point that was not measured leaves a hole in the grid")),
        Err(_) => Err(format!("{name} is \"{}\", which is no number", shortened(text))),
    };
    Ok([read("u", u)?, read("v", v)?, read("offset_mm", offset)?])
}

/// The rows of a grid, point by point.
#[derive(Default)]
struct Rows {
    u: Vec<f64>,
    v: Vec<f64>,
    offsets_mm: Vec<f64>,
    /// Points of the row in hand.
    count: usize,
}

impl Rows {
    fn take(&mut self, [u, v, offset]: [f64; 3]) -> Result<(), String> {
        for (name, value) in [("u", u), ("v", v)] {
            if !(0.0..=1.0).contains(&value) {
                return Err(format!("{name} is {value}, and the surface goes from 0 to 1"));
            }
        }
        match self.u.last() {
            Some(last) if *last == u => {}
            Some(last) if u < *last => {
                return Err(format!("u = {u} comes after u = {last}: the points are not sorted"));
            }
            Some(_) => {
                self.check_row()?;
                self.u.push(u);
                self.count = 0;
            }
            None => self.u.push(u),
        }
        match (self.u.len(), self.v.get(self.count)) {
            (1, _) => match self.v.last() {
                Some(last) if v <= *last => {
                    return Err(format!("v = {v} comes after v = {last}: the points are not sorted"));
                }
                _ => self.v.push(v),
            },
            (_, Some(expected)) if *expected == v => {}
            (_, Some(expected)) => {
                return Err(format!(
                    "v is {v} where the first row has {expected}: the grid is not full, or not sorted"
                ));
            }
            (_, None) => {
                return Err(format!("the row of u = {u} has more points than the first one, {}", self.v.len()));
            }
        }
        self.count += 1;
        self.offsets_mm.push(offset);
        Ok(())
    }

    /// Refuses a row that ends early.
    fn check_row(&self) -> Result<(), String> {
        let (here, all) = (self.count, self.v.len());
        let u = self.u.last().copied().unwrap_or_default();
        if here == all {
            return Ok(());
        }
        Err(format!("the row of u = {u} ends after {here} points, and the first row has {all}"))
    }

    fn end(self) -> Result<OffsetGrid, String> {
        self.check_row()?;
        let Self { u, v, offsets_mm, .. } = self;
        Ok(OffsetGrid { u, v, offsets_mm })
    }
}

/// Refuses a grid that does not cover the surface.
pub(super) fn check(grid: &OffsetGrid) -> Result<(), Wrong> {
    let OffsetGrid { u, v, offsets_mm } = grid;
    for (key, values) in [("u", u), ("v", v)] {
        let wrong = |problem: String, remedy| Err(Wrong { key, problem, remedy });
        let (Some(first), Some(last)) = (values.first(), values.last()) else {
            return wrong(format!("there is no value of {key}"), FULL);
        };
        if values.len() < 2 {
            return wrong(
                format!("there is one value of {key}, {first}"),
                "a grid has two values or more each way, 0 and 1 among them",
            );
        }
        if values.len() > MOST {
            return wrong(
                format!("there are {} values of {key}, and no more than {MOST} are taken", values.len()),
                "thin the grid out: a spline between its points stays smooth",
            );
        }
        if let Some(pair) = values.windows(2).find(|pair| pair[1] <= pair[0]) {
            return wrong(format!("{} comes after {} in {key}", number(pair[1]), number(pair[0])), FULL);
        }
        if *first != 0.0 || *last != 1.0 {
            return wrong(
                format!("{key} goes from {} to {}, and the surface from 0 to 1", number(*first), number(*last)),
                "add rows at the edges: what was not measured is not made up",
            );
        }
    }
    let (found, expected) = (offsets_mm.len(), u.len() * v.len());
    match found == expected {
        true => Ok(()),
        false => Err(Wrong {
            key: "offsets_mm",
            problem: format!("there are {found} offsets, and {} values of u times {} of v", u.len(), v.len()),
            remedy: "each pair of u and v has an offset, v running fastest",
        }),
    }
}
