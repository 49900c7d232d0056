"""What a study comes to: its buildings, links and motions, and the points of its sweep."""

from __future__ import annotations

import copy
import math
import tempfile
from pathlib import Path

import numpy as np
import pytest
import yaml
from scipy.signal import lsim

import pounding_cli as pound
from pounding_cli.api.studies import load_study as study_of
from pounding_cli.questions.sensitivity.question import Sensitivity
from pounding_cli.study import make_plan

G = 9.80665
STUDY = yaml.safe_load("""
records: {use: [elcentro], duration: 0.2 s}
buildings:
  stiff: {storeys: 3, period: 0.36 s, mass: 200 t}
  soft: {like: stiff, period: 0.60 s}
group: [stiff, soft]
cases: {case: {link: pounding, gap: 5 cm}}
analyses: [elastic]
estimate: none
""")


def study(changes: str = "", **more) -> dict:
    """STUDY with the values of a YAML mapping, keys with dots for places."""
    data = copy.deepcopy(STUDY) | more
    for key, value in (yaml.safe_load(changes) or {}).items():
        *outer, last = key.split(".")
        inner = data
        for name in outer:
            inner = inner[name]
        inner[last] = value
    return data


def building(keys: str) -> pound.Building:
    """The first building of STUDY with other keys."""
    data = study()
    data["buildings"]["stiff"] = yaml.safe_load(f"{{{keys}}}")
    return pound.load_study(data).building((), 0)


def run(data: dict, **settings) -> pound.Results:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "study.yaml")
        path.write_text(yaml.safe_dump(data, sort_keys=False), encoding="utf-8")
        results = pound.run(path, Path("results.h5").absolute(), engine="serial", replace=True, **settings)
    return results


@pytest.fixture(autouse=True)
def _folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


# Units


@pytest.mark.parametrize(
    ("key", "text", "value"),
    [
        ("mass", "200 t", 2e5), ("mass", "200 kg", 200), ("mass", "3 kN s2/m", 3000), ("mass", "5 g", 0.005),
        ("height", "300 cm", 3), ("height", "10 ft", 3.048), ("height", "120 in", 3.048), ("height", "7/2", 3.5),
        ("height", "120 inch", 3.048), ("height", "10 feet", 3.048), ("mass", "1000 lb", 453.59237),
        ("stiffness", "[10 kip/in]", 1751268.3524647637), ("yield_shear", "[20 kips]", 88964.43230521),
        ("stiffness", "[20 kN/mm]", 2e7), ("stiffness", "[2 MN/m]", 2e6), ("stiffness", "[1e10 N/m]", 1e10),
        ("yield_shear", "[900 kN]", 9e5), ("hardening", "5 %", 0.05), ("hardening", "5%", 0.05),
        ("hardening", "1/8", 0.125), ("hardening", " .5 ", 0.5),
    ],
)  # fmt: skip
def test_units(key, text, value):
    more = "" if key == "stiffness" else ", period: 0.5 s"
    found = building(f"storeys: 1, {key}: {text}{more}")
    assert getattr(found, key) == pytest.approx([value], rel=1e-14)


@pytest.mark.parametrize(
    ("text", "value"),
    [("0.35 g", 0.35 * G), ("350 cm/s2", 3.5), ("3.5 m/s^2", 3.5), ("350 Gal", 3.5)],
)
def test_accelerations(text, value):
    assert pound.load_study(study(f"records.scale: {{pga: {text}}}")).motion_uses(())["elcentro"].pga == (
        pytest.approx(value)
    )


# Buildings


def test_a_derived_building():
    """The period comes back from the eigenvalues, the taper from the ends, the base shear from the code."""
    stiff, soft = (pound.load_study(study()).building((), place) for place in (0, 1))
    assert (stiff.periods[0], soft.periods[0]) == pytest.approx((0.36, 0.60), rel=1e-12)
    assert stiff.stiffness[-1] / stiff.stiffness[0] == pytest.approx(1 / 3)
    assert np.diff(stiff.stiffness, 2) == pytest.approx(0, abs=1e-3)
    weight = 3 * 200e3 * G
    assert stiff.yield_shear[0] == pytest.approx(0.4 * 2.75 / 12 * weight)
    assert soft.yield_shear[0] == pytest.approx(0.4 * 1.25 * 1.2 / 0.6 ** (2 / 3) / 12 * weight)
    omega = 2 * math.pi / stiff.periods[:2]
    assert (stiff.alpha / omega + stiff.beta * omega) / 2 == pytest.approx(0.05)
    assert stiff.hardening.tolist() == [0.05] * 3
    assert stiff.foundation is None


def test_a_building_given_outright():
    one = building(
        "mass: [3 t, 2 t], height: [4 m, 3 m], stiffness: [2 MN/m, 1 MN/m], yield_shear: [9 kN, 5 kN], "
        "rayleigh: {alpha: 0.5, beta: 1 ms}, hardening: [0.1, 0], "
        "foundation: {mass: 5 t, sway_stiffness: 1 MN/m, sway_damping: 3 kN s/m}"
    )
    for name, value in (
        ("mass", [3000, 2000]), ("elevation", [4, 7]), ("stiffness", [2e6, 1e6]), ("yield_shear", [9000, 5000]),
        ("hardening", [0.1, 0]), ("alpha", 0.5), ("beta", 0.001),
    ):  # fmt: skip
        assert getattr(one, name) == pytest.approx(value, rel=1e-14), name
    assert (one.foundation.mass, one.foundation.sway_damping) == (5000, 3000)
    assert np.isinf(building("storeys: 2, period: 1 s, yield_shear: never").yield_shear).all()


@pytest.mark.parametrize(
    ("keys", "shares"),
    [
        ("{base_shear: 0.10 W}", [1, 5 / 6, 3 / 6]),
        ("{base_shear: 10 %, distribution: uniform}", [1, 2 / 3, 1 / 3]),
    ],
)
def test_a_base_shear_coefficient(keys, shares):
    found = building(f"storeys: 3, period: 0.36 s, mass: 200 t, yield: {keys}")
    assert found.yield_shear == pytest.approx(0.1 * 600e3 * G * np.array(shares))


def test_what_stands_nearer_counts():
    """A list gives way to a period that is nearer, a period to a list, a damping to Rayleigh's factors; mappings of a
    chain are merged."""
    data = study()
    data["buildings"] = yaml.safe_load("""
      a: {storeys: 3, stiffness: [3e8, 2e8, 1e8], yield: {zone: 0.3, Rw: 8}, damping: 2 %}
      b: {like: a, period: 0.6 s, rayleigh: {alpha: 1, beta: 0}, yield: {zone: 0.15}}
      c: {like: b, stiffness: [3e8, 2e8, 1e8], yield_shear: never}
    """)
    a, b, c = (pound.load_study(data | {"group": ["a", "b", "c"]}).building((), place) for place in range(3))
    assert a.stiffness.tolist() == c.stiffness.tolist() == [3e8, 2e8, 1e8]
    assert b.periods[0] == pytest.approx(0.6)
    assert (b.alpha, b.beta) == (c.alpha, c.beta) == (1, 0)
    share = [each.yield_shear[0] / min(1.5 / each.periods[0] ** (2 / 3), 2.75) for each in (a, b)]
    assert share == pytest.approx([0.3 / 8 * 600e3 * G, 0.15 / 8 * 600e3 * G])


@pytest.mark.parametrize(
    ("keys", "period", "stiffness"), [("period: 0.42 s", 1, 1.21), ("stiffness: {period: 0.42 s, mass: 300 t}", 1.1, 1)]
)
def test_a_swept_mass_holds_the_period_or_the_stiffness(keys, period, stiffness):
    """T = 2 pi sqrt(m / k): 1.21 times the mass is 1.1 times the period, or 1.21 times the stiffness."""
    data = study(sweep={"buildings.soft.mass": ["300 t", "363 t"]})
    data["buildings"]["soft"] = yaml.safe_load(f"{{storeys: 3, mass: 300 t, {keys}}}")
    light, heavy = (pound.load_study(data).building((place,), 1) for place in (0, 1))
    assert light.periods[0] == pytest.approx(0.42, rel=1e-12)
    assert heavy.periods == pytest.approx(period * light.periods, rel=1e-12)
    assert heavy.stiffness == pytest.approx(stiffness * light.stiffness, rel=1e-12)


def test_the_separation_of_the_paper():
    """The pair of Fig. 6: about 7 cm, 6.9 cm with a taper of 1/3."""
    path = Path(__file__).parents[2] / "configs" / "fig6.yaml"
    assert pound.load_study(path).separations().value_at(())[0] == pytest.approx(0.069, abs=5e-4)


# Links


@pytest.mark.parametrize(
    ("case", "links"),
    [
        ("{link: pounding, gap: 5 cm}", "1 pounding 5, 2 pounding 5, 3 pounding 5"),
        ("{link: none}", ""),
        ("{link: pounding, gap: 5 cm, floors: 2}", "2 pounding 5"),
        ("{link: connector, gap: 5 cm, floors: [3, 1]}", "1 connector 5, 3 connector 5"),
        (
            "{gap: 5 cm, links: [{link: connector, floors: 3, stiffness: 1 MN/m}, {link: pounding, floors: rest}]}",
            "1 pounding 5, 2 pounding 5, 3 connector 5",
        ),
        (
            "{gap: 5 cm, links: [{link: connector, floors: [3]}, {link: infill, floors: rest, gap: 7 cm}]}",
            "1 infill 7, 2 infill 7, 3 connector 5",
        ),
        (
            "{gap: 5 cm, links: [{link: infill, floors: {except: [2, 3]}}, {link: infill, floors: 3, gap: 4 cm}]}",
            "1 infill 5, 3 infill 4",
        ),
        ("{gap: 5 cm, links: [{link: none, floors: 2}, {link: pounding, floors: rest}]}", "1 pounding 5, 3 pounding 5"),
        (
            "{gap: 5 cm, links: [{link: pounding, floors: 1}, {link: connector, floors: 1, stiffness: 20 kN/mm}]}",
            "1 pounding 5, 1 connector 5",
        ),
        (
            "{gap: 5 cm, links: [pounding, {link: connector, floors: [2], gap: 1 cm}]}",
            "1 pounding 5, 2 pounding 5, 2 connector 1, 3 pounding 5",
        ),
    ],
)
def test_links_of_a_case(case, links):
    table = run(study(f"cases.case: {case}")).link()
    found = [f"{row.floor} {row.kind} {round(100 * row.gap, 9):g}" for row in table.itertuples() if row.kind]
    assert found == (links.split(", ") if links else [])
    assert table["link"].is_unique


def test_pairs_of_a_row():
    """Each pair its own links; what an entry leaves out comes from the case. Twins are told apart by their places."""
    case = "{gap: 5 cm, links: [{link: pounding, pair: 1, gap: 2 cm, floors: [3]}, {link: connector, pair: 2}]}"
    table = run(study(f"cases.case: {case}", group=["soft", "stiff", "soft"])).link()
    assert table["link"].tolist() == ["soft-1|stiff floor 3", *(f"stiff|soft-2 floor {floor}" for floor in (1, 2, 3))]
    assert table["gap"].tolist() == [0.02, 0.05, 0.05, 0.05]
    assert table["kind"].tolist() == ["pounding", "connector", "connector", "connector"]


def test_floors_meet_by_elevation():
    """Floors at 4, 6, 8 m and at 2, 4.0009, 7.0009, 8, 11 m: two pairs agree within 1 mm."""
    data = study()
    data["buildings"]["stiff"]["height"] = ["4 m", "2 m", "2 m"]
    data["buildings"]["soft"] = {"storeys": 5, "period": 0.6, "height": [2, 2.0009, 3, 0.9991, 3]}
    table = run(data).link()
    assert list(zip(table["floor"], table["right_floor"], strict=True)) == [(1, 2), (3, 4)]


@pytest.mark.parametrize(
    ("a", "b", "links"),
    [
        ({}, {"columns": 0.2}, ["floor 1, right columns", "floor 2, right columns"]),
        (
            {"columns": 0.1},
            {"columns": 0.2},
            ["floor 1, right columns", "floor 2|1, left columns", "floor 2, right columns"],
        ),
        ({"slab": "1.2 m"}, {"slab": "1.2 m", "columns": 0.2}, ["floor 1", "floor 2, right columns"]),
    ],
)
def test_slabs_that_strike_columns(a, b, links):
    """Floors at 3 and 6 m beside floors at 4 and 7.5 m. Fails if a slab takes the wrong storey, or thick slabs that
    overlap are not taken to meet."""
    data = study(group=["A", "B"])
    data["buildings"] = {
        "A": {"storeys": 2, "period": 0.3, "height": 3, **a},
        "B": {"storeys": 2, "period": 0.5, "height": [4, 3.5], **b},
    }
    assert run(data).link()["link"].tolist() == [f"A|B {link}" for link in links]


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("{link: connector, gap: 5 cm, stiffness: 1/5 mean storey of stiff}", "{link: connector, gap: 50 mm}"),
        ("{link: pounding, gap: 0.05, stiffness: 20x stiffest storey}", "{link: pounding, gap: 5 cm}"),
        ("{link: pounding, gap: 5 cm, restitution: 1/2}", "{link: pounding, gap: 1.9685039370078740 in}"),
    ],
)
def test_spellings_of_one_case_are_one_scene(one, other):
    """A scene that is known is not solved again. Fails if a default, a rule or a unit gives another scene."""
    data = study()
    data["cases"] = {"one": yaml.safe_load(one), "other": yaml.safe_load(other)}
    assert int(run(data).attrs["scenes"]) == 3


# Motions


@pytest.mark.parametrize(
    ("scale", "factors"), [("table1", [1.0, 1.75]), ("2", [2.0, 2.0]), ("{arias: elcentro}", [1.0, None])]
)
def test_scales(scale, factors):
    data = study(f"records: {{use: [elcentro, taft], duration: table1, scale: {scale}}}")
    used = list(pound.load_study(data).motion_uses(()).values())
    assert [each.window for each in used] == [10.0, 15.0]
    for each, factor in zip(used, factors, strict=True):
        if factor is None:
            assert each.arias == pytest.approx(used[0].arias, rel=1e-12)
        else:
            assert each.scale == factor


@pytest.mark.parametrize(
    ("scale", "value"), [("pga: 0.35 g", 0.35 * G), ("pgv: 40 cm/s", 0.4), ("sa: 0.8 g, period: 0.5 s", 0.8 * G)]
)
def test_every_motion_is_scaled_to_what_is_asked(scale, value):
    """In the part that is analysed, 5 s, between the samples too, where the ground is straight."""
    data = study(f"records: {{use: [elcentro, taft], duration: 5 s, scale: {{{scale}}}}}")
    read = pound.load_study(data)
    for name, use in read.motion_uses(()).items():
        motion = read.motion((), name)
        step, ground = motion.dt, motion.acceleration
        times = np.linspace(0, (len(ground) - 1) * step, 50 * (len(ground) - 1) + 1)
        fine = np.interp(times, np.arange(len(ground)) * step, ground)
        velocity = np.cumsum(fine[1:] + fine[:-1]) * step / 100
        found = {"pga": fine, "pgv": velocity, "sa:": pseudo_acceleration(times, fine, 0.5, 0.05)}[scale[:3]]
        assert np.abs(found).max() == pytest.approx(value, rel=1e-4)
        arias = (ground[1:] ** 2 + ground[1:] * ground[:-1] + ground[:-1] ** 2).sum() * step / 3 * math.pi / (2 * G)
        assert use.arias == pytest.approx(arias, rel=1e-9)


def pseudo_acceleration(times: np.ndarray, ground: np.ndarray, period: float, ratio: float) -> np.ndarray:
    """By the oscillator's exact step from sample to sample."""
    omega = 2 * math.pi / period
    return omega**2 * lsim(([-1.0], [1.0, 2 * ratio * omega, omega**2]), ground, times)[1]


def wave(path: Path, frequency: float) -> None:
    times = np.arange(300) * 0.01
    path.parent.mkdir(parents=True, exist_ok=True)
    head = "# unit: g\n# dt: 0.01 s\n"
    path.write_text(head + "".join(f"{0.2 * np.sin(2 * np.pi * frequency * t):.6f}\n" for t in times))


@pytest.mark.parametrize(
    ("use", "names"),
    [
        ("[motions]", ["a", "b"]),
        ('["motions/*.txt"]', ["b"]),
        ('["motions/**/*.txt"]', ["b", "c"]),
        ('[taft, "motions/?.csv", {file: motions/deep/c.txt, name: mine}]', ["taft", "a", "mine"]),
        ("[motions/b.txt]", ["b"]),
        ("[knet]", ["TST001-EW", "TST001-NS"]),
    ],
)
def test_files_folders_and_patterns(use, names):
    for place, name in enumerate(("motions/b.txt", "motions/a.csv", "motions/deep/c.txt", "knet/T.NS", "knet/T.EW")):
        wave(Path(name.replace("T.", "TST001.")), 1.0 + place)
    for name in ("README.md", ".hidden.txt", "x.VT2", "notes.pdf", "b.txt~"):
        Path("motions", name).write_text("no motion\n")
    Path("study.yaml").write_text(yaml.safe_dump(study(f"records.use: {use}")))
    assert list(pound.load_study("study.yaml").motions(())) == names


# Sweeps


@pytest.mark.parametrize(
    ("key", "values", "shown"),
    [
        ("cases.case.gap", "[0 cm, 50 mm, 0.1]", "0 cm; 5 cm; 10 cm"),
        ("cases.case.gap", "[0.05, 0.1]", "0.05 m; 0.1 m"),
        ("buildings.stiff.damping", "[3 %, 0.05]", "3 %; 5 %"),
        ("impact.restitution", "[0.4, 1/2]", "0.4; 0.5"),
        ("impact.stiffness", "[5 x stiffest storey, 2 GN/m]", "5 x stiffest storey; 2 GN/m"),
        ("cases.case.floors", "[1, 3, all]", "1; 3; all"),
        ("buildings.soft.period", "{from: 0.2 s, to: 0.8 s, count: 4}", "0.2 s; 0.4 s; 0.6 s; 0.8 s"),
        ("buildings.soft.period", "{from: 1.4 s, to: 0.8 s, step: -0.3 s}", "1.4 s; 1.1 s; 0.8 s"),
        (
            "buildings.soft.period",
            "{from: 0.2 s, to: 3.2 s, count: 5, spacing: log}",
            "0.2 s; 0.4 s; 0.8 s; 1.6 s; 3.2 s",
        ),
        ("buildings.soft.storeys", "{from: 2, to: 6, step: 2}", "2; 4; 6"),
    ],
)
def test_values_of_an_axis(key, values, shown):
    """In the unit in which they are written; a range gives 0.6 s, not 0.6000000000000001 s."""
    (axis,) = pound.load_study(study(impact={"restitution": 0.5}, sweep={key: yaml.safe_load(values)})).axes
    assert axis.names == (key,)
    assert "; ".join(text for place in range(len(axis.values)) for text in axis.display_values(place)) == shown


def test_axes_are_crossed_and_keys_of_one_axis_move_together():
    sweep = [
        {"impact.restitution": [0.4, 0.5]},
        {"buildings.stiff.period": ["0.3 s", "0.4 s"], "cases.case.gap": [0, 0.02]},
    ]
    results = run(study(sweep=sweep))
    found = results.link().drop_duplicates(["impact.restitution", "buildings.stiff.period", "cases.case.gap"])
    points = found[["impact.restitution", "buildings.stiff.period", "cases.case.gap"]].to_numpy().tolist()
    assert points == [[0.4, 0.3, 0.0], [0.4, 0.4, 0.02], [0.5, 0.3, 0.0], [0.5, 0.4, 0.02]]
    assert found["gap"].tolist() == [0.0, 0.02, 0.0, 0.02]


def test_options_of_keys_that_move_together_may_repeat_in_one_of_them():
    """Three places of a stiff building in a row: one key has the same period twice."""
    first = {"choice": ["0.36 s", "0.60 s", "0.60 s"]}
    second = {"choice": ["0.60 s", "0.36 s", "0.60 s"]}
    uncertain = [
        {"buildings.stiff.period": first, "buildings.soft.period": second},
        {"impact.restitution": {"choice": [0.4, 0.5]}},
    ]
    asked = {"outputs": ["mu"], "samples": 16}
    plan = Sensitivity(pound.load_study(study(uncertain=uncertain, sensitivity=asked))).plan
    periods = {values[:2] for values in plan.axes[-1].values}
    assert periods == {(0.36, 0.6), (0.6, 0.36), (0.6, 0.6)}


def test_a_swept_value_reaches_who_inherits_it():
    read = pound.load_study(study(sweep={"buildings.stiff.mass": ["100 t", "300 t"]}))
    assert [read.building((place,), 1).mass[0] for place in (0, 1)] == [1e5, 3e5]


def test_a_formula_counts_what_it_repeats_once():
    """Of 500 characters any: 70 terms alike are one row of operations and 69 sums."""
    force = "+" + " + ".join(["k*v"] * 70)
    laws = {"pad": {"force": force, "parameters": {"k": "1 kN/mm"}}}
    (link, *_) = pound.load_study(study("cases.x: {link: pad, gap: 1 cm}", laws=laws)).links((), "x")
    assert link.law.max_slopes[0] == pytest.approx(7e7)


def test_an_unknown_value_stands_at_its_middle():
    values = {"values": [0.4, 0.45, 0.65], "middle": 0.45}
    read = pound.load_study(study(sweep={"impact.restitution": values}))
    assert [read.axes[0].display_values(place) for place in range(3)] == [("0.4",), ("0.45",), ("0.65",)]
    assert read.to_plain_data()["impact"]["restitution"] == 0.45


@pytest.mark.parametrize(
    ("keep", "kept"),
    [
        ("histories", 8), ("{histories: {analyses: [inelastic]}}", 4), ("{histories: {cases: [near]}}", 4),
        ("{histories: {cases: [case], where: {cases.case.gap: 0.02}}}", 2),
        ("{histories: {where: {cases.case.gap: [1 cm, 20 mm]}}}", 8),
    ],
)  # fmt: skip
def test_histories_of_the_rows_that_are_chosen(keep, kept):
    data = study(
        "cases.near: {link: pounding, gap: 0 cm}", analyses=["elastic", "inelastic"],
        sweep={"cases.case.gap": ["1 cm", "2 cm"]}, keep=yaml.safe_load(keep),
    )  # fmt: skip
    assert len(run(data).histories()) == kept


def test_a_study_as_a_dict_is_that_of_its_file():
    """Its text is a study file that comes to the same, and the dict stays as it was."""
    data = study(sweep={"cases.case.gap": [0.01, 0.02]})
    before = copy.deepcopy(data)
    read = pound.load_study(data)
    Path("again.yaml").write_text(read.text)
    assert pound.load_study("again.yaml").to_plain_data() == read.to_plain_data() | {"title": "again"}
    assert data == before


def test_a_large_sweep_builds_every_building_once(monkeypatch):
    """Fails if answers of a study are forgotten while a sweep of some thousand points is expanded."""
    import pounding_cli.study.construct.resolve as resolve

    built, of_the_program = [], resolve.build_building
    monkeypatch.setattr(resolve, "build_building", lambda name, spec: built.append(name) or of_the_program(name, spec))
    periods = {"from": "0.3 s", "to": "0.5 s", "count": 145}
    buildings = {"a": {"storeys": 1, "period": "0.3 s"}, "b": {"storeys": 1, "period": "0.4 s"}}
    study = {"records": {"use": ["elcentro"], "duration": "1 s"}, "buildings": buildings, "group": ["a", "b"]}
    study |= {"cases": {"gap": {"link": "pounding", "gap": "1 cm"}}, "analyses": ["elastic"]}
    study["sweep"] = {f"buildings.{name}.period": periods for name in "ab"}
    assert len(make_plan(study_of(study))) == 145 * 145 + 145
    assert len(built) <= 2 * 145 + 4


def test_numbers_of_python_data_are_si():
    """Fails if a number without a unit is doubted where numbers are SI, or an implausible one is not."""
    study = {"records": {"use": ["elcentro"], "duration": "1 s"}, "group": ["a", "b"], "impact": {"stiffness": 5e9}}
    periods = {"a": 0.3, "b": 0.4}
    study["buildings"] = {name: {"storeys": 1, "period": period, "height": 3.0} for name, period in periods.items()}
    study["cases"] = {"gap": {"link": "pounding", "gap": 0.01}}
    assert study_of(study).warnings == ()
    (warning,) = study_of(study | {"impact": {"stiffness": 93500}}).warnings
    assert "softer" in warning.message


def test_the_damping_of_a_connector_stands_in_the_study():
    """Fails if the ratio that a connector takes from a restitution is not stated, or is another than it has."""
    study = {"records": {"use": ["elcentro"], "duration": "1 s"}, "group": ["a", "b"], "impact": {"restitution": 0.65}}
    periods = {"a": 0.3, "b": 0.4}
    study["buildings"] = {name: {"storeys": 1, "period": period, "height": 3.0} for name, period in periods.items()}
    study["cases"] = {"joined": {"link": "connector", "gap": "5 cm"}}
    resolved = study_of(study).to_plain_data()["cases"]["joined"]["links"][0]
    (link,) = make_plan(study_of(study)).build(0).links
    assert resolved["damping_ratio"] == link.law.damping_ratio == pytest.approx(0.1359, rel=1e-3)


UNCERTAIN = {
    "impact.restitution": {"uniform": {"from": 0.4, "to": 0.65}},
    "cases.case.gap": {"uniform": {"from": "4 cm", "to": "6 cm"}},
}


@pytest.mark.parametrize(
    ("more", "is_asked"),
    [
        ({}, False),
        ({"residual_drift": False}, False),
        ({"residual_drift": True}, True),
        ({"uncertain": UNCERTAIN, "sensitivity": {"outputs": ["residual_drift in soft"]}}, True),
        ({"uncertain": UNCERTAIN, "sensitivity": {"outputs": ["drift in soft"]}}, False),
    ],
)
def test_residual_drifts_are_found_where_they_are_asked_for(more: dict, is_asked: bool) -> None:
    """Fails if scenes with and without them share a digest, or if a limit on them is answered without them."""
    plan = make_plan(study_of(study(**more)))
    scenes = list(plan.scenes(np.arange(len(plan))))
    assert {scene.residual_drift for scene in scenes} == {is_asked}
    assert [scene.digest for scene in scenes] == [digest.tobytes().hex() for digest in plan.digests]
    without = make_plan(study_of(study()))
    assert (plan.digests != without.digests).any() == is_asked
    both = study(**more, analyses=["elastic", "inelastic"])
    storeys = pound.run(both, Path(tempfile.mkdtemp()) / "r.h5", engine="serial").storey()
    is_elastic = storeys["analysis"] == "elastic"
    assert (storeys["residual_drift"][is_elastic] == 0.0).all()  # whether asked for or not
    yielding = storeys["residual_drift"][~is_elastic]
    assert yielding.notna().all() == is_asked
    assert yielding.notna().any() == is_asked
