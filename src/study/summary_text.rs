//! The summary as a block of text, for the end of a run and the head of an inspection.

use std::fmt::{self, Display, Formatter};

use super::Summary;
use super::TapeSpring;
use super::summary::{FoldMean, MeshChange, PeakFound, WarningCount};
use crate::record::{Parameter, Reading, released_in_words};
use crate::scene::Sense;
use crate::units::{count, duration, figure, reading, rounded, signed, significant};

/// Share of the moment before the jump below which the shell has folded: a fold carries a tenth of it or less in the seven cases
/// (theory: 26.6 of 292 N·mm in the baseline).
const FOLDED: f64 = 0.5;

impl Display for Summary {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        self.write_head(f)?;
        if self.last.is_some() {
            writeln!(f)?;
            self.write_findings(f)?;
        }
        if !self.warnings.is_empty() {
            writeln!(f)?;
            self.write_warnings(f)?;
        }
        if !self.meshes.is_empty() {
            writeln!(f)?;
            self.write_meshes(f)?;
            writeln!(f)?;
            self.write_work(f)?;
        }
        Ok(())
    }
}

impl Summary {
    fn write_head(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let part = match self.symmetric_parts {
            1 => "whole shell",
            2 => "half model",
            _ => "quarter model",
        };
        match &self.spring {
            Some(spring) => {
                let sense = match spring.sense {
                    Sense::Opposite => "opposite sense",
                    Sense::Equal => "equal sense",
                };
                writeln!(
                    f,
                    "tape spring, L {} R {} t {} mm, arc {}°, {sense}, {part}",
                    significant(spring.length_mm, 6),
                    significant(spring.radius_mm, 6),
                    significant(spring.thickness_mm, 6),
                    rounded(spring.arc_rad.to_degrees()),
                )?;
            }
            None => writeln!(f, "{}", self.shell)?,
        }
        let Some(last) = &self.last else {
            let turned_down = match self.rejections {
                0 => String::new(),
                n => format!(": {} rejected", count(n, "solve")),
            };
            return writeln!(f, "no equilibrium yet{turned_down}");
        };
        let reached = if last.parameter > self.target * (1.0 + 1e-9) {
            format!("{}, beyond the {} that the scene asks for", self.at(last.parameter), self.at(self.target))
        } else if last.parameter >= self.target * (1.0 - 1e-9) {
            format!("{}, as the scene asks", self.at(self.target))
        } else {
            format!("{} of {}", self.at(last.parameter), self.at(self.target))
        };
        let (stages, steps) = (count(self.stages(), "stage"), count(self.load_steps, "load step"));
        writeln!(f, "{stages} in {steps} to {reached}, {}", duration(self.wall_s()))?;
        if last.negative_pivots > 0 {
            let pivots = count(last.negative_pivots as usize, "negative pivot");
            writeln!(f, "the last equilibrium is not stable: its stiffness has {pivots}")?;
        }
        Ok(())
    }

    /// A value of the parameter with its unit.
    fn at(&self, parameter: f64) -> String {
        self.driven_by.shown_short(parameter)
    }

    /// Two values of the parameter, with as many digits as tell them apart.
    fn between(&self, from: f64, to: f64) -> String {
        if from == to {
            return format!("at {}, on refining", self.at(to));
        }
        let [short, other] = [from, to].map(|at| self.at(at));
        if short != other {
            return format!("from {short} to {other}");
        }
        let [from, to] = [from, to].map(|at| significant(at, 7));
        match self.driven_by {
            Parameter::Rotation => format!("from {from}° to {to}°"),
            Parameter::LoadFactor => format!("from load factor {from} to load factor {to}"),
        }
    }

    /// Probes at the last equilibrium, jumps, and the balance of work and energy.
    fn write_readings(&self, f: &mut Formatter<'_>) -> fmt::Result {
        for Reading { name, value, unit, at } in &self.probes {
            let place = at.map_or(String::new(), |[u, v]| format!("  at u {u:.3}, v {v:.3}"));
            writeln!(f, "  {name:<17}  {:>14} {unit}{place}", reading(*value, 6))?;
        }
        for snap in &self.snaps {
            writeln!(
                f,
                "  {:<17}  {}, {}{}",
                "snap",
                self.between(snap.before, snap.after),
                released_in_words(snap.energy_released_n_mm, self.loads_follow, 3),
                if self.loads_follow && snap.energy_released_n_mm.is_some() { " along the descent" } else { "" }
            )?;
        }
        self.write_passed(f)?;
        let Some(balance) = self.balance else { return Ok(()) };
        let (measure, larger) = (balance.largest_n_mm(), balance.work_n_mm.abs().max(balance.accounted_n_mm().abs()));
        let measured_by = match measure > 1.01 * larger {
            true => format!(" of the {} N·mm that took part", reading(measure, 6).trim()),
            false => String::new(),
        };
        let workers = match balance.put_in_n_mm {
            0.0 => "loads and given motions",
            _ => "loads, given motions and the natural state",
        };
        writeln!(
            f,
            "  {:<17}  {:>14} N·mm of {workers}, strain energy {}: {} %{measured_by}",
            "work",
            reading(balance.work_n_mm, 6),
            reading(balance.accounted_n_mm(), 6),
            signed(100.0 * balance.relative_error(), 2)
        )
    }

    fn write_findings(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Some(spring) = &self.spring else { return self.write_readings(f) };
        Line { name: "", measured: "this run".into(), law: Some(("theory", "".into())), off: None, note: "" }
            .write(f)?;
        if let Some(stiffness) = self.initial_stiffness_n_mm {
            let law = spring.initial_stiffness_n_mm();
            Line {
                name: "initial stiffness",
                measured: format!("{:>7}  N·mm/rad", figure(stiffness, 1)),
                law: Some(("beam, 2EI/L", format!("{:>7}", figure(law, 1)))),
                off: Some(stiffness / law),
                note: "",
            }
            .write(f)?;
        }
        self.write_peak(f, spring)?;
        self.write_passed(f)?;
        if self.snaps.is_empty() && self.passed.is_empty() {
            Line { name: "snap", measured: "   none".into(), law: None, off: None, note: "" }.write(f)?;
        }
        for snap in &self.snaps {
            let measured = if snap.after > snap.before {
                format!("{:>8}° to {}°", figure(snap.before, 3), figure(snap.after, 3))
            } else {
                format!("{:>8}° on refining", figure(snap.after, 3))
            };
            let drop = format!(
                "{} → {} N·mm, {}{}",
                figure(snap.moment_before_n_mm, 2),
                figure(snap.moment_after_n_mm, 2),
                released_in_words(snap.energy_released_n_mm, self.loads_follow, 2),
                if snap.after > snap.before {
                    format!("; located to {}°", figure(snap.after - snap.before, 3))
                } else {
                    String::new()
                }
            );
            Line { name: "snap", measured, law: None, off: None, note: &drop }.write(f)?;
        }
        self.fold.map_or(Ok(()), |fold| self.write_fold(f, spring, fold))?;
        self.write_balance(f)
    }

    /// Limit points, bifurcations, and branches that were left.
    fn write_passed(&self, f: &mut Formatter<'_>) -> fmt::Result {
        for (parameter, released) in &self.left {
            let at = self.at(*parameter);
            let released = released.map_or(String::new(), |energy| format!(", released {energy:.2e} N·mm"));
            writeln!(f, "  {:<17}  unstable branch left at {at}{released}", "switch-branch")?;
        }
        if let (count @ 1.., released) = self.ripples {
            let each = "each less than refining the mesh changes";
            writeln!(f, "  {:<17}  {count} of the mesh, {each}, released {released:.2e} N·mm in all", "ripples")?;
        }
        for point in &self.passed {
            let critical = point.critical;
            let value = match (self.driven_by, point.probe, self.probes.first()) {
                (Parameter::Rotation, ..) => {
                    format!("{:>8}°  {} N·mm", figure(point.parameter, 3), figure(point.moment_n_mm, 3))
                }
                (_, Some(value), Some(first)) => {
                    format!("{:14.6}  {} {} {}", point.parameter, first.name, reading(value, 6), first.unit)
                }
                _ => format!("{:14.6}", point.parameter),
            };
            let name = critical.name();
            let change = count(critical.pivots_changed.unsigned_abs() as usize, "pivot");
            let sign = if critical.pivots_changed < 0 { "positive" } else { "negative" };
            writeln!(f, "  {name:<17}  {value}  ({change} turned {sign})")?;
        }
        Ok(())
    }

    /// Up to the first jump, or the end: work of both ends against strain energy.
    fn write_balance(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Some(balance) = self.balance else { return Ok(()) };
        let stored = balance.accounted_n_mm();
        let refinement = match balance.taken_out_by_refinement_n_mm {
            0.0 => String::new(),
            taken => format!(" + {} that refining took out", figure(taken, 3)),
        };
        let ripples = match balance.released_in_ripples_n_mm {
            0.0 => String::new(),
            released => format!(" + {} in ripples", figure(released, 3)),
        };
        Line {
            name: "work of the ends",
            measured: format!("{:>8} N·mm to {}°", figure(balance.work_n_mm, 3), rounded(balance.parameter)),
            law: Some(("strain energy", format!("{}{refinement}{ripples}", figure(balance.strain_energy_n_mm, 3)))),
            off: Some(balance.work_n_mm / stored),
            note: "",
        }
        .write(f)
    }

    fn write_peak(&self, f: &mut Formatter<'_>, spring: &TapeSpring) -> fmt::Result {
        let measured = match self.peak {
            Some(peak) => {
                let how = match peak.found {
                    PeakFound::Parabola => "",
                    PeakFound::Jump => ", jump",
                    PeakFound::LoadStep => ", the largest of the steps",
                };
                format!("{:>7}  N·mm at {}°{how}", figure(peak.moment_n_mm, 1), figure(peak.parameter, 2))
            }
            None if self.snaps.is_empty() => "   none, still rising".into(),
            None => "   none before the jump".into(),
        };
        let law = spring.peak();
        if let Some(why) = self.no_uniform_bending(spring) {
            return Line { name: "peak", measured, law: None, off: None, note: why }.write(f);
        }
        let place = law.map(|law| format!("at {}°", figure(law.parameter, 2)));
        let doubt = (self.peak.is_some() && self.peak_in_doubt).then(|| "the mesh is too coarse for it".to_owned());
        let note: Vec<String> = place.into_iter().chain(doubt).collect();
        Line {
            name: "peak",
            measured,
            law: Some(("Wuest", law.map_or("   none".into(), |law| format!("{:>7}", figure(law.moment_n_mm, 1))))),
            off: self.peak.zip(law).map(|(peak, law)| peak.moment_n_mm / law.moment_n_mm),
            note: &note.join("; "),
        }
        .write(f)
    }

    /// Why Wuest's law, of a spring whose curvature is the same all along, is none to compare the peak with.
    fn no_uniform_bending(&self, spring: &TapeSpring) -> Option<&'static str> {
        let jumped_at = self.snaps.first().map(|snap| snap.before);
        let law = spring.peak()?;
        if is_held_by_its_ends(spring) {
            Some("no law: the ends hold the section in shape all along")
        } else if spring.sense == Sense::Equal
            && (!self.left.is_empty()
                || !self.passed.is_empty()
                || jumped_at.is_some_and(|jumped_at| jumped_at < law.parameter))
        {
            Some("no law: the spring twists before it")
        } else {
            None
        }
    }

    /// Whether the moment fell so far that the shell has a fold, of which there are laws.
    fn has_folded(&self, fold: FoldMean) -> bool {
        let before = self.snaps.iter().map(|snap| snap.moment_before_n_mm).fold(0.0, f64::max);
        let highest = before.max(self.peak.map_or(0.0, |peak| peak.moment_n_mm));
        highest == 0.0 || fold.moment_n_mm < FOLDED * highest
    }

    fn write_fold(&self, f: &mut Formatter<'_>, spring: &TapeSpring, fold: FoldMean) -> fmt::Result {
        let range = match fold.points {
            1 => format!("     at {:.1}°", fold.range_deg[0]),
            n => format!("     {n} steps, {:.1}° to {:.1}°", fold.range_deg[0], fold.range_deg[1]),
        };
        if !self.has_folded(fold) || is_held_by_its_ends(spring) {
            let measured = format!("{:>8} N·mm", figure(fold.moment_n_mm, 2));
            return Line { name: "behind the jump", measured, law: None, off: None, note: range.trim() }.write(f);
        }
        let closed_form = match spring.sense {
            Sense::Opposite => "(1+ν)Dα",
            Sense::Equal => "(1−ν)Dα",
        };
        let plateau = spring.plateau().map(|plateau| ("Wuest, equal energy", plateau.moment_n_mm));
        let laws = plateau.into_iter().chain([(closed_form, spring.fold_moment_n_mm())]);
        for (i, (name, value)) in laws.enumerate() {
            let measured = if i == 0 { format!("{:>8} N·mm", figure(fold.moment_n_mm, 2)) } else { range.clone() };
            Line {
                name: if i == 0 { "fold moment" } else { "" },
                measured,
                law: Some((name, format!("{:>8}", figure(value, 2)))),
                off: Some(fold.moment_n_mm / value),
                note: "",
            }
            .write(f)?;
        }
        Ok(())
    }

    /// Each kind of warning once.
    fn write_warnings(&self, f: &mut Formatter<'_>) -> fmt::Result {
        for WarningCount { first, steps } in &self.warnings {
            let more = match steps {
                1 => String::new(),
                n => format!(" (the first of {n} load steps)"),
            };
            writeln!(f, "  warning at {}{more}: {}", self.at(first.parameter()), first.in_words())?;
        }
        Ok(())
    }

    fn write_meshes(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let whole = if self.symmetric_parts > 1 { "   whole shell" } else { "" };
        writeln!(f, "  {:<11}   {:>18}{whole}   {:>8}", "mesh from", "elements", "unknowns")?;
        for MeshChange { parameter, elements, unknowns } in &self.meshes {
            let count = elements.count();
            let elements = format!("{elements} = {count}");
            let whole = match self.symmetric_parts {
                1 => String::new(),
                parts => format!("   {:>11}", count * parts),
            };
            let degree = if self.driven_by == Parameter::Rotation { "°" } else { " " };
            writeln!(f, "  {parameter:>10.3}{degree}   {elements:>18}{whole}   {unknowns:>8}")?;
        }
        Ok(())
    }

    fn write_work(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let total = self.wall_s();
        let row = |f: &mut Formatter<'_>, name: &str, numbers: [String; 3], wall_s: f64| {
            let share = if total > 0.0 { 100.0 * wall_s / total } else { 0.0 };
            let [runs, iterations, factorizations] = numbers;
            writeln!(
                f,
                "  {name:<21}  {runs:>5}  {iterations:>10}  {factorizations:>14}  {wall_s:>8.2}  {share:>4.0} %"
            )
        };
        let texts = |numbers: [usize; 3]| numbers.map(|number| number.to_string());
        writeln!(
            f,
            "  {:<21}  {:>5}  {:>10}  {:>14}  {:>8}  {:>6}",
            "work in", "runs", "iterations", "factorizations", "wall s", "share"
        )?;
        for work in &self.work {
            row(f, work.stage.name(), texts([work.runs, work.iterations, work.factorizations]), work.wall_s)?;
        }
        if self.kept_s > 0.0 {
            row(f, "writing the log", [const { String::new() }; 3], self.kept_s)?;
        }
        let sum = |number: fn(&super::summary::StageWork) -> usize| self.work.iter().map(number).sum();
        row(f, "all", texts([self.stages(), sum(|work| work.iterations), sum(|work| work.factorizations)]), total)?;
        if self.rejections > 0 {
            writeln!(f, "  {} rejected on the way", count(self.rejections, "solve"))?;
        }
        Ok(())
    }
}

/// Whether the ends hold the section in shape all along: over R sqrt(R/t), the length in which a section opens out.
fn is_held_by_its_ends(spring: &TapeSpring) -> bool {
    spring.length_mm < spring.radius_mm * (spring.radius_mm / spring.thickness_mm).sqrt()
}

/// One result, with the law that it is compared with.
struct Line<'a> {
    name: &'a str,
    measured: String,
    law: Option<(&'a str, String)>,
    /// Measured over law.
    off: Option<f64>,
    note: &'a str,
}

impl Line<'_> {
    fn write(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let mut text = format!("  {:<17}  {:<29}  ", self.name, self.measured);
        if let Some((name, value)) = &self.law {
            let off = self.off.map_or(String::new(), |off| format!("{} %", signed(100.0 * (off - 1.0), 1)));
            text.push_str(&format!("{name:<19}  {value:<8}  {off:>9}  "));
        }
        text.push_str(self.note);
        writeln!(f, "{}", text.trim_end())
    }
}
