//! Where the object dictionary differs from that of an ECR60 with firmware 101A, and why.

/// Objects, what is told of them or of their entries, the real unit's value, the value here, and the reason.
type Difference = (&'static [u16], &'static str, &'static str, &'static str, &'static str);

const MANUAL_NAME: &str = "the manual of the USR2556E writes the name so";
const MANUAL_TYPE: &str = "the manual of the USR2556E gives the object this type";
const MAPPABLE: &str = "the family's ESI file maps it in both directions";
const SAVED: &str = "the family's ESI file maps it in both directions, and 0x1010 saves it";
const READ_ONLY: &str = "reserved, which users must not set (manual 2.2.18), or set by the drive itself";

/// Objects that the real unit's firmware does not have yet.
pub const ADDED: &[(u16, &str)] = &[
    (
        0x10F3,
        "the event log as configuration tools read it (ETG.1020); the real unit keeps none",
    ),
    (0x204B, "in the manual since V203"),
    (0x204C, "in the manual since V203"),
];

/// All differences; every row is needed.
pub const DIFFERENCES: &[Difference] = &[
    (&[0x1010, 0x1011], "type", "0009", "002A", "a record, not a string"),
    (
        &[0x1600, 0x1601, 0x1602, 0x1A00, 0x1A01, 0x1A02],
        "access",
        "003F",
        "000F",
        "mappings are refused in SAFEOP and OP (ETG.1000.6), and the access word says so",
    ),
    (
        &[
            0x2000, 0x2001, 0x2002, 0x2003, 0x2005, 0x2006, 0x2007, 0x2008, 0x2009, 0x200A, 0x200B, 0x200D, 0x2011, 0x2060, 0x2061, 0x2062,
            0x6099, 0x60FE,
        ],
        "access",
        "007F",
        "01FF",
        SAVED,
    ),
    (&[0x200C, 0x2150, 0x2151], "access", "003F", "01FF", SAVED),
    (
        &[0x200C],
        "access",
        "0007",
        "0087",
        "the family's ESI file maps it, and what the drive identifies is an input of the master",
    ),
    (
        &[
            0x2010, 0x6040, 0x605A, 0x605B, 0x605C, 0x605E, 0x6060, 0x607A, 0x607C, 0x6081, 0x6083, 0x6084, 0x6085, 0x6098, 0x609A, 0x60B8,
            0x60FF,
        ],
        "access",
        "007F",
        "00FF",
        MAPPABLE,
    ),
    (&[0x2020], "access", "003F", "0087", READ_ONLY),
    (
        &[0x2022, 0x2023, 0x2024, 0x2025, 0x2026, 0x60B9],
        "access",
        "007F",
        "0087",
        READ_ONLY,
    ),
    (
        &[0x60BA, 0x60BB, 0x60BC, 0x60BD],
        "access",
        "0047",
        "0087",
        "the family's ESI file maps it into TxPDOs, not into RxPDOs",
    ),
    (&[0x6081, 0x6083, 0x6084, 0x6085], "type", "0007", "0004", MANUAL_TYPE),
    (&[0x6098], "type", "0006", "0002", MANUAL_TYPE),
    (&[0x6098], "bits", "16", "8", MANUAL_TYPE),
    (
        &[0x609A],
        "type",
        "0004",
        "0007",
        "the real unit's object and entry disagree; the manual takes the object's type",
    ),
    (&[0x60BA, 0x60BB, 0x60BC, 0x60BD], "type", "0004", "0007", MANUAL_TYPE),
    (&[0x2003], "name", "Idle Current Percentage", "Idle Current Percent", MANUAL_NAME),
    (&[0x2005], "name", "Outputs function", "Outputs Function", MANUAL_NAME),
    (&[0x2005], "name", "Output1 function", "Output 1 Function", MANUAL_NAME),
    (&[0x2005], "name", "Output2 function", "Output 2 Function", MANUAL_NAME),
    (&[0x2006], "name", "Output Polarity", "Outputs Polarity", MANUAL_NAME),
    (&[0x2007], "name", "Inputs function", "Inputs Function", MANUAL_NAME),
    (&[0x2007], "name", "IN1 function", "Input 1 Function", MANUAL_NAME),
    (&[0x2007], "name", "IN2 function", "Input 2 Function", MANUAL_NAME),
    (&[0x2007], "name", "IN3 function", "Input 3 Function", MANUAL_NAME),
    (&[0x2007], "name", "IN4 function", "Input 4 Function", MANUAL_NAME),
    (&[0x2007], "name", "IN5 function", "Input 5 Function", MANUAL_NAME),
    (&[0x2007], "name", "IN6 function", "Input 6 Function", MANUAL_NAME),
    (&[0x2048], "name", "BusVoltage", "Bus Voltage", MANUAL_NAME),
    (&[0x2150], "name", "Alias Address", "Slave Alias", MANUAL_NAME),
    (&[0x2151], "name", "Alias Address source", "Slave Alias Source", MANUAL_NAME),
    (&[0x6060], "name", "Modes of Operation", "Mode of Operation", MANUAL_NAME),
    (
        &[0x6061],
        "name",
        "Modes of Operation Display",
        "Mode of Operation Display",
        MANUAL_NAME,
    ),
    (&[0x607A], "name", "Target Position", "Profile Target Position", MANUAL_NAME),
    (&[0x6085], "name", "Quickstop Declaration", "Quickstop Deceleration", MANUAL_NAME),
    (&[0x6099], "name", "Homing velocity", "Homing Velocity", MANUAL_NAME),
    (&[0x6099], "name", "Homing velocity_Fast", "Homing Velocity (fast)", MANUAL_NAME),
    (&[0x6099], "name", "Homing velocity_Slow", "Homing Velocity (slow)", MANUAL_NAME),
    (&[0x60B8], "name", "Touch probe function", "Touch Probe Function", MANUAL_NAME),
    (&[0x60B9], "name", "Touch probe Status", "Touch Probe Status", MANUAL_NAME),
    (
        &[0x60BA],
        "name",
        "Touch Probe 1 Positive Value",
        "Touch Probe Position 1 Positive Value",
        MANUAL_NAME,
    ),
    (
        &[0x60BB],
        "name",
        "Touch Probe 1 Negative Value",
        "Touch Probe Position 1 Negative Value",
        MANUAL_NAME,
    ),
    (
        &[0x60BC],
        "name",
        "Touch Probe 2 Positive Value",
        "Touch Probe Position 2 Positive Value",
        MANUAL_NAME,
    ),
    (
        &[0x60BD],
        "name",
        "Touch Probe 2 Negative Value",
        "Touch Probe Position 2 Negative Value",
        MANUAL_NAME,
    ),
    (&[0x60FE], "name", "Digital Output", "Digital Outputs", MANUAL_NAME),
    (&[0x60FE], "name", "bit mask", "Bit Mask", MANUAL_NAME),
];
