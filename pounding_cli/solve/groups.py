"""A row of buildings whose gaps never close is not simulated: its groups are solved alone, each once.

If the groups of a row, run one by one, never close a link between two of them, then no force crosses from one to the
other: their responses *are* the response of the row, which is unique. Whether a gap closes is seen in two steps. The
displacements of the groups at the samples of the motion show most gaps that do. Where they show none, two neighbouring
groups are run with nothing between them (`closing`): their peak closings decide, for this gap and for any other. That
run is as accurate as all others; a finer one follows only where the gap lies within the first one's error."""

from __future__ import annotations

import dataclasses
import functools
import math
import threading
from collections import OrderedDict
from collections.abc import Callable, Collection, Hashable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import chain, pairwise

import numpy as np

from pounding_cli.model.building import Building
from pounding_cli.model.condense import condensed
from pounding_cli.model.effects import effects_of
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Scene
from pounding_cli.solve.assess import difference
from pounding_cli.solve.closing import free_accuracy, kept_apart
from pounding_cli.solve.places import struck_columns
from pounding_cli.solve.response import (
    BOUNDED,
    MEASURED,
    BuildingResponse,
    ColumnResponse,
    LinkResponse,
    Response,
    composed_method,
)
from pounding_cli.solve.unpack import columns_of

ERRORS = 10.0
"""By so many accuracies of the closing, relative to the floors' own displacements, a gap must stay open to count as
never closed."""

MEMORY = 24 * 2**20
"""Responses kept for the scenes that follow [bytes]."""

MOST_PAIRS = 1000
"""Pairs of neighbours whose largest closings at the samples are kept for the scenes that follow."""

Key = tuple[Hashable, ...]
"""What tells the scenes of groups apart."""


class GroupSolver:
    """Solves scenes in the smallest groups that do not meet, and keeps what the next scenes may need again.

    Parameters
    ----------
    respond : (scene, watch) -> Response, with its samples where asked to watch
    solve : (scene, accuracy) -> Response of neighbouring groups with nothing between them; where it tells its error
        itself, no finer one is asked for
    accuracy : relative error of the peaks [-]
    is_assessed : whether the error of a scene is asked for, so that of closings between groups too

    What it answers depends on the scene alone, never on what came before. Threads may share it.
    """

    def __init__(
        self,
        respond: Callable[[Scene, bool], Response],
        solve: Callable[[Scene, float], Response],
        accuracy: float,
        is_assessed: Callable[[Scene], bool] = lambda scene: False,
    ) -> None:
        self._respond = respond
        self._solve = solve
        self._accuracy = accuracy
        self._is_assessed = is_assessed
        self._kept: OrderedDict[Key, Response] = OrderedDict()
        self._closings: dict[tuple[Key, Key], dict[tuple[int, int], float]] = {}
        self._bytes = 0
        self._unbooked = 0.0
        self._lock = threading.Lock()

    def __call__(self, scene: Scene) -> Response:
        """The response of a scene. Its seconds include groups of several buildings that were solved on the way: those
        are no scenes of their own, as buildings alone are."""
        response, beside = self.without_a_run(scene)
        if response is None:
            response = self._respond(scene, False)
        return dataclasses.replace(response, seconds=response.seconds + beside) if beside else response

    def without_a_run(self, scene: Scene) -> tuple[Response | None, float]:
        """The response of a scene that need not be run as a whole, or None; and the time that groups of several
        buildings took, which are no scenes of their own [s]."""
        if not scene.links and len(scene.buildings) == 1:
            response: Response | None = dataclasses.replace(
                self._watched(scene, range(1), _key(scene, range(1))), samples=()
            )
        else:
            response = self.by_proof(scene)
        with self._lock:
            beside, self._unbooked = self._unbooked, 0.0
        return response, beside

    def by_proof(self, scene: Scene) -> Response | None:
        """The response of a row that is not simulated, from its groups; None if all of it may meet."""
        groups = list(_first_groups(scene.buildings, scene.links))
        if len(groups) == 2 and self._known_to_meet(scene, *groups):
            return None
        while len(groups) > 1:
            keys = [_key(scene, group) for group in groups]
            parts = [self._watched(scene, group, key) for group, key in zip(groups, keys, strict=True)]
            if any(part.status != "done" or not part.samples for part in parts):  # without samples nothing is proven
                return None
            sides = zip(pairwise(groups), pairwise(parts), pairwise(keys), strict=True)
            meeting = [n for n, (two, ab, key) in enumerate(sides) if self._seen_to_meet(scene, *two, *ab, key)]
            if not meeting:
                free = self._kept_apart(scene, groups)
                meeting = [n for n, closings in enumerate(free) if closings is None]
                if not meeting:
                    return _composed(scene, groups, parts, [closings for closings in free if closings is not None])
            groups = _merged(groups, meeting)
        return None

    def _kept_apart(self, scene: Scene, groups: list[range]) -> list[Free | None]:
        """Of every two neighbouring groups what is found while nothing meets; None if they do, or come too close to
        say."""
        free: list[Free | None] = [Free(dict.fromkeys(_between(scene, g[-1]), 0.0)) for g in groups[:-1]]
        for stretch in _stretches(scene, groups):
            along = groups[stretch[0] : stretch[-1] + 2]
            begin = along[0].start
            row, _ = condensed(_cut_out(scene, range(begin, along[-1].stop)), self._accuracy)
            row = kept_apart(row, [group[-1] - begin for group in along[:-1]])
            judge = partial(_judged, scene, groups, stretch, row)
            coarse, fine = self._accuracy, free_accuracy(self._accuracy)
            first = self._free(row, coarse)
            least, most = judge(first, -ERRORS * coarse), judge(first, ERRORS * coarse)
            settled = first.status == "done" and all((least[n] is None) == (most[n] is None) for n in stretch)
            if not settled or self._is_assessed(scene):
                error = first.error_estimate if first.estimated == BOUNDED else math.inf
                if not (settled and error <= coarse):
                    second = self._free(row, fine)
                    error = difference(first, second)
                if settled and error <= coarse:
                    most = {n: found and dataclasses.replace(found, error_estimate=error) for n, found in most.items()}
                else:
                    most = judge(second, ERRORS * fine)
            free = [most.get(n, found) for n, found in enumerate(free)]
        return free

    def _free(self, row: Scene, accuracy: float) -> Response:
        """The response of a row whose groups have nothing between them."""
        group = range(len(row.buildings))
        return self._kept_or_solved(
            (*_key(row, group), accuracy), row, group, lambda scene: self._solve(scene, accuracy)
        )

    def _watched(self, scene: Scene, group: range, key: Key) -> Response:
        """The response of a group by itself, with its samples."""
        return self._kept_or_solved(key, scene, group, lambda scene: self._respond(scene, True))

    def _kept_or_solved(self, key: Key, scene: Scene, group: range, solve: Callable[[Scene], Response]) -> Response:
        """The response of a group from memory if it is there."""
        with self._lock:
            if key in self._kept:
                self._kept.move_to_end(key)
                return self._kept[key]
        response = solve(_cut_out(scene, group))
        with self._lock:
            self._unbooked += response.seconds if len(group) > 1 else 0.0
            if key not in self._kept:
                self._kept[key] = response
                self._bytes += _size(response)
            while self._bytes > MEMORY and len(self._kept) > 1:
                self._bytes -= _size(self._kept.popitem(last=False)[1])
        return response

    def _known_to_meet(self, scene: Scene, left: range, right: range) -> bool:
        """Whether a scene before has shown that the gap of one of the links between two groups closes."""
        known = self._closings.get((_key(scene, left), _key(scene, right)), {})
        return any(
            [known.get(floors, -math.inf) >= free_below
             for floors, free_below in _between_floors(scene.buildings, scene.links, left, right)]
        )  # fmt: skip

    def _seen_to_meet(
        self, scene: Scene, left: range, right: range, a: Response, b: Response, key: tuple[Key, Key]
    ) -> bool:
        """Whether the groups' own displacements at the samples of the motion close a link between them, or one of a law
        that any movement closes."""
        closings = self._closings.setdefault(key, {})
        if len(self._closings) > MOST_PAIRS:
            self._closings = {key: closings}
        for floors, free_below in _between_floors(scene.buildings, scene.links, left, right):
            if floors not in closings:
                closing = a.samples[-1][:, floors[0]] - b.samples[0][:, floors[1]]
                closings[floors] = float(closing.max(initial=0.0))
            if closings[floors] >= free_below:
                return True
        return False


def sure_parts(scene: Scene) -> list[Scene]:
    """The groups of several buildings that a row is taken apart into before anything is known of its responses."""
    groups = _first_groups(scene.buildings, scene.links)
    return [_cut_out(scene, group) for group in groups if len(group) > 1] if len(groups) > 1 else []


@dataclass(frozen=True)
class Free:
    """Two neighbouring groups that never meet.

    closings : of every link between them, its largest closing u_l - u_r [m]
    methods : keys in METHODS of what found them
    error_estimate : of the closings, where it was asked for [-]
    """

    closings: dict[Link, float]
    methods: tuple[str, ...] = ()
    error_estimate: float = 0.0


def _between(scene: Scene, left: int) -> list[Link]:
    return [link for link in scene.links if link.left == left]


def _move_alike(buildings: Sequence[Building], link: Link) -> bool:
    """Whether the link joins the same floor of two equal buildings: as long as nothing else pushes them, it is not
    closed by anything."""
    a, b = buildings[link.left], buildings[link.left + 1]
    return a.digest == b.digest and (link.left_floor, link.left_at) == (link.right_floor, link.right_at)


def _rests(buildings: Sequence[Building], left: range, right: range, link: Link) -> bool:
    """Whether a link between two groups joins buildings that move alike, each alone in its group."""
    return len(left) == len(right) == 1 and _move_alike(buildings, link)


@functools.lru_cache(maxsize=256)  # the same for every motion
def _between_floors(
    buildings: tuple[Building, ...], links: tuple[Link, ...], left: range, right: range
) -> list[tuple[tuple[int, int], float]]:
    """Of the links between floors of two groups, but for those that rest, the floors, from 0, and the closing below
    which no force acts [m]."""
    return [
        ((link.left_floor - 1, link.right_floor - 1), link.law.free_below)
        for link in links
        if link.left == left[-1] and link.left_at == link.right_at == 1.0 and not _rests(buildings, left, right, link)
    ]


@functools.lru_cache(maxsize=256)  # the same for every motion
def _first_groups(buildings: tuple[Building, ...], links: tuple[Link, ...]) -> tuple[range, ...]:
    """Every building by itself, but for those that are sure to meet: with a link that a first movement may already
    close."""
    sure = {link.left for link in links if link.law.free_below <= 0 and not _move_alike(buildings, link)}
    return tuple(_merged([range(b, b + 1) for b in range(len(buildings))], sure))


def _merged(groups: list[range], meeting: Collection[int]) -> list[range]:
    """The groups with each one in `meeting` joined to the next."""
    joined = [groups[0]]
    for number, group in enumerate(groups[1:]):
        if number in meeting:
            joined[-1] = range(joined[-1].start, group.stop)
        else:
            joined.append(group)
    return joined


def _key(scene: Scene, group: range) -> Key:
    """The same for all scenes in which the group by itself is the same scene, as their digests would be."""
    if len(group) == 1:
        return scene.buildings[group.start].digest, scene.motion.digest, scene.analysis, scene.tail
    buildings = tuple([building.digest for building in scene.buildings[group.start : group.stop]])
    return buildings, _inside(scene, group), scene.motion.digest, scene.analysis, scene.tail


def _inside(scene: Scene, group: range) -> tuple[Link, ...]:
    """The links of the group by itself."""
    if len(group) == 1:
        return ()
    if len(group) == len(scene.buildings):
        return scene.links
    return tuple(
        dataclasses.replace(link, left=link.left - group.start) for link in scene.links if link.left in group[:-1]
    )


def _cut_out(scene: Scene, group: range) -> Scene:
    """The group by itself; the scene where that is all of it."""
    if len(group) == len(scene.buildings):
        return scene
    buildings = scene.buildings[group.start : group.stop]
    return Scene(buildings, _inside(scene, group), scene.motion, scene.analysis, scene.tail)


def _stretches(scene: Scene, groups: list[range]) -> list[list[int]]:
    """Pairs of neighbouring groups, by the place of the left one, that are run together: one behind the other where a
    group of several stands between them, which is then run once. Others stay by themselves: two buildings are met
    again more often than three. Left out where nothing can close."""
    stretches: list[list[int]] = []
    for n, (left, right) in enumerate(pairwise(groups)):
        if all(_rests(scene.buildings, left, right, link) for link in _between(scene, left[-1])):
            continue
        if stretches and stretches[-1][-1] == n - 1 and len(left) > 1:
            stretches[-1].append(n)
        else:
            stretches.append([n])
    return stretches


def _judged(
    scene: Scene, groups: list[range], stretch: list[int], row: Scene, response: Response, error: float
) -> dict[int, Free | None]:
    """What a run of the groups of a stretch with nothing between them says of each pair, by the place of the left
    group; `error` as in `_open`."""
    begin = groups[stretch[0]].start
    return {n: _open(scene, groups[n], groups[n + 1], row, response, begin, error) for n in stretch}


def _open(
    scene: Scene, left: range, right: range, row: Scene, response: Response, begin: int, error: float
) -> Free | None:
    """What a run of a `row`, which begins with building `begin` of the scene, says of the links between two groups;
    `error` is that of a closing, relative to the floors' own displacements [-]."""
    if response.status != "done":
        return None
    found = dict(zip((link.ends for link in row.links), map(float, response.links.max_closing), strict=True))
    closings = {}
    for link in _between(scene, left[-1]):
        (one, floor, at), (other, other_floor, other_at) = link.ends
        closings[link] = found[(one - begin, floor, at), (other - begin, other_floor, other_at)]
    error *= sum(_furthest(response.buildings[place - begin]) for place in (left[-1], right[0]))
    for link in closings:
        if _rests(scene.buildings, left, right, link):
            closings[link] = 0.0
        elif closings[link] + error >= link.law.free_below:
            return None
    return Free(closings, response.methods)


def _composed(scene: Scene, groups: list[range], parts: list[Response], free: list[Free]) -> Response:
    """The response of the row from those of its groups; what these cost is booked when they are solved."""
    links = LinkResponse(np.zeros(len(scene.links), int), *np.zeros((4, len(scene.links))))
    for group, part in zip(groups, parts, strict=True):
        inside = [e for e, link in enumerate(scene.links) if link.left in group[:-1]]
        for name in vars(links) if inside else ():
            getattr(links, name)[inside] = getattr(part.links, name)
    closings = {link: closing for between in free for link, closing in between.closings.items()}
    for e, link in enumerate(scene.links):
        if link in closings:
            links.max_closing[e] = closings[link]
    errors = [part.error_estimate for part in parts] + [between.error_estimate for between in free]
    effects = tuple(dict.fromkeys(effect for part in parts for effect in part.effects))
    sentences = (_sentence(scene, between.closings) for between in free)
    return Response(
        tuple(building for part in parts for building in part.buildings),
        links,
        "done",
        "",
        composed_method(chain(*(part.methods for part in parts), *(between.methods for between in free))),
        parts[0].accuracy,
        steps=0,
        events=0,
        seconds=0.0,
        energy=_summed([part.energy for part in parts]),
        flags=tuple(dict.fromkeys(flag for part in parts for flag in part.flags)),
        effects=effects,
        dropped=(*effects_of(scene).dropped, *(sentence for sentence in sentences if sentence)),
        error_estimate=float(np.max(errors)),
        estimated=next(how for how in ("", BOUNDED, MEASURED) if how in {part.estimated for part in parts}),
        sensitivity=float(np.max([part.sensitivity for part in parts])),
        final=tuple(end for part in parts for end in part.final),
        columns=_columns(scene, groups, parts, closings),
    )


def _columns(scene: Scene, groups: list[range], parts: list[Response], closings: Collection[Link]) -> ColumnResponse:
    """Shears of struck columns: in a group those that its run has found; of columns that are never struck, because
    their link is in `closings`, what they have of the storey's."""
    found = []
    for each in struck_columns(scene.links):
        group, part = next((g, p) for g, p in zip(groups, parts, strict=True) if each.building in g)
        if scene.links[each.link] in closings:
            shear = each.share * part.buildings[each.building - group.start].shear[each.storey - 1]
            found.append((shear, shear))
        else:
            before = sum(link.left in group[:-1] for link in scene.links[: each.link])
            place = part.columns.link.tolist().index(before)
            found.append((part.columns.shear_below[place], part.columns.shear_above[place]))
    return columns_of(scene, *np.array(found).reshape(-1, 2).T)


def _sentence(scene: Scene, closings: dict[Link, float]) -> str:
    """Why the links between two groups were not simulated."""
    if not closings:
        return ""
    left = next(iter(closings)).left
    names = " | ".join(building.name for building in scene.buildings[left : left + 2])
    if all(closing == 0 for closing in closings.values()):
        return f"links {names}: equal buildings move alike, so nothing closes"
    least = min(link.law.free_below - closing for link, closing in closings.items())
    if least == math.inf:  # nothing was to stand there
        return ""
    return f"links {names}: the gap never closes, {least * 1000:.3g} mm of it stay open"


def _summed(ledgers: list[dict[str, float]]) -> dict[str, float]:
    """The ledgers of groups as one; what is missing is summed, and so is what it is relative to in each."""
    book = {key: sum(ledger[key] for ledger in ledgers) for key in ledgers[0] if key != "residual"}
    scale = sum(abs(_missing(ledger) / ledger["residual"]) for ledger in ledgers if ledger["residual"])
    scale = max(scale, *map(abs, book.values()))
    return book | {"residual": _missing(book) / scale if scale > 0 else 0.0}


def _missing(book: dict[str, float]) -> float:
    """What came in less what a ledger holds and has given away [J]."""
    return 2 * book["input"] - sum(value for key, value in book.items() if key != "residual")


def _furthest(building: BuildingResponse) -> float:
    """The largest displacement of any floor [m]."""
    return float(max(building.displacement_max.max(), -building.displacement_min.min()))


PEAKS = 10 * 2**10
"""What a response takes beside its samples, roughly [bytes]: a worker grows by as much for two buildings of five
storeys."""


def _size(response: Response) -> int:
    return PEAKS + sum(samples.nbytes for samples in response.samples)
