"""Reads and writes of the object dictionary by SDO, and the abort codes of what a drive must refuse."""

import struct

from process_data import PRODUCT, REVISION, VENDOR
from verdict import Failure, expect, expect_equal

ABORT_READ_ONLY = 0x0601_0002
ABORT_NO_OBJECT = 0x0602_0000
ABORT_LENGTH = 0x0607_0010
ABORT_NO_SUBINDEX = 0x0609_0011
ABORT_TOO_HIGH = 0x0609_0031
ABORT_TOO_LOW = 0x0609_0032
ABORT_STATE = 0x0800_0022

PEAK_CURRENT = 0x2000


def read(drive, index, subindex=0):
    """An unsigned object of any width."""
    return int.from_bytes(drive.sdo_read(index, subindex), "little")


def expect_abort(transfer, arguments, code, what):
    """Checks that a transfer with these arguments is refused with one abort code."""
    try:
        transfer(*arguments)
    except Exception as error:
        # Whatever else a master raises is no answer of the drive.
        if not hasattr(error, "abort_code"):
            raise
        expect_equal(error.abort_code & 0xFFFF_FFFF, code, f"{what}: abort code")
        return
    raise Failure(f"{what}: accepted, but abort code {code:#010x} is due")


def check_reads(drive):
    """Identity, the PDO assignment and a few defaults."""
    for index, text in [(0x1008, b"ECR60"), (0x1009, b"A1"), (0x100A, b"101B")]:
        expect_equal(drive.sdo_read(index, 0), text, f"{index:#06x}")
    expect_equal(read(drive, 0x1000), 0x0004_0192, "0x1000 device type")
    for subindex, value in enumerate([4, VENDOR, PRODUCT, REVISION]):
        expect_equal(read(drive, 0x1018, subindex), value, f"0x1018:{subindex:02} identity")
    expect_equal([read(drive, 0x1C00, subindex) for subindex in range(5)], [4, 1, 2, 3, 4], "0x1C00 sync manager types")
    expect_equal(read(drive, PEAK_CURRENT), 3000, "0x2000 peak current")
    expect_equal(read(drive, 0x2001), 10_000, "0x2001 motor resolution")


def check_writes(drive):
    """A write that is taken, and writes that are refused and change nothing."""
    drive.sdo_write(PEAK_CURRENT, 0, struct.pack("<H", 2500))
    expect_equal(read(drive, PEAK_CURRENT), 2500, "0x2000 after a write")
    refused = [
        (PEAK_CURRENT, 0, struct.pack("<H", 6001), ABORT_TOO_HIGH, "0x2000 above its range"),
        (PEAK_CURRENT, 0, struct.pack("<H", 99), ABORT_TOO_LOW, "0x2000 below its range"),
        (PEAK_CURRENT, 0, struct.pack("<I", 2600), ABORT_LENGTH, "4 bytes to 0x2000"),
        (0x607A, 0, struct.pack("<H", 1), ABORT_LENGTH, "2 bytes to 0x607A"),
        (0x6041, 0, struct.pack("<H", 0), ABORT_READ_ONLY, "write to 0x6041"),
        (0x1018, 1, struct.pack("<I", 0), ABORT_READ_ONLY, "write to 0x1018:01"),
        (0x605D, 0, struct.pack("<H", 1), ABORT_NO_OBJECT, "write to 0x605D"),
    ]
    for index, subindex, data, code, what in refused:
        expect_abort(drive.sdo_write, (index, subindex, data), code, what)
    expect_equal(read(drive, PEAK_CURRENT), 2500, "0x2000 after the refused writes")
    drive.sdo_write(PEAK_CURRENT, 0, struct.pack("<H", 3000))


def check_complete_access(drive):
    """Whole objects in one transfer: sub-index 0 as 16 bits, then the entries one behind the other, each as it is read alone."""
    for index in (0x1018, 0x1C00, 0x1C12, 0x1C13, 0x1600, 0x1601, 0x1602, 0x1A00, 0x1A01, 0x1A02):
        count = read(drive, index)
        entries = b"".join(drive.sdo_read(index, subindex) for subindex in range(1, count + 1))
        expect_equal(drive.sdo_read(index, 0, 64, True), struct.pack("<H", count) + entries, f"{index:#06x} by complete access")
    expect_equal(drive.sdo_read(0x1C12, 0, 64, True), struct.pack("<HH", 1, 0x1600), "0x1c12 by complete access")
    expect_equal(drive.sdo_read(0x6099, 1, 64, True), struct.pack("<II", 10_000, 2_000), "0x6099 from sub-index 1 by complete access")


def check_listing(drive):
    """The object dictionary as SDO information lists it."""
    listed = {entry.index: entry for entry in drive.od}
    missing = [hex(index) for index in (0x1000, 0x1018, 0x1600, 0x1C32, 0x2000, 0x2007, 0x6040, 0x6064, 0x60FE) if index not in listed]
    expect(not missing, f"SDO information lists {len(listed)} objects", f"without {missing}")
    expect_equal(listed[PEAK_CURRENT].name, b"Peak Current", "name of 0x2000 in SDO information")
    expect_equal([entry.bit_length for entry in listed[0x6099].entries], [8, 32, 32], "lengths of 0x6099 in SDO information")


def check_absent(drive):
    """Reads of what the device does not have."""
    for index in (0x605D, 0x607B, 0x607D, 0x6071):
        expect_abort(drive.sdo_read, (index, 0), ABORT_NO_OBJECT, f"read of {index:#06x}")
    expect_abort(drive.sdo_read, (0x1018, 5), ABORT_NO_SUBINDEX, "read of 0x1018:05")


def check_in_operation(drive, sync_type):
    """The mailbox works beside the process data, and the mapping is locked."""
    expect_equal(read(drive, 0x1C32, 1), sync_type, "0x1C32:01 synchronization type")
    expect_abort(drive.sdo_write, (0x1C12, 0, b"\x00"), ABORT_STATE, "PDO assignment in OP")


def write_mapping(drive, outputs, inputs):
    """Maps 0x1600 and 0x1A00 anew and assigns only them, as masters do it: count to 0, entries, count."""
    for assignment, mapping, layout in [(0x1C12, 0x1600, outputs), (0x1C13, 0x1A00, inputs)]:
        drive.sdo_write(assignment, 0, b"\x00")
        drive.sdo_write(mapping, 0, b"\x00")
        for subindex, entry in enumerate(layout.mapping(), 1):
            drive.sdo_write(mapping, subindex, struct.pack("<I", entry))
        drive.sdo_write(mapping, 0, bytes([len(layout.entries)]))
        drive.sdo_write(assignment, 1, struct.pack("<H", mapping))
        drive.sdo_write(assignment, 0, b"\x01")
    expect_equal(read(drive, 0x1C12, 1), 0x1600, "0x1c12:01 after the mapping")


def check_mapping(drive, outputs, inputs):
    """Reads the mapping back."""
    for assignment, mapping, layout in [(0x1C12, 0x1600, outputs), (0x1C13, 0x1A00, inputs)]:
        expect_equal(read(drive, assignment, 0), 1, f"{assignment:#06x}:00")
        expect_equal(read(drive, assignment, 1), mapping, f"{assignment:#06x}:01")
        count = read(drive, mapping, 0)
        seen = [read(drive, mapping, subindex) for subindex in range(1, count + 1)]
        expect(seen == layout.mapping(), f"{mapping:#06x} maps {len(layout.entries)} objects", f"got {[hex(entry) for entry in seen]}")
