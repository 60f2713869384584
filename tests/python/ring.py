#!/usr/bin/env python3
"""Cuts and repairs cables between drives in operation, with the SOEM master, and checks what becomes of the drives.

A ring keeps all drives in operation whichever cable is cut; in a line, those behind the cut are lost until they are taken back:
  usr2556e exec --ring --drives 3 -- target/python/bin/python tests/python/ring.py ring
  usr2556e exec --drives 3 -- target/python/bin/python tests/python/ring.py line
The program that gives the orders is $USR2556E, or usr2556e on the search path. The exit code is 0 when everything held.
"""

import argparse
import math
import os
import subprocess
import sys

import pysoem

import motion
from process_data import PATIENCE
from segment import FRAME_TIMEOUT, Segment
from verdict import Failure, expect, expect_equal, ok

DRIVES = 3
PERIOD_US = 2000

# The sine that the drives follow: pulses, and cycles of one swing.
AMPLITUDE = 1000
SWING = 500
# Cycles behind a change of a cable.
PAUSE = 150

# With no cable at one of its cards, SOEM awaits that card's frame in vain in each cycle. So there are few of them, and the time-out in us is shorter.
ONE_CARD_PAUSE = 6
ONE_CARD_TIMEOUT = 200_000

# In ms. In a ring it must outlast the time-outs of lost frames; in a line it is waited out.
RING_WATCHDOG = 5000.0
LINE_WATCHDOG = 1000.0

# An LRW counts 1 for the inputs and 2 for the outputs of each drive.
COUNTS_PER_DRIVE = 3

WATCHDOG_EXPIRED = 0x001B
SAFEOP_WITH_ERROR = pysoem.SAFEOP_STATE | pysoem.STATE_ERROR


class Order:
    """An order to the cables, given by another process while this one exchanges process data."""

    def __init__(self, *words):
        self.text = " ".join(words)
        self.process = subprocess.Popen([os.environ.get("USR2556E", "usr2556e"), "cable", *words])

    def pending(self):
        """Whether it has not been answered yet."""
        status = self.process.poll()
        if status:
            raise Failure(f"cable {self.text}: exit status {status}")
        return status is None


class Sine:
    """All drives on a sine round where they stand, in cyclic synchronous position mode."""

    def __init__(self, segment):
        self.segment = segment
        self.starts = motion.enable(segment)
        self.number = 0
        self.incomplete = 0

    def cycle(self, timeout=FRAME_TIMEOUT):
        """One more target for each drive; the answer is checked if it is complete, and counted if not."""
        self.number += 1
        offset = round(AMPLITUDE * math.sin(2 * math.pi * self.number / SWING))
        targets = [start + offset for start in self.starts]
        motion.command(self.segment, 0x0F, targets)
        counter = self.segment.count(timeout)
        if counter != self.segment.master.expected_wkc:
            self.incomplete += 1
            return
        for number, (target, row) in enumerate(zip(targets, self.segment.read()), 1):
            if row[0] & 0x6F != motion.OPERATION_ENABLED[1]:
                raise Failure(f"drive {number}: statusword {row[0]:#06x} in cycle {self.number}")
            if abs(target - row[2]) > motion.MOST_LAG:
                raise Failure(f"drive {number}: 0x6064 = {row[2]} does not follow the target {target}")

    def through(self, *words, one_card=False):
        """Goes on while an order is carried out, and for a while behind it. At most one frame may be lost meanwhile."""
        pause, timeout = (ONE_CARD_PAUSE, ONE_CARD_TIMEOUT) if one_card else (PAUSE, FRAME_TIMEOUT)
        self.incomplete = 0
        order = Order(*words)
        while order.pending():
            self.cycle(timeout)
        for _ in range(pause):
            self.cycle(timeout)
        expect(self.incomplete <= 1, f"{order.text}: all drives follow, at most one frame is lost", f"{self.incomplete} are")

    def end(self):
        """Returns to the start."""
        motion.command(self.segment, 0x0F, self.starts)
        for _ in range(PATIENCE):
            if [row[2] for row in self.segment.cycle()] == self.starts:
                ok("all drives are back on their first position, to the pulse")
                return
        raise Failure(f"positions {[row[2] for row in self.segment.read()]}, but {self.starts} are due")


def bring_up(watchdog, redundant=None):
    """The drives in OP, with a watchdog of so many milliseconds."""
    segment = Segment(os.environ["USR2556E_INTERFACE"], PERIOD_US * 1000, redundant)
    segment.scan(DRIVES)
    for drive in segment.drives:
        drive.set_watchdog("processdata", watchdog)
    segment.map()
    segment.start()
    return segment


def ring():
    """Each cable of a ring is cut and repaired, and each drive behind a cut stays where it was led to."""
    segment = bring_up(RING_WATCHDOG, os.environ["USR2556E_REDUNDANT_INTERFACE"])
    sine = Sine(segment)
    for cable in range(1, DRIVES + 2):
        sine.through("cut", str(cable), one_card=cable in (1, DRIVES + 1))
        sine.through("repair", str(cable))
    sine.end()
    segment.confirm(pysoem.OP_STATE)
    segment.close()


def line():
    """The drives behind a cut are lost, tell why when they can be reached again, and are taken back to OP."""
    segment = bring_up(LINE_WATCHDOG)
    cut = Order("cut", "2")
    cycle_while(segment, cut.pending)
    expect_equal(segment.count(), COUNTS_PER_DRIVE, "working counter with cable 2 cut")
    cycle_while(segment, lambda: True, int(2 * LINE_WATCHDOG * 1000) // PERIOD_US)
    repair = Order("repair", "2")
    cycle_while(segment, repair.pending)

    segment.master.read_state()
    states = [(drive.state, drive.al_status) for drive in segment.drives]
    expired = (SAFEOP_WITH_ERROR, WATCHDOG_EXPIRED)
    expect_equal(states, [(pysoem.OP_STATE, 0), expired, expired], "states after the repair")

    # One the short way, by acknowledging the error, the other with all of its configuration.
    acknowledged, configured = segment.drives[1:]
    acknowledged.state = pysoem.SAFEOP_STATE | pysoem.STATE_ACK
    acknowledged.write_state()
    expect_equal(configured.reconfig(), pysoem.SAFEOP_STATE, "state of drive 3, configured anew")
    segment.start()
    segment.stop()
    segment.close()


def cycle_while(segment, condition, most=PATIENCE):
    """Exchanges process data as long as the condition holds."""
    for _ in range(most):
        if not condition():
            return
        segment.count()


PARTS = {"ring": ring, "line": line}


def main():
    """Reads the command line, runs, and says how it ended."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("part", choices=PARTS)
    arguments = parser.parse_args()
    try:
        PARTS[arguments.part]()
    except (Failure, ConnectionError, pysoem.WkcError, pysoem.SdoError) as error:
        print(f"FAIL {error}", flush=True)
        return 1
    ok("everything")
    return 0


if __name__ == "__main__":
    sys.exit(main())
