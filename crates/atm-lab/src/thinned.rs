//! A list that stays short, and still covers all that was put into it.

/// Most items that one list holds; of more, every second is left out, and so on.
pub const MOST: usize = 200_000;

/// Every item, or every second, fourth, … of them once there are more than [`MOST`].
#[derive(Debug, Clone, PartialEq)]
pub struct Thinned<T> {
    kept: Vec<T>,
    /// One item in so many is kept.
    stride: u64,
    offered: u64,
}

impl<T> Thinned<T> {
    /// An empty list.
    pub const fn new() -> Self {
        Self { kept: Vec::new(), stride: 1, offered: 0 }
    }

    /// Takes an item in, if it is its turn.
    pub fn push(&mut self, item: T) {
        if self.offered.is_multiple_of(self.stride) {
            if self.kept.len() >= MOST {
                let mut index = 0;
                self.kept.retain(|_| {
                    index += 1;
                    index % 2 == 1
                });
                self.stride *= 2;
            }
            // The list was just halved: it may be that the item is no longer due.
            if self.offered.is_multiple_of(self.stride) {
                self.kept.push(item);
            }
        }
        self.offered += 1;
    }

    /// The items kept, in order.
    pub fn iter(&self) -> std::slice::Iter<'_, T> {
        self.kept.iter()
    }

    /// Items put in, kept or not.
    pub fn offered(&self) -> u64 {
        self.offered
    }

    /// Whether nothing was put in.
    pub fn is_empty(&self) -> bool {
        self.kept.is_empty()
    }
}

impl<T> Default for Thinned<T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T> FromIterator<T> for Thinned<T> {
    fn from_iter<I: IntoIterator<Item = T>>(items: I) -> Self {
        let mut thinned = Self::default();
        items.into_iter().for_each(|item| thinned.push(item));
        thinned
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_list_keeps_everything() {
        let list: Thinned<usize> = (0..MOST).collect();
        assert!(list.iter().copied().eq(0..MOST));
    }

    #[test]
    fn a_long_list_keeps_evenly_spaced_items_from_first_to_last() {
        let count = 5 * MOST / 2;
        let list: Thinned<usize> = (0..count).collect();
        assert!(list.iter().copied().eq((0..count).step_by(4)), "not every fourth");
        assert_eq!(list.offered(), count as u64);
    }
}
