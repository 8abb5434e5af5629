//! Memory that tasks share: one begins when there is room for what it takes.

use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// Share of the memory that is free at the start which tasks may take: what they take is known within a factor of two.
const SHARE: f64 = 0.8;

/// So many bytes, lent to tasks. A task that takes more than there are in all has them to itself.
#[derive(Debug)]
pub struct Room {
    all: u64,
    lent: Mutex<u64>,
    returned: Condvar,
}

/// Bytes that a task has, until it is dropped.
#[derive(Debug)]
pub struct Held<'r> {
    room: &'r Room,
    bytes: u64,
}

impl Room {
    /// Room of so many bytes.
    pub fn of(all: u64) -> Self {
        Self { all: all.max(1), lent: Mutex::new(0), returned: Condvar::new() }
    }

    /// Room for any number of tasks.
    pub fn unlimited() -> Self {
        Self::of(u64::MAX)
    }

    /// Most of what this machine says is free now, which other programs may ask for as well; where it says nothing, any number of tasks
    /// have room.
    pub fn of_this_machine() -> Self {
        crate::platform::free_memory().map_or_else(Self::unlimited, |free| Self::of((SHARE * free as f64) as u64))
    }

    /// Waits until there are so many bytes, and takes them.
    pub fn take(&self, bytes: u64) -> Held<'_> {
        let bytes = bytes.min(self.all);
        let mut lent = self.lent();
        while *lent > self.all - bytes {
            lent = self.returned.wait(lent).unwrap_or_else(PoisonError::into_inner);
        }
        *lent += bytes;
        Held { room: self, bytes }
    }

    fn lent(&self) -> MutexGuard<'_, u64> {
        self.lent.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Held<'_> {
    fn drop(&mut self) {
        *self.room.lent() -= self.bytes;
        self.room.returned.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};

    use super::*;

    #[test]
    fn no_more_is_lent_than_there_is() {
        let room = Room::of(10);
        let (lent, most) = (AtomicU64::new(0), AtomicU64::new(0));
        std::thread::scope(|scope| {
            for bytes in [1, 4, 7, 10, 99, 0, 3, 5] {
                let (room, lent, most) = (&room, &lent, &most);
                scope.spawn(move || {
                    let _held = room.take(bytes);
                    most.fetch_max(lent.fetch_add(bytes.min(10), Ordering::SeqCst) + bytes.min(10), Ordering::SeqCst);
                    std::thread::sleep(std::time::Duration::from_millis(2));
                    lent.fetch_sub(bytes.min(10), Ordering::SeqCst);
                });
            }
        });
        assert_eq!(*room.lent(), 0);
        assert!(most.load(Ordering::SeqCst) <= 10);
    }
}
