//! The errors of scenes that cannot be made discrete.

use crate::model::imperfection_error::ImperfectionError;
use crate::model::limits::{MOST_CONTROL_POINTS, SMOOTH};
use crate::spline::Elements;
use crate::units::significant;

/// Reasons why a scene cannot be made discrete.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelError {
    /// The surfaces cannot be imperfect as the scene asks for.
    #[error(transparent)]
    Imperfection(#[from] ImperfectionError),
    /// The supports at both ends of a direction take more rows of control points than the mesh has.
    #[error(
        "{elements} element(s) of degree {degree} along {along} have {rows} rows of control points, but the supports \
         at both ends take 2 each: write at least {least} elements along {along} of the model (mesh.elements)"
    )]
    TooFewRows {
        /// Direction, u or v.
        along: &'static str,
        /// Number of elements of the model in that direction.
        elements: usize,
        /// Degree in that direction.
        degree: usize,
        /// Number of rows of control points.
        rows: usize,
        /// Smallest number of elements that suffices.
        least: usize,
    },
    /// A symmetric support lies neither on an edge nor on a line.
    #[error(
        "support \"{support}\" is a plane of symmetry, which only an edge or a line can lie in: write one of them in `on`"
    )]
    NotAnEdge {
        /// Name of the support.
        support: String,
    },
    /// A force per length acts on a point.
    #[error(
        "action \"{action}\" is a force per length, and a point has no length: write an edge or a line in `on`, or use kind = \"force\""
    )]
    NotALine {
        /// Name of the action.
        action: String,
    },
    /// A force by the projected area acts on a surface that overhangs.
    #[error(
        "action \"{action}\" is a force by the projected area, and it meets one side of the surface at {one} and the other at {other}: \
         where one part lies above another only one of them carries it; use per = \"area\", or model the part that does"
    )]
    Overhang {
        /// Name of the action.
        action: String,
        /// Point where it meets one side most squarely.
        one: String,
        /// Point where it meets the other side.
        other: String,
    },
    /// An edge or line cannot lie in a plane of symmetry.
    #[error("support \"{support}\" is no plane of symmetry: {reason}")]
    NotASymmetryPlane {
        /// Name of the support.
        support: String,
        /// Reason, in words.
        reason: String,
    },
    /// A symmetric line lies inside a shell whose two sides differ.
    #[error(
        "the shell is not its own mirror image in the plane of support \"{support}\", a line inside: {what}; a symmetric line holds \
         only what both sides do by themselves, so make them alike, or model the half, whose edge lies there"
    )]
    NotItsOwnImage {
        /// Name of the support.
        support: String,
        /// What differs, in words.
        what: String,
    },
    /// The material is not its own mirror image.
    #[error(
        "support \"{support}\" is no plane of symmetry of this material: along and across its edge at {at}, {terms}; a mirror \
         image of this laminate is another laminate, so model the whole shell (all six of A16, A26, B16, B26, D16, D26 must \
         vanish; a share of {tolerance} is taken for rounding)"
    )]
    MaterialNotMirrored {
        /// Name of the support.
        support: String,
        /// Position at which it occurs, as text with its unit.
        at: String,
        /// Terms of the stiffness that do not vanish.
        terms: String,
        /// Share of the stiffness up to which they are taken for rounding.
        tolerance: f64,
    },
    /// A load on a plane of symmetry is not its own mirror image.
    #[error(
        "action \"{action}\" acts on the plane of symmetry of support \"{support}\" {how}: its mirror image acts in the \
         opposite direction; remove that part, or model the whole shell"
    )]
    LoadNotMirrored {
        /// Name of the action.
        action: String,
        /// Name of the support.
        support: String,
        /// How it acts, in words.
        how: String,
    },
    /// A rigid section meets a plane of symmetry that it may leave.
    #[error(
        "the rigid section \"{section}\" meets the plane of symmetry of support \"{support}\", and {} would take it out of that \
         plane: hold {} there (0.0), or model the whole shell",
        motions.join(", "),
        if motions.len() == 1 { "it" } else { "them" }
    )]
    SectionLeavesPlane {
        /// Name of the section's support.
        section: String,
        /// Name of the support.
        support: String,
        /// Motions of the section, as keys of a scene.
        motions: Vec<&'static str>,
    },
    /// Two supports hold a control point of a section that moves.
    #[error(
        "supports \"{support}\" and \"{other}\" meet, and \"{other}\" is a rigid section that moves: hold the one or the other \
         there, or give the section's motions so that it stays in place"
    )]
    SectionShared {
        /// Name of the support.
        support: String,
        /// Name of the section.
        other: String,
    },
    /// A plane of symmetry or a joint shares control points with a neighbouring section that moves.
    #[error(
        "{tie} and the rigid section \"{section}\", which moves, lie in one element: put more elements between them \
         (mesh.elements)"
    )]
    TiedToSection {
        /// Tie between the control points, in words.
        tie: String,
        /// Name of the section.
        section: String,
    },
    /// Two supports give different motions to the same control points.
    #[error("support \"{support}\" gives a displacement that {} does not allow: hold that component in one of them only", other.as_ref().map_or("another support".into(), |name| format!("\"{name}\"")))]
    Contradiction {
        /// Name of the support.
        support: String,
        /// Name of the other support, if it is known.
        other: Option<String>,
    },
    /// The surface has a kink at an interior line or a seam.
    #[error(
        "the surface has a kink of {}° at {at}, and one patch must be smooth (angles up to {}° are taken for rounding): give \
         the knots there a lower multiplicity, or put the control points before, on and behind the line on straight lines",
        significant(*angle_deg, 3),
        significant(SMOOTH.to_degrees(), 2)
    )]
    Kink {
        /// Position at which it occurs, as text with its unit.
        at: String,
        /// Angle between the lines of control points on both sides, degrees.
        angle_deg: f64,
    },
    /// The surface is smooth at an interior line or a seam, but the control points on both sides are in no single ratio.
    #[error(
        "the surface is smooth at {at}, on the knot {direction} = {knot}, but the {what} on its two sides are in another \
         ratio there than elsewhere along it (by more than {SMOOTH}), so that the shell cannot be kept smooth: lower the \
         multiplicity of that knot (remove it, or write it once less), or make the ratio the same all along"
    )]
    UnevenJoint {
        /// Direction, u or v.
        direction: &'static str,
        /// Value of the knot, in a range from 0 to 1.
        knot: String,
        /// Position at which it occurs, as text with its unit.
        at: String,
        /// What differs: weights or speeds.
        what: &'static str,
    },
    /// The surface has no normal at a point.
    #[error(
        "the surface has no normal at {at}: an edge collapses there, or control points coincide; move them apart, and at a \
         pole leave a small hole"
    )]
    Collapsed {
        /// Position at which it occurs, as text with its unit.
        at: String,
    },
    /// The normal turns over between two neighbouring points.
    #[error(
        "the surface folds over itself between {from} and {to}: its normal turns by {}°; control points are listed with v \
         running fastest, and lines of them must not turn back or cross",
        significant(*angle_deg, 3)
    )]
    FoldsOver {
        /// First point, as text with its unit.
        from: String,
        /// Second point, next to the first.
        to: String,
        /// Angle between the normals, degrees.
        angle_deg: f64,
    },
    /// The control points make a sound surface if they are taken in the other order.
    #[error(
        "{fault}. Taken in the other order these control points make a sound surface: they are listed with u running fastest, \
         and v has to; exchange the two loops that write them"
    )]
    ListedUFastest {
        /// Error of the surface in the order given.
        fault: Box<ModelError>,
    },
    /// Opposite edges coincide, and the scene does not say how they are joined.
    #[error(
        "the edges {edges} coincide (the largest distance is {gap_mm} mm, and up to {tolerance_mm} mm is taken for none): \
         write `seam = \"smooth\"` in [geometry] for a closed shell, or `seam = \"free\"` for one that is slit there"
    )]
    EdgesMeet {
        /// Names of the two edges.
        edges: &'static str,
        /// Largest distance between them, mm.
        gap_mm: String,
        /// Distance up to which they count as coinciding, mm.
        tolerance_mm: String,
    },
    /// Opposite edges coincide in opposite directions.
    #[error(
        "the edges {edges} coincide in opposite directions, as those of a Möbius strip: no smooth seam closes them; write \
         `seam = \"free\"` in [geometry] for a shell that is slit there"
    )]
    EdgesMeetReversed {
        /// Names of the two edges.
        edges: &'static str,
    },
    /// A seam is asked for, but no edges coincide.
    #[error(
        "`seam` is given in [geometry], and no opposite edges coincide: u-start and u-end are up to {} mm apart, v-start and \
         v-end up to {} mm (up to {tolerance_mm} mm is taken for none); leave it out, or close the control net",
        gaps_mm[0],
        gaps_mm[1]
    )]
    NoSeam {
        /// Largest distances between the edges across u and v, mm.
        gaps_mm: [String; 2],
        /// Distance up to which they count as coinciding, mm.
        tolerance_mm: String,
    },
    /// A rigid section cannot take a load.
    #[error(
        "section \"{section}\": {what} cannot act on it; choose another axis or reference point, or load the shell itself"
    )]
    SectionWithoutExtent {
        /// Name of the support.
        section: String,
        /// What cannot act, and why.
        what: &'static str,
    },
    /// A section moment is asked for across a line that ends in a rigid section.
    #[error("section \"{section}\" lies on both sides of the line of a section moment: read a reaction instead")]
    SectionAcross {
        /// Name of the support.
        section: String,
    },
    /// A joint is to be smooth where the surfaces meet at an angle.
    #[error("joint \"{joint}\" is smooth, and its surfaces meet at {angle_deg:.1}°: write `kind = \"kept-angle\"`")]
    NotSmooth {
        /// Name of the joint.
        joint: String,
        /// Angle between the tangent planes, degrees.
        angle_deg: f64,
    },
    /// The edges of a joint do not meet.
    #[error(
        "joint \"{joint}\": its edges are {} mm apart at {at}, and edges that are at most {} mm apart are joined; move one of the \
         shells, or name other edges",
        significant(*distance, 3),
        significant(*most, 3)
    )]
    EdgesApart {
        /// Name of the joint.
        joint: String,
        /// Largest distance, mm.
        distance: f64,
        /// Where.
        at: String,
        /// Distance at which edges still meet, mm.
        most: f64,
    },
    /// The faces of two shells that are to be glued lie together nowhere.
    #[error(
        "bond \"{bond}\": {}, and faces that are at most {} mm apart are glued; move one of the shells, or write a larger `gap_mm`",
        match gap {
            Some(gap) => format!("the faces of its shells are {} mm apart where they are nearest, at {at}", significant(*gap, 3)),
            None => "the faces of its shells do not face each other".to_owned(),
        },
        significant(*most, 3)
    )]
    NothingGlued {
        /// Name of the bond.
        bond: String,
        /// Smallest distance of faces that face each other, mm.
        gap: Option<f64>,
        /// Where.
        at: String,
        /// Distance at which faces are still glued, mm.
        most: f64,
    },
    /// Shells that are to be glued cross each other.
    #[error("bond \"{bond}\": its shells cross each other by {} mm at {at}; move them apart by the sum of half their thicknesses", significant(*by, 3))]
    ShellsCross {
        /// Name of the bond.
        bond: String,
        /// Depth, mm.
        by: f64,
        /// Where.
        at: String,
    },
    /// There are fewer elements than the surface has knot spans.
    #[error(
        "{asked} element(s) in {direction} are fewer than the {least} spans between the knots of the surface there: write at \
         least {least} for the model (mesh.elements)"
    )]
    TooFewElements {
        /// Direction, u or v.
        direction: &'static str,
        /// Number of elements asked for.
        asked: usize,
        /// Number of spans.
        least: usize,
    },
    /// The thickness reaches the smallest radius of curvature of the surface.
    #[error(
        "the thickness, {} mm, reaches the smallest radius of curvature of the surface, {} mm at {at}: a body so thick is no shell; \
         are lengths given in another unit than mm, or is thickness_mm meant smaller?",
        significant(*thickness_mm, 4),
        significant(*radius_mm, 4)
    )]
    ThickerThanRadius {
        /// Thickness of the shell, mm.
        thickness_mm: f64,
        /// Smallest radius of curvature, mm.
        radius_mm: f64,
        /// Position at which it occurs, as text with its unit.
        at: String,
    },
    /// The thickness reaches the shorter side of the surface.
    #[error(
        "the thickness, {} mm, reaches the shorter side of the surface, {} mm: a body so thick is no shell; are lengths given in \
         another unit than mm, or is thickness_mm meant smaller?",
        significant(*thickness_mm, 4),
        significant(*side_mm, 4)
    )]
    ThickerThanSide {
        /// Thickness of the shell, mm.
        thickness_mm: f64,
        /// Shorter side of the surface, mm.
        side_mm: f64,
    },
    /// A curved surface lies too far off the middle of the thickness.
    #[error(
        "the surface lies offset_mm = {offset_mm} off the middle of the thickness, and its smallest radius of curvature is {} mm at \
         {at}: what this theory leaves out makes results wrong by up to {} % (a tube under pressure); draw the middle surface with \
         its own radius, and write offset_mm = 0.0 (up to {} mm is taken here)",
        significant(*radius_mm, 4),
        significant(100.0 * error, 2),
        significant(*most_mm, 2)
    )]
    OffsetTooLarge {
        /// Offset of the surface, mm.
        offset_mm: f64,
        /// Smallest radius of curvature, mm.
        radius_mm: f64,
        /// Position at which it occurs, as text with its unit.
        at: String,
        /// Relative error of a tube under pressure.
        error: f64,
        /// Largest offset that is accepted, mm.
        most_mm: f64,
    },
    /// The mesh has a lower degree than the surface.
    #[error(
        "the surface has degree {geometry}, and the mesh degree {mesh} cannot hold it: raise mesh.degree to {geometry}"
    )]
    DegreeTooLow {
        /// Degree of the geometry.
        geometry: usize,
        /// Degree of the mesh.
        mesh: usize,
    },
    /// The supports leave a rigid motion free.
    #[error(
        "the supports do not hold the shell: {motion}; {}add a support, or hold more components",
        exchanged(instead)
    )]
    FreeMotion {
        /// Motion that is free, in words.
        motion: String,
        /// Supports, each with the place of exchanged u and v, as a scene has it, if all would be held with that.
        instead: Vec<(String, String)>,
    },
    /// A support holds rigid motions, but none is free.
    #[error(
        "support \"{support}\" holds rigid motions alone, and the other supports leave none free: remove it, or hold less in them"
    )]
    NoFreeMotion {
        /// Name of the support.
        support: String,
    },
    /// Moving sections carry too many of the points by which a support holds rigid motions.
    #[error(
        "support \"{support}\" holds rigid motions by points of the surface that no moving section carries, and {count} of them remain{}: \
         put more elements between the sections (mesh.elements)",
        if *count < 3 { "" } else { ", all on one line" }
    )]
    TooFewPoints {
        /// Name of the support.
        support: String,
        /// Number of points that remain.
        count: usize,
    },
    /// Loads do work on a motion that only a support of rigid motions holds.
    #[error(
        "the loads are not in balance, and support \"{support}\" holds rigid motions alone: {motion}, along which {share:.1e} of all \
         forces are out of balance at load factor {load_factor}; balance them (numbers of few digits leave that much), or hold the shell where its force goes"
    )]
    Unbalanced {
        /// Name of the support.
        support: String,
        /// Motion that they do work on, in words.
        motion: String,
        /// Work on that motion, relative to the sum of all forces at their arms.
        share: f64,
        /// Load factor at which they do so.
        load_factor: f64,
    },
    /// A support holds rigid motions alone, and terms of the caller's own hold some of them as well.
    #[error(
        "support \"{support}\" holds rigid motions alone, and springs or terms of the program's own hold the shell as well: {motion} only against \
         their forces, a share of which the support would carry; remove it, and hold what they leave free by another kind of support"
    )]
    HeldByTerms {
        /// Name of the support.
        support: String,
        /// Motion that both hold, in words.
        motion: String,
    },
    /// A probe asks for a support that is not in the scene.
    #[error("a probe asks for the reaction of support \"{support}\", and the scene has none of that name")]
    NoSuchSupport {
        /// Name of the support.
        support: String,
    },
    /// A section moment is asked for elsewhere than on a line.
    #[error("probe \"{probe}\" asks for a section moment, and a section is a line: write for example `on = \"u=0.5\"`")]
    NotASection {
        /// Name of the probe.
        probe: String,
    },
    /// A section moment is asked for, and a term cannot give the part of it on one side.
    #[error(
        "a section moment is found from all that acts on one side of the line, and the term \"{term}\" of the program's own does not \
         give the part of it that acts there: remove the probe, or implement `TermSource::below`"
    )]
    NoPart {
        /// Name of the term.
        term: String,
    },
    /// The supports hold every control point.
    #[error(
        "the supports hold every control point of {elements} elements: nothing is left to solve for; write more in mesh.elements, or hold less"
    )]
    NothingFree {
        /// Number of elements of the model in each direction.
        elements: Elements,
    },
    /// The mesh has more control points than the program takes on.
    #[error(
        "{elements} elements have {count} control points, and this program takes at most {MOST_CONTROL_POINTS}: write fewer in \
         mesh.elements, and let the mesh refine itself where it has to"
    )]
    TooManyControlPoints {
        /// Number of elements of the model in each direction.
        elements: Elements,
        /// Number of control points.
        count: usize,
    },
}

/// Places that would hold the shell, in words.
fn exchanged(instead: &[(String, String)]) -> String {
    let places: Vec<String> =
        instead.iter().map(|(support, on)| format!("with on = {on} in support \"{support}\"")).collect();
    match places.is_empty() {
        true => String::new(),
        false => format!("{} they would (are u and v exchanged there?), or ", places.join(", or ")),
    }
}
