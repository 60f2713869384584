"""The process data of USR2556E drives, whatever master exchanges them."""

import struct
import time

from verdict import Failure, expect

# Identity of the USR2556E as SII words 8 to 13 and object 0x1018 state it.
NAME = "USR2556E"
VENDOR, PRODUCT, REVISION = 0x0000_0A88, 0x0A88_0001, 0x0000_0204

# Cycles that may pass before something expected is given up.
PATIENCE = 5000


class Layout:
    """What the process data of one drive holds: entries of (index, bits) and the struct format that reads them."""

    def __init__(self, entries, form):
        self.entries = entries
        self.form = "<" + form
        self.size = struct.calcsize(self.form)

    def mapping(self):
        """The entries as a mapping object holds them; all of them at sub-index 0."""
        return [index << 16 | bits for index, bits in self.entries]


DEFAULT_OUTPUTS = Layout([(0x6040, 16), (0x6060, 8), (0x607A, 32)], "Hbi")
DEFAULT_INPUTS = Layout([(0x6041, 16), (0x6061, 8), (0x6064, 32), (0x60FD, 32)], "HbiI")

# A mapping other than the default, with profile velocity in the outputs and error code in the inputs.
OTHER_OUTPUTS = Layout([(0x6040, 16), (0x6060, 8), (0x607A, 32), (0x6081, 32)], "HbiI")
OTHER_INPUTS = Layout([(0x6041, 16), (0x6061, 8), (0x6064, 32), (0x60FD, 32), (0x603F, 16)], "HbiIH")


class Cyclic:
    """Drives that exchange process data at a period, all with the same layout.

    A master adds how: `drives`, `exchange`, `set_outputs` and `inputs_of`.
    """

    def __init__(self, period_ns):
        self.period = period_ns
        self.outputs = DEFAULT_OUTPUTS
        self.inputs = DEFAULT_INPUTS
        self.next_cycle = time.monotonic_ns()

    def write(self, *values):
        """Sets the outputs of every drive to the same values."""
        self.write_each([values] * len(self.drives))

    def write_each(self, rows):
        """Sets the outputs of the drives, one row of values each."""
        for drive, row in zip(self.drives, rows):
            self.set_outputs(drive, struct.pack(self.outputs.form, *row))

    def read(self):
        """The inputs of the drives, one tuple of values each."""
        return [struct.unpack(self.inputs.form, self.inputs_of(drive)) for drive in self.drives]

    def cycle(self, checked=True):
        """Exchanges process data once, at the segment's period, and answers the inputs."""
        self.pace()
        self.exchange(checked)
        return self.read()

    def cycle_until(self, condition, what):
        """Exchanges process data until the inputs of every drive meet the condition."""
        for _ in range(PATIENCE):
            if all(condition(row) for row in self.cycle()):
                expect(True, what)
                return
        rows = [[f"{value:#x}" for value in row] for row in self.read()]
        raise Failure(f"{what}: not within {PATIENCE} cycles, inputs {rows}")

    def pace(self):
        """Waits for the next cycle."""
        self.next_cycle += self.period
        left = self.next_cycle - time.monotonic_ns()
        if left > 0:
            time.sleep(left / 1e9)
        elif left < -self.period:
            # A late cycle is left out rather than followed by a burst.
            self.next_cycle = time.monotonic_ns()
