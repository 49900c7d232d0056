"""Reading a motion file: its format found, its samples read, its unit settled, what cannot be a motion refused."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pounding_cli.records.formats import CHANNELS, PLAIN, READERS, format_of
from pounding_cli.records.formats.text import Asked, Samples, Text, load
from pounding_cli.records.motion import GRAVITY, Motion
from pounding_cli.records.units import UNITS, acceleration_unit, quantity_of

FORMATS = tuple(READERS)

ASSUMED = ", unit {} assumed"
"""What the label of a motion says where nobody states its unit."""

_LARGEST = 5.0 * GRAVITY
# The strongest ground accelerations ever recorded lie between 3 and 5 g; above that the unit is wrong.


@dataclass(frozen=True)
class Reading:
    """A motion and how it was read: `format`, `unit`, and who said the unit ("the file", "you", "nobody").

    heading : what stands over the values where no unit can be read from it and nobody says one, else ""
    stated : the other unit that the file states where the unit given is not that, else ""
    """

    motion: Motion
    format: str
    unit: str
    unit_from: str
    heading: str = ""
    stated: str = ""

    @property
    def words(self) -> str:
        """The unit and where it comes from: "in g (assumed: the file states no unit)"."""
        if self.unit_from == "nobody":
            why = f"'{self.heading}' in the file is no unit" if self.heading else "the file states no unit"
            return f"in {self.unit} (assumed: {why})"
        given = f"as given, although the file says {self.stated}" if self.stated else "as given"
        return f"in {self.unit} ({'as the file says' if self.unit_from == 'the file' else given})"


def read_motion(
    path: str | Path,
    *,
    name: str | None = None,
    unit: str | None = None,
    dt: float | None = None,
    format: str | None = None,
    channel: int | None = None,
    column: int | None = None,
    source: str = "user",
) -> Motion:
    """Read a ground motion from a text file.

    Parameters
    ----------
    path : the file
    name : what to call the motion; the file's own `# name:` line or its stem unless given
    unit : unit of the acceleration (`records.units`); needed only where the file does not state it. In plain columns
        it comes before what the headings say, and without either the unit is g. Elsewhere it is refused where it
        contradicts the file
    dt : time step [s]; needed for one column without a `# dt:` line, otherwise checked against the file's own
    format : one of `FORMATS`; default: detected
    channel : which channel of a file that holds several (COSMOS, CSMIP), from 1
    column : which column of a table holds the acceleration, from 1
    source : label of the motion; that of a motion whose unit is assumed says so

    Raises `InputError`, with file and line, for a file that is missing, empty or not text, a value that is no
    number, uneven or falling times, a count, peak or digest other than the header's, a missing or contradicting
    time step or unit, velocities, displacements, counts without a scale, and a peak above 5 g (a wrong unit).
    """
    return read_file(
        path, name=name, unit=unit, dt=dt, format=format, channel=channel, column=column, source=source
    ).motion  # fmt: skip


def read_file(
    path: str | Path,
    *,
    name: str | None = None,
    unit: str | None = None,
    dt: float | None = None,
    format: str | None = None,
    channel: int | None = None,
    column: int | None = None,
    source: str = "user",
) -> Reading:
    """As `read_motion`, with how the file was read."""
    text = load(Path(path))
    asked = Asked(dt, channel, column)
    if unit is not None and acceleration_unit(unit) is None:
        raise text.refuse(f"unknown unit '{unit}' of acceleration", f"write one of {', '.join(UNITS)}, or 0.01 g")
    if format is not None and format not in READERS:
        raise text.refuse(f"unknown format '{format}'", f"write one of {', '.join(FORMATS)}")
    kind = format or format_of(text, asked)
    _refuse_stray(text, kind, asked)
    samples = READERS[kind](text, asked)
    used, who, stated = _unit(text, kind, samples, unit)
    values = _sound(text, samples, used)
    label = f"{source}{ASSUMED.format(used)}" if who == "nobody" else source
    motion = Motion(name or text.header.get("name") or Path(path).stem, samples.dt, values, label)
    written = text.header.get("digest")
    if kind == "column" and written is not None and written != motion.digest:
        raise text.refuse(
            "the samples are not those the file was written with: their digest differs",
            "import the motion again, or take the '# digest:' line out if the change was meant",
            samples.line,
        )
    return Reading(motion, kind, used, who, samples.heading if who == "nobody" else "", stated)


def _refuse_stray(text: Text, kind: str, asked: Asked) -> None:
    if asked.channel is not None and kind not in CHANNELS:
        raise text.refuse(f"a file of format '{kind}' has no channels", "leave 'channel' out")
    if asked.column is not None and kind != "table":
        raise text.refuse(f"a file of format '{kind}' has no columns to choose from", "leave 'column' out")


def _unit(text: Text, kind: str, samples: Samples, given: str | None) -> tuple[str, str, str]:
    """The unit the samples are in, who says so, and another one that headings state; raises `InputError` where a
    format that defines its unit contradicts the one given."""
    stated = samples.unit
    if stated is None:
        if given is None and kind not in PLAIN:
            raise text.refuse("the file does not state its unit", "give it: unit: cm/s2, or --unit cm/s2", samples.line)
        return (given, "you", "") if given else ("g", "nobody", "")
    if quantity_of(stated) == "counts":
        if given is None:
            raise text.refuse(
                "the file holds recorder counts, and no scale that makes them an acceleration",
                "download the processed record (V1 or V2), or say what one count is, e.g. unit: 6.34e-4 gal",
                samples.unit_line,
            )
        return given, "you", ""
    factor = acceleration_unit(stated)
    if factor is None:
        raise text.refuse(
            f"the file's unit '{stated}' is none of acceleration",
            f"correct it there: one of {', '.join(UNITS)}",
            samples.unit_line,
        )
    if given is not None and not abs((acceleration_unit(given) or 0.0) / factor - 1.0) <= 1e-4:
        if kind in PLAIN:
            return given, "you", stated
        raise text.refuse(
            f"the unit is given as {given}, but the file says {stated}",
            "leave the unit out, or correct the file's",
            samples.unit_line,
        )
    return stated, "the file", ""


def _sound(text: Text, samples: Samples, unit: str) -> np.ndarray:
    """The samples in m/s2; raises `InputError` where they can be no ground motion."""
    values = np.array(samples.values, dtype=float)
    if values.size < 2:
        raise text.refuse("only one sample found", "a motion needs at least two samples", samples.line)
    factor = acceleration_unit(unit) or 0.0
    peak = float(np.abs(values).max())
    if peak == 0.0:
        raise text.refuse("every sample is zero", "give a file that holds a ground motion", samples.line)
    if peak > _LARGEST / factor:
        raise text.refuse(
            f"the peak is {peak * (factor / GRAVITY):.4g} g read in {unit}: no ground motion is that strong",
            f"give the unit of the file: {', '.join(UNITS)}; recorder counts need their scale, e.g. 6.34e-4 gal",
            samples.line,
        )
    return values * factor
