"""The methods a plan is said to need are those that a run of it then takes."""

from __future__ import annotations

import numpy as np
import pytest

from pounding_cli.batch import run_plan
from pounding_cli.batch.forecast import methods_needed
from pounding_cli.store import open_results
from pounding_cli.study import expand, load_study

STUDY = """\
records: {use: [{file: weak.txt}], duration: whole}
buildings:
  stiff: {storeys: 3, period: 0.3 s}
  soft: {like: stiff, period: 0.5 s}
group: [stiff, soft]
cases:
  first: {link: pounding, gap: 50 cm}
analyses: [elastic]
estimate: none
"""

CONNECTED = ("link: pounding, gap: 50 cm", "link: connector, gap: 50 cm")
TOUCHING = ("gap: 50 cm", "gap: 0 cm")
INELASTIC = ("[elastic]", "[inelastic]")
THREE = ("[stiff, soft]", "[stiff, soft, stiff]")
PAIR = ("link: pounding, gap: 50 cm", "link: pounding, gap: 50 cm, pairs: [pounding, {link: pounding, gap: 0 cm}]")
FIXED = ("estimate: none", "method: newmark\ntime_step: 1e-2 s\nestimate: none")


@pytest.fixture
def planned(tmp_path):
    """The plan of STUDY with replacements made, and the results of its run."""
    t = np.arange(0.0, 0.5, 0.01)
    np.savetxt(tmp_path / "weak.txt", np.column_stack([t, 0.1 * np.sin(12 * t)]))

    def make(*changes):
        text = STUDY
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        (tmp_path / "a.yaml").write_text(text)
        plan = expand(load_study(tmp_path / "a.yaml"))
        run_plan(plan, tmp_path / "a.h5", engine_name="serial")
        return plan, open_results(tmp_path / "a.h5")

    return make


@pytest.mark.parametrize(
    ("changes", "methods", "of_rows"),
    [
        ((), {"exponential"}, {"exponential"}),  # the gap never closes
        ((TOUCHING,), {"exponential", "taylor"}, {"taylor"}),
        ((CONNECTED,), {"exponential"}, {"exponential"}),
        ((INELASTIC,), {"taylor"}, {"taylor"}),
        ((THREE, PAIR), {"exponential", "taylor"}, {"exponential, taylor"}),
        ((FIXED,), {"newmark"}, {"newmark"}),
    ],
)
def test_methods_said_are_methods_taken(planned, changes, methods, of_rows):
    """Fails if buildings alone, proofs or the groups of a row are left out."""
    plan, results = planned(*changes)
    assert methods_needed(plan) == set(results.methods) == methods
    assert set(results.scene().method) == of_rows
