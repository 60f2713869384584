//! Whatever a master writes, in whatever order: the drive keeps its invariants and does not panic.

mod rig;

use board::{Millivolts, Nanos, PowerStage};
use dictionary::Objects;
use drive::PowerState::*;
use drive::{DriveObjects, slots};
use proptest::prelude::*;
use rig::Rig;

#[derive(Clone, Debug)]
enum Step {
    Write(usize, u64),
    Controlword(u16),
    Mode(i8),
    Inputs(u8),
    Bus(i32),
    Network(bool),
    Synchronize(Option<u64>),
    Ticks(u16),
}

fn write() -> impl Strategy<Value = Step> {
    let value = prop_oneof![any::<u64>(), 0u64..40, Just(u64::MAX)];
    (0..DriveObjects::ENTRIES.len(), value).prop_map(|(slot, value)| Step::Write(slot, value))
}

fn steps() -> impl Strategy<Value = Vec<Step>> {
    let step = prop_oneof![
        6 => write(),
        6 => prop_oneof![any::<u16>(), Just(0x06), Just(0x0F), Just(0x1F), Just(0x5F), Just(0x7F), Just(0x80)]
            .prop_map(Step::Controlword),
        2 => prop_oneof![Just(1i8), Just(3), Just(6), Just(8), any::<i8>()].prop_map(Step::Mode),
        1 => prop_oneof![3 => 0u8..32, 1 => any::<u8>()].prop_map(Step::Inputs),
        1 => prop_oneof![9 => Just(24_000), 1 => any::<i32>()].prop_map(Step::Bus),
        1 => prop::bool::weighted(0.9).prop_map(Step::Network),
        2 => prop_oneof![Just(None), Just(Some(1_000_000)), any::<u64>().prop_map(Some)].prop_map(Step::Synchronize),
        6 => (0u16..300).prop_map(Step::Ticks),
    ];
    prop::collection::vec(step, 1..80)
}

fn apply(rig: &mut Rig, step: &Step) -> usize {
    match *step {
        Step::Write(slot, value) => {
            let entry = &DriveObjects::ENTRIES[slot];
            let data = &value.to_le_bytes()[..entry.size()];
            if entry.access.is_writable() && rig.drive.check_write(&rig.objects, slot, data).is_ok() {
                let _ = rig.objects.store(slot, data);
            }
        }
        Step::Controlword(word) => rig.objects.controlword = word,
        Step::Mode(mode) => rig.objects.mode = mode,
        Step::Inputs(inputs) => rig.inputs = inputs,
        Step::Bus(bus) => rig.bus = Millivolts(bus),
        Step::Network(operational) => rig.drive.set_network(operational),
        Step::Synchronize(cycle) => rig.drive.synchronize(&rig.objects, cycle.map(Nanos)),
        Step::Ticks(count) => return count.into(),
    }
    1
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1_000))]

    #[test]
    fn the_power_stage_is_on_in_powered_states_only_and_no_current_exceeds_the_peak(steps in steps()) {
        let mut rig = Rig::at_power_up();
        rig.drive.set_network(true);
        rig.objects.soft_lock_time = 3;
        for step in &steps {
            for _ in 0..apply(&mut rig, step) {
                rig.tick();
                let powered = matches!(rig.state(), OperationEnabled | QuickStopActive | FaultReactionActive);
                prop_assert!(powered || rig.actuators.stage == PowerStage::Off);
                if let Some(amplitude) = rig.amplitude() {
                    prop_assert!((0..=i32::from(rig.objects.peak_current)).contains(&amplitude));
                }
                prop_assert_eq!(rig.drive.position().pulses(), rig.objects.position);
                prop_assert!([0, 1, 3, 6, 8].contains(&rig.objects.mode_display));
                prop_assert_eq!(rig.state() == Fault || rig.state() == FaultReactionActive, rig.objects.error_code != 0);
            }
        }
        // Whatever came before, the drive can be brought back to work.
        rig.inputs = 0;
        rig.bus = Millivolts(24_000);
        rig.drive.set_network(true);
        rig.objects.input_polarity = 0x3F;
        rig.objects.input_filter = 0;
        // From some speeds, a ramp takes minutes.
        rig.objects.fault_reaction_option = 0;
        rig.objects.quick_stop_option = 0;
        rig.command(0x00);
        rig.ticks(4);
        rig.command(0x80);
        rig.command(0x00);
        rig.command(0x06);
        rig.command(0x0F);
        rig.command(0x0F);
        prop_assert_eq!(rig.state(), OperationEnabled);
    }
}

#[test]
fn relative_set_points_on_top_of_one_another_stay_within_reach() {
    let mut rig = Rig::enabled(1);
    rig.objects.store(slots::target_position, &i32::MIN.to_le_bytes()).unwrap();
    for _ in 0..100 {
        rig.command(0x4F);
        rig.command(0x7F);
    }
    assert!(rig.status(12));
    rig.objects.target_position = 0;
    rig.command(0x0F);
    rig.command(0x3F);
    rig.until("there", |rig| rig.status(10));
    assert_eq!(rig.objects.position, 0);
}
