//! What a run says when it is held against theory: the closed-form laws of tape springs.

mod wuest;

pub use wuest::{FoldMoments, Peak, Plateau, TapeSpring};
