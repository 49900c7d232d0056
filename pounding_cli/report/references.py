"""What a study rests on: the literature in `references.bib`, and who uses which entry for what."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pounding_cli import __version__
from pounding_cli.laws import link_laws, storey_laws
from pounding_cli.laws.isolation import FrictionPendulum
from pounding_cli.methods import METHODS
from pounding_cli.records import catalogue

_ENTRY = re.compile(r"^@(\w+)\{([^,\s]+),\n(.*?)^\}$", re.MULTILINE | re.DOTALL)
_FIELD = re.compile(r"^  (\w+) = \{(.*)\},?$", re.MULTILINE)


@dataclass(frozen=True)
class Reference:
    """One entry.

    key : its BibTeX key, the first author's family name and the year
    fields : BibTeX field -> value, without the escapes of BibTeX
    bibtex : the entry for a .bib file (UTF-8)
    """

    key: str
    fields: dict[str, str]
    bibtex: str

    @property
    def authors(self) -> str:
        """The authors: "Family, A. B., Family, C. & Family, D."; of an organisation its name."""
        name = self.fields["author"]
        if name.startswith("{"):
            return name.strip("{}")
        *first, last = name.split(" and ")
        return f"{', '.join(first)} & {last}" if first else last

    @property
    def text(self) -> str:
        """The entry on one line."""
        at = self.fields
        edition = f", {at['edition']} edition" if "edition" in at else ""
        volume = f" {at['volume']}" + (f"({at['number']})" if "number" in at else "") if "volume" in at else ""
        within = at.get("journal") or at.get("booktitle") or at.get("howpublished")
        where = [within + volume] if within else []
        where += [at[name].replace("--", "-") for name in ("pages", "publisher", "address") if name in at]
        doi = f" doi:{at['doi']}" if "doi" in at else ""
        return f"{self.authors} ({at['year']}). {at['title'].strip('{}')}{edition}. {', '.join(where)}.{doi}"


def read(text: str) -> dict[str, Reference]:
    """The entries of a .bib file that has one field a line, by key in the order of the file.

    Raises
    ------
    ValueError : an entry has a line that is no field, or a key is there twice
    """
    found: dict[str, Reference] = {}
    for entry in _ENTRY.finditer(text):
        key, body = entry[2], entry[3]
        fields = {name: re.sub(r"\\([&%#_])", r"\1", value) for name, value in _FIELD.findall(body)}
        if len(fields) != len(body.splitlines()):
            raise ValueError(f"{key}: a line is no `  field = {{value}},`")
        found[key] = Reference(key, fields, entry[0])
    if len(found) != text.count("\n@"):
        raise ValueError(
            "a key is there twice, or an entry does not begin with `@kind{key,` or end with `}` on a line of its own"
        )
    return found


REFERENCES = read(
    Path(__file__).with_name("references.bib").read_text(encoding="utf-8").replace("VERSION", __version__)
)
"""Every reference by its key."""


Use = Callable[[str, str], None]
"""use(key of REFERENCES, what it is used for)"""


@dataclass(frozen=True)
class Citation:
    """A reference and what a study used it for, one sentence a use."""

    reference: Reference
    uses: tuple[str, ...]


def citations(
    resolved: Mapping[str, Any],
    sources: Mapping[str, str],
    methods: Collection[str] = (),
    cite: Callable[[Mapping[str, Any], Use], None] | None = None,
) -> list[Citation]:
    """What to cite for a study.

    Parameters
    ----------
    resolved : the study with every default filled in
    sources : motion -> its label: "real", "stand-in" or "user", and ", unit g assumed" behind it
    methods : keys in METHODS that solve its scenes, buildings alone included
    cite : what its question uses besides
    """
    uses: dict[str, dict[str, None]] = {}

    def used(key: str, what: str) -> None:
        uses.setdefault(key, {})[what] = None

    used("pounding_cli", "the computations")
    _groups(resolved, sources, used)
    _methods(methods, resolved["estimate"] != "none", used)
    if cite is not None:
        cite(resolved, used)
    return [Citation(reference, tuple(uses[key])) for key, reference in REFERENCES.items() if key in uses]


def motions(sources: Mapping[str, str]) -> list[str]:
    """Where the motions come from, as far as the catalogue knows, one line each; `sources` as for `citations`."""
    return [f"{name} ({kind}): {_origin(name, kind)}" for name, kind in sources.items()]


def _origin(name: str, kind: str) -> str:
    entry = catalogue().get(name)
    if kind.startswith("user") or entry is None:
        return "your own file: cite its source"
    what = f"{entry.title}: {entry.event}, {entry.date}, magnitude {entry.magnitude}"
    what = f"{what}, {entry.station}, {entry.component}"
    if kind.startswith("real"):
        return f"{what}; your own file: cite its source"
    return f"{what}; synthesized by pounding_cli from: {'; '.join(entry.sources)}"


def _groups(resolved: Mapping[str, Any], sources: Mapping[str, str], used) -> None:
    used("spiliopoulos1996", "the model of the buildings, eqs (1) to (4)")
    kinds = {word for case in resolved["cases"].values() for word in _links(case)}
    for law in link_laws().values():
        for key, what in law.citation if law.name in kinds else ():
            used(key, what)
    bases = [resolved["buildings"][name].get("foundation") for name in resolved["group"]]
    if any(isinstance(base, dict) and (base.get("isolation") or {}).get("friction") for base in bases):
        for key, what in FrictionPendulum.citation:
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
