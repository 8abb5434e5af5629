//! Studies as files: structures, the reference of each, families of uniform meshes, and settings of adaptive runs.

use std::path::Path;

use serde::Deserialize;

use crate::scene::{Scene, SceneError, Stage, Symmetry, parse, parse_with_settings};
use crate::study::archive::Purpose;

/// A study: what is run, and what is compared with what.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StudyFile {
    /// What it shows.
    pub title: String,
    /// Settings `section.key=value` laid over every scene.
    #[serde(default)]
    pub settings: Vec<String>,
    /// How the runs are made that others are compared with.
    pub reference: ReferenceMesh,
    /// The structures.
    pub structure: Vec<Structure>,
    /// Families of uniform meshes.
    #[serde(default)]
    pub uniform: Vec<Family>,
    /// Settings of adaptive runs.
    #[serde(default)]
    pub adaptive: Vec<Adaptive>,
}

/// Degree and part of the reference of every structure.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReferenceMesh {
    /// Polynomial degree each way.
    pub degree: [usize; 2],
    /// The part of the shell that is modelled.
    pub part: Symmetry,
}

/// A structure of a study.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Structure {
    /// Its name.
    pub name: String,
    /// Its scene, relative to the study's folder.
    pub scene: String,
    /// A published speed-up, to be shown beside those found.
    pub published: Option<f64>,
    /// Elements of the reference each way over the whole shell, and of the coarser one that tells its own error.
    pub reference: [[usize; 2]; 2],
    /// Numbers of elements along the length of its uniform meshes, from coarse to fine.
    pub along: Vec<usize>,
    /// Settings of its own, by the name of the adaptive run that they belong to.
    #[serde(default)]
    pub settings: std::collections::BTreeMap<String, Vec<String>>,
}

/// Uniform meshes that differ in their number of elements along the length.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Family {
    /// Polynomial degree each way.
    pub degree: [usize; 2],
    /// Elements across the arc.
    pub across: usize,
    /// The columns of speed-ups that it counts in.
    pub columns: Vec<String>,
}

/// Settings of adaptive runs.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Adaptive {
    /// The name that they go by.
    pub name: String,
    /// Tables of the structure's scene that are left out.
    #[serde(default)]
    pub without: Vec<String>,
    /// Settings `section.key=value`.
    #[serde(default)]
    pub settings: Vec<String>,
}

/// What a run of a study is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Others are compared with it.
    Reference,
    /// A coarser one, which tells the error of the first.
    Coarser,
    /// A uniform mesh of the family with this number.
    Uniform(usize),
    /// Adaptive, with the settings of this number.
    Adaptive(usize),
}

impl Role {
    /// What such a run is for.
    pub fn purpose(self) -> Purpose {
        match self {
            Role::Reference | Role::Coarser => Purpose::Results,
            Role::Uniform(_) | Role::Adaptive(_) => Purpose::Time,
        }
    }
}

/// A run of a study.
#[derive(Clone, Debug)]
pub struct Planned {
    /// What it is.
    pub role: Role,
    /// Its name in tables.
    pub label: String,
    /// Its scene.
    pub scene: Scene,
}

/// Why a study cannot be run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// The file is no study.
    #[error("{file} is no study: {}", why.to_string().trim_end())]
    Syntax {
        /// The study.
        file: String,
        /// Where and why.
        why: Box<toml::de::Error>,
    },
    /// A list has nothing in it, or a number means nothing.
    #[error("{file}: {problem}")]
    Wrong {
        /// The study.
        file: String,
        /// What is wrong, and what to write.
        problem: String,
    },
    /// A scene cannot be read.
    #[error("{structure}: cannot read its scene {scene}")]
    NoScene {
        /// The structure.
        structure: String,
        /// Path of the scene.
        scene: String,
        /// Why.
        source: std::io::Error,
    },
    /// A scene is wrong, with the settings of a run.
    #[error("{structure}: {run}")]
    Scene {
        /// The structure.
        structure: String,
        /// The run.
        run: String,
        /// What is wrong.
        source: Box<SceneError>,
    },
}

impl StudyFile {
    /// Reads a study; errors call it `file`.
    ///
    /// # Errors
    /// Where the text is none.
    pub fn parse(text: &str, file: &str) -> Result<Self, StudyError> {
        let parsed: Result<Self, _> = toml::from_str(text);
        let study = parsed.map_err(|why| StudyError::Syntax { file: file.to_owned(), why: Box::new(why) })?;
        match study.problem() {
            Some(problem) => Err(StudyError::Wrong { file: file.to_owned(), problem }),
            None => Ok(study),
        }
    }

    /// What the types do not say.
    fn problem(&self) -> Option<String> {
        if self.structure.is_empty() {
            return Some("there is no [[structure]] to run".to_owned());
        }
        let named = |name: &str| self.adaptive.iter().filter(|adaptive| adaptive.name == name).count();
        if let Some(twice) = self.adaptive.iter().find(|adaptive| named(&adaptive.name) > 1) {
            return Some(format!("two [[adaptive]] are called {}: give each a name of its own", twice.name));
        }
        for Structure { name, along, settings, reference: [finer, coarser], .. } in &self.structure {
            if finer[0] < coarser[0] || finer[1] < coarser[1] || finer == coarser {
                return Some(format!(
                    "{name}: of its references {finer:?} is not finer than {coarser:?}: the finer comes first"
                ));
            }
            if let Some(odd) = along.iter().find(|along| **along % 2 == 1) {
                return Some(format!("{name}: along has {odd}, and halves of a shell need an even number"));
            }
            if self.structure.iter().filter(|other| other.name == *name).count() > 1 {
                return Some(format!("two structures are called {name}: give each a name of its own"));
            }
            if !along.is_sorted_by(|a, b| a < b) {
                return Some(format!("{name}: along = {along:?} does not go from coarse to fine"));
            }
            let known: Vec<&str> = self.adaptive.iter().map(|adaptive| adaptive.name.as_str()).collect();
            if let Some(unknown) = settings.keys().find(|key| !known.contains(&key.as_str())) {
                let known = known.join(", ");
                return Some(format!("{name} has settings for {unknown}, which no [[adaptive]] is called: {known}"));
            }
        }
        None
    }

    /// All columns of speed-ups, in the order in which they are first named.
    pub fn columns(&self) -> Vec<&str> {
        let mut columns: Vec<&str> = Vec::new();
        for column in self.uniform.iter().flat_map(|family| &family.columns) {
            if !columns.contains(&column.as_str()) {
                columns.push(column);
            }
        }
        columns
    }

    /// The runs of a structure: the reference, the coarser one, uniform meshes from coarse to fine, adaptive runs. Scenes are
    /// looked for from `folder`, and read by `read`.
    ///
    /// # Errors
    /// Where a scene cannot be read, or is wrong with the settings of a run.
    pub fn runs(
        &self,
        structure: &Structure,
        folder: &Path,
        read: &dyn Fn(&Path) -> std::io::Result<String>,
    ) -> Result<Vec<Planned>, StudyError> {
        let path = folder.join(&structure.scene);
        let named = path.display().to_string();
        let text = read(&path).map_err(|source| StudyError::NoScene {
            structure: structure.name.clone(),
            scene: named.clone(),
            source,
        })?;
        let wrong = |run: &str| {
            let (structure, run) = (structure.name.clone(), run.to_owned());
            move |source| StudyError::Scene { structure, run, source: Box::new(source) }
        };
        let base = parse_with_settings(&text, &named, &self.settings).map_err(wrong("as it stands"))?;
        let mut runs = Vec::new();
        let mut uniform = |role, label: String, degree, elements, part| {
            let scene = uniform_scene(&base, degree, elements, part).map_err(wrong(&label))?;
            runs.push(Planned { role, label, scene });
            Ok(())
        };
        let ReferenceMesh { degree, part } = self.reference;
        let [reference, coarser] = structure.reference;
        uniform(Role::Reference, "reference".to_owned(), degree, reference, part)?;
        uniform(Role::Coarser, "coarser reference".to_owned(), degree, coarser, part)?;
        for (number, family) in self.uniform.iter().enumerate() {
            let Family { degree: [p, q], across, .. } = *family;
            for along in &structure.along {
                let label = format!("uniform, degree {p}, {q}");
                uniform(Role::Uniform(number), label, [p, q], [*along, across], base.symmetry)?;
            }
        }
        for (number, adaptive) in self.adaptive.iter().enumerate() {
            let own = structure.settings.get(&adaptive.name).into_iter().flatten();
            let settings: Vec<&String> = self.settings.iter().chain(&adaptive.settings).chain(own).collect();
            let text = without(&text, &adaptive.without);
            let scene = parse_with_settings(&text, &named, &settings).map_err(wrong(&adaptive.name))?;
            runs.push(Planned { role: Role::Adaptive(number), label: adaptive.name.clone(), scene });
        }
        Ok(runs)
    }
}

/// The scene on a uniform mesh that stays as it is.
fn uniform_scene(base: &Scene, degree: [usize; 2], elements: [usize; 2], part: Symmetry) -> Result<Scene, SceneError> {
    let mut scene = base.clone();
    (scene.mesh.degree, scene.mesh.elements, scene.symmetry) = (degree, elements, part);
    (scene.adapt, scene.pipeline) = (None, vec![Stage::Solve]);
    parse(&scene.to_toml(), "uniform.toml")
}

/// The text of a scene without some of its tables. A text that is no TOML stays as it is, for its error to be told of it.
fn without(text: &str, tables: &[String]) -> String {
    if tables.is_empty() {
        return text.to_owned();
    }
    match toml::from_str::<toml::Table>(text) {
        Ok(mut scene) => {
            tables.iter().for_each(|table| _ = scene.remove(table));
            toml::to_string(&scene).unwrap_or_else(|_| text.to_owned())
        }
        Err(_) => text.to_owned(),
    }
}
