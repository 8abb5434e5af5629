//! What systems do differently: files by their identity, names that are links, room on disks, signals. Two files hold it, one for Unix
//! and one for all other systems, which has less to offer; `RUSTFLAGS="--cfg foldline_portable" cargo check` compiles the second
//! one on Unix too, so that it stays valid.

#[cfg(any(not(unix), foldline_portable))]
#[path = "platform/portable.rs"]
mod system;
#[cfg(all(unix, not(foldline_portable)))]
#[path = "platform/unix.rs"]
mod system;

pub(crate) use system::*;
