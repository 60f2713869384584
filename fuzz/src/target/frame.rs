//! Whole frames against three drives, in a line, a ring or a tree, that lie in INIT or run in OP.
//!
//! What must hold: a frame keeps its length and everything in it that is not data, working counter, position or event field; the working
//! counter grows by three a drive at the most; and whatever has come, a master then gets every drive to PREOP. That needs nothing of the
//! EEPROM, which the frames may have changed.

use std::sync::LazyLock;

use device::layout::MAILBOX_MAX;
use esc::{End, Processed, Side};
use raw_master::MAX_FRAME;
use usr2556e::drive::DriveConfig;
use wire::frame::{Command, Datagram, ETHERTYPE, FrameBuilder, Layout, SOURCE_ADDRESS, physical_address};
use wire::register::*;

use crate::bring_up;
use crate::bus::Bus;
use crate::input::{Input, Patience};

const DRIVES: usize = 3;
/// Steps of an input at the most.
const MOST_STEPS: usize = 64;
/// Datagrams of a built frame at the most.
const MOST_DATAGRAMS: u8 = 6;
/// What one drive can add to a working counter: one for reading and two for writing.
const MOST_COUNTED: usize = 3;
/// Set in the source address by drives.
const PROCESSED: u8 = 0x02;

const PRIMARY: End = End::Master(Side::Primary);
const SECONDARY: End = End::Master(Side::Secondary);

const fn port(position: usize, port: usize) -> End {
    End::Port { position, port }
}

/// Cables, each drive's port 0 towards the primary card: a line, a ring, a branch, and a ring with a branch.
const TOPOLOGIES: [&[(End, End)]; 4] = [
    &[(PRIMARY, port(0, 0)), (port(0, 1), port(1, 0)), (port(1, 1), port(2, 0))],
    &[
        (PRIMARY, port(0, 0)),
        (port(0, 1), port(1, 0)),
        (port(1, 1), port(2, 0)),
        (port(2, 1), SECONDARY),
    ],
    &[(PRIMARY, port(0, 0)), (port(0, 1), port(1, 0)), (port(0, 3), port(2, 0))],
    &[
        (PRIMARY, port(0, 0)),
        (port(0, 3), port(1, 0)),
        (port(1, 1), port(2, 0)),
        (port(0, 1), SECONDARY),
    ],
];

/// Each topology in INIT, and then each in OP.
static PREPARED: LazyLock<Vec<Bus>> = LazyLock::new(|| {
    let fresh: Vec<_> = TOPOLOGIES.iter().map(|cables| plugged(cables)).collect();
    let running = fresh.iter().map(|bus| {
        let mut bus = bus.clone();
        bring_up::to_preop(&mut bus, MAILBOX_MAX);
        bring_up::to_safeop(&mut bus);
        bring_up::to_op(&mut bus);
        bus
    });
    let running: Vec<_> = running.collect();
    fresh.into_iter().chain(running).collect()
});

fn plugged(cables: &[(End, End)]) -> Bus {
    let drive = |position| DriveConfig {
        // The first drive is the junction.
        ports: if position == 0 { 4 } else { 2 },
        ..DriveConfig::numbered(position)
    };
    let mut bus = Bus::new((0..DRIVES).map(drive));
    for end in TOPOLOGIES[0].iter().flat_map(|&(one, other)| [one, other]) {
        bus.disconnect(end);
    }
    for &(one, other) in cables {
        bus.connect(one, other);
    }
    bus
}

/// Runs an input.
///
/// # Panics
/// If a drive or a frame is not as it must be.
pub fn run(bytes: &[u8]) {
    let mut input = Input::new(bytes);
    let choice = usize::from(input.u8()) % PREPARED.len();
    let cables = TOPOLOGIES[choice % TOPOLOGIES.len()];
    let mut bus = PREPARED[choice].clone();
    let mut patience = Patience::default();
    for _ in 0..MOST_STEPS {
        if input.is_empty() {
            break;
        }
        step(&mut bus, cables, &mut input, &mut patience);
    }
    for &(one, other) in cables {
        bus.connect(one, other);
    }
    bus.catch_up();
    bring_up::to_preop(&mut bus, MAILBOX_MAX);
}

fn step(bus: &mut Bus, cables: &[(End, End)], input: &mut Input<'_>, patience: &mut Patience) {
    let kind = input.u8();
    match kind % 8 {
        0..=2 => {
            let (mut frame, length) = built(input);
            send(bus, side(kind), &mut frame[..length]);
        }
        3 => {
            let length = usize::from(input.u16()) % MAX_FRAME;
            send(bus, side(kind), &mut input.bytes(length).to_vec());
        }
        4 => {
            let length = usize::from(input.u16()) % MAX_FRAME;
            let mut frame = [&[0xFF; 12][..], &ETHERTYPE.to_be_bytes(), input.bytes(length)].concat();
            send(bus, side(kind), &mut frame);
        }
        5 => bus.pass_time(patience.span(input)),
        6 => {
            let span = patience.span(input);
            bus.wait(span);
        }
        _ => {
            let (one, other) = input.one_of(cables);
            if kind & 0x80 == 0 {
                bus.disconnect(one);
            } else {
                bus.connect(one, other);
            }
        }
    }
    // Some frames come while the drives have not seen the one before.
    if kind & 0x40 == 0 {
        bus.wait(0);
    }
}

fn side(kind: u8) -> Side {
    if kind & 0x20 == 0 { Side::Primary } else { Side::Secondary }
}

/// A frame of datagrams to addresses where something happens, perhaps damaged; and its length.
fn built(input: &mut Input<'_>) -> ([u8; MAX_FRAME], usize) {
    let mut frame = [0; MAX_FRAME];
    let shape = input.u8();
    let mut builder = match shape & 0x40 {
        0 => FrameBuilder::new(&mut frame, [0x10; 6]),
        _ => FrameBuilder::tagged(&mut frame, [0x10; 6], 0x6000),
    }
    .expect("there is room for a header");
    for index in 0..=shape % MOST_DATAGRAMS {
        let command = Command::from(input.u8() % 17);
        let address = address(command, input);
        let length = input.one_of(&[1, 2, 4, 8, 16, 64, 100, 300]);
        let mut data = input.bytes(length).to_vec();
        data.resize(length, 0);
        if builder.datagram(command, index, address, &data).is_err() {
            break;
        }
    }
    let length = builder.finish();
    if shape & 0x80 == 0 {
        return (frame, length);
    }
    let [at, value, cut] = input.array();
    frame[usize::from(at) + SOURCE_ADDRESS] = value;
    (frame, length - usize::from(cut).min(length))
}

/// A logical address among those of the process data, or a physical one.
fn address(command: Command, input: &mut Input<'_>) -> u32 {
    if matches!(command, Command::Lrd | Command::Lwr | Command::Lrw) {
        return 0x1_0000 + u32::from(input.u8());
    }
    let adp = match input.u8() {
        few @ 0..=0x7F => 0_u16.wrapping_sub(u16::from(few % 4)),
        few @ 0x80..=0xFE => 0x1000 + u16::from(few % 4),
        0xFF => input.u16(),
    };
    let ado = match input.u8() {
        0xFF => input.u16(),
        choice => REGISTERS[usize::from(choice) % REGISTERS.len()] + u16::from(choice) / REGISTERS.len() as u16,
    };
    physical_address(adp, ado)
}

/// Where something happens.
const REGISTERS: [u16; 31] = [
    TYPE,
    STATION_ADDRESS,
    WRITE_REGISTER_ENABLE,
    ESC_WRITE_ENABLE,
    RESET,
    DL_CONTROL,
    DL_CONTROL + 1,
    PHYSICAL_OFFSET,
    DL_STATUS,
    AL_CONTROL,
    AL_STATUS,
    PDI_CONTROL,
    ECAT_EVENT_MASK,
    AL_EVENT_MASK,
    RX_ERROR_COUNTERS,
    WATCHDOG_DIVIDER,
    PROCESS_WATCHDOG_TIME,
    EEPROM_CONFIGURATION,
    EEPROM_CONTROL,
    FMMU,
    FMMU + FMMU_SIZE,
    SM,
    SM + 2 * SM_SIZE,
    SM + SM_SIZE + sync_manager::ACTIVATE,
    DC_RECEIVE_TIMES,
    DC_SYSTEM_TIME,
    DC_SPEED_START,
    DC_CYCLIC_CONTROL,
    DC_START_TIME,
    DC_LATCH_CONTROL,
    PROCESS_RAM,
];

/// Sends a frame and checks what holds for every frame.
fn send(bus: &mut Bus, from: Side, frame: &mut [u8]) {
    let mut expected = frame.to_vec();
    let (processed, exit) = bus.pass(from, frame);
    let Some(layout) = Layout::of(&expected) else {
        assert_eq!((processed, exit), (Processed::NotEtherCat, None));
        assert_eq!(frame, expected);
        return;
    };
    let intact = layout.is_intact(&expected);
    match processed {
        Processed::Returned => assert!(intact && exit.is_some()),
        Processed::Malformed => assert!(!intact && exit.is_some()),
        Processed::Lost => assert!(exit.is_none()),
        Processed::NotEtherCat => panic!("it was EtherCAT"),
    }
    expected[SOURCE_ADDRESS] |= frame[SOURCE_ADDRESS] & PROCESSED;
    let (mut before, mut after) = (layout.walk(), layout.walk());
    while let (Some(mut before), Some(after)) = (before.next_mut(&mut expected), after.next(frame)) {
        allow(&mut before, &after);
    }
    assert_eq!(frame, expected, "more has changed than may");
}

/// Makes those changes to a datagram that drives may have made, after a look at them.
fn allow(datagram: &mut Datagram<&mut [u8]>, after: &Datagram<&[u8]>) {
    let counted = after.working_counter().wrapping_sub(datagram.working_counter());
    assert!(usize::from(counted) <= MOST_COUNTED * DRIVES, "working counter grew by {counted}");
    datagram.add_working_counter(counted);
    let passed = after.adp().wrapping_sub(datagram.adp());
    assert!(usize::from(passed) <= DRIVES, "position grew by {passed}");
    assert!(passed == 0 || counts_positions(datagram.command()), "address changed");
    for _ in 0..passed {
        datagram.increment_adp();
    }
    if after.is_circulating() {
        datagram.set_circulating();
    }
    datagram.add_events(after.events());
    assert_eq!(datagram.data().len(), after.data().len(), "length changed");
    datagram.data_mut().copy_from_slice(after.data());
}

const fn counts_positions(command: Command) -> bool {
    matches!(
        command,
        Command::Aprd | Command::Apwr | Command::Aprw | Command::Armw | Command::Brd | Command::Bwr | Command::Brw
    )
}
