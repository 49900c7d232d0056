"""K-NET and KiK-net: the ASCII file of the Japanese NIED, recorder counts with the scale that makes them gal.

Layout: seventeen lines `key value`, then whole numbers, eight a line
(https://www.kyoshin.bosai.go.jp/kyoshin/man/knetform_en.html).  The counts carry the recorder's offset; as in the
file's own `Max. Acc. (gal)`, the acceleration is what remains without the mean of the whole record.
"""

from __future__ import annotations

import re

from pounding_cli.records.formats.text import Asked, Samples, Text, number

_LINES = 17
_SCALE = re.compile(r"([\d.]+(?:[Ee][-+]?\d+)?)\s*\(\s*gal\s*\)\s*/\s*([\d.]+(?:[Ee][-+]?\d+)?)\s*\Z", re.IGNORECASE)
_PEAK_AGREES = 0.02
# The maximum is printed with three decimals; 0.01 gal more than that allows for small motions.
_PEAK_DIGITS = 0.01


def recognises(text: Text) -> bool:
    """Whether the file begins with an origin time and holds the line of the sampling frequency."""
    top = text.lines[text.first() :][:_LINES]
    return top[0].startswith("Origin Time") and any(line.startswith("Sampling Freq") for line in top)


def read(text: Text, asked: Asked) -> Samples:
    """The samples in gal; raises `InputError` for a missing scale, a wrong count or a peak other than stated."""
    frequency, line = _value(text, "Sampling Freq", "100Hz")
    rate = number(re.sub(r"\s*hz\s*\Z", "", frequency, flags=re.IGNORECASE))
    if rate is None or rate <= 0:
        raise text.refuse(f"the sampling frequency is '{frequency}'", "write e.g. Sampling Freq(Hz) 100Hz", line)
    step = text.same_step(asked.dt, text.step(1.0 / rate, line), line)
    scale, scale_line = _value(text, "Scale Factor", "3920(gal)/6182761")
    parts = _SCALE.match(scale)
    top, bottom = (number(parts[1]), number(parts[2])) if parts else (None, None)
    if not top or not bottom:
        raise text.refuse(
            f"the scale factor is '{scale}': the counts have no unit",
            "write gal over counts, e.g. Scale Factor 3920(gal)/6182761",
            scale_line,
        )
    start = text.first() + _LINES
    rows = text.rows(start)
    counts = [value for _, row in rows for value in row]
    seconds, seconds_line = _value(text, "Duration Time", "60")
    duration = number(seconds)
    if duration is None or not 0 < duration < 1e6:
        raise text.refuse(f"the duration is '{seconds}'", "write it in s, e.g. Duration Time(s) 60", seconds_line)
    text.count(str(round(duration * rate)), len(counts), seconds_line, "duration x frequency")
    mean = sum(counts) / len(counts)
    values = [(count - mean) * (top / bottom) for count in counts]
    _check_peak(text, max(abs(value) for value in values))
    return Samples(step, values, rows[0][0] + 1, "gal", scale_line)


def _check_peak(text: Text, peak: float) -> None:
    try:
        written, line = _value(text, "Max", "")
    except LookupError:
        return
    stated = number(written)
    if stated is not None and abs(peak - abs(stated)) > _PEAK_AGREES * abs(stated) + _PEAK_DIGITS:
        raise text.refuse(
            f"the header says a maximum of {stated:g} gal, but the samples reach {peak:.4g} gal",
            "the file is damaged, or its scale factor is another's: download it again",
            line,
        )


def _value(text: Text, key: str, example: str) -> tuple[str, int]:
    """What stands in column 19 and after on the header line of `key`, and that line."""
    first = text.first()
    for index, line in enumerate(text.lines[first : first + _LINES], first + 1):
        if line.startswith(key):
            return re.sub(rf"\A{key}[A-Za-z. ]*(?:\([^)]*\))?", "", line).strip(), index
    if not example:
        raise LookupError(key)
    raise text.refuse(f"the header has no line '{key}'", f"a K-NET file has one, e.g. {key} {example}", first + 1)
