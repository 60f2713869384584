#!/usr/bin/env python3
"""Drives USR2556E stepper drives, virtual or real, with the SOEM master, and checks what they answer.

With virtual drives, and without root:
  usr2556e exec --drives 3 -- target/python/bin/python tests/python/pysoem_session.py --drives 3
With drives on a cable, as root; their motors turn to and fro:
  target/python/bin/python tests/python/pysoem_session.py eth0 --drives 3

Each session has three parts: objects, and a move over the default mapping; a move over a mapping written by SDO; a move with
distributed clocks. It ends in INIT, and the next one starts from there without a power cycle. The exit code is 0 when everything held.
"""

import argparse
import os
import sys

try:
    import pysoem
except ImportError:
    sys.exit("FAIL pysoem is not installed: pip install --requirement tests/python/requirements.txt")

import motion
import objects
from process_data import DEFAULT_INPUTS, DEFAULT_OUTPUTS, OTHER_INPUTS, OTHER_OUTPUTS
from segment import Segment
from verdict import Failure, expect_equal, ok

SYNC_MANAGER, SYNC0 = 1, 2

# How far the drives may fall out of step with SYNC0 (0x10F1:02): as far as can be set, for this master is no real-time program.
FORGIVEN_SYNC_ERRORS = 0xFFFF


def default_mapping(segment, count, distance):
    """The mapping as it is after power-up, in plain sync manager operation."""
    segment.scan(count)
    for drive in segment.drives:
        objects.check_reads(drive)
        objects.check_writes(drive)
        objects.check_absent(drive)
        objects.check_complete_access(drive)
        objects.check_listing(drive)
        objects.check_mapping(drive, DEFAULT_OUTPUTS, DEFAULT_INPUTS)
    segment.map()
    segment.start()
    move(segment, SYNC_MANAGER, distance)
    segment.stop()


def other_mapping(segment, count, distance):
    """A mapping written by SDO. The drives stay in OP: the next scan must find them there."""
    segment.scan(count)
    segment.map(OTHER_OUTPUTS, OTHER_INPUTS, lambda drive: objects.write_mapping(drive, OTHER_OUTPUTS, OTHER_INPUTS))
    for drive in segment.drives:
        objects.check_mapping(drive, OTHER_OUTPUTS, OTHER_INPUTS)
    segment.start()
    move(segment, SYNC_MANAGER, distance)
    expect_equal([row[4] for row in segment.cycle()], [0] * count, "0x603F in the inputs")


def distributed_clocks(segment, count, distance):
    """The default mapping written back, SYNC0 at the segment's period."""

    def configure(drive):
        objects.write_mapping(drive, DEFAULT_OUTPUTS, DEFAULT_INPUTS)
        drive.sdo_write(0x10F1, 2, FORGIVEN_SYNC_ERRORS.to_bytes(2, "little"))

    segment.scan(count)
    segment.map(configure=configure, with_clocks=True)
    segment.start()
    move(segment, SYNC0, distance)
    segment.stop()


PARTS = {"default": default_mapping, "other": other_mapping, "clocks": distributed_clocks}


def move(segment, sync_type, distance):
    """Checks what the drives follow in OP, and moves them."""
    for drive in segment.drives:
        objects.check_in_operation(drive, sync_type)
    motion.there_and_back(segment, distance)


def run(arguments):
    """Runs the sessions, each with a master of its own."""
    for number in range(1, arguments.sessions + 1):
        segment = Segment(arguments.interface, arguments.period_us * 1000)
        try:
            for name in arguments.parts:
                print(f"--- session {number}: {PARTS[name].__name__.replace('_', ' ')}", flush=True)
                PARTS[name](segment, arguments.drives, arguments.distance)
        finally:
            segment.close()


def describe(error):
    """An error of the master in words; its exceptions carry them in attributes."""
    if isinstance(error, pysoem.SdoError):
        return f"SDO {error.index:#06x}:{error.subindex:02} of slave {error.slave_pos}: abort {error.abort_code & 0xFFFFFFFF:#010x} {error.desc}"
    if isinstance(error, pysoem.ConfigMapError):
        return "mapping: " + "; ".join(describe(part) for part in error.error_list)
    if isinstance(error, (pysoem.MailboxError, pysoem.PacketError)):
        return f"mailbox of slave {error.slave_pos}: error {error.error_code:#x} {error.desc}"
    if isinstance(error, pysoem.Emergency):
        return f"emergency: {error}"
    if isinstance(error, pysoem.WkcError):
        return f"no answer from the mailbox or a register, working counter {error.wkc}"
    return f"{error}"


MASTER_ERRORS = (
    pysoem.SdoError,
    pysoem.ConfigMapError,
    pysoem.MailboxError,
    pysoem.PacketError,
    pysoem.Emergency,
    pysoem.WkcError,
)


def main():
    """Reads the command line, runs, and says how it ended."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("interface", nargs="?", default=os.environ.get("USR2556E_INTERFACE"), help="default: $USR2556E_INTERFACE")
    parser.add_argument("--drives", type=int, default=1, help="how many drives must answer (default 1)")
    parser.add_argument("--sessions", type=int, default=2, help="how often to run all of it without a power cycle (default 2)")
    parser.add_argument("--parts", nargs="+", choices=PARTS, default=list(PARTS), help="what a session consists of (default: all)")
    parser.add_argument("--period-us", type=int, default=1000, help="period of the process data and of SYNC0 (default 1000)")
    parser.add_argument("--distance", type=int, default=5000, help="how far the motor turns, in pulses (default 5000, half a turn)")
    arguments = parser.parse_args()
    if not arguments.interface:
        parser.error("no interface: name one, or set USR2556E_INTERFACE")
    try:
        run(arguments)
    except (Failure, ConnectionError, *MASTER_ERRORS) as error:
        print(f"FAIL {describe(error)}", flush=True)
        return 1
    ok(f"everything (sessions: {arguments.sessions}, drives: {arguments.drives})")
    return 0


if __name__ == "__main__":
    sys.exit(main())
