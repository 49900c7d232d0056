"""COSMOS: the common format of the strong-motion networks (V1, V2), one or more channels a file.

Every channel: lines of text, blocks of integers and reals that say how many they are and in which Fortran format,
comments, the samples, an end-of-data line (Consortium of Organizations for Strong-Motion Observation Systems,
2001, COSMOS Strong Motion Data Format, version 1.20).
"""

from __future__ import annotations

import re
from dataclasses import dataclass

from pounding_cli.records.formats.text import Asked, Samples, Text, fortran, one_blank

_FIRST = re.compile(r"\(\s*format\s+v\s*[\d.]+", re.IGNORECASE)
_TEXT_LINES = re.compile(r"with\s+(\d{1,3})\s+text\s+lines", re.IGNORECASE)
_BLOCK = re.compile(r"\s*(\d{1,6})\s+(integer|real)[- ]*header", re.IGNORECASE)
_COMMENTS = re.compile(r"\s*(\d{1,6})\s+comment", re.IGNORECASE)
_DATA = re.compile(
    r"\s*(\d{1,9})\s+(\w+)\s+(?:data\s+)?(?:pts|points).*?units?\s*=\s*([^,(]+?)\s*(?:\(\s*\d+\s*\))?\s*,",
    re.IGNORECASE,
)
_CHANNEL = re.compile(r"sta\s+chan?\s*:?\s*(.*?)\s*(?:\(|location|\Z)", re.IGNORECASE)
_QUANTITIES = {1: "acceleration", 2: "velocity", 3: "displacement"}
_UNITS = {2: "g", 4: "cm/s2", 7: "in/s2", 10: "gal", 11: "mg", 12: "ug", 50: "counts"}
_TYPE, _UNIT = 1, 2
_STEP, _STEP_RAW = 61, 33
# Places among the integers and reals (the documentation counts from 1): the data's own step [ms], the recorder's [s].


@dataclass(frozen=True)
class _Block:
    """One series of the file, its samples not yet read."""

    quantity: str
    unit: str
    label: str
    step: float
    count: int
    line: int
    columns: tuple[int, int]


def recognises(text: Text) -> bool:
    """Whether the first line names the format's version."""
    return bool(_FIRST.search(text.lines[text.first()]))


def read(text: Text, asked: Asked) -> Samples:
    """The samples of one channel; raises `InputError` for velocities, or several channels and none named."""
    blocks = _blocks(text)
    found = [block for block in blocks if block.quantity == "acceleration"]
    if not blocks:
        raise text.refuse(
            "no line names the format's version", "a COSMOS file begins with e.g. '... (Format v01.20'", 1
        )
    if not found:
        raise text.wrong_quantity(blocks[0].quantity, blocks[0].line)
    block = found[text.channel(asked, [block.label for block in found], found[0].line)]
    step = text.same_step(asked.dt, text.step(block.step, block.line), block.line)
    values, _ = text.fixed(block.line, block.count, *block.columns)
    return Samples(step, values, block.line + 1, block.unit, block.line)


def _blocks(text: Text) -> list[_Block]:
    blocks = []
    index = text.first()
    while index < len(text.lines):
        if _FIRST.search(text.lines[index]):
            block, index = _block(text, index)
            blocks.append(block)
        else:
            index += 1
    return blocks


def _block(text: Text, start: int) -> tuple[_Block, int]:
    said = _TEXT_LINES.search(text.lines[start])
    index = start + (int(said[1]) if said else 13)
    label = next((found[1] for line in text.lines[start:index] if (found := _CHANNEL.search(one_blank(line)))), "")
    integers, index = _header(text, index, "integer")
    reals, index = _header(text, index, "real")
    comments = _COMMENTS.match(_line(text, index))
    if comments:
        index += 1 + int(comments[1])
    line = _line(text, index)
    data, columns = _DATA.match(one_blank(line)), fortran(line[line.lower().find("format") :])
    if not data or columns is None:
        raise text.refuse(
            "no line that says how many samples follow, in which unit and format",
            "a COSMOS file has e.g. '12091 acceleration pts, approx 120 secs, units=cm/s2 (4),Format=(8F10.5)'",
            min(index, len(text.lines) - 1) + 1,
        )
    quantity = _QUANTITIES.get(_whole(integers, _TYPE), data[2].lower())
    unit = _UNITS.get(_whole(integers, _UNIT), data[3])
    step = _real(reals, _STEP) / 1000.0 if _real(reals, _STEP) > 0 else _real(reals, _STEP_RAW)
    shown = re.sub(r"\s+", " ", label) or "unnamed"
    block = _Block(quantity, unit, shown, float(f"{step:.9g}"), int(data[1]), index + 1, columns)
    return block, index + 1


def _header(text: Text, index: int, kind: str) -> tuple[list[float], int]:
    line = _line(text, index)
    found, columns = _BLOCK.match(line), fortran(line)
    if not found or found[2].lower() != kind or columns is None:
        raise text.refuse(
            f"no line that says how many {kind} header values follow",
            f"a COSMOS file has e.g. '100 {kind.capitalize()}-header values follow on 10 lines, Format= (10I8)' here",
            min(index, len(text.lines) - 1) + 1,
        )
    return text.fixed_block(index + 1, int(found[1]), *columns)


def _line(text: Text, index: int) -> str:
    return text.lines[index] if index < len(text.lines) else ""


def _real(reals: list[float], place: int) -> float:
    return reals[place] if place < len(reals) else -999.0


def _whole(integers: list[float], place: int) -> int:
    return int(integers[place]) if place < len(integers) else -999
