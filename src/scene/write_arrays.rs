//! Arrays of tables of a scene as TOML.

use super::data::{
    Action, ActionKind, Edge, ForceVector, History, Hold, LoadedArea, Material, Motion, ParametricDirection, Place,
    Probe, ProbeKind, Scene, Support,
};
use super::keys::toml_float;

/// `[[ply]]`, `[[support]]`, `[[action]]` and `[[probe]]` tables of a scene, in this order.
pub(super) fn arrays(scene: &Scene) -> String {
    let mut text = String::new();
    if let Material::Laminate { plies, .. } = &scene.material {
        for ply in plies {
            let law = &ply.law;
            let numbers = [
                ("thickness_mm", ply.thickness_mm),
                ("angle_deg", ply.angle_deg),
                ("youngs_modulus_1_mpa", law.youngs_modulus_1_mpa),
                ("youngs_modulus_2_mpa", law.youngs_modulus_2_mpa),
                ("poissons_ratio_12", law.poissons_ratio_12),
                ("shear_modulus_12_mpa", law.shear_modulus_12_mpa),
            ];
            let expansions = [
                ("thermal_expansion_1_per_k", law.thermal_expansion_1_per_k),
                ("thermal_expansion_2_per_k", law.thermal_expansion_2_per_k),
            ];
            let given = expansions.into_iter().filter_map(|(name, value)| Some((name, value?)));
            let line = |(name, value)| format!("{name} = {}", toml_float(value));
            let density = ply.density_kg_m3.map(|value| ("density_kg_m3", value));
            let lines: Vec<String> = numbers.into_iter().chain(given).chain(density).map(line).collect();
            table(&mut text, "ply", &lines);
        }
    }
    scene.supports.iter().for_each(|support| table(&mut text, "support", &support_lines(support)));
    scene.actions.iter().for_each(|action| table(&mut text, "action", &action_lines(action)));
    scene.probes.iter().for_each(|probe| table(&mut text, "probe", &probe_lines(probe)));
    text
}

fn table(text: &mut String, name: &str, lines: &[String]) {
    text.push_str(&format!("\n[[{name}]]\n{}\n", lines.join("\n")));
}

fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

fn list(values: &[f64]) -> String {
    format!("[{}]", values.iter().map(|value| toml_float(*value)).collect::<Vec<_>>().join(", "))
}

fn edge(edge: Edge) -> &'static str {
    match edge {
        Edge::UStart => "\"u-start\"",
        Edge::UEnd => "\"u-end\"",
        Edge::VStart => "\"v-start\"",
        Edge::VEnd => "\"v-end\"",
    }
}

fn place(on: Place) -> String {
    match on {
        Place::Edge(which) => edge(which).into(),
        Place::Point(at) => list(&at),
        Place::Line(ParametricDirection::U, fraction) => format!("\"u={}\"", toml_float(fraction)),
        Place::Line(ParametricDirection::V, fraction) => format!("\"v={}\"", toml_float(fraction)),
        Place::Whole => "\"whole\"".into(),
    }
}

/// A force as one line, or as a size and `along`.
fn force(name: &str, force: ForceVector) -> Vec<String> {
    match force {
        ForceVector::Components(components) => vec![format!("{name} = {}", list(&components))],
        ForceVector::Along(size, direction) => {
            let word = serde_json::to_value(direction).unwrap_or_default();
            vec![format!("{name} = {}", toml_float(size)), format!("along = {word}")]
        }
    }
}

fn history(lines: &mut Vec<String>, history: &History) {
    if !history.is_proportional() {
        let rows: Vec<String> = history.0.iter().map(|row| list(row)).collect();
        lines.push(format!("history = [{}]", rows.join(", ")));
    }
}

fn support_lines(support: &Support) -> Vec<String> {
    let mut lines = vec![format!("name = {}", quoted(&support.name))];
    if support.on != Place::Whole {
        lines.push(format!("on = {}", place(support.on)));
    }
    match &support.hold {
        Hold::RigidMotions => lines.push("kind = \"rigid-motions\"".into()),
        Hold::Symmetric => lines.push("kind = \"symmetric\"".into()),
        Hold::Displacement { displacement_mm } => {
            lines.push("kind = \"displacement\"".into());
            for (name, value) in ["x_mm", "y_mm", "z_mm"].into_iter().zip(displacement_mm) {
                lines.extend(value.map(|value| format!("{name} = {}", toml_float(value))));
            }
        }
        Hold::Rigid { motions, reference_mm, normals_turn } => {
            lines.push("kind = \"rigid\"".into());
            let names = ["x_mm", "y_mm", "z_mm", "rotation_x_deg", "rotation_y_deg", "rotation_z_deg"];
            for (name, motion) in names.into_iter().zip(motions) {
                lines.push(match motion {
                    Motion::Free(_) => format!("{name} = \"free\""),
                    Motion::Given(value) => format!("{name} = {}", toml_float(*value)),
                });
            }
            lines.extend(reference_mm.map(|point| format!("reference_mm = {}", list(&point))));
            if !normals_turn {
                lines.push("normals = \"free\"".into());
            }
        }
    }
    history(&mut lines, &support.history);
    lines
}

fn action_lines(action: &Action) -> Vec<String> {
    let mut lines = vec![format!("name = {}", quoted(&action.name))];
    lines.extend(match &action.kind {
        ActionKind::Force { on, force_n } => {
            [vec!["kind = \"force\"".into(), format!("on = {}", list(on))], force("force_n", *force_n)].concat()
        }
        ActionKind::LineForce { on, force_n_per_mm } => {
            let place = format!("on = {}", place(*on));
            [vec!["kind = \"line-force\"".into(), place], force("force_n_per_mm", *force_n_per_mm)].concat()
        }
        ActionKind::AreaForce { force_n_per_mm2, per } => {
            let mut lines = vec!["kind = \"area-force\"".into()];
            lines.extend(force("force_n_per_mm2", *force_n_per_mm2));
            if *per == LoadedArea::Projected {
                lines.push("per = \"projected-area\"".into());
            }
            lines
        }
        ActionKind::Gravity { acceleration_m_s2 } => {
            vec!["kind = \"gravity\"".into(), format!("acceleration_m_s2 = {}", list(acceleration_m_s2))]
        }
        ActionKind::EdgeMoment { on, moment_n } => vec![
            "kind = \"edge-moment\"".into(),
            format!("on = {}", edge(*on)),
            format!("moment_n = {}", toml_float(*moment_n)),
        ],
        ActionKind::Pressure { pressure_mpa, follower } => vec![
            "kind = \"pressure\"".into(),
            format!("pressure_mpa = {}", toml_float(*pressure_mpa)),
            format!("follower = {follower}"),
        ],
        ActionKind::Temperature { change_k } => {
            vec!["kind = \"temperature\"".into(), format!("change_k = {}", toml_float(*change_k))]
        }
        ActionKind::NaturalCurvature { change_per_mm } => {
            vec!["kind = \"natural-curvature\"".into(), format!("change_per_mm = {}", list(change_per_mm))]
        }
    });
    history(&mut lines, &action.history);
    lines
}

fn probe_lines(probe: &Probe) -> Vec<String> {
    let name = format!("name = {}", quoted(&probe.name));
    // Components are words in kebab case, which is what serde makes of them.
    let word = |value: serde_json::Value| format!("component = {value}");
    match &probe.kind {
        ProbeKind::Displacement { on, component } => {
            let kind = "kind = \"displacement\"".into();
            let component = word(serde_json::to_value(component).unwrap_or_default());
            vec![name, kind, format!("on = {}", list(on)), component]
        }
        ProbeKind::Reaction { support, component } => vec![
            name,
            "kind = \"reaction\"".into(),
            format!("support = {}", quoted(support)),
            word(serde_json::to_value(component).unwrap_or_default()),
        ],
        ProbeKind::SectionMoment { on, component } => vec![
            name,
            "kind = \"section-moment\"".into(),
            format!("on = {}", place(*on)),
            word(serde_json::to_value(component).unwrap_or_default()),
        ],
        ProbeKind::Energy => vec![name, "kind = \"energy\"".into()],
        ProbeKind::BendingStrain => vec![name, "kind = \"bending-strain\"".into()],
    }
}
