#!/usr/bin/env python3
"""Reads and writes the files of a USR2556E with the SOEM master: the event log, and the parameters as backup and restore.

Without root:
  usr2556e exec -- target/python/bin/python tests/python/files.py
"""

import os
import sys

import pysoem

import objects
from segment import SERVICE_TIMEOUT, Segment
from verdict import Failure, expect, expect_equal, ok

LARGEST_FILE = 16_384
PARAMETERS = "parameters.txt"


def read(drive, name):
    """A file as text."""
    return drive.foe_read(name, 0, LARGEST_FILE, SERVICE_TIMEOUT).decode()


def write(drive, name, text):
    """Writes a file; whether the drive has taken it."""
    try:
        return drive.foe_write(name, 0, text.encode(), SERVICE_TIMEOUT) > 0
    except (pysoem.MailboxError, pysoem.PacketError):
        return False


def check(drive):
    """Backup, a change, restore; a file that is refused; both in the log."""
    backup = read(drive, PARAMETERS)
    expect("\n2000:00 = 3000 # Peak Current, mA\n" in backup, f"{PARAMETERS} holds 0x2000", backup)
    expect(len(backup) > 10 * 116, "the file takes many packets", f"got {len(backup)} bytes")

    changed = backup.replace("2000:00 = 3000", "2000:00 = 2500")
    expect(write(drive, PARAMETERS, changed), f"{PARAMETERS} with another value is taken")
    expect_equal(objects.read(drive, objects.PEAK_CURRENT), 2500, "0x2000 after the file")

    expect(not write(drive, PARAMETERS, "2000:00 = 2600\n2001:00 = 1\n"), "a value out of range is refused")
    expect(not write(drive, "other.txt", "x"), "an unknown file is refused")
    expect_equal(objects.read(drive, objects.PEAK_CURRENT), 2500, "0x2000 after the refused files")

    expect(write(drive, PARAMETERS, backup), f"{PARAMETERS} as it was is taken")
    expect_equal(read(drive, PARAMETERS), backup, f"{PARAMETERS} after restoring it")

    log = read(drive, "eventlog.txt").splitlines()
    expect("Power-on" in log[1], "the event log begins with power-on", f"got {log}")
    written = [line for line in log if line.endswith("File parameters.txt written")]
    expect_equal(len(written), 2, "files written by the event log")
    newest = objects.read(drive, 0x10F3, 2)
    message = drive.sdo_read(0x10F3, newest)
    expect_equal(int.from_bytes(message[6:8], "little"), 8, f"number of the text of the newest message, 0x10F3:{newest:02X}")


def main():
    """Scans the drives and checks the files of each."""
    segment = Segment(os.environ["USR2556E_INTERFACE"], 1_000_000)
    try:
        segment.scan(1)
        check(segment.drives[0])
        segment.stop()
    except Failure as error:
        print(f"FAIL {error}", flush=True)
        return 1
    finally:
        segment.close()
    ok("everything")
    return 0


if __name__ == "__main__":
    sys.exit(main())
