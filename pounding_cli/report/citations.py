"""What a study rests on: a reference for every law, code, measure, method and motion that it uses."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from pounding_cli.laws import link_laws, storey_laws
from pounding_cli.methods import METHODS
from pounding_cli.records import Entry, catalogue
from pounding_cli.report.references import REFERENCES, Reference
from pounding_cli.workflows import WORKFLOWS

Use = Callable[[str, str], None]
"""use(key of REFERENCES, what it is used for)"""


@dataclass(frozen=True)
class Citation:
    """A reference and what a study used it for, one sentence a use."""

    reference: Reference
    uses: tuple[str, ...]


@dataclass(frozen=True)
class Source:
    """Where a motion comes from: its name in the tables, its label (`Motion.source`), and in words."""

    name: str
    kind: str
    text: str


def citations(
    kind: str, resolved: Mapping[str, Any], sources: Mapping[str, str], methods: Collection[str] = ()
) -> list[Citation]:
    """What to cite for a study.

    Parameters
    ----------
    kind : the workflow, a key of WORKFLOWS
    resolved : the study with every default filled in
    sources : motion -> its label: "real", "stand-in" or "user", and ", unit g assumed" behind it
    methods : where scenes are rows of buildings, the keys in METHODS that solve its scenes, buildings alone included
    """
    uses: dict[str, dict[str, None]] = {}

    def used(key: str, what: str) -> None:
        uses.setdefault(key, {})[what] = None

    used("pounding_cli", "the computations")
    _groups(resolved, sources, used)
    _methods(methods, resolved["estimate"] != "none", used)
    if (cite := WORKFLOWS[kind].part("cite")) is not None:
        cite(resolved, used)
    return [Citation(reference, tuple(uses[key])) for key, reference in REFERENCES.items() if key in uses]


def motions(sources: Mapping[str, str]) -> list[Source]:
    """Where the motions come from, as far as the catalogue knows."""
    known = catalogue()
    return [Source(name, kind, _origin(kind, known.get(name))) for name, kind in sources.items()]


def _origin(kind: str, entry: Entry | None) -> str:
    if kind.startswith("user") or entry is None:
        return "your own file: cite its source"
    what = (
        f"{entry.title}: {entry.event}, {entry.date}, magnitude {entry.magnitude}, {entry.station}, {entry.component}"
    )
    if kind.startswith("real"):
        return f"{what}; your own file: cite its source"
    return f"{what}; synthesized by pounding_cli from: {'; '.join(entry.sources)}"


def _groups(resolved: Mapping[str, Any], sources: Mapping[str, str], used) -> None:
    used("spiliopoulos1996", "the model of the buildings, eqs (1) to (4)")
    kinds = {word for case in resolved["cases"].values() for word in _links(case)}
    for law in link_laws().values():
        for key, what in law.citation if law.name in kinds else ():
            used(key, what)
    storeys = {resolved["buildings"][name].get("storey_law") for name in resolved["group"]}
    for storey_law in storey_laws().values():
        for key, what in storey_law.citation if storey_law.name in storeys else ():
            used(key, what)
    for name in dict.fromkeys(resolved["group"]):
        building = resolved["buildings"][name]
        if building["yield_shear"] is None and "code" in building["yield"]:
            used(f"ubc{building['yield']['code'][-4:]}", f"the yield shears of {name}, the separation")
    _scaling(resolved["records"]["scale"], used)
    if "stand-in" in sources.values():
        used("lilhanand1988", "the synthesis of the stand-in motions")


def _links(case: Mapping[str, Any]) -> Iterable[str]:
    """Every kind of link of a case; of pounding by another law, pounding."""
    words = (str(link["link"]) for link in case["links"])
    return ("pounding" if word.startswith("pounding of ") else word for word in words)


def _scaling(scale: Any, used) -> None:
    if scale == "table1":
        used("spiliopoulos1996", "the scales of Table 1")
    if scale == "table1" or (isinstance(scale, Mapping) and "arias" in scale):
        used("arias1970", "the intensity by which the motions are scaled")


def _methods(names: Collection[str], estimated: bool, used) -> None:
    for method in (METHODS[name] for name in names):
        for key, _ in method.citation:
            used(key, f"the method of solution, {method.title}")
        judge = METHODS["taylor"] if method.takes_step else method  # as solve.assess has it
        for key, _ in judge.citation if estimated else ():
            used(key, "the finer runs for error and sensitivity")


def method_sources(names: Iterable[str]) -> list[str]:
    """The publications of methods of solution as lines of Markdown, one a method."""
    lines = []
    for name in names:
        cited = ((REFERENCES[key].text, where) for key, where in METHODS[name].citation)
        lines.append(f"- `{name}`: {'; '.join(f'{text} ({where})' if where else text for text, where in cited)}")
    return lines
