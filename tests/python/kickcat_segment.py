"""A segment of drives behind one interface, through the KickCAT master."""

import kickcat
from kickcat import Access, State
from kickcat.mailbox.request import MessageStatus

from process_data import DEFAULT_INPUTS, DEFAULT_OUTPUTS, Cyclic
from verdict import Failure, expect, expect_equal

# How long to wait for a frame while the drives are brought up, in s. Without a second interface, this master waits that long after each
# broadcast, and it reads the EEPROM with hundreds of them. So the first try is a short one; a busy machine needs more.
SCAN_TIMEOUTS = [0.01, 0.03, 0.1]
# How long to wait for a frame thereafter; it passes with each request of a state.
FRAME_TIMEOUT = 0.3
# How long a drive may take for a state change and for an answer by mailbox, in s.
STATE_TIMEOUT, SERVICE_TIMEOUT = 10.0, 2.0
# The process data watchdog, in s: longer than a request of a state, during which no process data go out.
WATCHDOG = 2.0

# As much as any object of the drive holds.
LARGEST = 512


class Refused(Exception):
    """A transfer that the drive has not confirmed. The code that it answers is not to be had, see `Drive.sdo_write`."""


class Drive:
    """One drive, with SDO transfers as pysoem has them."""

    def __init__(self, bus, slave):
        self.bus = bus
        self.slave = slave

    def sdo_read(self, index, subindex, size=LARGEST, ca=False):
        """The bytes of an object, or of all of it by complete access."""
        access = Access.COMPLETE if ca else Access.PARTIAL
        return self.bus.read_sdo(self.slave, index, subindex, access, size, SERVICE_TIMEOUT)

    def sdo_write(self, index, subindex, data, timeout=SERVICE_TIMEOUT):
        """Writes an object.

        KickCAT 2.5 takes a drive's abort for a stray message and goes on waiting, so a refusal ends with the time-out.
        """
        message = self.slave.mailbox.write_sdo(index, subindex, data=data, timeout=timeout)
        while message.status() == MessageStatus.RUNNING:
            self.bus.process_mailboxes()
        if message.status() != MessageStatus.SUCCESS:
            raise Refused(f"write of {index:#06x}:{subindex:02}: {message.status():#x}")


class KickcatSegment(Cyclic):
    """The master with all its drives, which are told the same."""

    def __init__(self, interface, period_ns):
        super().__init__(period_ns)
        self.interface = interface
        self.bus = None
        self.drives = []

    def scan(self, count):
        """Resets all drives to INIT, reads their EEPROMs and takes them to PREOP."""
        self.bring_up()
        self.drives = [Drive(self.bus, slave) for slave in self.bus.slaves()]
        expect_equal(len(self.drives), count, "number of slaves")
        expect_equal([drive.slave.address for drive in self.drives], [1001 + number for number in range(count)], "station addresses")
        self.confirm(State.PREOP)

    def bring_up(self):
        """Has the master do all that it does before PREOP, with more patience each time."""
        for timeout in SCAN_TIMEOUTS:
            link = kickcat.create_link(self.interface, "")
            link.set_timeout(timeout)
            self.bus = kickcat.Bus(link)
            try:
                self.bus.init(WATCHDOG)
            except RuntimeError as error:
                late = error
                continue
            link.set_timeout(FRAME_TIMEOUT)
            return
        raise late

    def map(self, outputs=DEFAULT_OUTPUTS, inputs=DEFAULT_INPUTS, configure=lambda drive: None):
        """Configures the drives in PREOP, maps the process data and takes them to SAFEOP."""
        self.outputs, self.inputs = outputs, inputs
        for drive in self.drives:
            configure(drive)
        self.bus.create_mapping()
        for number, drive in enumerate(self.drives, 1):
            seen = (drive.slave.output_size, drive.slave.input_size)
            wanted = (outputs.size, inputs.size)
            expect(seen == wanted, f"slave {number} maps {wanted[0]} bytes of outputs and {wanted[1]} of inputs", f"got {seen}")
        self.reach(State.SAFE_OP)
        self.write(*([0] * len(outputs.entries)))

    def start(self):
        """Takes the drives to OP, exchanging process data all the while, and checks the working counter from then on."""
        self.exchange(checked=False)
        self.bus.request_state(State.OPERATIONAL)
        self.bus.wait_for_state(State.OPERATIONAL, STATE_TIMEOUT, lambda: self.exchange(checked=False))
        self.confirm(State.OPERATIONAL)
        for _ in range(100):
            self.cycle()
        expect(True, "working counters are right in 100 cycles of OP")

    def stop(self):
        """Takes the drives back to INIT."""
        self.reach(State.INIT)

    def reach(self, state):
        """Asks for a state and waits for it."""
        self.bus.request_state(state)
        self.bus.wait_for_state(state, STATE_TIMEOUT)
        self.confirm(state)

    def confirm(self, state):
        """Checks that every drive is in `state`; this master raises the AL status code of one with an error."""
        for number, drive in enumerate(self.drives, 1):
            seen = self.bus.get_state(drive.slave)
            expect(seen == state, f"slave {number} is in {state.name}", f"got {seen}")

    def set_outputs(self, drive, image):
        """What a drive gets with the next exchange."""
        drive.slave.set_output_bytes(image)

    def inputs_of(self, drive):
        """What a drive has given with the last exchange."""
        return drive.slave.input_data

    def exchange(self, checked):
        """Exchanges process data once, by LRD and LWR; this master raises a wrong working counter if asked to check it."""
        if checked:
            self.bus.process_data()
        else:
            self.bus.process_data_no_check()
