"""docs/results.md says what the file holds, and its recipes run."""

from __future__ import annotations

import re
from pathlib import Path

import h5py
import pytest

from pounding_cli.store import write_results
from pounding_cli.variables import COORDINATES, STATISTICS, VARIABLES
from tests.helpers.plans import known, small_plan

PAGE = (Path(__file__).parents[3] / "docs" / "results.md").read_text()
RECIPES = re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL)


@pytest.fixture
def file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "results").mkdir()
    plan = small_plan()
    path = tmp_path / "results" / "fig6.h5"
    write_results(path, plan, {digest: known(scene) for digest, scene in plan.scenes.items()})
    return path


def test_every_variable_and_attribute_is_on_the_page(file):
    statistics = {variable.name for variable in STATISTICS}
    for name in (set(VARIABLES) | set(COORDINATES)) - statistics:
        assert f"`{name}`" in PAGE, name
    with h5py.File(file) as opened:
        for name in set(opened.attrs) - {"coordinates"}:
            assert f"`{name}`" in PAGE, name
        for name, item in opened.items():
            if isinstance(item, h5py.Group):
                assert f"`/{name}`" in PAGE, name
            else:
                assert name in VARIABLES or name in COORDINATES, name


def test_units_on_the_page_are_those_of_the_file():
    """Rows that name variables and units one for one, or one unit for all of them."""
    checked = 0
    for row in re.findall(r"^\|(.*)\|$", PAGE, flags=re.MULTILINE):
        cells = [cell.strip() for cell in row.split("|")]
        names = re.findall(r"`(\w+)`", cells[0])
        units = [unit.strip() for unit in cells[-2].split(",") if unit.strip()]
        own = [VARIABLES[name].unit for name in names if name in VARIABLES and VARIABLES[name].unit]
        if not own or len(own) != sum(name in VARIABLES for name in names):
            continue  # texts among them
        assert (units * len(own) if len(units) == 1 else units) == own, cells[0]
        checked += len(own)
    assert checked > 30


@pytest.mark.parametrize("recipe", RECIPES, ids=["pandas", "xarray", "h5py"])
def test_recipes_run(file, recipe, capsys):
    recipe = recipe.replace("storey=5", "storey=3")  # the file here has three storeys
    exec(recipe, {})
    printed = capsys.readouterr().out
    assert "1.5" in printed or "(2, 2, 2, 3) N" in printed
