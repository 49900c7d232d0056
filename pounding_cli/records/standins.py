"""The stand-ins that ship: which target each has, and the file it is written to."""

from __future__ import annotations

from pounding_cli.records.catalogue import Entry
from pounding_cli.records.motion import Motion
from pounding_cli.records.synthesis import Target, synthesize
from pounding_cli.records.writers import motion_text

DIGITS = 6
"""Decimals of g in a shipped file; rounding moves a sample by at most 5e-7 g."""


def target_of(entry: Entry) -> Target:
    """What the stand-in of a catalogue entry has to match: its facts, within Table 1's duration."""
    facts = entry.facts
    return Target(
        name=entry.name,
        seed=entry.seed,
        dt=entry.step,
        duration=entry.duration,
        pga=facts.pga,
        arias=facts.arias,
        husid_fractions=facts.husid_fractions,
        husid_times=facts.husid_times,
        periods=facts.periods,
        spectrum=facts.spectrum,
        pgv=facts.pgv,
    )


def stand_in(entry: Entry) -> Motion:
    """Synthesize the stand-in of a catalogue entry; the same every time."""
    return synthesize(target_of(entry))


def stand_in_text(entry: Entry, motion: Motion) -> str:
    """The text of the stand-in's file, its header saying what it is and how to make it again."""
    basis = "facts measured on the real motion" if entry.facts_of == "real" else "estimated facts"
    about = {
        "stand-in": f"STAND-IN for {entry.title}: synthetic, random phases, not a recording",
        "matches": f"{basis} in catalogue.yaml, within the first {entry.duration:g} s",
        "made by": f"pound records synthesize {entry.name} (seed {entry.seed})",
    }
    return motion_text(motion, about, DIGITS)
