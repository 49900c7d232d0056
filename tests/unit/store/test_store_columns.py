"""Slabs that strike columns, from the responses to the tables."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pounding_cli.solve.response import ColumnResponse
from pounding_cli.store import open_results, write_results
from pounding_cli.store.compare import compare
from pounding_cli.study import expand, load_study
from tests.helpers.plans import known

STUDY = """title: x
records: {use: [elcentro], duration: 1 s}
buildings:
  A: {storeys: 2, period: 0.3 s, height: 3 m}
  B: {storeys: 2, period: 0.5 s, height: [3 m, 4 m], columns: 20 %}
group: [A, B]
cases: {touching: {link: pounding, gap: 1 cm}, floors: {link: pounding, gap: 1 cm, at_columns: none}}
"""


@pytest.fixture
def written(tmp_path):
    """A results file by a number for the shear above the blow [N]."""

    def write(above: float):
        path = tmp_path / "study.yaml"
        path.write_text(STUDY)
        plan = expand(load_study(path))
        responses = {}
        for digest, scene in plan.scenes.items():
            link = np.array([e for e, link in enumerate(scene.links) if link.columns], int)
            columns = ColumnResponse(link, link + 1e5, link + above, link + 0.5)
            responses[digest] = replace(known(scene), columns=columns, error_estimate=1e-6)
        file = tmp_path / f"{above:g}.h5"
        write_results(file, plan, responses)
        return open_results(file)

    return write


def test_shears_stand_at_their_link(written):
    """Fails if the shears of one link are told of another, or of a link between floors."""
    link = written(2e5).link()
    struck = link[link["link"] == "A|B floor 2, right columns"]
    assert set(struck["case"]) == {"touching"}
    assert struck[["left_at", "right_at"]].to_numpy().tolist() == [[1.0, 0.75]] * len(struck)
    assert struck[["shear_below", "shear_above", "shear_demand"]].to_numpy().tolist() == [[1e5 + 1, 2e5 + 1, 1.5]] * 2
    floors = link[link["link"] == "A|B floor 1"]
    assert set(floors["case"]) == {"touching", "floors"}
    assert floors[["shear_below", "shear_above", "shear_demand"]].isna().all(axis=None)


def test_compare_tells_shears_that_differ(written):
    """Fails if a shear of columns is left out of what is compared."""
    changes = compare(written(2e5), written(2.1e5)).changes
    assert set(changes["column"]) == {"shear_above"}
    assert compare(written(2e5), written(2e5)).same_numbers
