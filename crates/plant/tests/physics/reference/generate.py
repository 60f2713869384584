#!/usr/bin/env python3
"""Writes tables.csv: what an independent solver makes of the motor's equations.

    python3 -m venv /tmp/reference && /tmp/reference/bin/pip install numpy scipy
    /tmp/reference/bin/python crates/plant/tests/physics/reference/generate.py

The solver is scipy's DOP853, of the eighth order, with tolerances of 1e-11 and a fresh start at each control tick of 50 us, because the bridge's
voltages jump there; duties act in the period after the one in which they are commanded. The equations are written down here once more and share no code with the plant; the motors' data are read from
src/motors.rs. A controller in the loop, the one of tests/physics/controller.rs, chooses the duties.

Two runs for each motor at 24 V and 48 V, at the motor's rated current and with as much inertia again as its rotor has:
- start: from rest under rated current to 3 turns a second within 150 ms, through the first resonance. Without Coulomb friction: at rest it is a set-valued
  function, which this solver has no notion of, and a smooth one in its place is another motor.
- fast: 100 ms at three quarters of the corner speed, up to 16 turns a second, with Coulomb friction, which in motion is a constant torque.
  Nearer to the corner, this simple controller does not hold every motor in step.

The bridge is ideal and the supply stiff, so that the tables check the motor alone.
"""

import math
import multiprocessing
import pathlib
import re

import numpy
from scipy.integrate import solve_ivp

HERE = pathlib.Path(__file__).parent
TICK = 50e-6
PERIODS = 50
EVERY = 40
PARTS = ("resistance", "inductance", "rated_current", "back_emf", "detent_torque", "inertia", "friction", "drag")


def motors():
    """Names and data of the named motors."""
    text = (HERE / "../../../src/motors.rs").read_text()
    data = {}
    for name, body in re.findall(r"pub const (\w+): MotorParameters = MotorParameters \{(.*?)\};", text, re.S):
        values = dict(re.findall(r"(\w+): ([\w:.-]+),", body))
        motor = {part: float(values[part]) for part in PARTS}
        motor["phases"] = 2 if values["phases"].endswith("Two") else 3
        data[name] = motor
    names = re.findall(r'name: "([^"]+)",.*?parameters: (\w+),', text, re.S)
    return {name: data[constant] for name, constant in names}


def corner_speed(motor, supply):
    """Speed in turns a second at which the rated current still fits into 95 % of the voltage."""
    limit = 0.95 * supply / (1 if motor["phases"] == 2 else math.sqrt(3))
    flux = motor["back_emf"] / PERIODS
    current = motor["rated_current"]
    low, high = 0.0, 1e5
    for _ in range(100):
        speed = (low + high) / 2
        reactive = speed * motor["inductance"] * current
        active = motor["resistance"] * current + speed * flux
        low, high = (speed, high) if reactive**2 + active**2 < limit**2 else (low, speed)
    return low / (2 * math.pi * PERIODS)


def duties(motor, supply, currents, phase, speed):
    """The controller: the voltage that the commanded current needs, and a proportional part."""
    cosine, sine = math.cos(2 * math.pi * phase), math.sin(2 * math.pi * phase)
    current, inductance = motor["rated_current"], motor["inductance"]
    quadrature = 2 * math.pi * speed * (PERIODS * inductance * current + motor["back_emf"])
    wanted = (
        motor["resistance"] * current * cosine - quadrature * sine + 4000 * inductance * (current * cosine - currents[0]),
        motor["resistance"] * current * sine + quadrature * cosine + 4000 * inductance * (current * sine - currents[1]),
    )
    if motor["phases"] == 2:
        legs = [part for voltage in wanted for part in (voltage / 2, -voltage / 2)]
    else:
        half = math.sqrt(3) / 2
        legs = [wanted[0], -wanted[0] / 2 + half * wanted[1], -wanted[0] / 2 - half * wanted[1], 0.0]
    return [int((0.5 + min(max(leg / supply, -0.475), 0.475)) * 65536) for leg in legs]


def voltages(motor, supply, legs):
    u, v, w, x = (duty / 65536 * supply for duty in legs)
    if motor["phases"] == 2:
        return u - v, w - x
    return (2 * u - v - w) / 3, (v - w) / math.sqrt(3)


def run(job):
    name, motor, supply, first, acceleration, ticks, rubs = job
    resistance, inductance, constant = motor["resistance"], motor["inductance"], motor["back_emf"]
    torque_constant = constant * (1 if motor["phases"] == 2 else 1.5)
    inertia = 2 * motor["inertia"]
    friction = motor["friction"] if rubs else 0.0

    def slope(_, state, va, vb):
        a, b, speed, angle = state
        sine, cosine = math.sin(PERIODS * angle), math.cos(PERIODS * angle)
        torque = torque_constant * (b * cosine - a * sine) - motor["detent_torque"] * math.sin(4 * PERIODS * angle)
        torque -= motor["drag"] * speed + math.copysign(friction, speed)
        return [
            (va - resistance * a + constant * speed * sine) / inductance,
            (vb - resistance * b - constant * speed * cosine) / inductance,
            torque / inertia,
            speed,
        ]

    state = numpy.array([motor["rated_current"], 0.0, 2 * math.pi * first, 0.0])
    lines = [f"{name},{supply},{first!r},{acceleration!r},{ticks},{int(rubs)}"]
    most = 0.0
    acting = [1 << 15] * 4
    for tick in range(ticks):
        time = (tick + 1) * TICK
        phase = PERIODS * (first * time + acceleration * time * time / 2)
        # What is commanded now acts in the next period.
        coming = duties(motor, supply, state, phase, first + acceleration * time)
        result = solve_ivp(
            slope, (0, TICK), state, "DOP853", args=voltages(motor, supply, acting), rtol=1e-11, atol=1e-13, first_step=TICK / 4
        )
        state = result.y[:, -1]
        acting = coming
        most = max(most, abs(phase - PERIODS * state[3] / (2 * math.pi)))
        if (tick + 1) % EVERY == 0:
            lines.append(f"{state[0]:.6f},{state[1]:.6f},{math.degrees(state[3]):.7f}")
    assert most < 0.45, f"{name} at {supply} V falls out of step: {most} periods"
    return lines


def jobs():
    for name, motor in motors().items():
        for supply in (24, 48):
            yield name, motor, supply, 0.0, 20.0, 3000, False
            yield name, motor, supply, round(0.75 * corner_speed(motor, supply), 3), 0.0, 2000, True


if __name__ == "__main__":
    with multiprocessing.Pool() as pool:
        tables = pool.map(run, jobs(), 1)
    text = "\n".join(line for table in tables for line in table)
    (HERE / "tables.csv").write_text(text + "\n")
