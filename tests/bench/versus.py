"""pound beside heyoka, OpenSees and scipy, run by run in turns on one core.

pound's time is that of the solver, which finds all peaks, link results and the energy ledger; heyoka's is that of its
states alone; OpenSees' is that of stepping with envelopes of the storeys."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from pounding_cli.model.scene import Scene
from pounding_cli.solve import solve

from . import scenes
from .clock import in_solver, least, timed

BATCH = 64
"""Scenes in a batch."""

NAMED = 2e-5
"""The step [s] at which every integrator that is right at all keeps about 1e-3."""

SETTINGS = (1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9)
"""Accuracies of pound and tolerances of heyoka tried [-]."""

WANTED = 1e-9
"""Error of the storey shears asked of both [-]."""

STEPS = (1e-4, 5e-5, 2e-5, 1e-5)
"""OpenSees' steps tried [s]."""


def together(many: list[Scene], accuracy: float) -> Callable[[], float]:
    """A run of many scenes, one after the other as a batch's worker runs them: its time in the solver a scene [s]."""
    run = in_solver(lambda: [solve(scene, accuracy) for scene in many])
    return lambda: run() / len(many)


def row(work: str, target: str, most: float, ours: tuple, peer: tuple) -> dict:
    """One comparison; `ours` and `peer` are (what, error [-] or None, seconds), `most` the largest ratio wanted."""
    ratio = ours[2] / peer[2]
    names = ("what", "error", "seconds")
    return {
        "work": work, "target": target, "ours": dict(zip(names, ours, strict=True)),
        "peer": dict(zip(names, peer, strict=True)), "ratio": ratio, "most": most, "met": ratio <= most,
    }  # fmt: skip


def heyoka() -> Iterator[dict]:
    """Elastic, touching, error 1e-9: the fastest setting of each that keeps it."""
    from tests.peers.heyoka_scene import ElasticScene

    scene = scenes.touching("elastic")
    exact = scenes.shears(solve(scene, 1e-14, "taylor"))

    def fastest(error_at: Callable[[float], float]) -> tuple[float, float]:
        """The coarsest of SETTINGS whose error [-] is below WANTED, and that error."""
        return next((setting, error) for setting in SETTINGS if (error := error_at(setting)) <= WANTED)

    mine, error = fastest(lambda accuracy: scenes.error(scenes.shears(solve(scene, accuracy)), exact))
    theirs, peer_error = fastest(lambda accuracy: scenes.error(ElasticScene(scene, accuracy).run().shear, exact))
    plain = ElasticScene(scene, theirs, peaks=False)
    many = scenes.batch(scene, BATCH)
    alone, peer, batch = least(
        (in_solver(lambda: solve(scene, mine)), lambda: plain.run().seconds, together(many, mine)), budget=20.0
    )
    other = (f"heyoka, tolerance {theirs:g}", peer_error, peer)
    work = "elastic, touching, 2 x 5 storeys, 10 s, error 1e-9"
    yield row(f"{work}: one scene", "1/3", 1 / 3, (f"accuracy {mine:g}", error, alone), other)
    yield row(f"{work}: in a batch of {BATCH}", "1/8", 1 / 8, (f"accuracy {mine:g}", error, batch), other)


def opensees() -> Iterator[dict]:
    """Touching, elastic at 1e-3 and inelastic at OpenSees' best."""
    from tests.peers.opensees import EXPLICIT, IMPLICIT

    scene = scenes.touching("elastic")
    tried = sorted(_tried(scene, EXPLICIT), key=lambda run: run[2])
    work = "elastic, touching, 2 x 5 storeys, 10 s, error 1e-3"
    for only, words in (
        (f", {NAMED:g} s", f"{work}: the fastest explicit at {NAMED:g} s"),
        ("", f"{work}: the fastest"),
    ):
        right = next(run for run in tried if run[1] <= 1e-3 and run[0].endswith(only))
        yield _against(scene, 1e-3, words, "1/5000", 1 / 5000, right, tried)
    scene = scenes.touching("inelastic")
    tried = sorted(_tried(scene, (*EXPLICIT, IMPLICIT)), key=lambda run: run[1])
    work = "inelastic, touching, 2 x 5 storeys, 10 s, error 1e-6"
    found = _against(scene, 1e-6, work, "smaller error, 1/3000", 1 / 3000, tried[0], tried)
    found["met"] = found["met"] and found["ours"]["error"] < found["peer"]["error"]
    yield found


def _tried(scene: Scene, integrators: Iterable[str]) -> Iterator[tuple[str, float, float]]:
    """(setting, error, seconds) of every OpenSees run that ended; CPU time, for a run lasts seconds."""
    from tests.peers.opensees import march

    exact = scenes.shears(solve(scene, 1e-12, "taylor"))
    for integrator in integrators:
        for dt in STEPS:
            try:
                peaks = march(scene, dt, integrator)
            except RuntimeError:  # it gave up
                continue
            yield f"OpenSees, {integrator}, {dt:g} s", scenes.error(peaks.shear, exact), peaks.seconds


def _against(scene: Scene, accuracy: float, work: str, target: str, most: float, peer: tuple, tried: list) -> dict:
    exact = scenes.shears(solve(scene, 1e-12, "taylor"))
    (ours,) = least((in_solver(lambda: solve(scene, accuracy)),))
    mine = (f"accuracy {accuracy:g}", scenes.error(scenes.shears(solve(scene, accuracy)), exact), ours)
    return {**row(work, target, most, mine, peer), "tried": tried}


def baseline() -> Iterator[dict]:
    """A building alone, by exact steps, against scipy and numpy at its own error of 1e-6 and at the samples."""
    from . import modal

    scene = scenes.touching("elastic").alone(0)
    exact = scenes.shears(solve(scene, 1e-13, "taylor"))
    error = scenes.error(scenes.shears(solve(scene, 1e-6)), exact)

    fine = refined(scene, modal.filtered, exact, 1e-6)
    peers = {
        f"scipy.signal.lfilter, mode by mode, {fine} points a sample": modal.filtered(scene, fine),
        "scipy.signal.lfilter, mode by mode, at the samples only": modal.filtered(scene, 1),
        "scipy.signal.lsim, at the samples only": modal.simulated(scene, 1),
        "exact modal step in numpy, at the samples only": modal.stepped(scene, 1),
    }
    for name, march in peers.items():
        mine, theirs = least((in_solver(lambda: solve(scene, 1e-6)), timed(march)))
        peer = (name, scenes.error(march()[0], exact), theirs)
        yield row("elastic, alone, 5 storeys, 10 s, error 1e-6", "1/5", 1 / 5, ("accuracy 1e-6", error, mine), peer)


def refined(scene: Scene, march: Callable, exact, wanted: float) -> int:
    """Points a sample at which peaks at the points alone have the wanted error [-], doubled until they do."""
    parts = 1
    while scenes.error(march(scene, parts)()[0], exact) > wanted:
        parts *= 2
    return parts


def figures() -> Iterator[dict]:
    """All scenes of Figs 6 and 7 with something between the buildings, at 1e-6."""
    for study, target in (("fig6", (0.5e-3, 1.2e-3)), ("fig7", (None, None))):
        found = scenes.linked(study)
        alone = least([in_solver(lambda s=s: solve(s, 1e-6)) for s in found], budget=6.0, fewest=8)
        (batch,) = least((together(found, 1e-6),), budget=3.0)
        median = sorted(alone)[len(alone) // 2]
        kinds = sorted((s.links[0].kind, s.analysis.value, t) for s, t in zip(found, alone, strict=True))
        yield {
            "study": study, "scenes": len(found), "alone": median, "batch": batch,
            "alone_most": target[1], "batch_most": target[0],
            "by_kind": _by_kind(kinds),
        }  # fmt: skip


def _by_kind(kinds: list[tuple[str, str, float]]) -> dict[str, float]:
    """Median time [s] by link and analysis."""
    groups: dict[str, list[float]] = {}
    for kind, analysis, seconds in kinds:
        groups.setdefault(f"{kind}, {analysis}", []).append(seconds)
    return {name: sorted(times)[len(times) // 2] for name, times in groups.items()}
