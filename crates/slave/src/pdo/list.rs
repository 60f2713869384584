//! Objects whose sub-index 0 says how many of their entries count.

use dictionary::AbortCode;

/// Entries 1 to `N`, of which the first so many count as sub-index 0 says.
#[derive(Clone, Debug)]
pub(crate) struct List<T, const N: usize> {
    count: u8,
    items: [T; N],
}

impl<T: Copy + Default, const N: usize> List<T, N> {
    /// A list of the first `N` of `initial`.
    pub(crate) fn new(initial: &[T]) -> Self {
        let mut items = [T::default(); N];
        let count = initial.len().min(N);
        items[..count].copy_from_slice(&initial[..count]);
        Self { count: count as u8, items }
    }

    /// Sub-index 0.
    pub(crate) const fn count(&self) -> u8 {
        self.count
    }

    /// The entries that count.
    pub(crate) fn active(&self) -> &[T] {
        &self.items[..usize::from(self.count)]
    }

    /// The entry at a sub-index that counts.
    ///
    /// # Errors
    /// 0x06090011 for those behind.
    pub(crate) fn item(&self, sub: u8) -> Result<T, AbortCode> {
        usize::from(sub)
            .checked_sub(1)
            .and_then(|position| self.active().get(position))
            .copied()
            .ok_or(AbortCode::SubIndexNotFound)
    }

    /// Whether an entry may be replaced now.
    ///
    /// # Errors
    /// 0x06010003 unless sub-index 0 is 0, 0x06090011 for an entry that does not exist.
    pub(crate) fn check_item(&self, sub: u8) -> Result<(), AbortCode> {
        if self.count != 0 {
            return Err(AbortCode::SubIndexZeroNotCleared);
        }
        if (1..=N).contains(&usize::from(sub)) {
            Ok(())
        } else {
            Err(AbortCode::SubIndexNotFound)
        }
    }

    /// Replaces an entry.
    ///
    /// # Errors
    /// Those of [`Self::check_item`].
    pub(crate) fn set_item(&mut self, sub: u8, value: T) -> Result<(), AbortCode> {
        self.check_item(sub)?;
        self.items[usize::from(sub) - 1] = value;
        Ok(())
    }

    /// The entries that would count if sub-index 0 were `count`; `None` if there are not as many.
    pub(crate) fn first(&self, count: u8) -> Option<&[T]> {
        self.items.get(..usize::from(count))
    }

    /// Sets sub-index 0 to a count for which [`Self::first`] had entries.
    pub(crate) fn set_count(&mut self, count: u8) {
        self.count = count.min(N as u8);
    }
}
