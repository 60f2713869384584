//! The objects of the drive: one table from which SDO, PDO mapping, persistence and every export derive.

dictionary::object_dictionary! {
    /// Manufacturer's objects from 0x2000 and profile objects from 0x6000 (manual chapter 2), with a typed field each.
    pub struct DriveObjects in slots {
        /// Peak of the sinusoidal phase current in operation (manual 2.2.1).
        0x2000:0 peak_current: u16 = 3000, RW | RX_PDO | TX_PDO | SAVED, in 100..=6000, unit "mA", "Peak Current";
        /// Pulses for one revolution of the motor; cannot be changed while the motor moves (manual 2.2.2).
        0x2001:0 resolution: u16 = 10000, RW | RX_PDO | TX_PDO | SAVED, in 200..=65535, unit "Pulse/rev", "Motor Resolution";
        /// Time without motion after which the motor gets its standby current (manual 2.2.3).
        0x2002:0 idle_time: u16 = 500, RW | RX_PDO | TX_PDO | SAVED, in 200..=65535, unit "ms", "Idle Time";
        /// Standby current in percent of the operating current 0x2000 (manual 2.2.4).
        0x2003:0 idle_current: u16 = 50, RW | RX_PDO | TX_PDO | SAVED, in 0..=100, unit "%", "Idle Current Percent";
        /// Function of OUT1: 0 custom, 1 alarm, 2 brake, 3 in place (manual 2.2.5).
        0x2005:1 output_1_function: u16 = 1, RW | RX_PDO | TX_PDO | SAVED, in 0..=3, "Output 1 Function" of "Outputs Function";
        /// Function of OUT2: 0 custom, 1 alarm, 2 brake, 3 in place (manual 2.2.5).
        0x2005:2 output_2_function: u16 = 2, RW | RX_PDO | TX_PDO | SAVED, in 0..=3, "Output 2 Function" of "Outputs Function";
        /// Polarity of the outputs, bit 0 OUT1, bit 1 OUT2: 0 normally closed, 1 normally open (manual 2.2.6).
        0x2006:0 output_polarity: u16 = 3, RW | RX_PDO | TX_PDO | SAVED, in 0..=3, "Outputs Polarity";
        /// Function of IN1: 0 general, 1 CW limit, 2 CCW limit, 3 home, 4 fault clearance, 5 emergency stop,
        /// 6 motor offline, 7 probe 1, 8 probe 2 (manual 2.2.7).
        0x2007:1 input_1_function: u16 = 0, RW | RX_PDO | TX_PDO | SAVED, in 0..=8, "Input 1 Function" of "Inputs Function";
        /// Function of IN2: 0 general, 1 CW limit, 2 CCW limit, 3 home, 4 fault clearance, 5 emergency stop,
        /// 6 motor offline, 7 probe 1, 8 probe 2 (manual 2.2.7).
        0x2007:2 input_2_function: u16 = 0, RW | RX_PDO | TX_PDO | SAVED, in 0..=8, "Input 2 Function" of "Inputs Function";
        /// Function of IN3: 0 general, 1 CW limit, 2 CCW limit, 3 home, 4 fault clearance, 5 emergency stop,
        /// 6 motor offline, 7 probe 1, 8 probe 2 (manual 2.2.7).
        0x2007:3 input_3_function: u16 = 1, RW | RX_PDO | TX_PDO | SAVED, in 0..=8, "Input 3 Function" of "Inputs Function";
        /// Function of IN4: 0 general, 1 CW limit, 2 CCW limit, 3 home, 4 fault clearance, 5 emergency stop,
        /// 6 motor offline, 7 probe 1, 8 probe 2 (manual 2.2.7).
        0x2007:4 input_4_function: u16 = 2, RW | RX_PDO | TX_PDO | SAVED, in 0..=8, "Input 4 Function" of "Inputs Function";
        /// Function of IN5: 0 general, 1 CW limit, 2 CCW limit, 3 home, 4 fault clearance, 5 emergency stop,
        /// 6 motor offline, 7 probe 1, 8 probe 2 (manual 2.2.7).
        0x2007:5 input_5_function: u16 = 3, RW | RX_PDO | TX_PDO | SAVED, in 0..=8, "Input 5 Function" of "Inputs Function";
        /// Function of IN6: 0 general, 1 CW limit, 2 CCW limit, 3 home, 4 fault clearance, 5 emergency stop,
        /// 6 motor offline, 7 probe 1, 8 probe 2 (manual 2.2.7).
        0x2007:6 input_6_function: u16 = 6, RW | RX_PDO | TX_PDO | SAVED, in 0..=8, "Input 6 Function" of "Inputs Function";
        /// Polarity of the inputs, bit 0 IN1 to bit 5 IN6: 0 normally closed, 1 normally open (manual 2.2.8).
        /// A normally open input is valid while its opto-coupler carries current, a normally closed one while it carries none.
        0x2008:0 input_polarity: u16 = 0x3F, RW | RX_PDO | TX_PDO | SAVED, in 0..=0x3F, "Inputs Polarity";
        /// Time of the sliding average filter through which every motion passes; motion lags by it (manual 2.2.9).
        0x2009:0 filter_time: u16 = 6400, RW | RX_PDO | TX_PDO | SAVED, in 0..=25600, unit "us", "Filter Time";
        /// Half of the time in which the current rises when the motor is enabled: the ramp takes twice this value (manual 2.2.10).
        0x200A:0 soft_lock_time: u16 = 1000, RW | RX_PDO | TX_PDO | SAVED, in 0..=65535, unit "50us", "Soft lock Time";
        /// Whether the drive identifies the motor and computes the current loop's gains: 0 no, 1 yes (manual 2.2.11).
        0x200B:1 auto_pi: u16 = 1, RW | RX_PDO | TX_PDO | SAVED, in 0..=1, "AutoPI enable" of "Current loop parameters";
        /// Proportional gain of the current loop in 1/256 V/A; cannot be written while sub-index 1 is 1 (manual 2.2.11).
        0x200B:2 current_loop_kp: u16 = 1000, RW | RX_PDO | TX_PDO | SAVED, in 100..=65535, "Iloop_Kp" of "Current loop parameters";
        /// Integral gain of the current loop in 1/1024 V/A per tick; cannot be written while sub-index 1 is 1 (manual 2.2.11).
        0x200B:3 current_loop_ki: u16 = 200, RW | RX_PDO | TX_PDO | SAVED, in 0..=10000, "Iloop_Ki" of "Current loop parameters";
        /// Anti-windup gain of the current loop, 256 for a tracking time equal to the integration time; cannot be written while sub-index 1 is 1
        /// (manual 2.2.11).
        0x200B:4 current_loop_kc: u16 = 256, RW | RX_PDO | TX_PDO | SAVED, in 0..=1024, "Iloop_Kc" of "Current loop parameters";
        /// 0 two-phase, 1 three-phase stepper motor (manual 2.2.12).
        0x200C:1 motor_type: u16 = 0, RW | RX_PDO | TX_PDO | SAVED, in 0..=1, "Motor type" of "Motor parameters";
        /// Winding resistance as identified (manual 2.2.12).
        0x200C:2 resistance_auto: u16 = 1000, RO | TX_PDO, in 100..=65535, unit "mOhm", "Resistance Auto" of "Motor parameters";
        /// Winding inductance as identified (manual 2.2.12).
        0x200C:3 inductance_auto: u16 = 1, RO | TX_PDO, in 0..=10, unit "mH", "Inductance Auto" of "Motor parameters";
        /// Winding resistance as the user states it (manual 2.2.12).
        0x200C:4 resistance_set: u16 = 1000, RW | RX_PDO | TX_PDO | SAVED, in 0..=10000,
            unit "mOhm", "Resistance Set" of "Motor parameters";
        /// Winding inductance as the user states it (manual 2.2.12).
        0x200C:5 inductance_set: u16 = 1, RW | RX_PDO | TX_PDO | SAVED, in 1..=10, unit "mH", "Inductance Set" of "Motor parameters";
        /// Back-EMF of a winding in mV s/rad of the shaft, for the damper against mid-band instability; 0 switches that off (manual 2.2.12).
        0x200C:6 bemf_coefficient: u16 = 256, RW | RX_PDO | TX_PDO | SAVED, in 0..=1000, "BEMF coefficient" of "Motor parameters";
        /// 1 turns the motor the other way for the same command; cannot be changed while the motor moves (manual 2.2.13).
        0x200D:0 run_reverse: u16 = 0, RW | RX_PDO | TX_PDO | SAVED, in 0..=1, "Invert motor direction";
        /// Active alarms, one bit each (manual 2.2.14).
        0x200E:0 alarm_code: u16 = 0, RO | TX_PDO, "Alarm Code";
        /// Bit 0 enabled, 1 failed, 2 in place, 3 running, 4 homed, 5 ready (manual 2.2.15).
        0x200F:0 status_code: u16 = 0, RO | TX_PDO, "Status Code";
        /// Writing 1 sets the position counter 0x6064 to zero; the drive then returns the object to 0 (manual 2.2.16).
        0x2010:0 zero_position: u16 = 0, RW | RX_PDO | TX_PDO, in 0..=1, "Zero Position";
        /// 0 open loop. The manual also defines 1 and 2, closed loop, which this drive does not accept (manual 2.2.17).
        0x2011:0 control_mode: u16 = 0, RW | RX_PDO | TX_PDO | SAVED, in 0..=0, "Control mode";
        /// Reserved for closed-loop drives, never writable here (manual 2.2.18).
        0x2020:0 encoder_resolution: u16 = 4000, RO | TX_PDO, "Encoder Resolution";
        /// Reserved for closed-loop drives, never writable here (manual 2.2.18).
        0x2021:0 encoder_counter: u16 = 0, RO | TX_PDO, "Encoder Counter in one rev";
        /// Reserved for closed-loop drives, never writable here (manual 2.2.18).
        0x2022:0 position_error_limit: u32 = 4000, RO | TX_PDO, "Position trace error Limit";
        /// Reserved for closed-loop drives, never writable here (manual 2.2.18).
        0x2023:1 position_loop_kp: u16 = 2000, RO | TX_PDO, "PosLoop_Kp" of "Position loop parameters";
        /// Reserved for closed-loop drives, never writable here (manual 2.2.18).
        0x2023:2 position_loop_ki: u16 = 100, RO | TX_PDO, "PosLoop_Ki" of "Position loop parameters";
        /// Reserved for closed-loop drives, never writable here (manual 2.2.18).
        0x2023:3 position_loop_kd: u16 = 200, RO | TX_PDO, "PosLoop_Kd" of "Position loop parameters";
        /// Reserved for closed-loop drives, never writable here (manual 2.2.18).
        0x2023:4 position_loop_kvff: u16 = 30, RO | TX_PDO, "PosLoop_Kvff" of "Position loop parameters";
        /// Reserved for closed-loop drives, never writable here (manual 2.2.18).
        0x2023:5 position_loop_kdi: u16 = 0, RO | TX_PDO, "PosLoop_Kdi" of "Position loop parameters";
        /// Reserved for closed-loop drives, never writable here (manual 2.2.18).
        0x2024:1 in_position_mode: u16 = 0, RO | TX_PDO, "InPosMode" of "InPosition parameters";
        /// Reserved for closed-loop drives, never writable here (manual 2.2.18).
        0x2024:2 in_position_count: u16 = 10, RO | TX_PDO, "InPosCnt" of "InPosition parameters";
        /// Reserved for closed-loop drives, never writable here (manual 2.2.18).
        0x2024:3 in_position_time: u16 = 1000, RO | TX_PDO, "InPosTime" of "InPosition parameters";
        /// Reserved for closed-loop drives, never writable here (manual 2.2.18).
        0x2025:1 servo_filter_1: u16 = 200, RO | TX_PDO, "FV1_HZ" of "Servo filters";
        /// Reserved for closed-loop drives, never writable here (manual 2.2.18).
        0x2025:2 servo_filter_2: u16 = 600, RO | TX_PDO, "FV2_HZ" of "Servo filters";
        /// Reserved for closed-loop drives, never writable here (manual 2.2.18).
        0x2025:3 servo_filter_output: u16 = 2000, RO | TX_PDO, "FPOUT_HZ" of "Servo filters";
        /// Reserved for closed-loop drives, never writable here (manual 2.2.18).
        0x2026:1 pvia_kp: u16 = 2000, RO | TX_PDO, "PVIA_Kp" of "Servo mode2 parameters";
        /// Reserved for closed-loop drives, never writable here (manual 2.2.18).
        0x2026:2 pvia_ki: u16 = 1000, RO | TX_PDO, "PVIA_Ki" of "Servo mode2 parameters";
        /// Reserved for closed-loop drives, never writable here (manual 2.2.18).
        0x2026:3 pvia_kv1: u16 = 200, RO | TX_PDO, "PVIA_Kv1" of "Servo mode2 parameters";
        /// Reserved for closed-loop drives, never writable here (manual 2.2.18).
        0x2026:4 pvia_kv2: u16 = 400, RO | TX_PDO, "PVIA_Kv2" of "Servo mode2 parameters";
        /// Reserved for closed-loop drives, never writable here (manual 2.2.18).
        0x2026:5 pvia_kvff: u16 = 0, RO | TX_PDO, "PVIA_Kvff" of "Servo mode2 parameters";
        /// Commanded speed of the motor (manual 2.2.19).
        0x2043:0 speed_reference: i16 = 0, RO | TX_PDO, in -3000..=3000, unit "RPM", "Speed Reference";
        /// Speed of the motor; without an encoder, the commanded one (manual 2.2.20).
        0x2044:0 speed_feedback: i16 = 0, RO | TX_PDO, in -3000..=3000, unit "RPM", "Speed Feedback";
        /// Supply voltage of the power stage (manual 2.2.21).
        0x2048:0 bus_voltage: u16 = 0, RO | TX_PDO, unit "10mV", "Bus Voltage";
        /// Electrical level of the inputs, bit 0 IN1 to bit 5 IN6: 1 means a signal, before filter and polarity (manual 2.2.22).
        0x2049:0 input_level: u16 = 0, RO | TX_PDO, "Input Level";
        /// Electrical level of the outputs, bit 0 OUT1, bit 1 OUT2: 0 while the output conducts, 1 while it does not (manual 2.2.23).
        0x204A:0 output_level: u16 = 0, RO | TX_PDO, "Output Level";
        /// Time that an input has to be steady before it counts (manual 2.2.24).
        0x204B:0 input_filter: u16 = 60, RW, unit "50us", "IN Port filter";
        /// Which of the manual's two variants of the homing methods runs; variant 1 is reconstructed (manual 2.2.25, 2.4.6).
        0x204C:0 homing_variant: u16 = 0, RW, in 0..=1, "HM method select";
        /// Which detections are on; bit 7 is phase loss (manual, revision V202).
        0x2056:0 error_detection: u16 = 0x0080, RW | RX_PDO, "Error Detect enable";
        /// Amplitude of the harmonic against the first resonance, in per mille of the current (manual 2.2.26).
        0x2060:0 harmonic_amplitude: u16 = 0, RW | RX_PDO | TX_PDO | SAVED, in 0..=1000, "Amplitude of First Anti-Vibration";
        /// Phase of the harmonic in winding A, in 1/1024 periods (manual 2.2.27).
        0x2061:0 harmonic_phase_a: u16 = 0, RW | RX_PDO | TX_PDO | SAVED, in 0..=1024, "Phase A of First Anti-Vibration";
        /// Phase of the harmonic in winding B, in 1/1024 periods (manual 2.2.28).
        0x2062:0 harmonic_phase_b: u16 = 0, RW | RX_PDO | TX_PDO | SAVED, in 0..=1024, "Phase B of First Anti-Vibration";
        /// Station alias that the drive takes at power-up while 0x2151 is 1; otherwise the one in the EEPROM (manual 1.5).
        0x2150:0 alias: u16 = 1001, RW | RX_PDO | TX_PDO | SAVED, "Slave Alias";
        /// Where the station alias comes from: 0 EEPROM, 1 object 0x2150 (manual 1.5).
        0x2151:0 alias_source: u16 = 0, RW | RX_PDO | TX_PDO | SAVED, in 0..=1, "Slave Alias Source";
        /// Code of the last fault, 0 after a fault reset (manual 2.3.1).
        0x603F:0 error_code: u16 = 0, RO | TX_PDO, "Error Code";
        /// Commands to the power state machine and to the mode (manual 2.3.2).
        0x6040:0 controlword: u16 = 0, RW | RX_PDO | TX_PDO, "Control Word";
        /// State of the power state machine and of the mode (manual 2.3.3).
        0x6041:0 statusword: u16 = 0, RO | TX_PDO, "Status Word";
        /// How a quick stop stops: 0 power off, 1 with 0x6084, 2 with 0x6085, then Switch On Disabled; 5 and 6 as 1 and 2, then stay
        /// (CiA 402).
        0x605A:0 quick_stop_option: i16 = 2, RW | RX_PDO | TX_PDO, in 0..=6, "Quickstop Option Code";
        /// How Shutdown leaves Operation Enabled: 0 power off, 1 stop with 0x6084 first (CiA 402).
        0x605B:0 shutdown_option: i16 = 0, RW | RX_PDO | TX_PDO, in 0..=1, "Shutdown Option Code";
        /// How Disable Operation leaves Operation Enabled: 0 power off, 1 stop with 0x6084 first (CiA 402).
        0x605C:0 disable_operation_option: i16 = 1, RW | RX_PDO | TX_PDO, in 0..=1, "Disable Operation Option Code";
        /// How a fault stops: 0 power off, 1 with 0x6084, 2 with 0x6085, then power off (CiA 402).
        0x605E:0 fault_reaction_option: i16 = 1, RW | RX_PDO | TX_PDO, in 0..=2, "Fault Reaction Code";
        /// Wanted mode: 1 PP, 3 PV, 6 homing, 8 CSP (manual 2.3.4). 0 keeps the mode there is.
        0x6060:0 mode: i8 = 0, RW | RX_PDO | TX_PDO, "Mode of Operation";
        /// Mode that is active (manual 2.3.5).
        0x6061:0 mode_display: i8 = 0, RO | TX_PDO, "Mode of Operation Display";
        /// Position of the motor, which in open loop is the commanded one; it wraps (manual 2.3.6).
        0x6064:0 position: i32 = 0, RO | TX_PDO, unit "Pulse", "Position Actual Value";
        /// Speed of the motor, which in open loop is the commanded one (manual 2.3.7).
        0x606C:0 velocity: i32 = 0, RO | TX_PDO, unit "RPM", "Velocity Actual Value";
        /// Measured current in per mille of the operating current 0x2000.
        0x6077:0 torque: i16 = 0, RO | TX_PDO, unit "0.1%", "Torque Actual Value";
        /// Target position of PP and CSP (manual 2.3.8).
        0x607A:0 target_position: i32 = 0, RW | RX_PDO | TX_PDO, unit "Pulse", "Profile Target Position";
        /// What the position counter reads at the home position (manual 2.3.9).
        0x607C:0 home_offset: i32 = 0, RW | RX_PDO | TX_PDO, unit "Pulse", "Home Offset";
        /// Speed of a PP motion (manual 2.3.10).
        0x6081:0 profile_velocity: i32 = 10000, RW | RX_PDO | TX_PDO, in 0..=0x7FFF_FFFF, unit "Pulse/s", "Profile Velocity";
        /// Acceleration in PP and PV (manual 2.3.11). 0 counts as 1.
        0x6083:0 profile_acceleration: i32 = 100000, RW | RX_PDO | TX_PDO, in 0..=0x7FFF_FFFF, unit "Pulse/s2", "Profile Acceleration";
        /// Deceleration in PP and PV (manual 2.3.12). 0 counts as 1.
        0x6084:0 profile_deceleration: i32 = 100000, RW | RX_PDO | TX_PDO, in 0..=0x7FFF_FFFF, unit "Pulse/s2", "Profile Deceleration";
        /// Deceleration of quick stops and at switches (manual 2.3.13). 0 counts as 1.
        0x6085:0 quick_stop_deceleration: i32 = 500000, RW | RX_PDO | TX_PDO, in 0..=0x7FFF_FFFF, unit "Pulse/s2", "Quickstop Deceleration";
        /// Homing method, 17 to 30 or 35 (manual 2.3.14, 2.4.6).
        0x6098:0 homing_method: i8 = 17, RW | RX_PDO | TX_PDO, in 17..=35, "Homing Method";
        /// Homing speed towards a switch (manual 2.3.15).
        0x6099:1 homing_speed_fast: u32 = 10000, RW | RX_PDO | TX_PDO | SAVED,
            unit "Pulse/s", "Homing Velocity (fast)" of "Homing Velocity";
        /// Homing speed towards the deciding edge (manual 2.3.15).
        0x6099:2 homing_speed_slow: u32 = 2000, RW | RX_PDO | TX_PDO | SAVED, unit "Pulse/s", "Homing Velocity (slow)" of "Homing Velocity";
        /// Acceleration and deceleration in homing (manual 2.3.16). 0 counts as 1.
        0x609A:0 homing_acceleration: u32 = 100000, RW | RX_PDO | TX_PDO, unit "Pulse/s2", "Homing Acceleration";
        /// Velocity feed-forward of closed-loop drives; without effect in open loop.
        0x60B1:0 velocity_offset: i32 = 0, RW | RX_PDO, "Velocity offset";
        /// Torque feed-forward of closed-loop drives; without effect in open loop.
        0x60B2:0 torque_offset: i16 = 0, RW | RX_PDO, "Torque offset";
        /// What the touch probes do: bit 0 enables probe 1, 1 latches every edge instead of the first, 4 latches rising edges, 5 falling
        /// ones; bits 8, 9, 12, 13 do so for probe 2 (manual 2.3.17, CiA 402).
        0x60B8:0 probe_function: u16 = 0, RW | RX_PDO | TX_PDO, "Touch Probe Function";
        /// State of the touch probes: bit 0 probe 1 is enabled, 1 a rising edge is latched, 2 a falling one; bits 8 to 10 of probe 2
        /// (manual 2.3.18).
        0x60B9:0 probe_status: u16 = 0, RO | TX_PDO, "Touch Probe Status";
        /// Position at the rising edge of probe 1 (manual 2.3.19).
        0x60BA:0 probe_1_positive: u32 = 0, RO | TX_PDO, unit "Pulse", "Touch Probe Position 1 Positive Value";
        /// Position at the falling edge of probe 1 (manual 2.3.20).
        0x60BB:0 probe_1_negative: u32 = 0, RO | TX_PDO, unit "Pulse", "Touch Probe Position 1 Negative Value";
        /// Position at the rising edge of probe 2 (manual 2.3.21).
        0x60BC:0 probe_2_positive: u32 = 0, RO | TX_PDO, unit "Pulse", "Touch Probe Position 2 Positive Value";
        /// Position at the falling edge of probe 2 (manual 2.3.22).
        0x60BD:0 probe_2_negative: u32 = 0, RO | TX_PDO, unit "Pulse", "Touch Probe Position 2 Negative Value";
        /// Number of rising edges that probe 1 has latched.
        0x60D5:0 probe_1_positive_count: u16 = 0, RO | TX_PDO, "Touch Probe 1 Positive Counter";
        /// Number of falling edges that probe 1 has latched.
        0x60D6:0 probe_1_negative_count: u16 = 0, RO | TX_PDO, "Touch Probe 1 Negative Counter";
        /// Number of rising edges that probe 2 has latched.
        0x60D7:0 probe_2_positive_count: u16 = 0, RO | TX_PDO, "Touch Probe 2 Positive Counter";
        /// Number of falling edges that probe 2 has latched.
        0x60D8:0 probe_2_negative_count: u16 = 0, RO | TX_PDO, "Touch Probe 2 Negative Counter";
        /// Difference of commanded and actual position: always 0 in open loop.
        0x60F4:0 following_error: i32 = 0, RO | TX_PDO, unit "Pulse", "Following error actual value";
        /// Bit 0 CCW limit, 1 CW limit, 2 home, 16 to 21 IN1 to IN6: 1 while the signal is valid (manual 2.3.23).
        0x60FD:0 digital_inputs: u32 = 0, RO | TX_PDO, "Digital Inputs";
        /// Bits 16 and 17 switch OUT1 and OUT2 on, if they have the custom function and the mask lets them (manual 2.3.24).
        0x60FE:1 physical_outputs: u32 = 0, RW | RX_PDO | TX_PDO | SAVED, "Physical Outputs" of "Digital Outputs";
        /// Bits 16 and 17 let sub-index 1 control OUT1 and OUT2 (manual 2.3.24).
        0x60FE:2 output_mask: u32 = 0, RW | RX_PDO | TX_PDO | SAVED, "Bit Mask" of "Digital Outputs";
        /// Target speed of PV (manual 2.3.25).
        0x60FF:0 target_velocity: i32 = 0, RW | RX_PDO | TX_PDO, unit "Pulse/s", "Target Velocity";
        /// Bit 0 PP, 2 PV, 5 homing, 7 CSP (manual 2.3.26).
        0x6502:0 supported_modes: u32 = 0x0000_00A5, RO | TX_PDO, "Supported Drive Modes";
    }
}
