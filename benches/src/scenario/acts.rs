//! What master and world do in a scenario: how it begins, and what comes before each tick.

use board::{Millivolts, Nanos};
use plant::{PlantConfig, Travel, Turns, motors};
use usr2556e::master::process_data::controlword::{CHANGE_ON_SET_POINT, ENABLE_OPERATION, FAULT_RESET, HALT, IMMEDIATELY, RELATIVE, START};
use usr2556e::master::process_data::{mode, towards_enabled};

use crate::firmware_core::Core;

const MILLISECOND: u32 = (1_000_000 / board::TICK.0) as u32;

/// An axis whose limits are far away, with flags for the probes near the middle.
pub fn axis() -> PlantConfig {
    let mut config = PlantConfig {
        travel: Travel {
            negative_limit: Turns(-500.0),
            positive_limit: Turns(500.0),
            home: (Turns(0.2), Turns(0.5)),
            stops: (Turns(-600.0), Turns(600.0)),
        },
        ..PlantConfig::default()
    };
    config.flags[0] = Some((Turns(0.05), Turns(0.4)));
    config.flags[1] = Some((Turns(-0.1), Turns(0.1)));
    config
}

/// The same axis with a motor of three phases.
pub fn three_phase_axis() -> PlantConfig {
    PlantConfig {
        motor: motors::THREE_PHASE_57,
        ..axis()
    }
}

pub fn enabled(mode: i8) -> Core {
    let mut core = Core::new(axis());
    core.enable(mode);
    core
}

pub fn power_up(core: &mut Core, _: u32) {
    core.objects.mode = mode::PROFILE_POSITION;
    if !core.is_ready() {
        core.objects.controlword = towards_enabled(core.objects.statusword, core.objects.controlword);
    }
}

/// What may change at standstill does, in the same tick.
pub fn parameters(core: &mut Core, tick: u32) {
    if !tick.is_multiple_of(10 * MILLISECOND) {
        return;
    }
    let odd = tick / (10 * MILLISECOND) % 2;
    let objects = &mut core.objects;
    objects.resolution = [10_000, 51_200][odd as usize];
    objects.run_reverse = odd as u16;
    objects.filter_time = [25_600, 12_850][odd as usize];
    objects.peak_current = [3000, 5600][odd as usize];
    objects.input_polarity = [0x3F, 0x1C][odd as usize];
    objects.zero_position = 1;
}

/// A set-point every 30 ms in each of the ways there are, with another speed and ramp each; a halt now and then.
pub fn profile_position(core: &mut Core, tick: u32) {
    const WAYS: [u16; 6] = [
        IMMEDIATELY,
        CHANGE_ON_SET_POINT,
        CHANGE_ON_SET_POINT,
        IMMEDIATELY | RELATIVE,
        HALT,
        IMMEDIATELY,
    ];
    const PERIOD: u32 = 30 * MILLISECOND;
    let number = (tick / PERIOD) as usize;
    let objects = &mut core.objects;
    if tick % PERIOD == PERIOD / 2 {
        objects.controlword = ENABLE_OPERATION;
    } else if tick.is_multiple_of(PERIOD) {
        objects.target_position = [7000, 9000, -3000, -6001, 5, -4321, 0][number % 7];
        objects.profile_velocity = [100_000, 120_000, 90_001, 100_003][number % 4];
        objects.profile_acceleration = [6_000_000, 7_000_001, 4_999_999][number % 3];
        objects.profile_deceleration = [6_000_000, 4_234_567, 5_000_003, 7_000_000][number % 4];
        objects.controlword = ENABLE_OPERATION | START | WAYS[number % WAYS.len()];
    }
}

/// Another speed every 50 ms, most of them in the other direction, and a halt now and then.
pub fn profile_velocity(core: &mut Core, tick: u32) {
    if !tick.is_multiple_of(50 * MILLISECOND) {
        return;
    }
    let number = (tick / (50 * MILLISECOND)) as usize;
    let objects = &mut core.objects;
    objects.target_velocity = [100_000, -110_001, 99_999, 30_003, -1, 0][number % 6];
    objects.profile_acceleration = [6_000_000, 7_000_001, 4_000_003][number % 3];
    objects.profile_deceleration = [7_000_000, 6_345_678, 5_000_009][number % 3];
    objects.controlword = if number % 5 == 4 {
        ENABLE_OPERATION | HALT
    } else {
        ENABLE_OPERATION
    };
}

/// Positions of an axis that swings to and fro within 100 ms, by up to 0.2 turns and 16 turns a second: parabolas, which need no float
/// function.
pub fn swing(tick: u32) -> i32 {
    const HALF: u32 = 1000;
    let (half, at) = (tick / HALF, i64::from(tick % HALF));
    let length = i64::from(HALF);
    let height = 2000 * 4 * at * (length - at) / (length * length);
    (if half.is_multiple_of(2) { height } else { -height }) as i32
}

pub fn cyclic_1_ms(core: &mut Core, tick: u32) {
    if tick.is_multiple_of(MILLISECOND) {
        core.objects.target_position = swing(tick);
        core.set_point = Some(Nanos(1_000_000));
    }
}

/// Every third target comes a tick late, every 40th never.
pub fn cyclic_500_us(core: &mut Core, tick: u32) {
    const CYCLE: u32 = MILLISECOND / 2;
    let late = u32::from((tick / CYCLE).is_multiple_of(3));
    if tick % CYCLE == late && tick / CYCLE % 40 != 39 {
        core.objects.target_position = swing(tick);
        core.set_point = Some(Nanos(500_000));
    }
}

/// An axis of three turns, on the wrong side of its home switch, that looks for home.
pub fn homing(method: i8) -> Core {
    let mut config = axis();
    config.travel = Travel {
        negative_limit: Turns(-1.5),
        positive_limit: Turns(1.5),
        home: (Turns(-0.4), Turns(-0.1)),
        stops: (Turns(-4.0), Turns(4.0)),
    };
    config.start = Turns(0.8);
    let mut core = Core::new(config);
    core.objects.homing_method = method;
    core.objects.homing_variant = 1;
    core.objects.homing_speed_fast = 100_000;
    core.objects.homing_speed_slow = 50_000;
    core.objects.homing_acceleration = 4_000_000;
    core.objects.quick_stop_deceleration = 6_000_000;
    core.enable(mode::HOMING);
    core
}

pub fn start_once(core: &mut Core, _: u32) {
    core.objects.controlword = ENABLE_OPERATION | START;
}

/// PV, PP, CSP and homing in turn, each for 15 ms and none at rest when the next one begins. Targets lie as far ahead as the mode wants
/// them: in CSP a cycle's way, else further than the axis gets.
pub fn changing_modes(core: &mut Core, tick: u32) {
    const MODES: [i8; 4] = [mode::PROFILE_VELOCITY, mode::PROFILE_POSITION, mode::CYCLIC_POSITION, mode::HOMING];
    if !tick.is_multiple_of(MILLISECOND) {
        return;
    }
    let number = (tick / (15 * MILLISECOND)) as usize;
    let objects = &mut core.objects;
    objects.profile_acceleration = 5_000_000;
    objects.profile_deceleration = 4_000_000;
    objects.profile_velocity = 90_000;
    objects.target_velocity = 120_000;
    objects.homing_method = 27;
    objects.mode = MODES[number % MODES.len()];
    let way = if objects.mode == mode::CYCLIC_POSITION {
        swing(tick) / 20
    } else {
        4 * swing(tick)
    };
    objects.target_position = objects.position.wrapping_add(way);
    objects.controlword = match (tick / MILLISECOND).is_multiple_of(2) {
        true => ENABLE_OPERATION,
        false => ENABLE_OPERATION | START | IMMEDIATELY,
    };
    core.set_point = Some(Nanos(1_000_000));
}

/// Motion that ends by over-voltage, by the network, by emergency stop, by Shutdown; the master then enables it again.
pub fn faults(core: &mut Core, tick: u32) {
    const PERIOD: u32 = 100 * MILLISECOND;
    if tick == 0 {
        core.objects.output_1_function = 1;
        core.objects.soft_lock_time = 0;
        core.objects.filter_time = 6400;
        core.objects.target_velocity = 30_000;
        core.objects.profile_acceleration = 5_000_000;
        core.objects.profile_deceleration = 5_000_000;
        core.objects.quick_stop_deceleration = 9_000_000;
    }
    let (number, at) = (tick / PERIOD % 4, tick % PERIOD);
    let trouble = (300..400).contains(&at);
    core.plant
        .set_supply(Millivolts(if trouble && number == 0 { 65_000 } else { 36_000 }));
    core.drive.set_network(!(trouble && number == 1));
    core.hold(if trouble && number == 2 { 1 << 5 } else { 0 });
    core.objects.controlword = match at {
        300..1600 if number == 3 => ENABLE_OPERATION & !1,
        1600 => FAULT_RESET,
        _ => towards_enabled(core.objects.statusword, core.objects.controlword),
    };
}

pub fn all_inputs_ready() -> Core {
    let mut core = enabled(mode::PROFILE_POSITION);
    unfilter(&mut core);
    core
}

/// Inputs without filter: three of probe 1 and three of probe 2.
pub fn unfilter(core: &mut Core) {
    let objects = &mut core.objects;
    objects.input_filter = 0;
    objects.input_3_function = 7;
    objects.input_4_function = 8;
    objects.input_5_function = 7;
    objects.input_6_function = 8;
}

/// From power-up, as soon as that is over, as [`all_inputs`].
pub fn three_phases(core: &mut Core, tick: u32) {
    if tick == 0 {
        core.objects.motor_type = 1;
        core.objects.peak_current = 5600;
    }
    if core.is_ready() {
        unfilter(core);
        all_inputs(core, tick);
    } else {
        power_up(core, tick);
    }
}

/// All inputs change in the same tick, every other tick, while the axis follows set-points.
pub fn all_inputs(core: &mut Core, tick: u32) {
    profile_position(core, tick);
    core.hold(if (tick / 2).is_multiple_of(2) { 0x3F } else { 0 });
}
