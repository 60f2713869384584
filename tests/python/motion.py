"""CiA 402 over process data: enabling, cyclic synchronous position, disabling.

Every layout used here begins with controlword, mode and target, and with statusword, mode display and position.
"""

from verdict import Failure, expect

CSP = 8

# Statusword masks and values of the CiA 402 states.
SWITCH_ON_DISABLED = (0x4F, 0x40)
READY_TO_SWITCH_ON = (0x6F, 0x21)
SWITCHED_ON = (0x6F, 0x23)
OPERATION_ENABLED = (0x6F, 0x27)
FOLLOWS_COMMAND = 1 << 12

# The position that a cycle reads is a few cycles old; this many pulses behind its target, 50 cycles at full speed, is not following.
MOST_LAG = 500


def in_state(state):
    """A condition on the inputs of a drive."""
    mask, value = state
    return lambda row: row[0] & mask == value


def command(segment, controlword, targets):
    """Sets the outputs of all drives: mode CSP, one target each, zeros in whatever else is mapped."""
    rest = [0] * (len(segment.outputs.entries) - 3)
    segment.write_each([(controlword, CSP, target, *rest) for target in targets])


def enable(segment):
    """Takes all drives through the states to Operation Enabled at standstill, and answers their positions."""
    positions = [row[2] for row in segment.cycle()]
    steps = [
        (0x00, SWITCH_ON_DISABLED, "Switch On Disabled"),
        (0x06, READY_TO_SWITCH_ON, "Ready To Switch On"),
        (0x07, SWITCHED_ON, "Switched On"),
        (0x0F, OPERATION_ENABLED, "Operation Enabled"),
    ]
    for controlword, state, name in steps:
        command(segment, controlword, positions)
        segment.cycle_until(in_state(state), f"controlword {controlword:#04x}: {name}")
    segment.cycle_until(lambda row: row[1] == CSP, "mode display is CSP")
    segment.cycle_until(lambda row: row[0] & FOLLOWS_COMMAND, "statusword bit 12: follows the command")
    return positions


def disable(segment):
    """Takes all drives back to Switch On Disabled."""
    positions = [row[2] for row in segment.cycle()]
    command(segment, 0x06, positions)
    segment.cycle_until(in_state(READY_TO_SWITCH_ON), "controlword 0x06: Ready To Switch On")
    command(segment, 0x00, positions)
    segment.cycle_until(in_state(SWITCH_ON_DISABLED), "controlword 0x00: Switch On Disabled")


def ramp(segment, starts, distance):
    """Leads all drives over a distance in pulses and checks that 0x6064 follows and ends on the target."""
    targets = list(starts)
    for offset in offsets(distance):
        targets = [start + offset for start in starts]
        command(segment, 0x0F, targets)
        for target, row in zip(targets, segment.cycle()):
            if row[0] & 0x6F != OPERATION_ENABLED[1]:
                raise Failure(f"statusword {row[0]:#06x} while moving")
            if abs(target - row[2]) > MOST_LAG:
                raise Failure(f"0x6064 = {row[2]} does not follow the target {target}")
    arrived = [False] * len(targets)
    for _ in range(1000):
        arrived = [row[2] == target for target, row in zip(targets, segment.cycle())]
        if all(arrived):
            break
    expect(all(arrived), f"0x6064 follows a CSP ramp of {distance} pulses to its end", f"{segment.read()} for targets {targets}")
    return targets


def offsets(distance):
    """Offsets from the start, one a cycle: the speed rises to 10 pulses a cycle and falls again, one pulse every 10 cycles."""
    direction = 1 if distance > 0 else -1
    travelled, speed, cycle = 0, 1, 0
    while travelled < abs(distance):
        braking = sum(range(speed)) * 10
        left = abs(distance) - travelled
        if cycle % 10 == 0:
            speed = max(1, speed - 1) if left <= braking + speed * 10 else min(10, speed + 1)
        travelled += min(speed, left)
        cycle += 1
        yield direction * travelled


def there_and_back(segment, distance):
    """Enables the drives, moves them over a distance and back, disables them."""
    positions = enable(segment)
    positions = ramp(segment, positions, distance)
    ramp(segment, positions, -distance)
    disable(segment)
