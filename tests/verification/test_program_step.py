"""Program steps against plain ones: the same law once as coefficients, once written as operations.

The two share the equations of motion of a slot, but not the series, the search for events, the peaks or the ledger."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from pounding_cli.laws.connector import Connector
from pounding_cli.laws.infill import Infill
from pounding_cli.laws.law import Branch, LinkLaw
from pounding_cli.laws.pounding import Pounding
from pounding_cli.model.building import Building
from pounding_cli.model.foundation import Foundation
from pounding_cli.model.links import Link
from pounding_cli.model.scene import Analysis, Scene
from pounding_cli.solve import solve
from pounding_cli.solve.histories import history
from pounding_cli.study import expand, load_study
from tests.hard.random_scenes import random_scene


def written(law: LinkLaw) -> LinkLaw:
    """A law whose branches are those of another, their forces as expressions."""

    class Written(type(law)):  # type: ignore[misc]
        name = f"written {law.name}"

        def branches(self, left_mass: float, right_mass: float) -> tuple[Branch, ...]:
            given = super().branches(left_mass, right_mass)
            return tuple(
                dataclasses.replace(b, linear=0.0, cubic=0.0, offset=0.0, dashpot=0.0, root=0.0, force=b.expression)
                if b.closed
                else b
                for b in given
            )

    return Written(**{field.name: getattr(law, field.name) for field in dataclasses.fields(law)})


def all_written(scene: Scene) -> Scene:
    laws = {link.law: written(link.law) for link in scene.links}
    return dataclasses.replace(
        scene, links=tuple(dataclasses.replace(link, law=laws[link.law]) for link in scene.links)
    )


def peaks(run) -> np.ndarray:
    columns = [
        np.ravel(getattr(building, name))
        for building in run.buildings
        for name in ("shear", "drift", "acceleration", "displacement_max", "displacement_min", "rocking", "sway")
    ]
    links = run.links
    columns += [links.impacts, links.peak_force, links.max_closing, links.impulse, links.contact_time]
    return np.concatenate([np.ravel(column).astype(float) for column in columns])


def compare(scene: Scene, rel: float, accuracy: float = 1e-9, **more) -> None:
    table, operations = (solve(one, accuracy, "taylor", **more) for one in (scene, all_written(scene)))
    assert table.status == operations.status == "done"
    assert abs(operations.energy["residual"]) < 1e-9
    expected, found = peaks(table), peaks(operations)
    assert found == pytest.approx(expected, rel=rel, abs=1e-12 * np.abs(expected).max())
    for name in ("input", "damping", "hysteresis", "links"):
        scale = max(abs(value) for value in table.energy.values())
        assert operations.energy[name] == pytest.approx(table.energy[name], rel=rel, abs=rel * scale)


KINDS = {"pounding": Pounding, "infill": Infill, "connector": Connector}


@pytest.mark.parametrize("analysis", ["elastic", "inelastic"])
@pytest.mark.parametrize("kind", KINDS)
def test_written_laws_are_those_of_tables(kind, analysis):
    """Every kind of link of Fig. 6, touching floors included; yielding storeys locate their own events.

    Fails without the ground, with another hysteresis, or where a guard of the step looks at something else."""
    plan = expand(load_study(Path("configs/fig6.yaml")))
    scenes = [s for s in plan.scenes.values() if s.links and s.links[0].kind == kind and s.analysis == analysis]
    assert scenes
    for scene in {scene.links[0].gap: scene for scene in scenes}.values():
        compare(scene, 1e-8)


def test_forces_that_are_cut_off_are_followed():
    """A force that would pull does not act, and acts again where it would push. Fails if the ledger books the work of
    a force that is cut off."""
    plan = expand(load_study(Path("configs/fig6.yaml")))
    scene = next(s for s in plan.scenes.values() if s.links and s.links[0].kind == "infill" and s.analysis == "elastic")
    cut = [dataclasses.replace(link, law=dataclasses.replace(link.law, tension_cut=True)) for link in scene.links]
    compare(dataclasses.replace(scene, links=tuple(cut)), 1e-8)


def test_foundations_rock_and_sway_in_program_steps():
    """Fails without the angular acceleration, or with the drift that rocking adds."""
    plan = expand(load_study(Path("configs/fig6.yaml")))
    scene = next(s for s in plan.scenes.values() if s.links and s.links[0].kind == "pounding" and s.links[0].gap == 0)
    ground = Foundation(
        mass=2e5, inertia=1e6, sway_stiffness=2e9, sway_damping=3e6, rocking_stiffness=5e9, rocking_damping=3e7
    )  # fmt: skip
    founded = tuple(dataclasses.replace(building, foundation=ground) for building in scene.buildings)
    compare(dataclasses.replace(scene, buildings=founded), 1e-7, all_effects=True)


def test_random_scenes_are_the_same_either_way():
    """Rows of several buildings, mixed links, islands. Fails if an island is put back without what a link remembers."""
    tried = 0
    for seed in range(60):
        scene, _ = random_scene(seed)
        if not any(link.law.can_close for link in scene.links):
            continue
        once, finer = (solve(scene, accuracy, "taylor", bounds=(40_000, 10_000)) for accuracy in (1e-9, 1e-12))
        if once.status != "done" or finer.status != "done":
            continue
        scale = np.abs(peaks(finer)).max()
        if peaks(once) != pytest.approx(peaks(finer), rel=1e-9, abs=1e-12 * scale):
            continue  # sensitive: rounding alone moves it
        other = solve(all_written(scene), 1e-9, "taylor")
        assert other.status == "done", seed
        assert peaks(other) == pytest.approx(peaks(finer), rel=1e-6, abs=1e-9 * scale), seed
        tried += 1
    assert tried > 15


def test_histories_take_the_force_of_operations():
    """Fails if a history evaluates the operations of another branch."""
    plan = expand(load_study(Path("configs/fig6.yaml")))
    scene = next(s for s in plan.scenes.values() if s.links and s.links[0].kind == "infill")
    table, operations = history(scene, 1e-9, 0.005), history(all_written(scene), 1e-9, 0.005)
    largest = np.abs(table.link_force).max()
    assert operations.link_force == pytest.approx(table.link_force, rel=1e-7, abs=1e-7 * largest)
    assert operations.energy["links"] == pytest.approx(table.energy["links"], rel=1e-6, abs=1.0)


def test_single_floors_join_and_part_in_rows():
    """A row of five single floors: islands. Fails if what is closed by a written force is not kept together."""
    buildings = tuple(
        Building(f"b{n}", [1e5], [3.0], [1e5 * (2 * np.pi / (0.3 + 0.1 * n)) ** 2], [np.inf], [0.0], 0.3, 0.001)
        for n in range(5)
    )
    motion = next(iter(expand(load_study(Path("configs/fig6.yaml"))).scenes.values())).motion
    links = tuple(Link(n, 1, 1, Pounding(0.005, 5e8, 0.2)) for n in range(4))
    compare(Scene(buildings, links, motion, Analysis.ELASTIC), 1e-7)
