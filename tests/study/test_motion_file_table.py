"""Motion files of every kind: each is read with its peak, step, number of samples and unit, or refused with the key to
write. A new format adds rows to motion_files.yaml."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
import yaml

import pounding_cli as pound
from pounding_cli.records import read_file
from tests.helpers import motion_layouts as layouts

VALUES = (0.0125, -0.03025, 0.048, -0.02175, 0.0095, -0.00425, 0.002, -0.001)
STEP = 0.02
TIMES = [f"{STEP * place:.2f}" for place in range(len(VALUES))]
ONE = [f"{value:.5f}" for value in VALUES]
TWO, THREE = ([f"{factor * value:.5f}" for value in VALUES] for factor in (2, 3))
COUNTING = list(map(str, range(len(VALUES))))


def lines(*columns: Sequence[str], between: str = " ") -> str:
    return "".join(between.join(row) + "\n" for row in zip(*columns, strict=True))


def wrapped(words: Sequence[str], per_line: int, width: int = 10) -> str:
    cells = [word.rjust(width) for word in words]
    return "".join("".join(cells[at : at + per_line]) + "\n" for at in range(0, len(cells), per_line))


COMMAS = [word.replace(".", ",") for word in ONE]
IN_TIMES = [word.replace(".", ",") for word in TIMES]
ROWS = {
    "one": lines(ONE),
    "two": lines(TIMES, ONE),
    "comma": lines(TIMES, ONE, between=","),
    "semicolon": lines(TIMES, ONE, between="; "),
    "tab": lines(TIMES, ONE, between="\t"),
    "quoted": "".join(f'"{time}","{value}"\n' for time, value in zip(TIMES, ONE, strict=True)),
    "milliseconds": lines([f"{20 * place}" for place in range(8)], ONE, between=","),
    "minutes": lines([f"{STEP * place / 60:.12f}" for place in range(8)], ONE, between=","),
    "times-rounded": lines(["0.00", "0.01", "0.01", "0.02", "0.02", "0.03", "0.03", "0.04"], ONE, between=","),
    "swapped": lines(ONE, TIMES, between=","),
    "three": lines(TIMES, ONE, TWO, between=","),
    "four-commas": lines(TIMES, ONE, TWO, THREE, between=","),
    "four": lines(TIMES, ONE, TWO, THREE, between="   "),
    "components": lines(ONE, TWO, THREE, between=","),
    "acc-vel-disp": lines(TIMES, ONE, TWO, THREE, between=","),
    "index-time": lines(COUNTING, TIMES, ONE, between=","),
    "index": lines(COUNTING, ONE, between=","),
    "index-semicolon": lines(COUNTING, ONE, between=";"),
    "index-from-1": lines([str(place + 1) for place in range(8)], ONE),
    "uneven": lines([*TIMES[:4], "0.09", *TIMES[5:]], ONE),
    "rows": wrapped(ONE, 5),
    "end-of-data": lines(TIMES, ONE) + "\n*** END OF DATA ***\n\n",
    "one-eof": lines(ONE) + "EOF",
    "end-and-more": lines(TIMES, ONE) + "end of data\n0.16 0.5\n",
    "words-among-numbers": lines(TIMES, ONE) + "Velocity of the ground\n" + lines(TIMES, TWO),
    "pairs": wrapped([word for pair in zip(TIMES, ONE, strict=True) for word in pair], 4),
    "decimal-comma": lines(COMMAS),
    "decimal-comma-short": "0,0125\n-0,03025\n0,048\n-0,02175\n0,0095\n-0,00425\n0,002\n-0,001\n",
    "decimal-comma-two": lines(IN_TIMES, COMMAS, between=";"),
    "decimal-comma-blank": lines(IN_TIMES, COMMAS),
    "decimal-comma-comma": lines(IN_TIMES, COMMAS, between=","),
    "decimal-comma-quoted": "".join(f'"{time}","{value}"\n' for time, value in zip(IN_TIMES, COMMAS, strict=True)),
    "minus-sign": lines(TIMES, ONE).replace("-", "\u2212"),
    "not-a-number": lines(TIMES, ONE).replace("0.04800", "nan"),
    "junk-in-the-first-row": lines(TIMES, ONE).replace("0.01250", "0.0125x"),
}


CSMNC = (
    "051ABC200101010203\n0200101010203 2020-01-01 1:2:3 BTM\nTEST EARTHQUAKE, NOWHERE\n"
    "EPICENTER  30.000N 103.000E DEPTH 13 KM\nMAGNITUDE  6.0(Ms)\nSTATION: 51ABC 30.000N 102.000E\n"
    "SITE CONDITION: ROCK\nCOMP. EW\nUNCORRECTED ACCELERATION          UNIT: CM/SEC/SEC\n"
    "NO. OF POINTS:  8  EQUALLY SPACED INTERVALS OF:  0.02  SEC\n"
    "PEAK VALUE:    0.048   AT   0.04 SEC    DURATION:  0.16 SEC\nPRE-EVENT TIME:  20  SEC\nCSMNC\n\n" + ROWS["rows"]
)
NSMN = (
    "STRONG GROUND MOTION RECORDS OF TURKIYE\nPLACE                    : NOWHERE\n"
    "EARTHQUAKE DATE          : 01/01/2020 01:02:03 (GMT)\nEARTHQUAKE MAGNITUDE     : 6.0 MW\n"
    "STATION ID               : 4801\nRECORD TIME              : 01/01/2020 01:02:03 (GMT)\n"
    "NUMBER OF DATA           : 8\nSAMPLING INTERVAL (sec)  : 0.02\n"
    "RAW PGA VALUES (gal)     : (N-S) 0.048  (E-W) 0.096  (U-D) 0.144\n"
    "ACCELERATION DATA (gal)\n\n        N-S         E-W         U-D\n" + lines(ONE, TWO, THREE, between="   ")
)
GEONET = layouts.geonet_component(VALUES)
THREE_CHANNELS = (VALUES, *([factor * value for value in VALUES] for factor in (2, 3)))
FILES: dict[str, str | bytes] = {
    "geonet-v2a": GEONET,
    "geonet-v1a": layouts.geonet_component(VALUES, corrected=False),
    "geonet-three": GEONET
    + layouts.geonet_component(THREE_CHANNELS[1], "N80W")
    + layouts.geonet_component(THREE_CHANNELS[2], "Up"),
    "asa": layouts.asa(THREE_CHANNELS),
    "csmnc": CSMNC,
    "renadic": "PROCESADO : 01/01/2020\n\n\n\n\nPRUEBA S/N 675\nL\nUNIVERSIDAD DE CHILE - RENADIC\n" + ROWS["rows"],
    "bhrc": "* VOL1DS: 1234/01 TEST\nINST = SSA-2\n\n\nL\n\nCOMP L\nNowhere Station\n" + ROWS["rows"],
    "caltech": "CORRECTED ACCELEROGRAM IIA001  40.001.0   COMP S00E  FILE 1\nNOWHERE EARTHQUAKE\n" + ROWS["rows"],
    "nsmn": NSMN,
    "html": "<!DOCTYPE html>\n<html><body>404 not found 1 2 3</body></html>\n1 2\n3 4\n",
    "zip": b"PK\x03\x04\x14\0\0\0" + bytes(range(64)),
    "miniseed": b"000001D TEST  HNEXX" + bytes(range(64)),
}

with (Path(__file__).parent / "motion_files.yaml").open(encoding="utf-8") as table:
    CASES = [(kind, row) for kind, rows in yaml.safe_load(table).items() for row in rows]


def told(case: tuple[str, dict[str, Any]]) -> str:
    kind, row = case
    what = row.get("file") or f"{row['head']}-{row['rows']}"
    return f"{kind}: {what}-{row.get('give', '')}".replace("\n", "|")


@pytest.mark.parametrize("case", CASES, ids=told)
def test_the_file_is_read_as_it_means_or_refused_with_the_key(tmp_path: Path, case: tuple[str, dict[str, Any]]) -> None:
    _, row = case
    content = FILES[row["file"]] if "file" in row else f"{row['head']}\n".lstrip("\n") + ROWS[row["rows"]]
    path = tmp_path / "motion.txt"
    path.write_bytes(content if isinstance(content, bytes) else content.encode(row.get("encoding", "utf-8")))
    if "refused" in row:
        with pytest.raises(pound.InputError) as caught:
            read_file(path, **row.get("give", {}))
        (problem,) = caught.value.problems
        said = f"{problem.message} | {problem.hint}"
        assert [word for word in row["refused"] if word not in said] == [], said
        assert "assumed" not in said
        assert "damaged" not in said
        return
    reading = read_file(path, **row.get("give", {}))
    unit, one = row["read"]
    assert reading.unit == unit
    assert reading.motion.pga == pytest.approx(row.get("peak", 0.048 * one), rel=1e-9)
    assert reading.motion.acceleration.size == len(VALUES)
    assert reading.motion.dt == pytest.approx(row.get("step", STEP), rel=1e-12)
    doubt = "; ".join(f"{each.message} | {each.hint}" for each in reading.doubts)
    assert row.get("doubt", "") in doubt
    assert bool(doubt) == ("doubt" in row)
    assert row.get("said", "") in reading.words
