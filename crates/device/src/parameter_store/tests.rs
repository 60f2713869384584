use super::*;
use crate::NoMemory;
use crate::parameter_set::{delivery, of};
use embedded_storage::nor_flash::{ErrorType, NorFlashErrorKind, ReadNorFlash};
use proptest::prelude::*;
use std::vec::Vec;

/// What an erasure that is cut off has made of its page.
#[derive(Clone, Copy, Debug)]
enum Erasure {
    /// The bytes up to some place are erased.
    Forwards,
    /// The bytes from some place on are erased.
    Backwards,
    /// Some bytes are erased.
    Anywhere,
    /// All bits were cleared first, as NOR flash does it, and set again up to some place.
    Clearing,
}

/// Pages of flash that lose power after so many bytes.
#[derive(Clone)]
struct Flash<const WORD: usize, const PAGE: usize> {
    cells: Vec<u8>,
    erasure: Erasure,
    /// Bytes that can still be written or erased.
    power: usize,
    /// Bytes written or erased.
    work: usize,
}

impl<const WORD: usize, const PAGE: usize> Flash<WORD, PAGE> {
    fn new(pages: usize) -> Self {
        Self {
            cells: std::vec![0xFF; PAGE * pages],
            erasure: Erasure::Forwards,
            power: usize::MAX,
            work: 0,
        }
    }

    fn set(&mut self, at: usize, value: u8) -> Result<(), NorFlashErrorKind> {
        self.power = self.power.checked_sub(1).ok_or(NorFlashErrorKind::Other)?;
        self.work += 1;
        self.cells[at] = value;
        Ok(())
    }

    /// After a cut: the power is back.
    fn on(&mut self) {
        self.power = usize::MAX;
    }

    fn load(&mut self) -> Result<DriveObjects, Damaged> {
        load(self)
    }

    fn save(&mut self, objects: &DriveObjects) -> Result<(), AbortCode> {
        save(self, &of(objects))
    }
}

impl<const WORD: usize, const PAGE: usize> ErrorType for Flash<WORD, PAGE> {
    type Error = NorFlashErrorKind;
}

impl<const WORD: usize, const PAGE: usize> ReadNorFlash for Flash<WORD, PAGE> {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        bytes.copy_from_slice(&self.cells[offset as usize..][..bytes.len()]);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.cells.len()
    }
}

impl<const WORD: usize, const PAGE: usize> NorFlash for Flash<WORD, PAGE> {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = PAGE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        assert!((from as usize).is_multiple_of(PAGE) && (to as usize).is_multiple_of(PAGE));
        for page in (from as usize..to as usize).step_by(PAGE) {
            if matches!(self.erasure, Erasure::Clearing) {
                for at in page..page + PAGE {
                    self.set(at, 0)?;
                }
            }
            for offset in 0..PAGE {
                let place = match self.erasure {
                    Erasure::Forwards | Erasure::Clearing => offset,
                    Erasure::Backwards => PAGE - 1 - offset,
                    // An odd factor visits every byte once, as pages are powers of two.
                    Erasure::Anywhere => (offset + 1).wrapping_mul(0x9E37_79B9) % PAGE,
                };
                self.set(page + place, 0xFF)?;
            }
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        assert!((offset as usize).is_multiple_of(WORD) && bytes.len().is_multiple_of(WORD));
        for (at, byte) in (offset as usize..).zip(bytes) {
            // Words that were begun may be written with zeros only, as flash with error correction demands; unless a page only seems erased.
            let seems_erased = !matches!(self.erasure, Erasure::Forwards);
            assert!(self.cells[at] == 0xFF || *byte == 0 || seems_erased, "{at:#x} is written twice");
            self.set(at, self.cells[at] & *byte)?;
        }
        Ok(())
    }
}

/// Objects that differ in many places for each number.
fn parameters(number: u32) -> DriveObjects {
    DriveObjects {
        peak_current: 1000 + (number % 5000) as u16,
        alias: number as u16,
        homing_speed_fast: number,
        homing_speed_slow: !number,
        output_mask: number.wrapping_mul(0x9E37_79B9),
        ..DriveObjects::new()
    }
}

/// Memory after so many saves of [`parameters`] with the numbers behind `seed`.
fn saved<const WORD: usize, const PAGE: usize>(pages: usize, saves: u32, seed: u32) -> Flash<WORD, PAGE> {
    let mut flash = Flash::new(pages);
    for number in 1..=saves {
        flash.save(&parameters(seed + number)).unwrap();
    }
    flash
}

/// Cuts the save that follows `saves` others after every byte.
fn cut_everywhere<const WORD: usize, const PAGE: usize>(pages: usize, saves: u32, seed: u32, erasure: Erasure) {
    let mut before = saved::<WORD, PAGE>(pages, saves, seed);
    before.erasure = erasure;
    let value = |number: u32| parameters(seed + number);
    let old = if saves == 0 { DriveObjects::new() } else { value(saves) };
    let (new, next) = (value(saves + 1), value(saves + 2));
    let mut whole = before.clone();
    whole.work = 0;
    whole.save(&new).unwrap();
    let mut is_new = false;
    for cut in 0..=whole.work {
        let at = std::format!("{WORD}-byte words, {pages} pages, {saves} saves, {erasure:?}, cut after {cut} bytes");
        let mut flash = before.clone();
        flash.power = cut;
        assert_eq!(flash.save(&new).is_ok(), cut == whole.work, "{at}");
        flash.on();
        let found = flash.load();
        assert!(found == Ok(old.clone()) || found == Ok(new.clone()), "{at}: {found:?}");
        assert!(!is_new || found == Ok(new.clone()), "{at}: it was the new set before");
        is_new = found == Ok(new.clone());
        // The next save may be cut off as well.
        flash.power = (cut * 7919 + seed as usize) % (2 * PAGE);
        let again = flash.save(&next).is_ok();
        flash.on();
        let after = flash.load();
        // A first save that was cut off is erased, and of a half-erased page nobody knows what it was.
        let unknown = saves == 0 && !is_new && after == Err(Damaged);
        assert!(
            after == Ok(next.clone()) || !again && (unknown || after == found),
            "{at}: {after:?}"
        );
        flash.save(&next).unwrap_or_else(|error| panic!("{at}: {error}"));
        assert_eq!(flash.load(), Ok(next.clone()), "{at}");
    }
    assert!(is_new);
}

#[test]
fn a_cut_after_any_byte_leaves_the_old_set_or_the_new_and_saving_works_again() {
    // Up to the first times that pages of each half are erased.
    for saves in 0..=16 {
        cut_everywhere::<4, 1024>(4, saves, 77 * saves, Erasure::Forwards);
    }
    for (saves, seed) in [(0, 1), (1, 2), (9, 5), (22, 6)] {
        cut_everywhere::<8, 2048>(5, saves, seed * 0x0101_0101, Erasure::Forwards);
        cut_everywhere::<1, 1024>(6, saves, seed * 0x0202_0101, Erasure::Forwards);
        cut_everywhere::<32, 2048>(4, saves, seed * 0x0303_0101, Erasure::Forwards);
    }
}

#[test]
fn whatever_a_cut_erasure_leaves_is_survived() {
    for erasure in [Erasure::Backwards, Erasure::Anywhere, Erasure::Clearing] {
        for saves in 4..=11 {
            cut_everywhere::<4, 1024>(4, saves, 77 * saves, erasure);
        }
    }
}

#[test]
fn sets_are_spread_over_all_pages() {
    let mut flash = saved::<4, 1024>(4, 200, 0);
    let erased = |flash: &Flash<4, 1024>| {
        flash
            .cells
            .chunks(1024)
            .map(|page| page.iter().all(|cell| *cell == 0xFF))
            .collect::<Vec<_>>()
    };
    let mut used = [false; 4];
    for number in 0..20 {
        flash.save(&parameters(number)).unwrap();
        for (used, erased) in used.iter_mut().zip(erased(&flash)) {
            *used |= !erased;
        }
    }
    assert_eq!(used, [true; 4]);
    // A set takes some 350 bytes, and no page is erased before it is full.
    flash.work = 0;
    for number in 0..100 {
        flash.save(&parameters(number)).unwrap();
    }
    assert!(flash.work < 100 * 350 * 5 / 2, "{}", flash.work);
}

#[test]
fn restoring_leaves_the_parameters_of_delivery_for_the_next_start() {
    let mut flash = saved::<4, 1024>(4, 3, 0);
    save(&mut flash, &delivery()).unwrap();
    assert_eq!(flash.load(), Ok(DriveObjects::new()));
    flash.save(&parameters(9)).unwrap();
    assert_eq!(flash.load(), Ok(parameters(9)));
}

#[test]
fn a_board_without_a_memory_or_with_one_too_small_cannot_save() {
    assert_eq!(load(&mut NoMemory), Ok(DriveObjects::new()));
    assert_eq!(save(&mut NoMemory, &delivery()), Err(AbortCode::CannotStore));
    for mut flash in [Flash::<4, 1024>::new(1), Flash::new(2), Flash::new(3)] {
        assert_eq!(flash.save(&parameters(1)), Err(AbortCode::CannotStore));
    }
    let mut small_pages = Flash::<4, 512>::new(16);
    assert_eq!(small_pages.save(&parameters(1)), Err(AbortCode::CannotStore));
    assert_eq!(small_pages.load(), Ok(DriveObjects::new()));
}

#[test]
fn damage_to_the_last_set_is_noticed_and_saving_ends_it() {
    for saves in [1, 2, 3, 7, 8] {
        let sound = saved::<4, 1024>(4, saves, 0);
        let mut lost = 0;
        for at in (0..sound.cells.len()).filter(|at| sound.cells[*at] != 0xFF) {
            for bit in [0, 5] {
                let mut flash = sound.clone();
                flash.cells[at] ^= 1 << bit;
                match flash.load() {
                    Ok(found) => assert_eq!(found, parameters(saves), "bit {bit} at {at:#x} after {saves} saves"),
                    Err(Damaged) => {
                        lost += 1;
                        assert_eq!(flash.load(), Err(Damaged), "at every start, until it is saved anew");
                        flash.save(&parameters(77)).unwrap();
                        assert_eq!(flash.load(), Ok(parameters(77)));
                    }
                }
            }
        }
        assert!(lost >= 2 * FULL_SIZE, "{lost}");
    }
}

proptest! {
    #[test]
    fn rubbish_is_told_as_damage_and_can_be_overwritten(
        rubbish in proptest::collection::vec(any::<u8>(), 4096),
        kept in prop::sample::select(std::vec![0_usize, 1024, 2048]),
    ) {
        let mut flash = saved::<4, 1024>(4, 1, 0);
        flash.cells[kept..].copy_from_slice(&rubbish[kept..]);
        flash.erasure = Erasure::Anywhere;
        let expected = if kept == 0 { Err(Damaged) } else { Ok(parameters(1)) };
        prop_assert_eq!(flash.load(), expected);
        prop_assert_eq!(flash.save(&parameters(2)), Ok(()));
        prop_assert_eq!(flash.load(), Ok(parameters(2)));
    }
}
