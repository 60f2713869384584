//! A recorded answer beside those that drives give now.

use wire::frame::{Command, Layout};

/// Length of a drive's inputs in the default mapping: statusword, mode of operation display, position actual value, digital inputs.
const INPUTS: usize = 11;

/// How a recorded answer compares.
#[derive(Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Every byte is the same.
    Exact,
    /// Every byte is the same except inputs, which are of a moment between the two possible ones.
    Between,
    /// Something else is different.
    Different,
}

/// Compares a recorded answer with those of drives that had caught up `fully` and `hardly` when the frame came.
///
/// Equal to one of them is exact. What may lie between them is only the inputs in logical datagrams, where a drive's begin at each of
/// `places`: whoever serves drives answers first and simulates then, so that how many control ticks have passed when a frame comes is up to
/// the operating system. Lengths, headers, working counters, registers, mailboxes and clocks must be the same in any case.
pub fn compare(recorded: &[u8], fully: &[u8], hardly: &[u8], places: &[usize]) -> Verdict {
    if recorded == fully || recorded == hardly {
        return Verdict::Exact;
    }
    let (rest, inputs) = take_apart(recorded, places);
    let (rest_fully, inputs_fully) = take_apart(fully, places);
    let (rest_hardly, inputs_hardly) = take_apart(hardly, places);
    let possible = inputs_fully.iter().zip(&inputs_hardly);
    let between = inputs
        .iter()
        .zip(possible)
        .all(|(inputs, (fully, hardly))| is_between(inputs, fully, hardly));
    if (rest == rest_fully || rest == rest_hardly) && between {
        Verdict::Between
    } else {
        Verdict::Different
    }
}

/// A frame with the inputs in it blanked out, and those.
fn take_apart(frame: &[u8], places: &[usize]) -> (Vec<u8>, Vec<[u8; INPUTS]>) {
    let mut rest = frame.to_vec();
    let mut inputs = Vec::new();
    let mut walk = Layout::of(frame).expect("EtherCAT").walk();
    while let Some(mut datagram) = walk.next_mut(&mut rest) {
        if !matches!(datagram.command(), Command::Lrd | Command::Lrw) {
            continue;
        }
        for &place in places {
            let taken: &mut [u8; INPUTS] = (&mut datagram.data_mut()[place..place + INPUTS]).try_into().expect("as many");
            inputs.push(std::mem::take(taken));
        }
    }
    (rest, inputs)
}

/// Whether the position is in the range of the two others, and all else as in one of them.
fn is_between(inputs: &[u8; INPUTS], one: &[u8; INPUTS], other: &[u8; INPUTS]) -> bool {
    let position = |inputs: &[u8; INPUTS]| i32::from_le_bytes([inputs[3], inputs[4], inputs[5], inputs[6]]);
    let (low, high) = (position(one).min(position(other)), position(one).max(position(other)));
    let fields = [0..2, 2..3, 7..11];
    (low..=high).contains(&position(inputs))
        && fields
            .into_iter()
            .all(|field| inputs[field.clone()] == one[field.clone()] || inputs[field.clone()] == other[field])
}

#[cfg(test)]
mod tests {
    use super::{Verdict, compare};

    /// An answer to a logical datagram with these inputs, its working counter and a clock's reading.
    fn answer(status: u8, position: i32, counter: u16, clock: u8) -> Vec<u8> {
        let mut frame = vec![0xFF; 12];
        frame.extend([0x88, 0xA4, 37, 0x10]);
        frame.extend([12, 1, 0, 0, 0, 0, 11, 0x80, 0, 0, status, 2, 8]);
        frame.extend(position.to_le_bytes());
        frame.extend([0; 4]);
        frame.extend(counter.to_le_bytes());
        frame.extend([14, 2, 0, 0, 0x10, 9, 2, 0, 0, 0, clock, 0, 1, 0]);
        frame
    }

    #[test]
    fn inputs_of_a_moment_between_are_told_from_others() {
        let (fully, hardly) = (answer(0x37, 20, 3, 9), answer(0x33, 10, 3, 9));
        let verdict = |recorded: &[u8]| compare(recorded, &fully, &hardly, &[0]);
        assert_eq!(verdict(&hardly), Verdict::Exact);
        assert_eq!(verdict(&answer(0x33, 20, 3, 9)), Verdict::Between);
        assert_eq!(verdict(&answer(0x37, 15, 3, 9)), Verdict::Between);
        for other in [
            answer(0x31, 15, 3, 9),
            answer(0x37, 21, 3, 9),
            answer(0x37, 15, 1, 9),
            answer(0x37, 15, 3, 8),
        ] {
            assert_eq!(verdict(&other), Verdict::Different);
        }
        assert_eq!(verdict(&hardly[..hardly.len() - 1]), Verdict::Different);
    }
}
