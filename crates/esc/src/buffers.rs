//! Three buffers, so that one side always has a whole one to read and the other always one to write (ESC data sheet, section I, 8.3).

/// Which of the buffers 0 to 2 is written, which waits and which is read; always a permutation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Buffers {
    producer: u8,
    waiting: u8,
    consumer: u8,
    fresh: bool,
    latest: Option<u8>,
}

impl Buffers {
    /// Nothing written yet.
    pub(crate) const EMPTY: Self = Self {
        producer: 0,
        waiting: 1,
        consumer: 2,
        fresh: false,
        latest: None,
    };

    /// The buffer to write.
    pub(crate) const fn producer(&self) -> u8 {
        self.producer
    }

    /// The buffer to read.
    pub(crate) const fn consumer(&self) -> u8 {
        self.consumer
    }

    /// The buffer written last.
    pub(crate) const fn latest(&self) -> Option<u8> {
        self.latest
    }

    /// Hands over the buffer that was written.
    pub(crate) const fn publish(&mut self) {
        self.latest = Some(self.producer);
        core::mem::swap(&mut self.producer, &mut self.waiting);
        self.fresh = true;
    }

    /// Turns to the newest buffer for reading.
    pub(crate) const fn take(&mut self) {
        if self.fresh {
            core::mem::swap(&mut self.consumer, &mut self.waiting);
            self.fresh = false;
        }
    }

    /// Whether the buffers are three different ones and none is written and newest at once.
    #[cfg(test)]
    pub(crate) fn is_consistent(&self) -> bool {
        let mut buffers = [self.producer, self.waiting, self.consumer];
        buffers.sort_unstable();
        buffers == [0, 1, 2] && self.latest != Some(self.producer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_is_read_and_never_written_in_any_order_of_steps() {
        // Every sequence of ten steps, a bit each: publish or take.
        for sequence in 0..1 << 10 {
            let (mut buffers, mut contents, mut newest) = (Buffers::EMPTY, [None; 3], None);
            for step in 0..10 {
                if sequence >> step & 1 != 0 {
                    contents[usize::from(buffers.producer())] = Some(step);
                    newest = Some(step);
                    buffers.publish();
                } else {
                    buffers.take();
                    assert_eq!(contents[usize::from(buffers.consumer())], newest);
                }
                assert!(buffers.is_consistent());
                assert_eq!(buffers.latest().map(|latest| contents[usize::from(latest)]), newest.map(Some));
            }
        }
    }
}
