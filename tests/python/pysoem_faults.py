#!/usr/bin/env python3
"""Does to USR2556E drives what goes wrong on a bus, with the SOEM master, and checks what they make of it.

With virtual drives, and without root:
  usr2556e exec --drives 8 --clock-drift 100 -- target/python/bin/python tests/python/pysoem_faults.py --drives 8 align
  usr2556e exec --drives 2 -- target/python/bin/python tests/python/pysoem_faults.py --drives 2 watchdog
  usr2556e exec --drives 3 --lose 1 -- target/python/bin/python tests/python/pysoem_faults.py --drives 3 loss

align: clocks of different rates come together within 5 s.
watchdog: the master falls silent, acknowledges what the drives tell of it, and goes on.
loss: the wire loses frames; OP goes on, set-points stay with their drives, SDO transfers succeed.
"""

import argparse
import os
import struct
import sys
import time

import pysoem

import motion
import objects
from process_data import PATIENCE
from pysoem_session import FORGIVEN_SYNC_ERRORS, MASTER_ERRORS, describe
from segment import FRAME_TIMEOUT, Segment
from verdict import Failure, expect, expect_equal, ok

PERIOD = 1_000_000
SECONDS = 5

SYSTEM_TIME_DIFFERENCE = 0x092C
# The sign of the register is its highest bit.
MAGNITUDE = 0x7FFF_FFFF
# How far a clock may be from the reference clock, in ns.
MOST_DIFFERENCE = 1_000

# The process data watchdog that is let expire, in ms.
WATCHDOG = 100.0
SM_WATCHDOG = 0x001B
SAFEOP_ERROR = pysoem.SAFEOP_STATE | pysoem.STATE_ERROR

# How often to repeat what a lost frame has ended.
PERSISTENCE = 20
# How many SDO transfers of each kind there are for each drive.
ROUNDS = 50
# What stands for the working counter of a frame that did not come back.
NO_FRAME = -1
# How long to wait for a frame on a wire that loses some, in us: a few cycles.
LOST_AFTER = 5_000


def align(segment, count):
    """Distributed clocks with clocks that drift."""

    def configure(drive):
        drive.sdo_write(0x10F1, 2, FORGIVEN_SYNC_ERRORS.to_bytes(2, "little"))

    segment.scan(count)
    segment.map(configure=configure, with_clocks=True)
    segment.start()
    for _ in range(SECONDS * 1_000_000_000 // PERIOD):
        segment.cycle()
    differences = []
    for drive in segment.drives:
        value = struct.unpack("<I", drive._fprd(SYSTEM_TIME_DIFFERENCE, 4, FRAME_TIMEOUT))[0]
        differences.append(value & MAGNITUDE)
    expect(max(differences) < MOST_DIFFERENCE, f"0x092C of each drive is below {MOST_DIFFERENCE} ns", f"{differences}")
    objects.check_in_operation(segment.drives[0], 2)
    segment.stop()


def watchdog(segment, count):
    """Silence for longer than the watchdog's time, acknowledgement, OP again."""
    segment.scan(count)
    for drive in segment.drives:
        drive.set_watchdog("processdata", WATCHDOG)
    segment.map()
    segment.start()
    before = time.monotonic()
    segment.cycle()
    while segment.master.read_state() == pysoem.OP_STATE:
        expect_patience(before)
    silence = time.monotonic() - before
    expect(silence * 1000 >= WATCHDOG, f"the drives stay in OP for the {WATCHDOG:.0f} ms of the watchdog", f"left after {silence:.3f} s")
    while not all(drive.state == SAFEOP_ERROR for drive in segment.drives):
        expect_patience(before)
        segment.master.read_state()
    expect_equal([drive.al_status for drive in segment.drives], [SM_WATCHDOG] * count, "AL status codes")
    segment.master.send_processdata()
    counter = segment.master.receive_processdata(FRAME_TIMEOUT)
    expect_equal(counter, count, "working counter while only inputs are exchanged")
    segment.master.state = pysoem.SAFEOP_STATE | pysoem.STATE_ACK
    segment.master.write_state()
    segment.master.state_check(pysoem.SAFEOP_STATE, FRAME_TIMEOUT)
    segment.confirm(pysoem.SAFEOP_STATE)
    segment.start()
    segment.stop()


def expect_patience(since):
    """Gives up what does not happen within 10 s."""
    if time.monotonic() - since > 10:
        raise Failure("the drives do not leave OP when process data stop")


def loss(segment, count):
    """Process data and SDO transfers on a wire that loses frames."""
    persistently(lambda: segment.scan(count))
    transfer(segment)
    segment.map()
    segment.master.state = pysoem.OP_STATE
    segment.master.write_state()
    lost = 0
    for cycle in range(PATIENCE):
        segment.pace()
        segment.master.send_processdata()
        segment.master.receive_processdata(LOST_AFTER)
        if cycle % 100 == 0 and segment.arrived():
            break
    segment.confirm(pysoem.OP_STATE)
    targets = [0] * count
    for cycle in range(SECONDS * 1_000_000_000 // PERIOD):
        # Each drive goes its own way, from enabled drives on.
        if cycle > 1000:
            targets = [(-1) ** number * (number + 1) * (cycle - 1000) for number in range(count)]
        lost += forgiving_cycle(segment, targets)
        check_followed(segment, targets)
    for _ in range(100):
        lost += forgiving_cycle(segment, targets)
    expect(lost > 0, "frames were lost", "none")
    expect_equal([row[2] for row in segment.read()], targets, "positions")
    segment.confirm(pysoem.OP_STATE)
    segment.stop()


def transfer(segment):
    """Writes an object of each drive and reads it back, many times."""
    timeouts = pysoem.settings.timeouts
    usual, timeouts.ret = timeouts.ret, LOST_AFTER
    for number in range(ROUNDS):
        value = struct.pack("<H", 1000 + number)
        for drive in segment.drives:
            persistently(lambda drive=drive: drive.sdo_write(0x2000, 0, value))
            # This master now and then gives back nothing where an answer got lost.
            seen = persistently(lambda drive=drive: drive.sdo_read(0x2000, 0)) or persistently(lambda drive=drive: drive.sdo_read(0x2000, 0))
            if seen != value:
                raise Failure(f"0x2000 reads {seen} after {value} was written")
    timeouts.ret = usual
    ok("SDO transfers succeed")


def persistently(action):
    """Repeats what this master breaks off when a frame is lost."""
    for _ in range(PERSISTENCE):
        try:
            return action()
        except (pysoem.WkcError, pysoem.MailboxError, pysoem.PacketError):
            continue
    return action()


def forgiving_cycle(segment, targets):
    """One exchange, whose frame may get lost; whether it was."""
    segment.pace()
    motion.command(segment, 0x0F, targets)
    segment.master.send_processdata()
    counter = segment.master.receive_processdata(LOST_AFTER)
    if counter not in (NO_FRAME, segment.master.expected_wkc):
        segment.explain(counter)
    return counter == NO_FRAME


def check_followed(segment, targets):
    """A drive behind another's set-point would be far from its own."""
    for target, row in zip(targets, segment.read()):
        if abs(target - row[2]) > motion.MOST_LAG:
            raise Failure(f"0x6064 = {row[2]} beside the target {target}")


PARTS = {"align": align, "watchdog": watchdog, "loss": loss}


def main():
    """Reads the command line, runs, and says how it ended."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("part", choices=PARTS)
    parser.add_argument("interface", nargs="?", default=os.environ.get("USR2556E_INTERFACE"), help="default: $USR2556E_INTERFACE")
    parser.add_argument("--drives", type=int, default=1, help="how many drives must answer (default 1)")
    arguments = parser.parse_args()
    if not arguments.interface:
        parser.error("no interface: name one, or set USR2556E_INTERFACE")
    segment = Segment(arguments.interface, PERIOD)
    try:
        PARTS[arguments.part](segment, arguments.drives)
    except (Failure, ConnectionError, *MASTER_ERRORS) as error:
        print(f"FAIL {describe(error)}", flush=True)
        return 1
    finally:
        segment.close()
    ok(f"everything (part: {arguments.part}, drives: {arguments.drives})")
    return 0


if __name__ == "__main__":
    sys.exit(main())
