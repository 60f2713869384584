mod rig;
use rig::Rig;
use board::*;
#[test]
fn d() {
    let mut rig = Rig::at_power_up();
    rig.drive.set_network(true);
    rig.objects.soft_lock_time = 3;
    println!("{:?} {:?}", drive::DriveObjects::ENTRIES[84].name, drive::DriveObjects::ENTRIES[82].name);
    rig.objects.homing_acceleration = u32::MAX; rig.objects.homing_speed_fast=32789633;
    rig.tick(); rig.tick();
    rig.objects.mode=6; rig.tick();
    rig.command(31); rig.ticks(209);
    rig.inputs=16; rig.tick(); rig.objects.mode=8; rig.tick(); rig.ticks(189); 
    println!("{:?} v {} pos {:?}", rig.state(), rig.pulses_per_second(), rig.drive.position());
    rig.command(10244); println!("{:?}",rig.state()); rig.command(15); rig.tick(); rig.tick();
    println!("{:?} v {} pos {:?}", rig.state(), rig.pulses_per_second(), rig.drive.position());
    rig.drive.synchronize(&rig.objects, Some(Nanos(1000000)));
    rig.tick();
    rig.bus=Millivolts(60001); rig.tick(); rig.tick();
    println!("{:?} v {} pos {:?}", rig.state(), rig.pulses_per_second(), rig.drive.position());
        rig.inputs = 0;
        rig.bus = Millivolts(24_000);
        rig.objects.quick_stop_deceleration = i32::MAX;
        rig.objects.profile_deceleration = i32::MAX;
        rig.objects.homing_acceleration = u32::MAX;
        rig.objects.input_filter = 0;
        rig.command(0x00);
    for _ in 0..10 { rig.ticks(400);
    println!("{:?} v {} pos {:?}", rig.state(), rig.drive.velocity().sub_pulses_per_tick(), rig.drive.position()); }
}
