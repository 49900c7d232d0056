"""SMC: the USGS strong-motion file, one component, accelerations in cm/s2.

Layout: 11 lines of text, 6 of integers (8I10), 10 of reals (5E15.7), comments that begin with `|`, then samples
in eight columns of ten (National Strong-Motion Program, https://escweb.wr.usgs.gov/nsmp-data/smcfmt.html).
"""

from __future__ import annotations

import re

from pounding_cli.records.formats.text import Asked, Samples, Text

_TYPE = re.compile(
    r"\s*(\d)\s+(UNCORRECTED ACCELEROGRAM|CORRECTED ACCELEROGRAM|VELOCITY|DISPLACEMENT|RESPONSE|FOURIER)"
)
_WORDS, _INTEGERS, _REALS = 11, 6, 10
_COMMENTS, _COUNT, _PROBLEM = 15, 16, 17
# Places among the integers; the sampling rate is the second real, after the value that stands for "unknown".


def recognises(text: Text) -> bool:
    """Whether the first line is one of the six that the format allows."""
    return bool(_TYPE.match(text.lines[text.first()].upper()))


def read(text: Text, asked: Asked) -> Samples:
    """The samples; raises `InputError` for velocities, spectra, uneven samples, and a record flagged as faulty."""
    first = text.first()
    kind = _TYPE.match(text.lines[first].upper())
    if kind is None:
        raise text.refuse(
            "the first line names no SMC type", "an SMC file begins with e.g. '2 CORRECTED ACCELEROGRAM'", first + 1
        )
    if "ACCELEROGRAM" not in kind[2]:
        quantity = {"RESPONSE": "response spectra", "FOURIER": "Fourier spectra"}.get(kind[2], kind[2].lower())
        raise text.wrong_quantity(quantity, first + 1)
    place = first + _WORDS
    integers, after = text.fixed_block(place, 8 * _INTEGERS, 8, 10)
    reals, start = text.fixed_block(after, 5 * _REALS, 5, 15)
    unknown, rate = reals[0], reals[1]
    if rate == unknown or not rate > 0:
        raise text.refuse(
            "the header gives no sampling rate: the samples are not evenly spaced",
            "download the corrected record ('2 CORRECTED ACCELEROGRAM')",
            after + 1,
        )
    step = text.same_step(asked.dt, text.step(float(f"{1.0 / rate:.9g}"), after + 1), after + 1)
    if integers[_PROBLEM] == 1:
        raise text.refuse(
            "the record is flagged as faulty",
            "read its comments; set the second integer of the third integer line to 0 if you judge it sound",
            place + 3,
        )
    comments, count = int(integers[_COMMENTS]), int(integers[_COUNT])
    if not (0 <= comments < len(text.lines) and 0 < count < 10**9):
        raise text.refuse(
            f"the header says {comments} comments and {count} samples", "download the file again", place + 2
        )
    values, _ = text.fixed(start + comments, count, 8, 10)
    return Samples(step, values, start + comments + 1, "cm/s2", 0)
