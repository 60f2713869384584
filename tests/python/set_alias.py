#!/usr/bin/env python3
"""Writes a station alias into the EEPROM of the first drive, with the SOEM master, as configuration tools do.

Usage, for virtual drives that keep their EEPROM in the folder `kept`:
  usr2556e exec --keep kept -- target/python/bin/python tests/python/set_alias.py 77
"""

import os
import struct
import sys

import pysoem

ALIAS_WORD, CHECKSUM_WORD = 4, 7


def checksum(configuration):
    """CRC-8 with polynomial 0x07 and initial value 0xFF over the first 14 bytes (ETG.1000.6, 5.4)."""
    value = 0xFF
    for byte in configuration:
        value ^= byte
        for _ in range(8):
            value = (value << 1 ^ 0x07 if value & 0x80 else value << 1) & 0xFF
    return value


def write_alias(drive, alias):
    """Replaces the alias, makes the checksum fit again, and reads both back."""
    configuration = bytearray(b"".join(drive.eeprom_read(word)[:2] for word in range(CHECKSUM_WORD)))
    struct.pack_into("<H", configuration, 2 * ALIAS_WORD, alias)
    for word, value in [(ALIAS_WORD, alias), (CHECKSUM_WORD, checksum(configuration))]:
        written = struct.pack("<H", value)
        drive.eeprom_write(word, written)
        seen = drive.eeprom_read(word)[:2]
        if seen != written:
            sys.exit(f"word {word} of the EEPROM reads {seen.hex()} after {written.hex()} was written")


def main():
    """Finds the drives and writes the alias given on the command line."""
    timeouts = pysoem.settings.timeouts
    timeouts.ret, timeouts.eeprom = 500_000, 2_000_000
    master = pysoem.Master()
    master.open(os.environ["USR2556E_INTERFACE"])
    try:
        if master.config_init() <= 0:
            sys.exit("no drive answers")
        write_alias(master.slaves[0], int(sys.argv[1]))
    finally:
        master.close()


if __name__ == "__main__":
    main()
