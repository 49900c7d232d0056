"""Two storeys under El Centro, elastic and yielding, beside a course's."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from comparison import CHOPRA_ELCENTRO, Entry, Row, compare


def compare_nptel_frame(solved: Any) -> Iterator[Row]:
    """Yield the peaks of both examples."""
    storeys = solved.table("storey").query("building == 'frame'").set_index(["analysis", "storey"])
    floors = solved.table("floor").query("building == 'frame'").set_index(["analysis", "floor"])["displacement"]
    why = "the course does not say which digitisation of El Centro it used"
    shear = storeys["V"]["elastic", 1] / 1e3
    yield compare("elastic: displacement of the roof [m]", 0.202, floors["elastic", 2], ".3f", why)
    yield compare("elastic: base shear [kN]", 40.72, shear, ".2f", why)
    yield compare("yielding: displacement of the roof [m]", 0.1483, floors["inelastic", 2], ".4f", why)
    yield compare("yielding: displacement of the first floor [m]", 0.068, floors["inelastic", 1], ".3f", why)
    yield compare("yielding: drift of the second storey [m]", 0.088, storeys["drift"]["inelastic", 2], ".3f", why)


ENTRY = Entry(compare_nptel_frame, motions=(CHOPRA_ELCENTRO,))
