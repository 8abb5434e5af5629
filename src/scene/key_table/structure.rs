//! Keys of `[[support]]`, `[[action]]` and `[[probe]]`.

use crate::scene::keys::Presence::{Default, Follows, InsteadOf, Unless};
use crate::scene::keys::Reach::{Free, LaterLoads, Names};
use crate::scene::keys::{Choice, Form, Key, Kind, Length, Limits, choice};

const fn support(name: &'static str, kind: Kind, example: &'static str) -> Key {
    Key::new("support", name, kind, example)
}

const fn action(name: &'static str, kind: Kind, example: &'static str) -> Key {
    Key::new("action", name, kind, example)
}

/// No state depends on what is measured.
const fn probe(name: &'static str, kind: Kind, example: &'static str) -> Key {
    Key::new("probe", name, kind, example).reaches(Free)
}

pub(super) static SUPPORT: &[Key] = &[
    support("name", Kind::Text, "\"root\"")
        .means("What reports call it; no two supports have the same.")
        .or(Follows("\"support 1\", \"support 2\" and so on"))
        .reaches(Names)
        .also_called(LABELS),
    support("kind", Kind::Word(&[
        choice("hinged", "displacement zero in x, y and z; rotation free"),
        choice("fixed", "displacement zero in the components of hold; rotation free"),
        choice("displacement", "displacement given in some components, free in those left out; rotation free"),
        choice(
            "symmetric",
            "an edge in a plane of symmetry: no displacement across the plane, no turn about the edge; or the line in the middle \
             (0.5) of a whole shell that is its own mirror image in the plane, with its supports and actions: alike on the \
             line; coordinates may be off by 1e-4 of its size, angles by 0.057 degrees. Material and loads must be their own \
             mirror images: a laminate with A16, A26, B16, B26, D16 or D26 is not",
        ),
        choice("clamped", "an edge: position and direction of the normal held; strain in the surface stays free"),
        choice("rigid", "an edge that moves as a rigid section, clamped to the shell"),
        choice(
            "rigid-motions",
            "the rigid motions that all other supports leave free, and nothing else: on the mean of points at thirds of u and v \
             the shell neither moves nor turns. It carries nothing while the loads are in balance, which is checked on the \
             undeformed shell; a probe \"reaction\" shows what loads leave that follow the shell",
        ),
    ]), "\"clamped\"")
        .means("How it holds.")
        .also_called(TYPES),
    support("on", Kind::Region(&[Form::Edge, Form::Point, Form::Line]), "[1.0, 0.5]")
        .of(&["hinged", "fixed", "displacement"])
        .means("Where it holds.")
        .also_called(PLACES),
    support("on", Kind::Region(&[Form::Edge, Form::Line]), "\"v-start\"")
        .of(&["symmetric"])
        .means("Edge or line in the plane of symmetry.")
        .also_called(PLACES),
    support("on", Kind::Region(&[Form::Edge]), "\"u-start\"")
        .of(&["clamped", "rigid"])
        .means("Edge that it holds.")
        .or(Unless("edges"))
        .also_called(PLACES),
    support("edges", Kind::Edges(Length::Any), "[\"web.u-end\", \"flange.u-end\"]")
        .of(&["clamped", "rigid"])
        .means("Edges of several shells that are held as one section.")
        .or(InsteadOf("on")),
    support("shell", Kind::Text, "\"web\"").means("Shell that the place belongs to.").or(Follows(ONE_SHELL)),
    support("hold", Kind::Words(AXES), "[\"x\", \"z\"]")
        .of(&["fixed"])
        .means("Components of the displacement that are zero.")
        .or(Default("[\"x\", \"y\", \"z\"]"))
        .also_called(&["held", "components", "dofs"]),
    support("x_mm", Kind::Number(Limits::ANY), "1.5")
        .of(&["displacement"])
        .means("Displacement along x at factor 1.")
        .or(Follows(FREE))
        .also_called(&["x", "ux"]),
    support("y_mm", Kind::Number(Limits::ANY), "0.0")
        .of(&["displacement"])
        .means("The same along y.")
        .or(Follows(FREE))
        .also_called(&["y", "uy"]),
    support("z_mm", Kind::Number(Limits::ANY), "0.0")
        .of(&["displacement"])
        .means("The same along z.")
        .or(Follows(FREE))
        .also_called(&["z", "uz"]),
    motion("x_mm", "0.0").means("Displacement of the reference point along x at factor 1.").also_called(&["x", "ux"]),
    motion("y_mm", "0.0").means("The same along y.").also_called(&["y", "uy"]),
    motion("z_mm", "\"free\"").means("The same along z.").also_called(&["z", "uz"]),
    motion("rotation_x_deg", "0.0")
        .means("Rotation of the section about x at factor 1; the three together are a rotation vector.")
        .also_called(&["rx", "theta_x"]),
    motion("rotation_y_deg", "30.0").means("The same about y.").also_called(&["ry", "theta_y"]),
    motion("rotation_z_deg", "0.0").means("The same about z.").also_called(&["rz", "theta_z"]),
    support("reference_mm", Kind::Numbers(Length::Exactly(3), Limits::ANY), "[0.0, 0.0, 0.0]")
        .of(&["rigid"])
        .means("The point that x_mm, y_mm and z_mm move and about which the section turns.")
        .or(Follows("the centroid of the edge, or of all edges"))
        .also_called(&["reference_point", "centre", "center"]),
    support("normals", Kind::Word(&[
        choice("turn", "clamped: the shell's normal turns with the section"),
        choice("free", "hinged"),
    ]), "\"turn\"")
        .of(&["rigid"])
        .means("How the shell is joined to the section.")
        .or(Default("\"turn\"")),
    support("history", Kind::Rows(2), "[[0.0, 0.0], [1.0, 1.0], [2.0, 0.5]]")
        .of(&["displacement", "rigid"])
        .means(HISTORY)
        .or(Follows("the factor is the load factor"))
        .reaches(LaterLoads)
        .also_called(HISTORIES),
];

pub(super) static ACTION: &[Key] = &[
    action("name", Kind::Text, "\"tip force\"")
        .means("What errors call it.")
        .or(Follows("\"action 1\", \"action 2\" and so on"))
        .reaches(Names)
        .also_called(LABELS),
    action("kind", Kind::Word(&[
        choice("force", "a force on a point that keeps its direction"),
        choice("line-force", "a force per undeformed length of an edge or a line that keeps its direction"),
        choice("area-force", "a force per area of the whole surface that keeps its direction"),
        choice("gravity", "own weight: density times thickness times acceleration; needs density_kg_m3, or a [[mass]]"),
        choice(
            "edge-moment",
            "a moment per undeformed length of an edge, about the deformed edge's tangent in the direction of growing v (u-edges) \
             or u (v-edges); it turns with the shell",
        ),
        choice("section-force", "a force on a rigid section, at its reference point, that keeps its direction"),
        choice(
            "section-moment",
            "a moment on a rigid section: forces along one axis, in arms along another. Dead, they have the potential -M f.(R a), \
             with f the axis of the forces, a that of the arms (f x about) and R the rotation of the section; a section without \
             extent along the arms takes none",
        ),
        choice("pressure", "on the whole surface, positive along n: on a cylinder or a sphere it acts from within"),
        choice(
            "temperature",
            "a change of temperature of the whole shell, which expands as its material states; layers that differ curve it. \
             Sections keep their angles: expansion through the thickness is taken to be that along the surface",
        ),
        choice(
            "natural-curvature",
            "the curvature that the shell has where it is free of stress changes: a tape that was rolled up, a bistable shell. \
             With no other action it comes to rest there without stress",
        ),
    ]), "\"line-force\"")
        .means("What acts. Forces act on the model as it is: on half a shell put half the force that acts on its cut.")
        .also_called(TYPES),
    action("on", Kind::Region(&[Form::Point]), "[1.0, 0.5]")
        .of(&["force"])
        .means("Point that it acts on.")
        .also_called(PLACES),
    action("on", Kind::Region(&[Form::Edge, Form::Line]), "\"u-end\"")
        .of(&["line-force"])
        .means("Edge or line that it acts on.")
        .also_called(PLACES),
    action("on", Kind::Region(&[Form::Edge]), "\"u-end\"")
        .of(&["edge-moment"])
        .means("Edge that it acts on.")
        .also_called(PLACES),
    action("shell", Kind::Text, "\"web\"")
        .means("Shell that it acts on.")
        .or(Follows("the only shell; weight, temperature and natural curvature act on all shells")),
    action("section", Kind::Text, "\"tip\"")
        .of(&["section-force", "section-moment"])
        .means("Name of the support of kind \"rigid\" or \"clamped\" that it acts on."),
    action("force_n", Kind::Vector, "[0.0, 0.0, 4.0]").of(&["force"]).means(FORCE).also_called(FORCES),
    action("force_n", Kind::Numbers(Length::Exactly(3), Limits::ANY), "[0.0, 0.0, 4.0]")
        .of(&["section-force"])
        .means("Force in x, y and z.")
        .also_called(FORCES),
    action("moment_n_mm", Kind::Number(Limits::ANY), "100.0")
        .of(&["section-moment"])
        .means("The moment, N mm.")
        .also_called(&["moment", "m"]),
    action("about", Kind::Word(AXES), "\"y\"")
        .of(&["section-moment"])
        .means("Axis that it acts about.")
        .also_called(&["axis"]),
    action("forces_along", Kind::Word(AXES), "\"x\"")
        .of(&["section-moment"])
        .means("Axis of its forces, another one: of a boom along x that is bent, x."),
    action("turns", Kind::Word(&[
        choice("dead", "its forces keep their direction"),
        choice("follows", "its forces turn with the section, and have no potential"),
    ]), "\"dead\"")
        .of(&["section-moment"])
        .means("What its forces do as the section turns.")
        .or(Default("\"dead\"")),
    action("force_n_per_mm", Kind::Vector, "[0.0, 0.0, 1.0]").of(&["line-force"]).means(FORCE).also_called(FORCES),
    action("force_n_per_mm2", Kind::Vector, "[0.0, 0.0, -0.001]").of(&["area-force"]).means(FORCE).also_called(FORCES),
    action("along", Kind::Word(&[NORMAL, RADIAL]), "\"normal\"")
        .of(&["force", "area-force"])
        .means("The direction of a force that is one number.")
        .or(Follows(COMPONENTS))
        .also_called(DIRECTIONS),
    action("along", Kind::Word(&[
        NORMAL,
        RADIAL,
        choice("outward", "in the surface, square to an edge, out of the shell; on edges alone"),
    ]), "\"outward\"")
        .of(&["line-force"])
        .means("The direction of a force that is one number, each point its own.")
        .or(Follows(COMPONENTS))
        .also_called(DIRECTIONS),
    action("per", Kind::Word(&[
        choice("area", "of the undeformed surface"),
        choice("projected-area", "of its projection on a plane square to the force, as snow lies on the ground plan"),
    ]), "\"area\"")
        .of(&["area-force"])
        .means("The area that is meant.")
        .or(Default("\"area\"")),
    action("acceleration_m_s2", Kind::Numbers(Length::Exactly(3), Limits::ANY), "[0.0, 0.0, -9.81]")
        .of(&["gravity"])
        .means("Acceleration in x, y and z.")
        .or(Default("[0.0, 0.0, -9.81]"))
        .also_called(&["g", "gravity"]),
    action("moment_n", Kind::Number(Limits::ANY), "-50.0")
        .of(&["edge-moment"])
        .means("N mm per mm; on a plate, a negative one on u-end bends that end towards +z.")
        .also_called(&["moment", "m"]),
    action("pressure_mpa", Kind::Number(Limits::ANY), "0.001")
        .of(&["pressure"])
        .means("Pressure.")
        .also_called(&["p"]),
    action("follower", Kind::Switch, "true")
        .of(&["pressure"])
        .means(
            "Whether it acts along the deformed normal, on the deformed area; otherwise it is dead, along the normal of the \
             undeformed surface, on its area.",
        )
        .or(Default("true"))
        .also_called(&["follows", "following"]),
    action("change_k", Kind::Number(Limits::ANY), "-150.0")
        .of(&["temperature"])
        .means("Change of the temperature.")
        .also_called(&["delta_t", "temperature", "dt"]),
    action("change_per_mm", Kind::Numbers(Length::Exactly(3), Limits::ANY), "[0.02, 0.0, 0.0]")
        .of(&["natural-curvature"])
        .means(
            "Change of the curvature in the directions e1 (that of u) and e2 = n x e1, and of their twist; positive bends away \
             from n: a cylinder-panel has [0.0, 1/radius, 0.0], so that [0.0, -1/radius, 0.0] makes it naturally flat.",
        )
        .also_called(&["curvature", "kappa", "κ"]),
    action("history", Kind::Rows(2), "[[0.0, 0.0], [1.0, 1.0]]")
        .means(HISTORY)
        .or(Follows("the factor is the load factor"))
        .reaches(LaterLoads)
        .also_called(HISTORIES),
];

pub(super) static PROBE: &[Key] = &[
    probe("name", Kind::Text, "\"tip\"")
        .means("What reports call it; no two probes have the same.")
        .also_called(LABELS),
    probe("kind", Kind::Word(&[
        choice("displacement", "of a point, mm"),
        choice(
            "reaction",
            "what a support or a spring exerts on the shell: N, or N mm about the section's reference point (of others: the centroid of the \
             place); the derivative of strain energy less work of the loads with respect to the support's motion. Where \
             supports meet, a \"symmetric\" one takes force across its plane and moment, the other all force along it; of two \
             others the first in the scene counts. On half a shell: half of what a support that crosses the cut exerts on the \
             whole",
        ),
        choice(
            "section-moment",
            "N mm that the side of larger u or v exerts on the other, about the line's middle. Loads are cut by the line, reactions \
             are not: within an element or two of a support, or across one, it may be off by 10 % and more; cut farther away or \
             read the reaction",
        ),
        choice("energy", "strain energy, N mm"),
        choice(
            "bending-strain",
            "largest bending strain along u or v at the points of integration, 1/mm, and where: they lie inside the elements, \
             and read a little less than an edge has",
        ),
    ]), "\"displacement\"")
        .means("What it measures.")
        .also_called(TYPES),
    probe("shell", Kind::Text, "\"web\"")
        .of(&["displacement", "section-moment", "bending-strain"])
        .means("Shell that it looks at.")
        .or(Follows(ONE_SHELL)),
    probe("on", Kind::Region(&[Form::Point]), "[1.0, 0.5]")
        .of(&["displacement"])
        .means("Point whose displacement it is.")
        .also_called(PLACES),
    probe("on", Kind::Region(&[Form::Line]), "\"u=0.5\"")
        .of(&["section-moment"])
        .means("Line across which it acts.")
        .also_called(PLACES),
    probe("support", Kind::Text, "\"root\"").of(&["reaction"]).means("Name of the support or of the spring."),
    probe("component", Kind::Word(&[
        choice("x", ""),
        choice("y", ""),
        choice("z", ""),
        NORMAL,
        RADIAL,
        choice("magnitude", "its length"),
    ]), "\"z\"")
        .of(&["displacement"])
        .means("Component of the displacement.")
        .also_called(DIRECTIONS),
    probe("component", Kind::Word(&[
        choice("force-x", ""),
        choice("force-y", ""),
        choice("force-z", ""),
        choice("moment-x", ""),
        choice("moment-y", ""),
        choice("moment-z", ""),
    ]), "\"force-z\"")
        .of(&["reaction"])
        .means("Component of the force or of the moment.")
        .also_called(DIRECTIONS),
    probe("component", Kind::Word(AXES), "\"y\"")
        .of(&["section-moment"])
        .means("Axis of the moment.")
        .also_called(DIRECTIONS),
];

/// A motion of a rigid section.
const fn motion(name: &'static str, example: &'static str) -> Key {
    support(name, Kind::NumberOr("free"), example).of(&["rigid"]).or(Default("0.0"))
}

const AXES: &[Choice] = &[choice("x", ""), choice("y", ""), choice("z", "")];
const NORMAL: Choice = choice(
    "normal",
    "along n: +z on a plate or an annulus, away from the axis of a cylinder or the centre of a sphere",
);
const RADIAL: Choice = choice(
    "radial",
    "away from the axis of a cylinder panel (x) or an annulus (z), or from the centre of a sphere zone; plate, profile and nurbs have \
     none",
);
const FREE: &str = "this component is free";
const ONE_SHELL: &str = "the only shell";
const COMPONENTS: &str = "the force has components";
const FORCE: &str = "Force in x, y and z; or one number and `along`, a direction that the undeformed surface has.";
const HISTORY: &str = "Rows of [load factor, factor], straight in between, constant beyond the last. By arc length a history that \
                       ends, or is constant, ends the path there; below its first point it is constant too.";

pub(super) const LABELS: &[&str] = &["id", "label", "title"];
const TYPES: &[&str] = &["type"];
const PLACES: &[&str] = &["at", "where", "place", "location", "edge", "point", "line"];
const FORCES: &[&str] = &["f", "load"];
const DIRECTIONS: &[&str] = &["direction", "axis"];
const HISTORIES: &[&str] = &["curve", "time_curve", "schedule"];
