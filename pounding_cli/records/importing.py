"""Bringing a real motion into the user's folder: its normalised file, and what differs from the catalogue."""

from __future__ import annotations

from pathlib import Path

from pounding_cli.records.catalogue import Entry
from pounding_cli.records.intensity import arias
from pounding_cli.records.motion import GRAVITY, Motion
from pounding_cli.records.writers import motion_text

_PEAK = 0.02
_ARIAS = 0.02
# Relative differences worth telling; two digitisations of one film often differ by more than that.


def imported_text(entry: Entry, motion: Motion, origin: Path) -> str:
    """The text of the imported motion's file: values in full, with where they came from and their digest."""
    about = {
        "motion": entry.title,
        "event": f"{entry.event}, {entry.date.isoformat()}",
        "station": f"{entry.station}, {entry.component}",
        "imported from": origin.name,
        "digest": motion.digest,
    }
    return motion_text(motion, about)


def differences(entry: Entry, motion: Motion) -> list[str]:
    """What differs from the catalogue, in words: peak, Arias intensity in the window, time step, length."""
    told = []
    facts, window = entry.facts, motion.windowed(entry.duration)
    if motion.duration < entry.duration - 0.5 * motion.dt:
        told.append(f"length: {motion.duration:g} s, shorter than Table 1's {entry.duration:g} s: all is used")
    measured = entry.facts_of == "real"
    known = "measured on a public digitisation" if measured else "estimated from Table 1"
    if abs(window.pga / facts.pga - 1.0) > _PEAK:
        told.append(
            f"peak: {window.pga / GRAVITY:.3f} g in the first {entry.duration:g} s, "
            f"against {facts.pga / GRAVITY:.3f} g {known} and {entry.peak / GRAVITY:.2f} g in Table 1"
        )
    found = arias(window)
    if abs(found / facts.arias - 1.0) > _ARIAS:
        told.append(
            f"Arias intensity: {found:.3f} m/s in the first {entry.duration:g} s, "
            f"against {facts.arias:.3f} m/s {known}: an Arias scale "
            f"changes by {(facts.arias / found) ** 0.5:.3f}"
        )
    if facts.dt is not None and abs(motion.dt / facts.dt - 1.0) > 1e-6:
        told.append(f"time step: {motion.dt:g} s, against {facts.dt:g} s: another digitisation")
    if facts.samples is not None and facts.dt is not None:
        length = facts.dt * (facts.samples - 1)
        if abs(motion.duration - length) > facts.dt:
            told.append(f"whole length: {motion.duration:g} s, against {length:g} s: cut, or another digitisation")
    return told
