//! A part of the surface: the values of keys named `on`.

use serde_json::{Value, json};
use toml::de::DeValue;

use super::data::{Edge, ParametricDirection, Region};
use super::entry::Entry;
use super::fault::{Checked, Fault};
use super::keys::{Form, Key};
use super::nearest::nearest;
use super::problem::Problem;
use super::value::{as_float, value_type};

/// The edges, as a scene calls them.
pub(super) static EDGES: [(Edge, &str); 4] = {
    let [a, b, c, d] = Edge::ALL;
    [(a, a.name()), (b, b.name()), (c, c.name()), (d, d.name())]
};

/// Reads a part of the surface of one of some forms; where only edges or only points are allowed, that alone.
pub(super) fn read(key: &'static Key, forms: &[Form], entry: &Entry<'_>) -> Checked<Value> {
    let at = entry.value_place();
    let place = match entry.value.get_ref() {
        DeValue::String(text) => edge_or_line(key, text, entry)?,
        DeValue::Array(items) if items.len() == 2 => {
            let numbers: Vec<f64> = items.iter().filter_map(|item| as_float(item.get_ref())).collect();
            let Ok(point) = <[f64; 2]>::try_from(numbers) else {
                return Err(Fault::new(Problem::WrongType { key, found: value_type(entry.value.get_ref()) }, &at));
            };
            if point.iter().any(|fraction| !(0.0..=1.0).contains(fraction)) {
                return Err(Fault::new(Problem::NoSuchPoint { key, found: point }, &at));
            }
            Region::Point(point.map(|fraction| fraction + 0.0))
        }
        DeValue::Array(items) => return Err(Fault::new(Problem::WrongLength { key, found: items.len() }, &at)),
        other => return Err(Fault::new(Problem::WrongType { key, found: value_type(other) }, &at)),
    };
    let (form, bare) = match place {
        Region::Edge(edge) => (Form::Edge, json!(edge)),
        Region::Point(point) => (Form::Point, json!(point)),
        Region::Line(..) | Region::Whole => (Form::Line, json!(place)),
    };
    match forms {
        _ if !forms.contains(&form) => Err(Fault::new(Problem::WrongForm { key, found: form }, &at)),
        [_] => Ok(bare),
        _ => Ok(json!(place)),
    }
}

fn edge_or_line(key: &'static Key, text: &str, entry: &Entry<'_>) -> Checked<Region> {
    let at = entry.value_place();
    if let Some((edge, _)) = EDGES.iter().find(|(_, name)| *name == text) {
        return Ok(Region::Edge(*edge));
    }
    if let Some((direction, fraction)) = text.split_once('=') {
        let direction = match direction.trim() {
            "u" => Some(ParametricDirection::U),
            "v" => Some(ParametricDirection::V),
            _ => None,
        };
        match (direction, fraction.trim().parse::<f64>()) {
            (Some(direction), Ok(fraction)) if 0.0 < fraction && fraction < 1.0 => {
                return Ok(Region::Line(direction, fraction));
            }
            (Some(_), Ok(_)) => return Err(Fault::new(Problem::NoSuchLine { key, found: text.into() }, &at)),
            _ => {}
        }
    }
    let meant = nearest(&text.replace("start", "-start").replace("end", "-end"), EDGES.iter().map(|(_, name)| *name));
    let fault = Fault::new(Problem::UnknownRegion { key, found: text.into(), meant }, &at);
    Err(match meant {
        Some(meant) => fault.edit(&at, entry.written(meant)),
        None => fault,
    })
}
