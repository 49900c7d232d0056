"""Random statements, evaluated a second time by group-bys over the tables: margins and outcomes agree."""

from __future__ import annotations

import itertools
import math
import operator
import random
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
import pytest

import pounding_cli as pound
from pounding_cli.questions.statements import FAILS, HOLDS, UNKNOWN

STUDY: dict[str, Any] = {
    "records": {"use": ["elcentro", "taft"], "duration": "2 s"},
    "buildings": {
        "soft": {"storeys": 2, "period": "0.5 s", "mass": "200 t", "yield": {"base_shear": "0.1 W"}},
        "stiff": {"storeys": 3, "period": "0.3 s", "mass": "200 t", "yield": {"base_shear": "0.2 W"}},
        "moat": {"wall": {"height": "6 m"}},
    },
    "group": ["soft", "stiff", "soft", "moat"],
    "cases": {
        "near": {"link": "pounding", "gap": "2 mm"},
        "alone": {"link": "none", "gap": "2 cm"},
        "near-b": {
            "gap": "5 mm",
            "links": [
                {"link": "connector", "floors": [2], "pair": 1, "stiffness": "1/5 mean storey of stiff"},
                {"link": "pounding", "floors": "rest"},
            ],
        },
    },
    "sweep": {"impact.restitution": [0.4, 0.6]},
    "analyses": ["elastic", "inelastic"],
    "estimate": "none",
}
KEY = "impact.restitution"
POINTS, CASES, ANALYSES, MOTIONS = (
    (0.4, 0.6),
    ("near", "alone", "near-b"),
    ("elastic", "inelastic"),
    ("elcentro", "taft"),
)
ROLES = {"": None, "stiffest building": ["stiff"], "softer buildings": ["soft-1", "soft-2"]}
ROLES |= {name: [name] for name in ("soft-1", "stiff", "soft-2")}
UNITS = {"mu": "", "V_ratio": "", "drift": "m", "acceleration": "m/s2", "displacement": "m", "impacts": "",
         "peak_force": "N", "max_closing": "m", "events": "", "pga": "m/s2", "period": "s"}  # fmt: skip
TABLES = {
    "storey": ("mu", "V_ratio", "drift"), "floor": ("acceleration", "displacement"),
    "link": ("impacts", "peak_force", "max_closing"), "scene": ("events",), "records": ("pga",),
    "buildings": ("period",),
}  # fmt: skip
REDUCE = {"mean": np.mean, "largest": np.max, "smallest": np.min}
SIGNS = {"<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge}
COUNT = 120


@dataclass(frozen=True)
class Phrase:
    """A quantity as it is drawn, "" and None where it names nothing."""

    table: str
    name: str
    over_buildings: str
    reduction: str
    role: str
    level: int
    law: str
    case: str
    analysis: str
    motion: str
    point: float | None
    order: float

    def __str__(self) -> str:
        level = f"{self.table} {self.level}" if self.level else ""
        law = f"{self.law} links" if self.law else ""
        places = [each for each in (self.role, level, law, self.case, self.analysis, self.motion) if each]
        random.Random(self.order).shuffle(places)
        text = " ".join(each for each in (self.over_buildings, self.reduction, self.name) if each)
        text += f" in {' '.join(places)}" if places else ""
        return text + (f" [{KEY} = {self.point}]" if self.point else "")


def draw_phrase(rng: random.Random) -> Phrase:
    table = rng.choice(list(TABLES))
    of_buildings = table in ("storey", "floor", "buildings")
    of_scenes = table not in ("records", "buildings")
    reduction = rng.choice(["", *REDUCE]) if of_buildings or table == "link" else ""
    role = rng.choice([*ROLES]) if of_buildings and rng.random() < 0.6 else ""
    level = rng.randint(1, 2) if table in ("storey", "floor") and rng.random() < 0.3 else 0
    is_double = table in ("storey", "floor") and reduction and not role and not level and rng.random() < 0.5
    return Phrase(
        table, rng.choice(TABLES[table]), rng.choice([*REDUCE]) if is_double else "", reduction, role, level,
        rng.choice(["", "pounding", "connector"]) if table == "link" else "",
        rng.choice(["", *CASES]) if of_scenes else "", rng.choice(["", *ANALYSES]) if of_scenes else "",
        rng.choice(["", "", *MOTIONS]) if table != "buildings" else "",
        rng.choice([None, None, *POINTS]) if of_scenes else None, rng.random(),
    )  # fmt: skip


def reduce_numbers(how: str, numbers: Any) -> float:
    return float(REDUCE[how](numbers)) if len(numbers) else math.nan


def evaluate(phrase: Phrase, tables: Mapping[str, pd.DataFrame], place: tuple[float, str, str], over: str) -> float:
    """Return a quantity at a point, in a case and analysis; over : reduction of the motions, or one of them."""
    rows = tables[phrase.table]
    point, case, analysis = place
    named = {KEY: phrase.point or point, "case": phrase.case or case, "analysis": phrase.analysis or analysis}
    named |= {"record": phrase.motion or (over if over in MOTIONS else "")}
    for key, value in named.items():
        if key in rows and value:
            rows = rows[rows[key] == value]
    if phrase.table in ("storey", "floor", "buildings"):
        rows = rows[rows["building"].isin(ROLES[phrase.role] or ["soft-1", "stiff", "soft-2"])]
    if phrase.level:
        rows = rows[rows[phrase.table] == phrase.level]
    if phrase.law:
        rows = rows[rows["kind"] == phrase.law]
    over = "mean" if over in MOTIONS else over
    if phrase.table in ("scene", "records"):
        return reduce_numbers(over, rows[phrase.name])
    keys = {
        "storey": ["building", "storey"],
        "floor": ["building", "floor"],
        "link": ["link"],
        "buildings": ["building"],
    }
    groups = rows.groupby(keys[phrase.table], observed=True, sort=False)[phrase.name]
    numbers = groups.first() if phrase.table == "buildings" else groups.agg(lambda each: reduce_numbers(over, each))
    reduction = phrase.reduction or "largest"
    if phrase.over_buildings:
        of_building = numbers.groupby(level=0, observed=True).agg(lambda each: reduce_numbers(reduction, each))
        return reduce_numbers(phrase.over_buildings, of_building)
    return reduce_numbers(reduction, numbers)


@dataclass(frozen=True)
class Drawn:
    """A statement as it is drawn: phrases and values, and the signs between them."""

    parts: tuple[Phrase | float, ...]
    signs: tuple[str, ...]
    over: str

    @property
    def unit(self) -> str:
        return next(UNITS[each.name] for each in self.parts if isinstance(each, Phrase))

    def __str__(self) -> str:
        texts = [str(each) if isinstance(each, Phrase) else f"{each!r} {self.unit}".strip() for each in self.parts]
        return texts[0] + "".join(f" {sign} {text}" for sign, text in zip(self.signs, texts[1:], strict=True))

    def test(self, tables: Mapping[str, pd.DataFrame], place: tuple[float, str, str]) -> tuple[float, str]:
        """Return the smallest margin and the outcome at a place."""
        margins, held = [], []
        for over in MOTIONS if self.over == "each" else [self.over]:
            parts = [evaluate(each, tables, place, over) if isinstance(each, Phrase) else each for each in self.parts]
            steps = list(zip(parts, self.signs, parts[1:], strict=False))
            margins.append(min((right - left) * (1 if sign[0] == "<" else -1) for left, sign, right in steps))
            held.append(all(SIGNS[sign](left, right) for left, sign, right in steps))
            if any(map(math.isnan, parts)):
                return math.nan, UNKNOWN  # a case without links lacks them under every motion
        return min(margins), HOLDS if all(held) else FAILS


def draw_statement(rng: random.Random, tables: Mapping[str, pd.DataFrame]) -> Drawn:
    """Return a statement whose values lie at, just below or above a number that its quantity takes."""
    phrase, over = draw_phrase(rng), rng.choice(["each", *REDUCE])
    other = draw_phrase(rng)
    place = (rng.choice(POINTS), rng.choice(CASES), rng.choice(ANALYSES))
    number = evaluate(phrase, tables, place, MOTIONS[0] if over == "each" else over)
    low, high = (float((number if math.isfinite(number) else 1.0) * rng.choice([0.8, 1.0, 1.25])) for _ in range(2))
    parts = rng.choice([(phrase, high), (low, phrase), (low, phrase, high)])
    if UNITS[other.name] == UNITS[phrase.name]:
        parts = (phrase, other)
    direction = rng.choice("<>")
    return Drawn(parts, tuple(direction + rng.choice(["", "="]) for _ in parts[1:]), over)


def iter_places(row: Mapping[str, Any]) -> Iterator[tuple[float, str, str]]:
    """Yield the places for which a row of the table stands: all where it names none."""
    points = POINTS if math.isnan(row[KEY]) else (row[KEY],)
    cases = [row["case"] or CASES[0], row["case"] or CASES[-1]]
    analyses = [row["analysis"] or each for each in ANALYSES]
    yield from itertools.product(points, set(cases), set(analyses))


@pytest.mark.parametrize("seed", [1])
def test_random_statements_have_the_outcomes_of_group_bys(tmp_path, monkeypatch, seed):
    monkeypatch.delenv("POUND_RECORDS", raising=False)
    file = tmp_path / "r.h5"
    results = pound.run(STUDY, file, engine="serial")
    tables = {name: getattr(results, name)() for name in TABLES if name != "buildings"}
    tables["buildings"] = results.buildings
    rng = random.Random(seed)
    drawn = {str(number): draw_statement(rng, tables) for number in range(1, COUNT + 1)}
    statements = [{"says": "x", "holds": str(each), "over_motions": each.over} for each in drawn.values()]
    frame = pound.run({**STUDY, "statements": statements}, file, engine="serial").table("statements")
    found = set()
    for row in frame.to_dict("records"):
        one = drawn[row["statement"]]
        for place in iter_places(row):
            margin, outcome = one.test(tables, place)
            assert row["outcome"] == outcome, (str(one), one.over, place)
            assert row["margin"] == pytest.approx(margin, rel=1e-9, abs=1e-9, nan_ok=True), (str(one), one.over, place)
            found.add(outcome)
    assert set(frame["statement"]) == set(drawn)
    assert found == {HOLDS, FAILS, UNKNOWN}
