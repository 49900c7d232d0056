"""Motion files of every kind: each is read as declared, or refused with the line that cures it: pasted, that line reads
the motion. A new kind adds rows to motion_files.yaml."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
import yaml

import pounding_cli as pound
from pounding_cli.records import Declaration, read_file
from tests.helpers import motion_layouts as layouts

VALUES = (0.0125, -0.03025, 0.048, -0.03075, 0.0045, -0.00625, 0.003, -0.00075)
STEP = 0.02
TIMES = [f"{STEP * place:.2f}" for place in range(len(VALUES))]
ONE = [f"{value:.5f}" for value in VALUES]
TWO, THREE = ([f"{factor * value:.5f}" for value in VALUES] for factor in (2, 3))
COUNTING = list(map(str, range(len(VALUES))))
MAX_PASTES = 3


def lines(*columns: Sequence[str], between: str = " ") -> str:
    return "".join(between.join(row) + "\n" for row in zip(*columns, strict=True))


def wrapped(words: Sequence[str], per_line: int, width: int = 10) -> str:
    cells = [word.rjust(width) for word in words]
    return "".join("".join(cells[at : at + per_line]) + "\n" for at in range(0, len(cells), per_line))


COMMAS = [word.replace(".", ",") for word in ONE]
IN_TIMES = [word.replace(".", ",") for word in TIMES]
CARDS = ["".join(f"{value:9.6f}" for value in VALUES[at : at + 4]) for at in (0, 4)]
THOUSANDS = [f"{100000 * value:,.0f}" for value in VALUES]
ROWS = {
    "one": lines(ONE),
    "two": lines(TIMES, ONE),
    "comma": lines(TIMES, ONE, between=","),
    "semicolon": lines(TIMES, ONE, between="; "),
    "tab": lines(TIMES, ONE, between="\t"),
    "quoted": "".join(f'"{time}","{value}"\n' for time, value in zip(TIMES, ONE, strict=True)),
    "trailing-commas": lines(TIMES, ONE, [""] * 8, between=","),
    "seconds": lines(COUNTING, ONE),
    "swapped": lines(ONE, TIMES, between=","),
    "three": lines(TIMES, ONE, TWO, between=","),
    "components": lines(ONE, TWO, THREE, between=","),
    "index-time": lines(COUNTING, TIMES, ONE, between=","),
    "uneven": lines([*TIMES[:4], "0.09", *TIMES[5:]], ONE),
    "five": wrapped(ONE, 5),
    "cards": "".join(f"{card}{place:8d}\n" for place, card in enumerate(CARDS, 1)).replace(" -", "-"),
    "cards-with-blanks": "".join(f"{row}{place:8d}\n" for place, row in enumerate(wrapped(ONE, 2).splitlines(), 1)),
    "implied": "".join("".join(f"{1e6 * value:9.0f}" for value in VALUES[at : at + 4]) + "\n" for at in (0, 4)),
    "two-channels": wrapped(ONE, 5) + "CHANNEL 2\n" + wrapped(TWO, 5),
    "blank-line": lines(ONE) + "\n" + lines(TWO),
    "end-of-data": lines(TIMES, ONE) + "\n*** END OF DATA ***\n\n",
    "words-below": lines(TIMES, ONE) + "END OF DATA\n",
    "missing-cell": lines(TIMES, [*ONE[:4], "", *ONE[5:]]),
    "empty-cell": lines(TIMES, [*ONE[:4], "", *ONE[5:]], between=","),
    "empty-first": lines([*TIMES[:4], "", *TIMES[5:]], ONE, between=","),
    "decimal-comma": lines(COMMAS),
    "decimal-comma-two": lines(IN_TIMES, COMMAS, between=";"),
    "decimal-comma-blank": lines(IN_TIMES, COMMAS),
    "decimal-comma-comma": lines(IN_TIMES, COMMAS, between=","),
    "quoted-decimal-commas": "".join(f'"{time}","{value}"\n' for time, value in zip(IN_TIMES, COMMAS, strict=True)),
    "points-of-thousands": lines([word.replace(",", ".") for word in THOUSANDS]),
    "milliseconds": lines([f"{20 * place}" for place in range(8)], ONE),
    "peak-below": lines([*ONE, "0.04800"]),
    "pairs": wrapped([word for pair in zip(TIMES, ONE, strict=True) for word in pair], 4),
    "comment-among": lines(TIMES[:3], ONE[:3]) + "# peak\n" + lines(TIMES[3:], ONE[3:]),
    "double-spaced": lines(TIMES, ONE).replace("\n", "\n\n"),
    "times-before-rows": "".join(f"{0.04 * n:6.2f}{row}\n" for n, row in enumerate(wrapped(ONE, 2).splitlines())),
    "thousands": lines(TIMES, THOUSANDS, between="\t"),
    "semicolon-thousands": lines(IN_TIMES, [word.replace(",", ".") for word in THOUSANDS], between=";"),
    "with-unit": lines(TIMES, [ONE[0], ONE[1] + "g", *ONE[2:]]),
    "stars": lines(TIMES, [ONE[0], "*******", *ONE[2:]]),
    "minus-sign": lines(TIMES, ONE).replace("-", "\u2212"),
    "not-a-number": lines(TIMES, ONE).replace("0.04800", "nan"),
    "junk-in-the-first-row": lines(TIMES, ONE).replace("0.01250", "0.0125x"),
    "one-sign": lines([word.strip("-") for word in ONE]),
    "sentinel": lines(TIMES, [*ONE[:2], "-999", "-999.0", *ONE[4:]]),
    "one-sentinel": lines(TIMES, [*ONE[:2], "-9999", *ONE[3:]]),
    "spike": lines(TIMES, [*ONE[:2], "0.48000", *ONE[3:]]),
}
GEONET = layouts.geonet_component(VALUES)
THREE_CHANNELS = (VALUES, *([factor * value for value in VALUES] for factor in (2, 3)))
FILES: dict[str, str | bytes] = {
    "geonet-v2a": GEONET,
    "geonet-v1a": layouts.geonet_component(VALUES, corrected=False),
    "geonet-three": GEONET
    + layouts.geonet_component(THREE_CHANNELS[1], "N80W")
    + layouts.geonet_component(THREE_CHANNELS[2], "Up"),
    "asa": layouts.asa(THREE_CHANNELS),
    "html": "<!DOCTYPE html>\n<html><body>404 not found</body></html>\n",
    "zip": b"PK\x03\x04\x14\0\0\0" + bytes(range(64)),
}

with (Path(__file__).parent / "motion_files.yaml").open(encoding="utf-8") as table:
    CASES = [(kind, row) for kind, rows in yaml.safe_load(table).items() for row in rows]


def told(case: tuple[str, dict[str, Any]]) -> str:
    kind, row = case
    what = row.get("file") or f"{row['head']}-{row['rows']}"
    return f"{kind}: {what}-{row.get('give', '')}".replace("\n", "|")


def read_pasted(path: Path, refused: pound.InputError, filled: dict[str, str]) -> Any:
    """What the line of a refusal reads: a person pastes it, and fills in what it leaves open, as often as it comes."""
    for _ in range(MAX_PASTES):
        (problem,) = refused.issues
        found = re.search(r"\{file: .*\}", problem.hint)
        assert found is not None, problem
        line = found[0]
        for word, value in filled.items():
            line = line.replace(word, value)
        keys = yaml.safe_load(line)
        assert keys.pop("file") == path.name
        if "dt" in keys:
            number, unit = keys["dt"].split()
            keys["dt"] = float(number) * {"s": 1.0, "ms": 0.001}[unit]
        try:
            return read_file(path, Declaration(**keys))
        except pound.InputError as again:
            refused = again
    raise refused


@pytest.mark.parametrize("case", CASES, ids=told)
def test_the_file_is_read_as_declared_or_refused_with_the_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, case: tuple[str, dict[str, Any]]
) -> None:
    monkeypatch.chdir(tmp_path)
    _, row = case
    content = FILES[row["file"]] if "file" in row else f"{row['head']}\n".lstrip("\n") + ROWS[row["rows"]]
    path = Path("motion.txt")
    path.write_bytes(content if isinstance(content, bytes) else content.encode(row.get("encoding", "utf-8")))
    declared = Declaration(**row.get("give", {}))
    if "refused" in row:
        with pytest.raises(pound.InputError) as caught:
            read_file(path, declared)
        (problem,) = caught.value.issues
        said = f"{problem.message} | {problem.hint}"
        assert [word for word in row["refused"] if word not in said] == [], said
        assert "damaged" not in said or row["head"].startswith("#")
        if "paste" not in row:
            return
        reading = read_pasted(path, caught.value, row["paste"])
    else:
        reading = read_file(path, declared)
    assert reading.motion.pga == pytest.approx(row.get("peak", 0.048) * row["read"], rel=1e-9)
    assert reading.motion.acceleration.size == len(VALUES)
    assert reading.motion.dt == pytest.approx(row.get("step", STEP), rel=1e-12)
    doubt = "; ".join(f"{each.message} | {each.hint}" for each in reading.doubts)
    assert row.get("doubt", "") in doubt
    assert bool(doubt) == ("doubt" in row), doubt
    assert row.get("said", "") in "\n".join(reading.lines)
