//! The forces that each support exerts on the shell: the multipliers of its constraints.
//!
//! At equilibrium the forces g on the control points (internal less loads), each seen in the frame of its point, are those
//! of the constraints b_k · v = m_k alone: g = Σ λ_k b_k. A support exerts Σ λ_k b_k over the constraints that are its own.
//! Where δv moves it by δm and keeps all others, g · δv = λ · δm: its force is the derivative of strain energy less work of
//! the loads with respect to its motion, and where its control points are tied to others (by a plane of symmetry, by a
//! C¹ joint) what these carry comes to it through the tie. A sum of g over the control points that it holds misses that.
//!
//! The multipliers are unique where the constraints are independent. Where they are not, several ask the same of the same
//! control points, and only the sum of their forces is determined; then they carry in turn, and one that follows from
//! those before it carries nothing:
//!
//! 1. planes of symmetry. Near a support, the traction in the cut is what the other half exerts, and that of the support
//!    across the plane falls to zero there. So the plane takes the force across it at the corner, and a couple between its
//!    two rows of control points, but no force along it: the whole of that is the support's. The control points of the
//!    edge follow those next to it, where the whole shell has its own; in degree 2, where both have the same functions,
//!    reactions of a part and of the whole agree to rounding;
//! 2. other supports, in the order of the scene;
//! 3. planes of symmetry through lines inside: where the shell is what they say, they carry nothing;
//! 4. joints. Their forces have neither resultant nor moment.

use std::collections::BTreeMap;

use crate::model::Placement;
use crate::model::elimination::{Expression, multipliers};
use crate::model::supports::Supports;

/// Forces on some control points, N, by their numbers.
pub type PointForces = BTreeMap<usize, [f64; 3]>;

/// Forces that supports and joints exert on the control points of a shell in equilibrium.
#[derive(Clone, Debug)]
pub struct Exerted {
    /// Forces of each support, in the order of [`Supports::footprints`].
    pub by_supports: Vec<PointForces>,
    /// Forces of the joints, between control points of the shell itself.
    pub by_joints: PointForces,
}

impl Placement<'_> {
    /// Splits the forces on the control points (internal less loads, N) into those of the supports and joints. The
    /// residual on the free unknowns is not among them.
    pub fn exerted(&self, forces: &[[f64; 3]]) -> Exerted {
        let supports = self.supports();
        let turn = in_turn(supports);
        let constraints: Vec<&Expression> = turn.iter().map(|index| &supports.constraints[*index]).collect();
        let local: Vec<f64> =
            forces.iter().enumerate().flat_map(|(point, force)| self.seen_in_frame(point, *force)).collect();
        let mut by_supports = vec![PointForces::new(); supports.footprints.len()];
        let mut by_joints = PointForces::new();
        for (index, multiplier) in turn.iter().zip(multipliers(&constraints, &local)) {
            let holder = supports.owner[*index].map_or(&mut by_joints, |support| &mut by_supports[support]);
            for (component, factor) in supports.constraints[*index].iter().filter(|(c, _)| *c < local.len()) {
                let sum = holder.entry(component / 3).or_default();
                sum[component % 3] += multiplier * factor;
            }
        }
        for holder in by_supports.iter_mut().chain([&mut by_joints]) {
            holder.iter_mut().for_each(|(point, force)| *force = self.seen_in_space(*point, *force));
        }
        Exerted { by_supports, by_joints }
    }
}

/// Lists the constraints in the order in which they carry.
fn in_turn(supports: &Supports) -> Vec<usize> {
    let mut mirrors = vec![0; supports.section_of.len()];
    for point in supports.footprints.iter().flat_map(|trace| &trace.mirrored) {
        mirrors[*point] += 1;
    }
    let key = |index: &usize| {
        let class = match supports.owner[*index] {
            Some(support) if !supports.footprints[support].mirrored.is_empty() => 0,
            Some(support) if supports.footprints[support].is_inner_mirror => 2,
            Some(_) => 1,
            None => 3,
        };
        let points = supports.constraints[*index].iter().map(|(component, _)| component / 3);
        let followers = points.filter_map(|point| mirrors.get(point)).max().copied().unwrap_or(0);
        (class, supports.owner[*index], if class == 0 { 0 } else { followers })
    };
    let mut turn: Vec<usize> = (0..supports.constraints.len()).collect();
    turn.sort_by_key(key);
    turn
}
