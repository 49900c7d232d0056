"""Keep the sound keys of a faulty case, so that everything wrong with it is told at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from pydantic import TypeAdapter, ValidationError

from pounding_cli.errors import KeyPath
from pounding_cli.laws import link_laws
from pounding_cli.study.construct.complete_links import complete_links, find_idle_shared_keys, find_key_issues
from pounding_cli.study.construct.link_names import NamedInLink, Names, find_link_name_issues
from pounding_cli.study.construct.written import iter_named_in_links, read_spec
from pounding_cli.study.schema.links import NO_LINK, CaseSpec, ImpactSpec, SeveralLinksSpec
from pounding_cli.study.text.file import Items, Map, get
from pounding_cli.study.text.issues import IssuesFound

MAX_PRUNINGS = 5
"""Times that faulty keys are left out, as others may come to light behind them."""

_ADAPTER: TypeAdapter[Any] = TypeAdapter(CaseSpec)
_IMPACT_ADAPTER: TypeAdapter[Any] = TypeAdapter(ImpactSpec)


@dataclass(frozen=True, eq=False)
class DraftCase:
    """A faulty case without what is faulty.

    case : validated, with no link in place of links that are faulty as a whole; None where too little is left
    named : what its links name
    left_out : paths of the keys and links that are faulty
    """

    case: Any
    named: tuple[NamedInLink, ...]
    left_out: frozenset[KeyPath]


def read_draft(tree: Map, path: tuple[str, ...]) -> DraftCase | None:
    """Return the draft of a case; None of one that is sound."""
    try:
        read_spec(tree, path)
    except IssuesFound:
        named = tuple(iter_named_in_links(tree, path))
        case = get(tree, *path)
        left_out: set[KeyPath] = set()
        for _ in range(MAX_PRUNINGS):
            try:
                return DraftCase(_ADAPTER.validate_python(case), named, frozenset(left_out))
            except ValidationError as error:
                for item in error.errors(include_url=False):
                    steps = [step for step in item["loc"] if not str(step).startswith("(")]
                    if item["type"] == "too_short" and get(case, *steps):
                        continue  # pydantic counts sound entries only
                    case = _leave_out(case, steps, path, left_out)
        return DraftCase(None, named, frozenset())
    return None


def _leave_out(case: Any, steps: Sequence[str | int], path: KeyPath, left_out: set[KeyPath]) -> Any:
    """Return a case without the key of a link, or the key beside its links, that is faulty; None without its links.

    steps : from the case to what is faulty
    """
    key = str(steps[0]) if steps else "link"
    if not isinstance(case, Map):
        return None
    if key == "links" and isinstance(case.get(key), Items) and len(steps) > 1:
        number = int(steps[1])
        links = Items(case[key], case[key].mark, case[key].marks)
        links[number] = _leave_out_of_link(links[number], steps[2:], (*path, key, number), left_out)
        return Map({**case, key: links}, case.mark, case.marks)
    if key == "links" or (key == "link" and "links" not in case):
        return None
    left_out.add((*path, key))
    return Map({name: value for name, value in case.items() if name != key}, case.mark, case.marks)


def _leave_out_of_link(link: Any, steps: Sequence[str | int], path: KeyPath, left_out: set[KeyPath]) -> Any:
    """Return a link of a list without its faulty key; no link in place of one that is faulty as a whole."""
    key = str(steps[0]) if steps else "link"
    if isinstance(link, Map) and key != "link":
        left_out.add((*path, key))
        return Map({name: value for name, value in link.items() if name != key}, link.mark, link.marks)
    left_out.add(path)
    return NO_LINK


def read_impact_draft(tree: Map) -> tuple[Any, tuple[str, ...]]:
    """Return the impact element without its faulty keys, None where too little is left; and these keys."""
    impact = tree.get("impact")
    if not isinstance(impact, Map):
        return None, ()
    try:
        return _IMPACT_ADAPTER.validate_python(impact), ()
    except ValidationError as error:
        left_out = tuple({str(item["loc"][0]) for item in error.errors(include_url=False) if item["loc"]})
        sound = {key: value for key, value in impact.items() if key not in left_out}
    try:
        return _IMPACT_ADAPTER.validate_python(sound), left_out
    except ValidationError:
        return None, left_out


def check_draft_names(draft: DraftCase, names: Names) -> None:
    """Raise IssuesFound where links of a faulty case name what the study does not have."""
    issues = [issue for named in draft.named for issue in find_link_name_issues(named, names)]
    if issues:
        raise IssuesFound(issues)


def check_draft(name: str, draft: DraftCase, impact: Any, names: Names) -> None:
    """Raise IssuesFound where keys of sound links of a faulty case are missing or do not apply."""
    if draft.case is None:
        return
    issues = []
    links = complete_links(name, draft.case, impact)
    for link in links:
        parents = (link.path, ("cases", name))
        keys = [str(path[-1]) for path in draft.left_out if path[:-1] in parents]
        issues += find_key_issues(link, keys)
    are_known = all(link.law in (*link_laws(), *names.laws, NO_LINK) for link in links)
    has_all_links = not any(path[-2:-1] == ("links",) for path in draft.left_out)
    if isinstance(draft.case, SeveralLinksSpec) and are_known and has_all_links:
        issues += find_idle_shared_keys(name, draft.case, links)
    if issues:
        raise IssuesFound(issues)
