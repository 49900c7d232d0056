"""Closed forms of the sources of docs/published/, which the literals of its studies are checked against."""

from __future__ import annotations

from math import acos, cos, pi, sin, sqrt

from scipy.constants import g as GRAVITY
from scipy.optimize import brentq
from scipy.special import beta

# Blows on a rigid wall


def find_rigid_speed(w: float, r: float, s: float, periods: int = 1) -> float:
    """Return the speed of the blow that comes once in some periods of x'' + x = cos(w t) with a rigid wall at s [-].

    Source: Shaw, S. W. & Holmes, P. J. (1983). A periodically forced piecewise linear oscillator. Journal of Sound and
    Vibration 90(1), 129-155.
    """
    lapse = 2 * pi * periods / w
    amplitude = 1 / (1 - w**2)
    loss = (1 - r) / w
    turn = (1 + r) * sin(lapse) / (1 - cos(lapse))
    root = sqrt(amplitude**2 * turn**2 - (s**2 - amplitude**2) * loss**2)
    return 2 * (root - turn * s) / (turn**2 + loss**2)


def find_doubling_speed(w: float, r: float) -> float:
    """Return the speed at which the motion of x'' + x = cos(w t) with one blow in a period doubles its period [-].

    Source: Budd, C. & Dux, F. (1994). Chattering and related behaviour in impact oscillators. Philosophical
    Transactions of the Royal Society of London A 347, 365-389; as F. Dux's program impact-oscillator has it.
    """
    period = 2 * pi / w
    amplitude = 1 / (1 - w**2)
    loss = (1 - r) / w
    sine, cosine = sin(period), cos(period)
    turn = (1 + r) * sine / (1 - cosine)
    trace = 4 * r * cosine - 2 * (1 + r**2) + (w**2 - 1) * turn**2 * (1 - cosine)
    swing = (1 + r) * w * sine
    square = trace**2 + swing**2 * (w**2 * (turn**2 + loss**2) - 2 * trace / (1 - cosine))
    return abs(2 * swing * w * amplitude) / sqrt(square)


def find_doubling_wall(w: float, r: float) -> float:
    """Return the place of the wall, s, at which the blows begin to alternate [-]."""
    speed = find_doubling_speed(w, r)
    return float(brentq(lambda s: find_rigid_speed(w, r, s) - speed, 0.0, 0.15))


# Single blows


def find_plate_blow(
    mass: float, width: float, depth: float, place: float, speed: float, e: float
) -> tuple[float, float, float, float]:
    """Return impulse [N s], rate of the twist [rad/s], speed of the centre after it [m/s] and loss [J] of a blow of a
    free rectangular plate on a wall.

    Source: linear and angular momentum about the centre, J = m (v - v1) = I w / y, and the restitution of the speed of
    the point that strikes.

    place : of the blow, off the centre [m]
    speed : before it [m/s]
    e : restitution [-]
    """
    inertia = mass * (width**2 + depth**2) / 12
    effective = 1 / (1 / mass + place**2 / inertia)
    impulse = (1 + e) * effective * speed
    return impulse, impulse * place / inertia, speed - impulse / mass, effective * speed**2 * (1 - e**2) / 2


def find_travel(mass: float, stiffness: float, friction: float, speed: float, way: float) -> tuple[float, float]:
    """Return by how much a sliding block compresses a spring, and how far from the spring it comes to rest [m].

    Source: the kinetic energy, less the friction on the way, is in the spring at the turn; that of the spring goes into
    the friction on the way back.

    speed : when the block is let go [m/s]
    way : from there to the spring [m]
    """
    slip_force = friction * mass * GRAVITY
    energy = mass * speed**2 / 2 - slip_force * way
    compression = (sqrt(slip_force**2 + 2 * stiffness * energy) - slip_force) / stiffness
    return compression, stiffness * compression**2 / 2 / slip_force - compression


def find_deepest(mass: float, stiffness: float, height: float, gravity: float) -> float:
    """Return when a mass that falls from rest on a spring is at its deepest [s].

    Source: free fall, then m x'' = m g - k x from x = 0 and the speed of the fall.
    """
    frequency = sqrt(stiffness / mass)
    speed = sqrt(2 * gravity * height)
    turn = pi / 2 + acos(speed / sqrt(speed**2 + (gravity / frequency) ** 2))
    return speed / gravity + turn / frequency


def find_stop_impulse(mass: float, stiffness: float, stop: float, speed: float) -> float:
    """Return the impulse of a blow of an oscillator on an elastic stop that it touches at rest [N s].

    Source: the force k_s x of x = v / w sin(w t), w^2 = (k + k_s) / m, over half a period.
    """
    return 2 * mass * speed * stop / (stiffness + stop)


def find_frequency(energy: float, mass: float, stiffness: float, stop: float, gap: float) -> float:
    """Return the frequency of the free vibration of an oscillator that reaches an elastic stop on one side [Hz].

    Source: the time of a sine between its crossings of the place of the stop, without and with it.

    energy : of the vibration, more than that of the gap [J]
    stiffness, stop : of the oscillator and of the stop [N/m]
    gap : between the stop and the place of rest [m]
    """
    speed = sqrt((2 * energy - stiffness * gap**2) / mass)
    free, held = sqrt(stiffness / mass), sqrt((stiffness + stop) / mass)
    depth = gap * stiffness / (stiffness + stop)  # of the stop's edge over the place of rest on it
    apart = 2 * (pi - acos(gap * free / sqrt((gap * free) ** 2 + speed**2))) / free
    touching = 2 * acos(depth * held / sqrt((depth * held) ** 2 + speed**2)) / held
    return 1 / (apart + touching)


def find_hertz_blow(mass: float, stiffness: float, speed: float) -> tuple[float, float]:
    """Return the largest force [N] and the duration [s] of a blow on a contact F = k_h v^1.5 without damping.

    Source: the energy (1/2) m v0^2 = (2/5) k_h v_max^2.5; the duration is the integral of dv / v' over the blow.
    """
    closing = (1.25 * mass * speed**2 / stiffness) ** 0.4
    return stiffness * closing**1.5, 0.8 * beta(0.4, 0.5) * closing / speed


# Rods


def find_wave_time(length: float, modulus: float, density: float) -> float:
    """Return the time that a wave takes to run a rod [s]."""
    return length * sqrt(density / modulus)


def find_rod_displacement(time: float, wave: float, speed: float = 1.0) -> float:
    """Return the displacement of the end of a free rod that strikes an equal one, fixed at its far end [m].

    Source: both ends move at half the speed until the wave returns from the free end, then back as fast, until the
    other one returns from the fixed end and throws the free rod back at its whole speed.

    time : after the contact [s]
    wave : time that a wave takes to run a rod [s]
    speed : of the blow [m/s]
    """
    there = -0.5 * min(time, 2 * wave)
    back = 0.5 * min(max(time - 2 * wave, 0), 2 * wave)
    return speed * (there + back + max(time - 4 * wave, 0))


# Restitution and yielding


def find_ice_restitution(speed: float) -> float:
    """Return the restitution of ice at a speed [m/s].

    Source: the measurements of Bridges et al. (1984), as the examples of the program REBOUND have them.
    """
    return 0.32 * (100 * speed) ** -0.234


def find_sudden_displacement(strength: float, stiffness: float, force: float) -> float:
    """Return the largest displacement of an elastoplastic oscillator under a sudden force that stays.

    Source: the work of the force is that of the spring, F x = R x - R^2 / (2 k).
    """
    return strength**2 / (2 * stiffness * (strength - force))
