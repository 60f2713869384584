//! A wire that loses frames, so that masters can be tested for what they do then.

use std::time::Duration;

use esc::Side;

use super::cards::Cards;
use super::{Link, LinkError, Received};

/// What is lost of a wire's frames: the same ones for the same seed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loss {
    /// Share of the frames of each direction, from 0 to 1.
    pub share: f64,
    /// Which frames they are.
    pub seed: u64,
}

/// Which frames get lost: each with the same probability, whatever became of the others.
#[derive(Clone, Debug)]
struct Fate {
    /// A random number below it loses a frame.
    threshold: u64,
    random: u64,
    lost: u64,
}

impl Fate {
    fn new(loss: Loss) -> Self {
        Self {
            threshold: (loss.share.clamp(0.0, 1.0) * 2_f64.powi(64)) as u64,
            random: loss.seed,
            lost: 0,
        }
    }

    /// Whether the next frame gets lost.
    fn strikes(&mut self) -> bool {
        let lost = next(&mut self.random) < self.threshold;
        self.lost += u64::from(lost);
        lost
    }
}

/// A link that loses some of the frames that pass it, in either direction.
#[derive(Clone, Debug)]
pub struct Lossy<L> {
    link: L,
    fate: Fate,
}

impl<L> Lossy<L> {
    /// `link`, with frames lost.
    pub fn new(link: L, loss: Loss) -> Self {
        Self {
            link,
            fate: Fate::new(loss),
        }
    }

    /// The link without loss.
    pub fn inner(&self) -> &L {
        &self.link
    }

    /// The link without loss.
    pub fn inner_mut(&mut self) -> &mut L {
        &mut self.link
    }

    /// How many frames have been lost so far.
    pub fn lost(&self) -> u64 {
        self.fate.lost
    }
}

/// The next of a sequence of evenly distributed numbers (SplitMix64, which gives the same numbers for ever, as generators of libraries
/// need not).
fn next(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mixed = (*state ^ *state >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
    mixed ^ mixed >> 31
}

impl<L: Link> Link for Lossy<L> {
    fn send(&mut self, frame: &[u8]) -> Result<(), LinkError> {
        if self.fate.strikes() { Ok(()) } else { self.link.send(frame) }
    }

    /// A frame that came in but got lost ends the wait as a time-out does.
    fn receive(&mut self, buffer: &mut [u8], wait: Duration) -> Result<Received, LinkError> {
        match self.link.receive(buffer, wait)? {
            Received::Frame(_) if self.fate.strikes() => Ok(Received::Timeout),
            received => Ok(received),
        }
    }
}

/// The same for the wires to all of a master's cards.
pub struct LossyCards {
    cards: Box<dyn Cards + Send>,
    fate: Fate,
}

impl LossyCards {
    /// `cards`, with frames lost.
    pub fn new(cards: Box<dyn Cards + Send>, loss: Loss) -> Self {
        Self {
            cards,
            fate: Fate::new(loss),
        }
    }
}

impl Cards for LossyCards {
    fn send_to(&mut self, side: Side, frame: &[u8]) -> Result<(), LinkError> {
        if self.fate.strikes() {
            Ok(())
        } else {
            self.cards.send_to(side, frame)
        }
    }

    /// As with [`Lossy`].
    fn receive_any(&mut self, buffer: &mut [u8], wait: Duration) -> Result<(Side, Received), LinkError> {
        match self.cards.receive_any(buffer, wait)? {
            (side, Received::Frame(_)) if self.fate.strikes() => Ok((side, Received::Timeout)),
            received => Ok(received),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wire that gives back what it is sent.
    #[derive(Default)]
    struct Echo(Option<u8>);

    impl Link for Echo {
        fn send(&mut self, frame: &[u8]) -> Result<(), LinkError> {
            self.0 = Some(frame[0]);
            Ok(())
        }

        fn receive(&mut self, buffer: &mut [u8], _: Duration) -> Result<Received, LinkError> {
            Ok(self.0.take().map_or(Received::Down, |byte| {
                buffer[0] = byte;
                Received::Frame(1)
            }))
        }
    }

    /// For each of `frames` frames, whether it was lost on the way out, on the way back, or not at all.
    fn fates(share: f64, seed: u64, frames: usize) -> (Vec<Received>, u64) {
        let mut link = Lossy::new(Echo::default(), Loss { share, seed });
        let fates = (0..frames).map(|_| {
            link.send(&[7]).unwrap();
            link.receive(&mut [0], Duration::ZERO).unwrap()
        });
        let fates = fates.collect();
        (fates, link.lost())
    }

    #[test]
    fn both_directions_lose_their_share() {
        for share in [0.01, 0.2, 0.5] {
            let (fates, lost) = fates(share, 1, 20_000);
            let count = |fate| fates.iter().filter(|&&received| received == fate).count() as f64;
            let (out, back) = (count(Received::Down), count(Received::Timeout));
            assert_eq!(out + back, lost as f64);
            assert!((out / 20_000.0 - share).abs() < 0.15 * share, "{out} of 20 000 sent");
            assert!(
                (back / (20_000.0 - out) - share).abs() < 0.15 * share,
                "{back} of the rest coming back"
            );
        }
    }

    #[test]
    fn nothing_or_everything_can_be_lost() {
        assert_eq!(fates(0.0, 3, 1000).1, 0);
        assert_eq!(fates(1.0, 3, 1000), (vec![Received::Down; 1000], 1000));
    }

    #[test]
    fn a_seed_loses_the_same_frames_again_and_another_loses_others() {
        assert_eq!(fates(0.1, 5, 200), fates(0.1, 5, 200));
        assert_ne!(fates(0.1, 5, 200), fates(0.1, 6, 200));
    }
}
