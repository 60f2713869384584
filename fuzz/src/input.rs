//! The fuzzer's bytes as a sequence of choices.

/// What is left of an input.
pub struct Input<'a>(&'a [u8]);

impl<'a> Input<'a> {
    /// All of it.
    pub const fn new(bytes: &'a [u8]) -> Self {
        Self(bytes)
    }

    /// Whether all was taken.
    pub const fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The next `count` bytes, or as many as there are.
    pub fn bytes(&mut self, count: usize) -> &'a [u8] {
        let (taken, rest) = self.0.split_at(count.min(self.0.len()));
        self.0 = rest;
        taken
    }

    /// The next bytes, zeros where there are none left.
    pub fn array<const COUNT: usize>(&mut self) -> [u8; COUNT] {
        let mut array = [0; COUNT];
        let bytes = self.bytes(COUNT);
        array[..bytes.len()].copy_from_slice(bytes);
        array
    }

    /// A number of one byte.
    pub fn u8(&mut self) -> u8 {
        u8::from_le_bytes(self.array())
    }

    /// A number of two bytes, little-endian.
    pub fn u16(&mut self) -> u16 {
        u16::from_le_bytes(self.array())
    }

    /// One of some choices, of which there must be one.
    pub fn one_of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[usize::from(self.u8()) % choices.len()]
    }
}

/// Spans of time that matter, in ns: a frame, a control tick, a cycle, the watchdog's.
const SPANS: [u64; 6] = [0, 7_000, 50_000, 200_000, 1_000_000, 101_000_000];

/// What an input may let pass altogether, in ns, so that no input takes long.
const MOST_TIME: u64 = 110_000_000;

/// How much time an input may still let pass.
pub struct Patience(u64);

impl Default for Patience {
    fn default() -> Self {
        Self(MOST_TIME)
    }
}

impl Patience {
    /// A span of time, in ns, that the input chooses; 0 when none is left.
    pub fn span(&mut self, input: &mut Input<'_>) -> u64 {
        let span = input.one_of(&SPANS).min(self.0);
        self.0 -= span;
        span
    }
}
