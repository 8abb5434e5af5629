//! Which revision of the numerics this is.

/// Revision of the numerics, raised by hand whenever the bits of any state change: another order of a sum, another
/// start of Newton's method, another rule of step control. A log names the revision that wrote each of its stretches,
/// so that stages that come out differently are blamed on the program and not on the machine.
///
/// `tests/restart/numerics.rs` runs small scenes and holds their chain hashes against those stored for this revision: it
/// fails where bits have changed and this has not, and its message states what to do.
pub const NUMERICS_REVISION: u32 = 5;
