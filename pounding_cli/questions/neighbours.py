"""The buildings that a neighbour may be that is only seen: an axis of a question, behind those of the study."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from pounding_cli.numbers import Unit, join_limited, pluralize
from pounding_cli.study.schema.archetypes import KEY, Seen, is_sample_key, list_seen
from pounding_cli.study.vary.axes import Axis, sweep_maps

if TYPE_CHECKING:
    from pounding_cli.questions.question import StudyQuestion
    from pounding_cli.results.results import ResultTables
    from pounding_cli.study import Study
    from pounding_cli.tables import Table


def list_drawn(study: Study) -> list[Seen]:
    """Return the buildings of the group of which a question draws several, those that they may be.

    Left out are those that the study takes as certain, those of which it gives all that is uncertain, and those of
    which it chooses one by `sample`.
    """
    swept = {key for holder in sweep_maps(study.tree) for key in holder}
    return [
        seen
        for seen in list_seen(study.tree)
        if seen.uncertain_quantities() and seen.spec.sample == 0 and seen.sample_key not in swept
    ]


def build_neighbour_axis(question: StudyQuestion) -> Axis | None:
    """Return the axis of the buildings that neighbours may be, the median ones first; None where all are certain.

    All neighbours move together: each is drawn apart, by its name. What is wrong is noted.
    """
    drawn = list_drawn(question.study)
    if not drawn:
        return None
    counts = {seen.spec.neighbours for seen in drawn}
    if len(counts) > 1:
        names = " and ".join(f"{seen.spec.neighbours} of {seen.name}" for seen in drawn)
        path = ("buildings", drawn[-1].name, KEY)
        hint = "write the same number of `neighbours` in each `archetype`"
        question.problems.add_at(question.study.tree, path, f"the neighbours are drawn together, but {names}", hint)
        return None
    rows = [(number,) * len(drawn) for number in range(counts.pop() + 1)]
    marks = tuple(seen.mark for seen in drawn)
    return Axis(tuple(seen.sample_key for seen in drawn), rows, [marks] * len(rows), (Unit(),) * len(drawn))


def list_drawn_names(results: ResultTables, table: Table) -> list[str]:
    """Return the building types of which a question drew several; not those that the study sweeps.

    table : over what they may be, which has no column of what is drawn
    """
    return [key.split(".")[1] for key in results.axes if is_sample_key(key) and not table.has(key)]


def describe_seen(
    results: ResultTables, building_type: str, name: str = "", row: Mapping[Any, Any] | None = None
) -> str:
    """Return what is known of a building that is only seen: "theirs (C1M, pre-code, 5 storeys)".

    name : of the building where it stands; "": that of its type
    row : of a table at a point of the sweep; without one, what is swept is left out
    """
    seen = results.study_data["buildings"][building_type][KEY]
    path = f"buildings.{building_type}.{KEY}"
    known = []
    for key in ("type", "design", "storeys"):
        is_swept = path in results.axes or f"{path}.{key}" in results.axes
        value = seen[key] if not is_swept else (row or {}).get(f"{path}.{key}")
        if value is not None:
            known.append(pluralize(int(value), "storey") if key == "storeys" else str(value))
    label = name or building_type
    return f"{label} ({', '.join(known)})" if known else label


def note_median_buildings(results: ResultTables) -> str:
    """Return which buildings are the median ones of what they may be; "" where all are certain."""
    buildings = results.study_data["buildings"]
    seen = []
    for name in dict.fromkeys(results.study_data["group"]):
        archetype = buildings[name].get(KEY)
        if archetype and archetype["uncertain"] and archetype["sample"] == 0:
            seen.append(describe_seen(results, name))
    if not seen:
        return ""
    is_are = "is the median building of what it" if len(seen) == 1 else "are the median buildings of what they"
    return (
        f"{join_limited(seen, last=' and ')} {is_are} may be, seen from the street: `pound gap` and `pound fragility` "
        "answer over the others too, `pound check` lists the numbers with their sources."
    )
