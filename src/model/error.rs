//! Why a scene cannot be made discrete.

use crate::model::limits::{MOST_CONTROL_POINTS, SMOOTH};
use crate::units::significant;

/// A scene that cannot be made discrete.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ModelError {
    /// Two rows of control points at each end are taken by its support.
    #[error(
        "{elements} element(s) of degree {degree} along {along} have {rows} rows of control points, but the supports \
         at both ends take 2 each: write at least {least} elements along {along} of the model (mesh.elements)"
    )]
    TooFewRows {
        /// The direction.
        along: &'static str,
        /// Elements along it of the model.
        elements: usize,
        /// Degree along it.
        degree: usize,
        /// Rows of control points.
        rows: usize,
        /// Elements that suffice.
        least: usize,
    },
    /// A symmetric support that is neither on an edge nor on a line.
    #[error(
        "support \"{support}\" is a plane of symmetry, which only an edge or a line can lie in: write one of them in `on`"
    )]
    NotAnEdge {
        /// Name of the support.
        support: String,
    },
    /// A force per length that is on a point.
    #[error(
        "action \"{action}\" is a force per length, and a point has no length: write an edge or a line in `on`, or use kind = \"force\""
    )]
    NotALine {
        /// Name of the action.
        action: String,
    },
    /// A force by the projected area on a surface that overhangs.
    #[error(
        "action \"{action}\" is a force by the projected area, and it meets one side of the surface at {one} and the other at {other}: \
         where one part lies above another only one of them catches it; use per = \"area\", or model the part that does"
    )]
    Overhang {
        /// Name of the action.
        action: String,
        /// Where it meets one side most squarely.
        one: String,
        /// Where it meets the other.
        other: String,
    },
    /// An edge that cannot lie in a plane of symmetry.
    #[error("support \"{support}\" is no plane of symmetry: {reason}")]
    NotASymmetryPlane {
        /// Name of the support.
        support: String,
        /// Why.
        reason: String,
    },
    /// A symmetric line inside a shell whose two sides differ.
    #[error(
        "the shell is not its own mirror image in the plane of support \"{support}\", a line inside: {what}; a symmetric line holds \
         only what both sides do by themselves, so make them alike, or model the half, whose edge lies there"
    )]
    NotItsOwnImage {
        /// Name of the support.
        support: String,
        /// What differs.
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
        /// Where.
        at: String,
        /// The terms that do not vanish.
        terms: String,
        /// Share of the stiffness that is taken for rounding.
        tolerance: f64,
    },
    /// A load on a plane of symmetry that is not its own mirror image.
    #[error(
        "action \"{action}\" acts on the plane of symmetry of support \"{support}\" {how}: its mirror image acts the other \
         way; take that part away, or model the whole shell"
    )]
    LoadNotMirrored {
        /// Name of the action.
        action: String,
        /// Name of the support.
        support: String,
        /// What is wrong with it.
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
        /// Motions of the section, as they stand in a scene.
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
    /// A plane of symmetry or a joint shares control points with a section that moves, from beside it.
    #[error(
        "{tie} and the rigid section \"{section}\", which moves, lie in one element: put more elements between them \
         (mesh.elements)"
    )]
    TiedToSection {
        /// What ties the control points.
        tie: String,
        /// Name of the section.
        section: String,
    },
    /// Two supports give different motions to the same control points.
    #[error("support \"{support}\" gives a displacement that {} does not allow: hold that component in one of them only", other.as_ref().map_or("another support".into(), |name| format!("\"{name}\"")))]
    Contradiction {
        /// Name of the support.
        support: String,
        /// Name of the other, if it is known.
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
        /// Where.
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
        /// u or v.
        direction: &'static str,
        /// The knot, of a range from 0 to 1.
        knot: String,
        /// Where.
        at: String,
        /// Weights or speeds.
        what: &'static str,
    },
    /// The surface has no normal at a point.
    #[error(
        "the surface has no normal at {at}: an edge collapses there, or control points coincide; move them apart, and at a \
         pole leave a small hole"
    )]
    Collapsed {
        /// Where.
        at: String,
    },
    /// The normal turns over between two points that lie next to each other.
    #[error(
        "the surface folds over itself between {from} and {to}: its normal turns by {}°; control points are listed with v \
         running fastest, and lines of them must not turn back or cross",
        significant(*angle_deg, 3)
    )]
    FoldsOver {
        /// Where.
        from: String,
        /// The point beside it.
        to: String,
        /// Angle between the normals, degrees.
        angle_deg: f64,
    },
    /// The control points make a sound surface where they are taken in the other order.
    #[error(
        "{fault}. Taken in the other order these control points make a sound surface: they are listed with u running fastest, \
         and v has to; exchange the two loops that write them"
    )]
    ListedUFastest {
        /// What is wrong with the surface as it stands.
        fault: Box<ModelError>,
    },
    /// Opposite edges coincide, and the scene does not say what happens there.
    #[error(
        "the edges {edges} coincide (the largest distance is {gap_mm} mm, and up to {tolerance_mm} mm is taken for none): \
         write `seam = \"smooth\"` in [geometry] for a closed shell, or `seam = \"free\"` for one that is slit there"
    )]
    EdgesMeet {
        /// The two.
        edges: &'static str,
        /// Largest distance, mm.
        gap_mm: String,
        /// Tolerance, mm.
        tolerance_mm: String,
    },
    /// Opposite edges coincide in opposite directions.
    #[error(
        "the edges {edges} coincide in opposite directions, as those of a Möbius strip: no smooth seam closes them; write \
         `seam = \"free\"` in [geometry] for a shell that is slit there"
    )]
    EdgesMeetReversed {
        /// The two.
        edges: &'static str,
    },
    /// A seam is asked for, and no edges coincide.
    #[error(
        "`seam` is given in [geometry], and no opposite edges coincide: u-start and u-end are up to {} mm apart, v-start and \
         v-end up to {} mm (up to {tolerance_mm} mm is taken for none); leave it out, or close the control net",
        gaps_mm[0],
        gaps_mm[1]
    )]
    NoSeam {
        /// Largest distances in u and in v, mm.
        gaps_mm: [String; 2],
        /// Tolerance, mm.
        tolerance_mm: String,
    },
    /// Fewer elements than the surface has spans.
    #[error(
        "{asked} element(s) in {direction} are fewer than the {least} spans between the knots of the surface there: write at \
         least {least} for the model (mesh.elements)"
    )]
    TooFewElements {
        /// u or v.
        direction: &'static str,
        /// Elements asked for.
        asked: usize,
        /// Spans.
        least: usize,
    },
    /// A body that its own curvature leaves no inside.
    #[error(
        "the thickness, {} mm, reaches the smallest radius of curvature of the surface, {} mm at {at}: a body so thick is no shell; \
         are lengths given in another unit than mm, or is thickness_mm meant smaller?",
        significant(*thickness_mm, 4),
        significant(*radius_mm, 4)
    )]
    ThickerThanRadius {
        /// Thickness, mm.
        thickness_mm: f64,
        /// Smallest radius of curvature, mm.
        radius_mm: f64,
        /// Where.
        at: String,
    },
    /// A body as thick as it is wide.
    #[error(
        "the thickness, {} mm, reaches the shorter side of the surface, {} mm: a body so thick is no shell; are lengths given in \
         another unit than mm, or is thickness_mm meant smaller?",
        significant(*thickness_mm, 4),
        significant(*side_mm, 4)
    )]
    ThickerThanSide {
        /// Thickness, mm.
        thickness_mm: f64,
        /// Shorter side, mm.
        side_mm: f64,
    },
    /// A curved surface drawn too far from the middle of the thickness.
    #[error(
        "the surface lies offset_mm = {offset_mm} off the middle of the thickness, and its smallest radius of curvature is {} mm at \
         {at}: what this theory leaves out makes results wrong by up to {} % (a tube under pressure); draw the middle surface with \
         its own radius, and write offset_mm = 0.0 (up to {} mm is taken here)",
        significant(*radius_mm, 4),
        significant(100.0 * error, 2),
        significant(*most_mm, 2)
    )]
    OffsetTooLarge {
        /// Offset, mm.
        offset_mm: f64,
        /// Smallest radius of curvature, mm.
        radius_mm: f64,
        /// Where.
        at: String,
        /// Error of a tube under pressure, of its value.
        error: f64,
        /// Largest offset that is taken, mm.
        most_mm: f64,
    },
    /// A mesh of lower degree than the surface has.
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
    #[error("the supports do not hold the shell: {motion}; add a support, or hold more components")]
    FreeMotion {
        /// The motion, in words.
        motion: String,
    },
    /// A support that holds rigid motions where none is free.
    #[error(
        "support \"{support}\" holds rigid motions alone, and the other supports leave none free: take it out, or hold less in them"
    )]
    NoFreeMotion {
        /// Name of the support.
        support: String,
    },
    /// Moving sections carry most of the points by which a support holds rigid motions.
    #[error(
        "support \"{support}\" holds rigid motions by points of the surface that no moving section carries, and {count} of them remain{}: \
         put more elements between the sections (mesh.elements)",
        if *count < 3 { "" } else { ", all on one line" }
    )]
    TooFewPoints {
        /// Name of the support.
        support: String,
        /// Points that remain.
        count: usize,
    },
    /// Loads push along a motion that only such a support holds.
    #[error(
        "the loads are not in balance, and support \"{support}\" holds rigid motions alone: {motion}, where they push by {share:.1e} of all \
         that acts at load factor {load_factor}; balance them (numbers of few digits leave that much), or hold the shell where its force goes"
    )]
    Unbalanced {
        /// Name of the support.
        support: String,
        /// The motion that they push along, in words.
        motion: String,
        /// Their work on it, of the sum of all forces at their arms.
        share: f64,
        /// Where.
        load_factor: f64,
    },
    /// A support that holds rigid motions alone, and terms of the caller's own that hold some of them as well.
    #[error(
        "support \"{support}\" holds rigid motions alone, and terms of the program's own hold the shell as well: {motion} but against \
         their forces, of which the support would take a share; take it out, and hold what they leave free by another kind of support"
    )]
    HeldByTerms {
        /// Name of the support.
        support: String,
        /// A motion that both hold, in words.
        motion: String,
    },
    /// A probe of a support that is not in the scene.
    #[error("a probe asks for the reaction of support \"{support}\", and the scene has none of that name")]
    NoSuchSupport {
        /// Name of the support.
        support: String,
    },
    /// A section moment across something else than a line.
    #[error("probe \"{probe}\" asks for a section moment, and a section is a line: write for example `on = \"u=0.5\"`")]
    NotASection {
        /// Name of the probe.
        probe: String,
    },
    /// A section moment of a model with a term that does not know its part on one side.
    #[error(
        "a section moment is found from all that acts on one side of the line, and the term \"{term}\" of the program's own does not \
         say what of it acts there: take the probe out, or say it (`TermSource::below`)"
    )]
    NoPart {
        /// Name of the term.
        term: String,
    },
    /// The supports leave nothing free.
    #[error(
        "the supports hold every control point of {} × {} elements: nothing is left to solve for; write more in mesh.elements, or hold less",
        elements[0],
        elements[1]
    )]
    NothingFree {
        /// Elements each way of the model.
        elements: [usize; 2],
    },
    /// More than memory holds.
    #[error(
        "{} × {} elements have {count} control points, and the most that this program takes on is {MOST_CONTROL_POINTS}: write fewer in \
         mesh.elements, and let the mesh refine itself where it has to",
        elements[0],
        elements[1]
    )]
    TooManyControlPoints {
        /// Elements each way of the model.
        elements: [usize; 2],
        /// Control points.
        count: usize,
    },
}
