"""A segment of drives behind one interface, through the SOEM master."""

import struct
import time

import pysoem

from verdict import Failure, expect, expect_equal

# Identity of the USR2556E as SII words 8 to 13 and object 0x1018 state it.
NAME = "USR2556E"
VENDOR, PRODUCT, REVISION = 0x0000_0A88, 0x0A88_0001, 0x0000_0204

# How long a drive may take for a state change, in us: the longest time-out of its ESI file is 9 s.
STATE_TIMEOUT = 10_000_000
# How long to wait for a frame, and for the slower EEPROM and mailbox, in us. Long, so that a busy machine is not mistaken for a lost frame.
FRAME_TIMEOUT = 500_000
SERVICE_TIMEOUT = 2_000_000
# The process data watchdog, in ms: ten times the default, for the same reason.
WATCHDOG = 1000.0
# Cycles that may pass before something expected is given up.
PATIENCE = 5000

STATE_NAMES = {1: "INIT", 2: "PREOP", 3: "BOOT", 4: "SAFEOP", 8: "OP"}


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


class Segment:
    """The master with all its drives, which are told the same. With a second interface, it is the master of a ring."""

    def __init__(self, interface, period_ns, redundant=None):
        self.interface = interface
        self.period = period_ns
        self.outputs = DEFAULT_OUTPUTS
        self.inputs = DEFAULT_INPUTS
        self.with_clocks = False
        timeouts = pysoem.settings.timeouts
        timeouts.ret = timeouts.safe = FRAME_TIMEOUT
        timeouts.eeprom = timeouts.tx_mailbox = timeouts.rx_mailbox = SERVICE_TIMEOUT
        self.master = pysoem.Master()
        self.master.sdo_read_timeout = self.master.sdo_write_timeout = SERVICE_TIMEOUT
        self.master.open(interface, redundant)
        self.next_cycle = time.monotonic_ns()

    def close(self):
        """Gives the interface back."""
        self.master.close()

    @property
    def drives(self):
        """The drives in the order of the wire."""
        return self.master.slaves

    def scan(self, count):
        """Resets all drives to INIT, identifies them and takes them to PREOP."""
        found = self.master.config_init()
        if found <= 0:
            raise Failure(f"no slave answers on {self.interface}")
        expect_equal(found, count, "number of slaves")
        for number, drive in enumerate(self.drives, 1):
            seen = (drive.name, drive.man, drive.id, drive.rev)
            expect(seen == (NAME, VENDOR, PRODUCT, REVISION), f"slave {number} is a {NAME} by its EEPROM", f"got {seen}")
            drive.set_watchdog("processdata", WATCHDOG)
        self.reach(pysoem.PREOP_STATE, request=False)

    def map(self, outputs=DEFAULT_OUTPUTS, inputs=DEFAULT_INPUTS, configure=None, with_clocks=False):
        """Configures the drives in PREOP, maps the process data and takes them to SAFEOP.

        With `with_clocks`, clocks are aligned first and SYNC0 is started in PREOP, where a drive checks it.
        """
        self.outputs, self.inputs, self.with_clocks = outputs, inputs, with_clocks
        if with_clocks:
            expect(self.master.config_dc(), "distributed clocks are found")

        def prepare(drive):
            if configure:
                configure(drive)
            if with_clocks:
                drive.dc_sync(True, self.period)

        for drive in self.drives:
            drive.setup_func = prepare
        self.master.config_map()
        for number, drive in enumerate(self.drives, 1):
            seen = (len(drive.output), len(drive.input))
            wanted = (outputs.size, inputs.size)
            expect(seen == wanted, f"slave {number} maps {wanted[0]} bytes of outputs and {wanted[1]} of inputs", f"got {seen}")
        self.write(*([0] * len(outputs.entries)))
        self.reach(pysoem.SAFEOP_STATE, request=False)

    def start(self):
        """Takes the drives to OP, exchanging process data all the while, and checks the working counter from then on."""
        self.master.state = pysoem.OP_STATE
        self.master.write_state()
        for cycle in range(STATE_TIMEOUT * 1000 // self.period):
            self.cycle(checked=False)
            if cycle % 100 == 0 and self.arrived():
                break
        self.confirm(pysoem.OP_STATE)
        for _ in range(100):
            self.cycle()
        expect(True, f"working counter is {self.master.expected_wkc} in 100 cycles of OP")

    def arrived(self):
        """Whether nothing is left to wait for: all drives are in OP, or one has refused."""
        everywhere = self.master.read_state() == pysoem.OP_STATE
        return everywhere or any(drive.state & pysoem.STATE_ERROR for drive in self.drives)

    def stop(self):
        """Takes the drives back to INIT."""
        self.reach(pysoem.INIT_STATE)

    def reach(self, state, request=True):
        """Asks for a state, unless the master has done so already, and waits for it."""
        if request:
            self.master.state = state
            self.master.write_state()
        self.master.state_check(state, STATE_TIMEOUT)
        self.confirm(state)

    def confirm(self, state):
        """Checks that every drive is in `state` without an error."""
        self.master.read_state()
        for number, drive in enumerate(self.drives, 1):
            reason = f"got {drive.state:#x}, AL status code {drive.al_status:#06x} {pysoem.al_status_code_to_string(drive.al_status)}"
            expect(drive.state == state, f"slave {number} is in {STATE_NAMES[state]}", reason)

    def write(self, *values):
        """Sets the outputs of every drive."""
        for drive in self.drives:
            drive.output = struct.pack(self.outputs.form, *values)

    def write_each(self, rows):
        """Sets the outputs of the drives, one row of values each."""
        for drive, row in zip(self.drives, rows):
            drive.output = struct.pack(self.outputs.form, *row)

    def read(self):
        """The inputs of the drives, one tuple of values each."""
        return [struct.unpack(self.inputs.form, drive.input) for drive in self.drives]

    def exchange(self, timeout=FRAME_TIMEOUT):
        """Exchanges process data once, at the segment's period, and answers the working counter."""
        self.pace()
        self.master.send_processdata()
        return self.master.receive_processdata(timeout)

    def cycle(self, checked=True):
        """As `exchange`, but answers the inputs."""
        counter = self.exchange()
        if checked and counter != self.master.expected_wkc:
            self.explain(counter)
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
        """Waits for the next cycle; with clocks, half a period after the drives' SYNC0."""
        self.next_cycle += self.period
        if self.with_clocks:
            error = (self.master.dc_time - self.period // 2) % self.period
            if error > self.period // 2:
                error -= self.period
            self.next_cycle -= max(-self.period // 100, min(self.period // 100, error // 16))
        left = self.next_cycle - time.monotonic_ns()
        if left > 0:
            time.sleep(left / 1e9)
        elif left < -self.period:
            # A late cycle is left out rather than followed by a burst.
            self.next_cycle = time.monotonic_ns()

    def explain(self, counter):
        """Raises what a wrong working counter comes from."""
        self.master.read_state()
        states = ", ".join(f"{drive.state:#x} (AL status code {drive.al_status:#06x})" for drive in self.drives)
        raise Failure(f"working counter {counter} instead of {self.master.expected_wkc}; states {states}")
