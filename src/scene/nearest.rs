//! The right spelling that is nearest to a wrong one.

/// Bytes beyond which no name is compared with.
pub(super) const LONGEST_NAME: usize = 64;

/// A name is a slip for another where at most one letter in this many differs (but always where one does).
const LETTERS_PER_SLIP: usize = 3;

/// Letters from which on a part of a name is taken for the whole.
const LEAST_PART: usize = 4;

/// The nearest of some right spellings, if any is near.
pub(super) fn nearest<'n>(found: &str, names: impl Iterator<Item = &'n str> + Clone) -> Option<&'n str> {
    if found.len() > LONGEST_NAME {
        return None;
    }
    let wanted = plain(found);
    let distance = |name: &str| strsim::osa_distance(&wanted, &plain(name));
    let slips = names.clone().filter(|name| slip(&wanted, &plain(name)));
    slips.min_by_key(|name| distance(name)).or_else(|| {
        // No slip: perhaps a part of a longer name, if of one only.
        let part = |name: &&str| {
            let name = plain(name);
            wanted.len() >= LEAST_PART && name.contains(&wanted) || name.len() >= LEAST_PART && wanted.contains(&name)
        };
        let mut parts = names.filter(part);
        let first = parts.next()?;
        parts.next().is_none().then_some(first)
    })
}

/// Whether a name is a slip for another.
pub(super) fn slip(found: &str, name: &str) -> bool {
    let allowed = (found.chars().count().max(name.chars().count()) / LETTERS_PER_SLIP).max(1);
    found.len() > 1 && strsim::osa_distance(found, name) <= allowed
}

/// A name without what people write in different ways.
pub(super) fn plain(name: &str) -> String {
    name.trim().to_lowercase().replace(['-', ' '], "_").replace('\'', "")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_parts_and_writings_find_the_name() {
        let words = || ["half-length", "half-arc", "quarter", "none"].into_iter();
        assert_eq!(nearest("quater", words()), Some("quarter"));
        assert_eq!(nearest("Half_Length", words()), Some("half-length"));
        assert_eq!(nearest("length", words()), Some("half-length"));
        assert_eq!(nearest("half", words()), None, "two names begin so");
        assert_eq!(nearest("banana", words()), None);
    }
}
