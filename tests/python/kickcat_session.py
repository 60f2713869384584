#!/usr/bin/env python3
"""Drives USR2556E stepper drives, virtual or real, with the KickCAT master, and checks what they answer.

With virtual drives, and without root:
  usr2556e exec --drives 2 -- target/python/bin/python tests/python/kickcat_session.py --drives 2

Each session has two parts: objects, and a move over the default mapping; a move over a mapping written by SDO, after which the drives
are left in OP. The next session starts from there without a power cycle. The exit code is 0 when everything held.
"""

import argparse
import os
import struct
import sys

try:
    import kickcat
except ImportError:
    sys.exit("FAIL kickcat is not installed: pip install --requirement tests/python/requirements.txt")

import motion
import objects
from kickcat_segment import KickcatSegment, Refused
from process_data import DEFAULT_INPUTS, DEFAULT_OUTPUTS, OTHER_INPUTS, OTHER_OUTPUTS
from verdict import Failure, expect, expect_equal, ok

PERIOD_NS = 2_000_000

# How long to wait for the confirmation of a write that will be refused, in s.
REFUSAL_TIMEOUT = 0.1


def check_objects(drive):
    """Reads and writes by SDO, whole objects, and descriptions."""
    objects.check_reads(drive)
    objects.check_complete_access(drive)
    drive.sdo_write(objects.PEAK_CURRENT, 0, struct.pack("<H", 2500))
    expect_equal(objects.read(drive, objects.PEAK_CURRENT), 2500, "0x2000 after a write")
    try:
        drive.sdo_write(objects.PEAK_CURRENT, 0, struct.pack("<H", 6001), REFUSAL_TIMEOUT)
        raise Failure("0x2000 above its range: accepted")
    except Refused:
        expect_equal(objects.read(drive, objects.PEAK_CURRENT), 2500, "0x2000 after a refused write")
    drive.sdo_write(objects.PEAK_CURRENT, 0, struct.pack("<H", 3000))
    for index, name in [(objects.PEAK_CURRENT, "Peak Current"), (0x6099, "Homing Velocity")]:
        expect_equal(drive.bus.read_object_description(drive.slave, index)[0], name, f"name of {index:#06x} in SDO information")


def default_mapping(segment, count, distance):
    """Objects, and a move over the mapping as the drives have it after power-up or as it is written back."""
    segment.scan(count)
    for drive in segment.drives:
        check_objects(drive)
    segment.map(configure=lambda drive: objects.write_mapping(drive, DEFAULT_OUTPUTS, DEFAULT_INPUTS))
    segment.start()
    move(segment, distance)
    segment.stop()


def other_mapping(segment, count, distance):
    """A mapping written by SDO. The drives stay in OP: the next scan must find them there."""
    segment.scan(count)
    segment.map(OTHER_OUTPUTS, OTHER_INPUTS, lambda drive: objects.write_mapping(drive, OTHER_OUTPUTS, OTHER_INPUTS))
    for drive in segment.drives:
        objects.check_mapping(drive, OTHER_OUTPUTS, OTHER_INPUTS)
    segment.start()
    move(segment, distance)
    expect_equal([row[4] for row in segment.cycle()], [0] * count, "0x603F in the inputs")


def move(segment, distance):
    """Checks what the drives follow in OP, and moves them."""
    for drive in segment.drives:
        expect_equal(objects.read(drive, 0x1C32, 1), 1, "0x1C32:01 synchronization type, read in OP")
    motion.there_and_back(segment, distance)


def main():
    """Reads the command line, runs, and says how it ended."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("interface", nargs="?", default=os.environ.get("USR2556E_INTERFACE"), help="default: $USR2556E_INTERFACE")
    parser.add_argument("--drives", type=int, default=1, help="how many drives must answer (default 1)")
    parser.add_argument("--sessions", type=int, default=1, help="how often to run all of it without a power cycle (default 1)")
    parser.add_argument("--distance", type=int, default=1000, help="how far the motor turns, in pulses (default 1000)")
    arguments = parser.parse_args()
    if not arguments.interface:
        parser.error("no interface: name one, or set USR2556E_INTERFACE")
    try:
        for number in range(1, arguments.sessions + 1):
            for part in (default_mapping, other_mapping):
                print(f"--- session {number}: {part.__name__.replace('_', ' ')}", flush=True)
                part(KickcatSegment(arguments.interface, PERIOD_NS), arguments.drives, arguments.distance)
    except (Failure, Refused, RuntimeError, kickcat.ErrorAL, kickcat.ErrorCoE) as error:
        print(f"FAIL {type(error).__name__}: {error}", flush=True)
        return 1
    ok(f"everything (sessions: {arguments.sessions}, drives: {arguments.drives})")
    return 0


if __name__ == "__main__":
    sys.exit(main())
