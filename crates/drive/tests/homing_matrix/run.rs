//! A homing run, recorded tick by tick, and whether it went by the legs it should.

use crate::expected::{AXIS, Axis, Edge, Leg};
use crate::rig::{IN_HOME, IN_NEGATIVE_LIMIT, IN_POSITIVE_LIMIT, Rig, Travel};

pub const RUNNING: (bool, bool, bool) = (false, false, false);
pub const IDLE: (bool, bool, bool) = (false, false, true);
pub const DONE: (bool, bool, bool) = (false, true, true);

/// Speeds of a run, in pulses/s, and its axis.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    pub fast: u32,
    pub slow: u32,
    pub axis: Axis,
    /// 0x204B, in ticks.
    pub filter: u16,
}

pub const PACE: Pace = Pace {
    fast: 10_000,
    slow: 2_000,
    axis: AXIS,
    filter: 0,
};

/// 0x609A and 0x6085.
pub const ACCELERATION: u32 = 10_000_000;
pub const STOP: i32 = 5_000_000;
/// 0x607C.
pub const OFFSET: i32 = 7_777;

/// A drive in Operation Enabled and homing mode, its counter at a position of its own.
pub fn ready(pace: &Pace) -> Rig {
    let mut rig = Rig::enabled(6);
    rig.objects.homing_speed_fast = pace.fast;
    rig.objects.homing_speed_slow = pace.slow;
    rig.objects.homing_acceleration = ACCELERATION;
    rig.objects.quick_stop_deceleration = STOP;
    rig.objects.home_offset = OFFSET;
    rig.objects.input_filter = pace.filter;
    let [negative, left, right, positive] = pace.axis.map(f64::from);
    rig.travel = Some(Travel {
        negative_limit_below: negative,
        positive_limit_from: positive,
        home: left..right,
    });
    rig
}

/// `ready`, with the shaft at `start`.
pub fn ready_at(ready: &Rig, start: i32, variant: u16, method: i8) -> Rig {
    let mut rig = ready.clone();
    rig.shaft = start.into();
    rig.objects.homing_variant = variant;
    rig.objects.homing_method = method;
    rig.ticks(2 + usize::from(rig.objects.input_filter));
    assert_eq!(rig.homing_bits(), IDLE);
    rig
}

/// A tick of a run.
#[derive(Clone, Copy, Debug)]
pub struct Moment {
    /// Where the shaft was when the inputs were sampled, and what the counter's whole pulses made of it, in the axis' pulses.
    pub at: f64,
    pub pulse: i32,
    pub levels: u8,
    /// The speed commanded by this tick.
    pub velocity: i32,
    pub bits: (bool, bool, bool),
}

/// Runs until bit 10 is set.
pub fn record(rig: &mut Rig) -> Vec<Moment> {
    let origin = rig.shaft.round() as i32 - rig.objects.position;
    let mut moments = Vec::new();
    rig.objects.controlword = 0x1F;
    while moments.len() < 400_000 {
        let (at, pulse) = (rig.shaft, rig.objects.position + origin);
        rig.tick();
        let bits = rig.homing_bits();
        moments.push(Moment {
            at,
            pulse,
            levels: rig.objects.input_level as u8,
            velocity: rig.pulses_per_second(),
            bits,
        });
        if bits.2 {
            return moments;
        }
    }
    panic!("an endless search");
}

/// The edge between two moments, and the direction in which it was passed.
pub fn edge_between(before: &Moment, after: &Moment, axis: &Axis) -> Option<(Edge, i32)> {
    let on = |bit: u8| after.levels & bit != 0;
    let nearer_left = (after.at - f64::from(axis[1])).abs() < (after.at - f64::from(axis[2])).abs();
    let (place, on) = match before.levels ^ after.levels {
        0 => return None,
        IN_NEGATIVE_LIMIT => (0, on(IN_NEGATIVE_LIMIT)),
        IN_POSITIVE_LIMIT => (3, on(IN_POSITIVE_LIMIT)),
        IN_HOME => (if nearer_left { 1 } else { 2 }, on(IN_HOME)),
        levels => panic!("several edges in a tick: {levels:06b}"),
    };
    Some((Edge { place, on }, (after.at - before.at).signum() as i32))
}

/// Asserts that the run went by `legs`, one after the other and no others; returns the tick that saw the last edge.
pub fn follow(moments: &[Moment], legs: &[Leg], pace: &Pace) -> usize {
    // Where the present leg begins, and how fast.
    let (mut begin, mut before) = (1, 0.0);
    let mut seen = 0;
    for leg in legs {
        let raw = (begin..moments.len())
            .find(|&tick| edge_between(&moments[tick - 1], &moments[tick], &pace.axis) == Some((leg.edge, leg.direction)))
            .unwrap_or_else(|| panic!("no {leg:?}"));
        let step = (moments[raw].at - moments[raw - 1].at).abs();
        let past = pace.past(leg, &moments[raw]);
        assert!((-1e-6..=step + 1e-6).contains(&past), "{leg:?} is {past} past its switch");

        seen = raw + usize::from(pace.filter);
        let speed = f64::from(pace.speed(leg));
        let (slower, faster) = (speed.min(before), speed.max(before));
        let velocity_in = |tick: usize| f64::from(moments[tick].velocity * leg.direction);
        // A leg that begins in motion must not come to rest in between.
        let stray = (begin..seen).find(|&tick| !(slower..=faster).contains(&velocity_in(tick)));
        assert_eq!(stray.map(velocity_in), None, "{leg:?}");
        let velocity = velocity_in(seen - 1);
        let travelled = (moments[seen].at - moments[begin - 1].at).abs();
        let needed = (faster * faster - slower * slower) / 2.0 / f64::from(ACCELERATION) + faster / 10_000.0;
        assert!(velocity == speed || travelled <= needed, "{leg:?} ends at {velocity}");

        begin = seen + 1;
        before = velocity;
        if leg.rests {
            begin += moments[seen..].iter().position(|moment| moment.velocity == 0).expect("standstill");
            before = 0.0;
        }
    }
    let runs_in = |directions: &mut dyn Iterator<Item = i32>| {
        let mut directions: Vec<i32> = directions.filter(|&direction| direction != 0).collect();
        directions.dedup();
        directions
    };
    assert_eq!(
        runs_in(&mut moments.iter().map(|moment| moment.velocity.signum())),
        runs_in(&mut legs.iter().map(|leg| leg.direction)),
        "no other legs"
    );
    seen
}

impl Pace {
    pub fn speed(&self, leg: &Leg) -> u32 {
        if leg.fast { self.fast } else { self.slow }
    }

    /// How far the shaft has gone beyond the switch that ends `leg`, in the direction of travel.
    pub fn past(&self, leg: &Leg, moment: &Moment) -> f64 {
        (moment.at - f64::from(self.axis[leg.edge.place])) * f64::from(leg.direction)
    }

    /// How far an edge passed at a speed may lie behind its switch: it counts with the first tick after it, and after the filter's time.
    pub fn delay(&self, speed: u32) -> f64 {
        f64::from(self.filter + 1) * f64::from(speed) / 20_000.0
    }
}
