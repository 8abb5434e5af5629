//! What must hold between the pieces of a profile: none is but a point, it neither closes nor meets itself, and bends less than the
//! thickness allows.

use super::data::ProfilePiece;
use super::fault::Checked;
use super::table::Table;
use crate::units::significant;

/// Distance below which two points of a profile are one, as a share of its length.
const TOUCH: f64 = 1e-6;

/// A point or a vector in the y-z plane, mm.
type Vector = [f64; 2];

/// A piece of a profile in its place.
#[derive(Clone, Copy, Debug)]
enum Stretch {
    Line {
        from: Vector,
        /// Unit vector.
        direction: Vector,
        length: f64,
    },
    Arc {
        centre: Vector,
        radius: f64,
        /// Angle of its first point, radians, from +y towards +z.
        from: f64,
        /// Angle from its first point to its last.
        sweep: f64,
    },
}

/// Refuses a profile with a piece that is next to nothing, and one that closes or meets itself elsewhere.
pub(super) fn check(table: &Table, pieces: &[ProfilePiece], start_mm: Vector, direction_deg: f64) -> Checked<()> {
    let stretches = placed(pieces, start_mm, direction_deg);
    let whole: f64 = pieces.iter().map(ProfilePiece::length_mm).sum();
    let touch = TOUCH * whole;
    // An arc of no angle is such a piece too.
    if let Some((index, piece)) = pieces.iter().enumerate().find(|(_, piece)| piece.length_mm() <= touch) {
        let [short, whole] = [piece.length_mm(), whole].map(|length| significant(length, 4));
        let problem =
            format!("piece {} of the profile is {short} mm long, and the whole profile {whole} mm", index + 1);
        let place = table.place_of_item("profile", index);
        return Err(table.wrong(place.as_ref(), problem, "leave it out, or make it longer"));
    }
    let end = stretches.last().map_or(start_mm, Stretch::end);
    if distance(start_mm, end) <= touch {
        return Err(table.wrong(
            table.place_of_item("profile", pieces.len() - 1).as_ref(),
            format!("the profile ends where it starts, at {}", shown(start_mm)),
            "leave a gap; a closed circle is kind = \"cylinder-panel\" with arc_deg = 360.0 and a seam, any other closed section \
             kind = \"nurbs\" with a seam",
        ));
    }
    for (later, stretch) in stretches.iter().enumerate() {
        for (earlier, other) in stretches[..later].iter().enumerate() {
            let is_next = earlier + 1 == later;
            if let Some(at) = meeting(other, stretch, is_next, touch) {
                let problem = format!("pieces {} and {} of the profile meet at {}", earlier + 1, later + 1, shown(at));
                let remedy = "make pieces shorter, or turn them the other way: positive angles turn to the left";
                let place = table.place_of_item("profile", later);
                return Err(table
                    .wrong(place.as_ref(), problem, remedy)
                    .also(table.place_of_item("profile", earlier).as_ref()));
            }
        }
    }
    Ok(())
}

/// Refuses an arc with a radius no larger than the thickness.
pub(super) fn check_thin(geometry: &Table, thickness_mm: f64) -> Checked<()> {
    let pieces: Option<Vec<ProfilePiece>> = geometry.get("profile");
    let is_thick = |piece: &ProfilePiece| match piece {
        ProfilePiece::Arc { radius_mm, .. } => thickness_mm >= *radius_mm,
        ProfilePiece::Line { .. } => false,
    };
    let Some((index, ProfilePiece::Arc { radius_mm, .. })) =
        pieces.into_iter().flatten().enumerate().find(|(_, piece)| is_thick(piece))
    else {
        return Ok(());
    };
    let problem = format!(
        "piece {} of the profile has a radius of {radius_mm} mm, for which a thickness of {thickness_mm} mm is not thin",
        index + 1
    );
    let remedy = "shell theory holds for a thickness far below the radius: take a larger radius or a thinner shell; is each in mm?";
    Err(geometry.wrong(geometry.place_of_item("profile", index).as_ref(), problem, remedy))
}

fn shown(at: Vector) -> String {
    // A rounding of zero is zero.
    let [y, z] = at.map(|x| significant(if x.abs() < 1e-9 { 0.0 } else { x }, 4));
    format!("y = {y}, z = {z} mm")
}

fn placed(pieces: &[ProfilePiece], start: Vector, direction_deg: f64) -> Vec<Stretch> {
    let (mut at, mut heading_deg) = (start, direction_deg);
    let place = |piece: &ProfilePiece| {
        let (sin, cos) = heading_deg.to_radians().sin_cos();
        let stretch = match *piece {
            ProfilePiece::Line { line_mm } => Stretch::Line { from: at, direction: [cos, sin], length: line_mm },
            ProfilePiece::Arc { arc_deg, radius_mm } => {
                let side = arc_deg.signum();
                let centre = [at[0] - side * radius_mm * sin, at[1] + side * radius_mm * cos];
                let from = (heading_deg - side * 90.0).to_radians();
                Stretch::Arc { centre, radius: radius_mm, from, sweep: arc_deg.to_radians() }
            }
        };
        heading_deg += piece.turn_deg();
        at = stretch.end();
        stretch
    };
    pieces.iter().map(place).collect()
}

impl Stretch {
    fn end(&self) -> Vector {
        match *self {
            Stretch::Line { from, direction, length } => along(from, direction, length),
            Stretch::Arc { centre, radius, from, sweep } => on_circle(centre, radius, from + sweep),
        }
    }

    fn start(&self) -> Vector {
        match *self {
            Stretch::Line { from, .. } => from,
            Stretch::Arc { centre, radius, from, .. } => on_circle(centre, radius, from),
        }
    }

    /// Whether a point of its line or circle is on it.
    fn holds(&self, point: Vector, touch: f64) -> bool {
        match *self {
            Stretch::Line { from, direction, length } => {
                let s = dot(less(point, from), direction);
                (-touch..=length + touch).contains(&s)
            }
            Stretch::Arc { centre, radius, from, sweep } => {
                let [y, z] = less(point, centre);
                let turned = sweep.signum() * (z.atan2(y) - from);
                let turned = turned.rem_euclid(std::f64::consts::TAU);
                let slack = touch / radius;
                turned <= sweep.abs() + slack || turned >= std::f64::consts::TAU - slack
            }
        }
    }
}

/// Finds a point that two pieces have in common, besides the one in which consecutive pieces follow on each other.
fn meeting(one: &Stretch, other: &Stretch, is_next: bool, touch: f64) -> Option<Vector> {
    if is_next {
        // Lines and circles that touch each other have no other point in common; only one circle goes round.
        return same_circle(one, other, touch).then(|| [other.end(), one.start()]).and_then(|[end, start]| {
            let round = one.holds(end, touch).then_some(end);
            round.or_else(|| other.holds(start, touch).then_some(start))
        });
    }
    let ends = [(one, other.start()), (one, other.end()), (other, one.start()), (other, one.end())];
    let at_end = ends.into_iter().find(|(stretch, point)| lies_on(stretch, *point, touch)).map(|(_, point)| point);
    at_end.or_else(|| {
        let mut points = crossings(one, other, touch).into_iter();
        points.find(|point| one.holds(*point, touch) && other.holds(*point, touch))
    })
}

fn lies_on(stretch: &Stretch, point: Vector, touch: f64) -> bool {
    let off = match *stretch {
        Stretch::Line { from, direction, .. } => cross(direction, less(point, from)).abs(),
        Stretch::Arc { centre, radius, .. } => (distance(point, centre) - radius).abs(),
    };
    off <= touch && stretch.holds(point, touch)
}

fn same_circle(one: &Stretch, other: &Stretch, touch: f64) -> bool {
    match (*one, *other) {
        (Stretch::Arc { centre, radius, .. }, Stretch::Arc { centre: second, radius: other, .. }) => {
            distance(centre, second) <= touch && (radius - other).abs() <= touch
        }
        _ => false,
    }
}

/// Points that the lines and circles of two pieces have in common, or nearly so; none where they are the same.
fn crossings(one: &Stretch, other: &Stretch, touch: f64) -> Vec<Vector> {
    match (*one, *other) {
        (Stretch::Line { from, direction, .. }, Stretch::Line { from: start, direction: along_other, .. }) => {
            let sine = cross(direction, along_other);
            match sine.abs() < 1e-12 {
                true => vec![],
                false => vec![along(from, direction, cross(less(start, from), along_other) / sine)],
            }
        }
        (Stretch::Line { from, direction, .. }, Stretch::Arc { centre, radius, .. })
        | (Stretch::Arc { centre, radius, .. }, Stretch::Line { from, direction, .. }) => {
            let foot = along(from, direction, dot(less(centre, from), direction));
            on_chord(foot, direction, radius, distance(centre, foot), touch)
        }
        (Stretch::Arc { centre, radius, .. }, Stretch::Arc { centre: second, radius: of_second, .. }) => {
            let apart = distance(centre, second);
            if apart <= touch {
                return vec![];
            }
            let [y, z] = less(second, centre).map(|x| x / apart);
            // The chord that both circles share crosses the line of centres here.
            let at = (apart * apart + radius * radius - of_second * of_second) / (2.0 * apart);
            on_chord(along(centre, [y, z], at), [-z, y], radius, at.abs(), touch)
        }
    }
}

/// The ends of a chord of a circle: its middle, direction and distance from the centre.
fn on_chord(middle: Vector, direction: Vector, radius: f64, off: f64, touch: f64) -> Vec<Vector> {
    if off > radius + touch {
        return vec![];
    }
    let half = (radius * radius - off * off).max(0.0).sqrt();
    vec![along(middle, direction, half), along(middle, direction, -half)]
}

fn on_circle([y, z]: Vector, radius: f64, angle: f64) -> Vector {
    [y + radius * angle.cos(), z + radius * angle.sin()]
}

fn along([y, z]: Vector, direction: Vector, length: f64) -> Vector {
    [y + length * direction[0], z + length * direction[1]]
}

fn less(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1]]
}

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: Vector, b: Vector) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn distance(a: Vector, b: Vector) -> f64 {
    let [y, z] = less(a, b);
    y.hypot(z)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(line_mm: f64) -> ProfilePiece {
        ProfilePiece::Line { line_mm }
    }

    fn arc(arc_deg: f64, radius_mm: f64) -> ProfilePiece {
        ProfilePiece::Arc { arc_deg, radius_mm }
    }

    /// The pieces that meet first, or none, whichever way the profile is turned.
    fn meet(pieces: &[ProfilePiece]) -> Option<[usize; 2]> {
        let turned = |direction_deg: f64| {
            let stretches = placed(pieces, [3.0, -2.0], direction_deg);
            let mut pairs = (0..pieces.len()).flat_map(|later| (0..later).map(move |earlier| [earlier, later]));
            pairs.find(|[a, b]| meeting(&stretches[*a], &stretches[*b], a + 1 == *b, 1e-5).is_some())
        };
        let found = turned(0.0);
        assert!([37.0, 90.0, -150.0].into_iter().all(|direction_deg| turned(direction_deg) == found), "{pieces:?}");
        found
    }

    #[test]
    fn pieces_that_meet_are_found() {
        assert_eq!(meet(&[line(10.0), arc(180.0, 2.0), line(10.0)]), None);
        assert_eq!(meet(&[arc(60.0, 5.0), arc(-120.0, 5.0), arc(60.0, 5.0)]), None);
        assert_eq!(meet(&[line(3.0), line(4.0), arc(300.0, 4.0)]), None);
        // A loop whose end crosses its beginning, twice round, a line into an arc, and one that only touches.
        assert_eq!(meet(&[line(10.0), arc(270.0, 2.0), line(5.0)]), Some([0, 2]));
        assert_eq!(meet(&[line(10.0), arc(270.0, 2.0), line(2.0)]), Some([0, 2]));
        assert_eq!(meet(&[line(10.0), arc(270.0, 2.0), line(1.9)]), None);
        assert_eq!(meet(&[arc(200.0, 3.0), arc(170.0, 3.0)]), Some([0, 1]));
        assert_eq!(meet(&[arc(130.0, 3.0), arc(130.0, 3.0), arc(130.0, 3.0)]), Some([0, 2]));
        assert_eq!(meet(&[arc(180.0, 3.0), arc(180.0, 2.0), line(9.0), arc(-300.0, 3.0), line(50.0)]), Some([0, 2]));
    }
}
