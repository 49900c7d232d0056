"""What was measured, as JSON and as tables between marks in docs/performance.md."""

from __future__ import annotations

import json
from pathlib import Path

from .clock import PACKAGES, ROOT

KEPT = ROOT / "docs" / "figures" / "bench.json"
PAGE = ROOT / "docs" / "performance.md"


def read(path: Path = KEPT) -> dict:
    """What was measured before; empty if nothing was."""
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}


def keep(parts: dict, path: Path = KEPT) -> None:
    """Write what was measured, numbers to four digits."""
    path.write_text(json.dumps(_rounded(parts), indent=1) + "\n", encoding="utf-8")


def _rounded(what):
    if isinstance(what, float):
        return float(f"{what:.4g}")
    if isinstance(what, dict):
        return {key: _rounded(value) for key, value in what.items()}
    return [_rounded(value) for value in what] if isinstance(what, list | tuple) else what


def tables(parts: dict) -> dict[str, str]:
    """Markdown by mark, of every part that was measured."""
    makers = {
        "peers": _peers, "figures": _figures, "program": _program, "laws": _laws, "operations": _operations,
        "profile": _profile, "sampled": _sampled, "growth": _growth, "batch": _batch, "sweeps": _sweeps,
    }  # fmt: skip
    made = {name: make(parts[name]["found"]) for name, make in makers.items() if name in parts}
    return {**made, "machine": _machine(parts)}


def write(parts: dict, page: Path = PAGE) -> None:
    """Replace what stands between the marks.

    Raises
    ------
    ValueError : a mark is missing
    """
    text = page.read_text(encoding="utf-8")
    for name, table in tables(parts).items():
        begin, end = marks(name)
        before, first, rest = text.partition(begin)
        _, last, after = rest.partition(end)
        if not first or not last:
            raise ValueError(f"{page} lacks the marks {begin} and {end}")
        text = f"{before}{begin}\n{table}\n{end}{after}"
    page.write_text(text, encoding="utf-8")


def marks(name: str) -> tuple[str, str]:
    """What stands before and after a table."""
    return f"<!-- {name}: begin (make bench) -->", f"<!-- {name}: end -->"


def time_of(seconds: float) -> str:
    """Three digits with a fitting unit."""
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6), ("ns", 1e-9)):
        if seconds >= size or unit == "ns":
            return f"{_digits(seconds / size)} {unit}"
    raise AssertionError


def _digits(value: float) -> str:
    return f"{value:.3g}" if value < 1000 else f"{value:.0f}"


def ratio_of(ratio: float) -> str:
    """A part as one over so much, or as so many times."""
    return f"1/{_digits(1 / ratio)}" if ratio < 1 else f"{_digits(ratio)} times"


def met(verdict: bool | None) -> str:
    """One word for the verdict."""
    return "" if verdict is None else "met" if verdict else "**not met**"


def _table(head: str, rows: list[list[str]]) -> str:
    columns = head.count("|") + 1
    lines = [f"| {head} |", "|" + "---|" * columns]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def _peers(found: list[dict]) -> str:
    rows = []
    for one in found:
        ours, peer = one["ours"], one["peer"]
        rows.append([
            one["work"], f"{time_of(ours['seconds'])}, error {ours['error']:.0e}",
            f"{peer['what']}: {time_of(peer['seconds'])}, error {peer['error']:.0e}", ratio_of(one["ratio"]),
            one["target"], met(one["met"]),
        ])  # fmt: skip
    return _table("work | pound | peer | pound over peer | target | verdict", rows)


def _figures(found: list[dict]) -> str:
    rows = []
    for one in found:
        for how in ("alone", "batch"):
            most = one[f"{how}_most"]
            words = {"alone": "one after the other, median", "batch": "all in one batch, mean"}[how]
            verdict = met(None if most is None else one[how] <= most)
            target = "" if most is None else time_of(most)
            rows.append([f"{one['study']}: {one['scenes']} scenes, {words}", time_of(one[how]), target, verdict])
        rows += [
            [f"{one['study']}: {kind}, median", time_of(seconds), "", ""] for kind, seconds in one["by_kind"].items()
        ]
    return _table("scenes at 1e-6, solver only | time a scene | target | verdict", rows)


def _program(found: list[dict]) -> str:
    rows = []
    for one in found:
        said = "" if "said" not in one else "; said on screen" if one["said"] else "; **not said on screen**"
        rows.append([
            one["work"], time_of(one["wall"]), time_of(one["core"]), time_of(one["most"]), met(one["met"]) + said,
        ])  # fmt: skip
    return _table("what | by the clock | time on all cores | target | verdict", rows)


def _laws(found: list[dict]) -> str:
    rows = [
        [
            one["kind"],
            f"`{one['law']}`",
            time_of(one["seconds"]),
            _digits(one["over"]),
            f"{one['steps']}",
            f"{one['events']}",
        ]
        for one in found
    ]
    return _table("what | law | time a scene | over the first of its kind | steps | events", rows)


def _operations(found: dict) -> str:
    rows = [
        ["steps, orders, events", f"{found['steps']}, {found['orders']}, {found['events']}"],
        ["operations of all coefficients", f"{found['operations'] / 1e6:.2f} million"],
        ["the core's measured multiply-add peak", f"{found['peak'] / 1e9:.1f} billion operations a second"],
        ["a multiply-add that waits for the one before", time_of(found["waiting"])],
        ["time at the peak", time_of(found["at_peak"])],
        [
            "time at least, as orders wait for one another (five such each)",
            time_of(5 * found["waiting"] * found["orders"]),
        ],
        ["time taken", time_of(found["seconds"])],
        ["**taken over peak**", f"**{found['ratio']:.0f}**"],
    ]
    return _table("elastic, touching, 2 x 5 storeys, 10 s, accuracy 1e-6 | ", rows)


def _profile(found: dict[str, float]) -> str:
    return _table("left out | of the time is gone", [[name, f"{100 * part:.0f} %"] for name, part in found.items()])


def _sampled(found: dict[str, float]) -> str:
    return _table("part of a step | of the time", [[name, f"{100 * part:.0f} %"] for name, part in found.items()])


def _growth(found: list[dict]) -> str:
    rows = []
    for one in found:
        measured = (
            f"x {one['ratio']:.3g} in all" if one["whole"] or one["most"] is None else f"slope {one['slope']:.2f}"
        )
        allowed = (
            "report" if one["most"] is None else f"x {one['most']:g}" if one["whole"] else f"slope {one['most']:g}"
        )
        span = f"{one['values'][0]:g} to {one['values'][-1]:g}"
        times = f"{time_of(one['seconds'][0])} to {time_of(one['seconds'][-1])}"
        steps = f"{one['steps'][0]} to {one['steps'][-1]}"
        events = f"{one['events'][0]} to {one['events'][-1]}"
        rows.append([one["over"], span, times, steps, events, measured, allowed, met(one["met"])])
    return _table("what grows | from, to | time of a scene | steps | events | measured | allowed | verdict", rows)


def _batch(found: dict) -> str:
    solver = found["solver"]
    rows = [["solver", time_of(solver), "", "", ""]]
    for name, most in (("overhead", 0.2), ("estimates", 0.5)):
        share = found[name] / solver
        rows.append([name, time_of(found[name]), f"{share:.2f}", f"{most:g}", met(share <= most)])
    over = found["default_over_none"]
    rows.append(["`estimate: all` over `estimate: none`", "", f"{over:.2f}", "1.5", met(over <= 1.5)])
    for name, gain in found["two_workers"].items():
        rows.append(
            [f"one worker over two, by the clock, `estimate: {name}`", "", f"{gain:.2f}", "1.8", met(gain >= 1.8)]
        )
    return _table(f"{found['scenes']} scenes | a scene | over the solver | target | verdict", rows)


def _sweeps(found: list[dict]) -> str:
    rows = [
        [
            str(one["scenes"]), time_of(one["wall"]), time_of(one["wall"] / one["scenes"]),
            f"{one['memory'] / 1e6:.0f} MB", met(one["memory"] < 500e6), f"{one['file'] / 1e6:.1f} MB", one["load"],
        ]
        for one in found
    ]  # fmt: skip
    return _table(
        "scenes | time, all included | a scene | memory of all processes | below 500 MB | file | load before", rows
    )


def _machine(parts: dict) -> str:
    rows = []
    for name, part in parts.items():
        here = part["machine"]
        versions = ", ".join(f"{package} {here[package]}" for package in ("python", *PACKAGES))
        rows.append(
            [name, here["day"], here["commit"], f"{here['processor']}, {here['cores']} cores", here["load"], versions]
        )
    return _table("part | day | commit | machine | load before | versions", rows)
