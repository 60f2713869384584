"""A segment of drives behind one interface, through the SOEM master."""

import pysoem

from process_data import DEFAULT_INPUTS, DEFAULT_OUTPUTS, NAME, PRODUCT, REVISION, VENDOR, Cyclic
from verdict import Failure, expect, expect_equal

# How long a drive may take for a state change, in us: the longest time-out of its ESI file is 9 s.
STATE_TIMEOUT = 10_000_000
# How long to wait for a frame, and for the slower EEPROM and mailbox, in us. Long, so that a busy machine is not mistaken for a lost frame.
FRAME_TIMEOUT = 500_000
SERVICE_TIMEOUT = 2_000_000
# The process data watchdog, in ms: ten times the default, for the same reason.
WATCHDOG = 1000.0

STATE_NAMES = {1: "INIT", 2: "PREOP", 3: "BOOT", 4: "SAFEOP", 8: "OP"}


class Segment(Cyclic):
    """The master with all its drives, which are told the same. With a second interface, it is the master of a ring."""

    def __init__(self, interface, period_ns, redundant=None):
        super().__init__(period_ns)
        self.interface = interface
        self.with_clocks = False
        timeouts = pysoem.settings.timeouts
        timeouts.ret = timeouts.safe = FRAME_TIMEOUT
        timeouts.eeprom = timeouts.tx_mailbox = timeouts.rx_mailbox = SERVICE_TIMEOUT
        self.master = pysoem.Master()
        self.master.sdo_read_timeout = self.master.sdo_write_timeout = SERVICE_TIMEOUT
        self.master.open(interface, redundant)

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

    def set_outputs(self, drive, image):
        """What a drive gets with the next exchange."""
        drive.output = image

    def inputs_of(self, drive):
        """What a drive has given with the last exchange."""
        return drive.input

    def count(self, timeout=FRAME_TIMEOUT):
        """Exchanges process data once, at the segment's period, and answers the working counter."""
        self.pace()
        self.master.send_processdata()
        return self.master.receive_processdata(timeout)

    def exchange(self, checked):
        """Exchanges process data once, and checks the working counter if asked to."""
        self.master.send_processdata()
        counter = self.master.receive_processdata(FRAME_TIMEOUT)
        if checked and counter != self.master.expected_wkc:
            self.explain(counter)

    def pace(self):
        """Waits for the next cycle; with clocks, half a period after the drives' SYNC0."""
        if self.with_clocks:
            error = (self.master.dc_time - self.period // 2) % self.period
            if error > self.period // 2:
                error -= self.period
            self.next_cycle -= max(-self.period // 100, min(self.period // 100, error // 16))
        super().pace()

    def explain(self, counter):
        """Raises what a wrong working counter comes from."""
        self.master.read_state()
        states = ", ".join(f"{drive.state:#x} (AL status code {drive.al_status:#06x})" for drive in self.drives)
        raise Failure(f"working counter {counter} instead of {self.master.expected_wkc}; states {states}")
