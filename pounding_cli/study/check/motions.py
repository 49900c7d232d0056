"""Check motions: peaks of the ground that are implausible, asked for or as used."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from pounding_cli.errors import Issue, KeyPath
from pounding_cli.numbers import join_limited
from pounding_cli.study.check.values import AS_MEANT, check_values, format_value, suggest_value
from pounding_cli.study.check.view import View
from pounding_cli.study.construct.motions import MotionUse
from pounding_cli.study.schema.quantity import PLAUSIBLE_RANGES
from pounding_cli.units import GRAVITY

_PGA: KeyPath = ("records", "scale", "pga")


def check_motions(view: View) -> Iterator[Issue]:
    """Yield accelerations without a unit, and peaks of the ground that are implausible, asked for or as used."""
    of_values = list(check_values(view.written, view.records, ("records",)))
    yield from of_values
    if any(issue.of[:2] == _PGA[:2] for issue in of_values):
        return  # the peaks are what follows from that value
    asked = getattr(view.records.scale, "pga", None)
    if asked is None or view.is_swept_pga:
        yield from _check_peaks(list(view.suite.uses.values()))
        return
    fits = PLAUSIBLE_RANGES["peak asked for"]
    if not fits.holds(asked):
        message = f"{fits.name} is {format_value(asked, fits.units)}: {fits.reason}"
        hint = suggest_value(view.written.find_text(_PGA), asked, fits)
        yield Issue(_PGA, message, hint, code="peak", excess=fits.excess(asked))


def _check_peaks(uses: Sequence[MotionUse]) -> Iterator[Issue]:
    """Yield peaks of the ground that are implausible as used, or above 2 g both in the file and as used."""
    fits = PLAUSIBLE_RANGES["peak of a motion"]
    unlikely = [use for use in uses if not fits.holds(use.pga) or use.pga / max(use.scale, 1.0) > 2 * GRAVITY]
    if unlikely:
        peaks = join_limited(f"{use.name} ({use.pga / GRAVITY:.3g} g)" for use in unlikely)
        key = "scale" if any(use.scale != 1 for use in unlikely) else "use"
        hint = f"check `unit:` of its file and `scale:`; otherwise leave it, {AS_MEANT}"
        excess = max(fits.excess(use.pga) for use in unlikely)
        message = f"unlikely peaks: {peaks}: {fits.reason}"
        yield Issue(("records", key), message, hint, code="peak", excess=excess)
