//! Pages to read.
//!
//! | page | what |
//! |---|---|
//! | [`tutorial`] | a tape spring of one's own, from nothing to a report |
//! | [`theory`] | what is computed, with equations and sources |
//! | [`structures`] | several shells: joints, bonds, common sections |
//! | [`log`] | the format of a log, for a reader in another language |
//! | [`sweeps`] | tables over many designs |
//! | [`citing`] | how to cite the program and the papers behind it |
//! | [`changes`] | what each version brought |

#[doc = include_str!("changes.md")]
pub mod changes {}

#[doc = include_str!("citing.md")]
pub mod citing {}

#[doc = include_str!("log.md")]
pub mod log {}

#[doc = include_str!("structures.md")]
pub mod structures {}

#[doc = include_str!("sweeps.md")]
pub mod sweeps {}

#[doc = include_str!("theory.md")]
pub mod theory {}

#[doc = include_str!("tutorial.md")]
pub mod tutorial {}
