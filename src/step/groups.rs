//! Groups of entity numbers (a union–find forest with path halving).

use std::collections::HashMap;

/// Disjoint groups; a number that was never joined is a group of its own.
#[derive(Debug, Default)]
pub struct Groups {
    parents: HashMap<u64, u64>,
}

impl Groups {
    /// The number that stands for the group of `id`.
    pub fn find(&mut self, id: u64) -> u64 {
        let mut id = id;
        while let Some(&parent) = self.parents.get(&id) {
            match self.parents.get(&parent) {
                Some(&grandparent) => {
                    self.parents.insert(id, grandparent);
                    id = grandparent;
                }
                None => return parent,
            }
        }
        id
    }

    /// Makes one group of two; that of `first` stands for both.
    pub fn join(&mut self, first: u64, second: u64) {
        let (first, second) = (self.find(first), self.find(second));
        if first != second {
            self.parents.insert(second, first);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Groups;

    #[test]
    fn joined_numbers_have_one_root() {
        let mut groups = Groups::default();
        for i in 0..100 {
            groups.join(i + 1, i);
        }
        groups.join(500, 501);
        assert!((0..=100).all(|i| groups.find(i) == 100));
        assert_eq!([groups.find(501), groups.find(7000)], [500, 7000]);
    }
}
