//! The ties between rows of control points: joints, seams and planes of symmetry.

use crate::model::ModelError;
use crate::model::edge::{EdgeRows, edge_rows};
use crate::model::joint::{Joint, joints, seam};
use crate::model::soundness::closed_directions;
use crate::scene::{Edge, Geometry, Hold, NurbsPatch, ParametricDirection, Region, Scene, Seam, Support};
use crate::spline::Patch;

/// Ties between rows of control points of a mesh.
#[derive(Debug)]
pub struct Ties {
    /// Joints in each direction.
    pub joints: [Vec<Joint>; 2],
    /// Seam in each direction: one joint or none.
    pub seam: [Vec<Joint>; 2],
    /// Edges that lie in planes of symmetry, or across which the surface goes on in another shell: rows beside them span the
    /// tangent there.
    smooth: Vec<Edge>,
}

impl Ties {
    /// Finds the joints and seams of a patch, and the planes of symmetry among some supports; `joined` are the edges that smooth joints
    /// tie to other patches.
    ///
    /// # Errors
    /// Where the geometry is not smooth at a joint.
    pub fn new(
        scene: &Scene,
        patch: &Patch,
        supports: &[Support],
        joined: impl Iterator<Item = Edge>,
    ) -> Result<Self, ModelError> {
        let closed = match scene.geometry {
            Geometry::CylinderPanel { seam: Some(Seam::Smooth), .. }
            | Geometry::Annulus { seam: Some(Seam::Smooth), .. } => [false, true],
            Geometry::SphereZone { seam: Some(Seam::Smooth), .. } => [true, false],
            Geometry::Nurbs(NurbsPatch { seam: Some(Seam::Smooth), .. }) => closed_directions(patch),
            _ => [false, false],
        };
        let closing = |direction: usize| {
            if closed[direction] { seam(patch, direction).map(|joint| vec![joint]) } else { Ok(vec![]) }
        };
        let mirrors = supports.iter().filter(|support| support.hold == Hold::Symmetric).filter_map(|s| match s.on {
            Region::Edge(edge) => Some(edge),
            _ => None,
        });
        Ok(Self {
            joints: [joints(patch, 0)?, joints(patch, 1)?],
            seam: [closing(0)?, closing(1)?],
            smooth: mirrors.chain(joined).collect(),
        })
    }

    /// Finds the rows of control points of an edge. Those that a plane of symmetry or a C¹ joint holds on one line span
    /// the tangent there and share its normal: their own normals would take a free motion away.
    ///
    /// # Errors
    /// Where the surface has no normal on the edge.
    pub fn rows(&self, patch: &Patch, edge: Edge) -> Result<EdgeRows, ModelError> {
        let mut rows = edge_rows(patch, edge)?;
        let (across, _) = edge.side();
        let running = if across == ParametricDirection::U { 1 } else { 0 };
        let last = rows.normals.len() - 1;
        for mirror in &self.smooth {
            match mirror.side() {
                (direction, _) if direction == across => {}
                (_, false) => rows.normals[1] = rows.normals[0],
                (_, true) => rows.normals[last - 1] = rows.normals[last],
            }
        }
        for joint in self.joints[running].iter().chain(&self.seam[running]) {
            rows.normals[joint.before] = rows.normals[joint.index];
            rows.normals[joint.after] = rows.normals[joint.index];
        }
        Ok(rows)
    }
}
