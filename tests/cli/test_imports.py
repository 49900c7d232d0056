"""`pound import`: layouts of several versions, what is refused by name, and a frame whose stick has its period."""

from __future__ import annotations

import csv
import re

import numpy as np
import openpyxl
import pytest
import yaml

from pounding_cli.api.studies import load_study
from pounding_cli.imports.pushover import PushoverCurve, draw_fits, fit_two_lines

STOREYS = 9
MASS = np.array([220e3, *[200e3] * 7, 150e3])
HEIGHT = np.array([4.0, *[3.2] * 8])


class Frame:
    """A plane frame of nine storeys and two bays, with beams that bend: an independent model of a tower.

    mass [kg] at the floors; stiffness [N/m] condensed to their drifts; period [s] of the first mode
    shear [N], drift [m] : of the storeys, under forces that follow the first mode
    """

    def __init__(self) -> None:
        self.stiffness = self._condense()
        root = np.sqrt(MASS)
        values, vectors = np.linalg.eigh(self.stiffness / np.outer(root, root))
        self.period = 2 * np.pi / np.sqrt(values[0])
        forces = root * vectors[:, 0] * np.sign(vectors[-1, 0]) * 1e3
        displacement = np.linalg.solve(self.stiffness, forces)
        self.shear = np.cumsum(forces[::-1])[::-1]
        self.drift = np.diff(displacement, prepend=0.0)

    @staticmethod
    def _condense() -> np.ndarray:
        """Return the stiffness of the floors, with the rotations of the joints condensed out."""
        bays, span = 2, 6.0
        columns, beams = 30e9 * 0.5**4 / 12, 30e9 * 0.3 * 0.5**3 / 12
        joints = bays + 1
        size = STOREYS * (1 + joints)

        def rotation(storey: int, joint: int) -> int:
            return STOREYS + storey * joints + joint

        whole = np.zeros((size, size))
        for storey, h in enumerate(HEIGHT):
            for joint in range(joints):
                # displacement and rotation below and above
                part = columns / h**3 * np.array([
                    [12, 6 * h, -12, 6 * h], [6 * h, 4 * h * h, -6 * h, 2 * h * h],
                    [-12, -6 * h, 12, -6 * h], [6 * h, 2 * h * h, -6 * h, 4 * h * h],
                ])  # fmt: skip
                places = [storey - 1, rotation(storey - 1, joint), storey, rotation(storey, joint)]
                kept = [n for n in range(4) if storey > 0 or n > 1]
                for row in kept:
                    for column in kept:
                        whole[places[row], places[column]] += part[row, column]
            for bay in range(bays):
                ends = [rotation(storey, bay), rotation(storey, bay + 1)]
                whole[np.ix_(ends, ends)] += beams / span * np.array([[4, 2], [2, 4]])
        floors, turns = slice(0, STOREYS), slice(STOREYS, size)
        return whole[floors, floors] - whole[floors, turns] @ np.linalg.solve(whole[turns, turns], whole[turns, floors])


FRAME = Frame()
NAMES = [f"Story{number}" for number in range(1, STOREYS + 1)]
DOWN = list(reversed(range(STOREYS)))


def layout(version: str) -> dict[str, list[list]]:
    """Return the sheets of one version: by name, the rows below the title: headings, units, values."""
    k = FRAME.shear / FRAME.drift
    level = np.cumsum(HEIGHT)
    if version == "v16":  # millimetres, elevations with a base, `Load Case/Combo`, `Stiffness X`
        return {
            "Story Data": [
                ["Name", "Height", "Elevation", "Master Story", "Similar To", "Splice Story"],
                [None, "mm", "mm", None, None, None],
                *[[NAMES[i], 1e3 * HEIGHT[i], 1e3 * level[i], "No", "None", "No"] for i in DOWN],
                ["Base", 0, 0, "No", "None", "No"],
            ],
            "Mass Summary by Story": [
                ["Story", "UX", "UY", "UZ"],
                [None, "kg", "kg", "kg"],
                *[[NAMES[i], MASS[i], MASS[i], 0] for i in DOWN],
                ["Base", 55e3, 55e3, 0],
            ],
            "Story Stiffness": [
                ["Story", "Load Case", "Shear X", "Drift X", "Stiffness X", "Shear Y", "Drift Y", "Stiffness Y"],
                [None, None, "kN", "mm", "kN/m", "kN", "mm", "kN/m"],
                *[[NAMES[i], "EQX", FRAME.shear[i] / 1e3, 1e3 * FRAME.drift[i], k[i] / 1e3, 0, 0, 0] for i in DOWN],
            ],
            "Modal Periods and Frequencies": [
                ["Case", "Mode", "Period", "Frequency", "Circular Frequency", "Eigenvalue"],
                [None, None, "sec", "cyc/sec", "rad/sec", "rad²/sec²"],
                ["Modal", 1, FRAME.period, 1, 1, 1],
            ],
        }
    if version == "v18":  # metres and tonnes as kN-s²/m, `Output Case`, StiffXh beside StiffX, two cases
        zeros = [0, 0, 0, 0]
        stiffness = [
            [FRAME.shear[i] / 1e3, FRAME.drift[i], 7.0, k[i] / 1e3] for i in range(STOREYS)
        ]  # StiffXh is another
        return {
            "Story Definitions": [
                ["Tower", "Name", "Height", "Master Story", "Similar To", "Splice Story", "Splice Height", "Color"],
                [None, None, "m", None, None, None, "m", None],
                *[["T1", NAMES[i], HEIGHT[i], "No", "None", "No", 0, "Yellow"] for i in DOWN],
            ],
            "Mass Summary by Story": [
                ["Story", "UX", "UY", "UZ"],
                [None, "kN-s²/m", "kN-s²/m", "kN-s²/m"],
                *[[NAMES[i], MASS[i] / 1e3, MASS[i] / 1e3, 0] for i in DOWN],
            ],
            "Story Stiffness": [
                [
                    "Story",
                    "Output Case",
                    "Case Type",
                    "Step Type",
                    "Shear X",
                    "Drift X",
                    "StiffXh",
                    "StiffX",
                    "Shear Y",
                    "Drift Y",
                    "StiffYh",
                    "StiffY",
                ],
                [None, None, None, None, *["kN", "m", "kN/m", "kN/m"] * 2],
                *[[NAMES[i], "EQX", "LinStatic", None, *stiffness[i], *zeros] for i in DOWN],
                *[[NAMES[i], "EQY", "LinStatic", None, *zeros, *stiffness[i]] for i in DOWN],
            ],
            "Modal Periods And Frequencies": [
                ["Case", "Mode", "Period", "Frequency", "CircFreq", "Eigenvalue"],
                [None, None, "sec", "cyc/sec", "rad/sec", "rad²/sec²"],
                ["Modal", 1, 2.0, 1, 1, 1],
                ["Modal", 2, FRAME.period, 1, 1, 1],
            ],
            "Modal Participating Mass Ratios": [
                ["Case", "Mode", "Period", "UX", "UY", "UZ", "SumUX"],
                [None, None, "sec", None, None, None, None],
                ["Modal", 1, 2.0, 0.01, 0.8, 0, 0.01],
                ["Modal", 2, FRAME.period, 0.8, 0.01, 0, 0.81],
            ],
            "Centers Of Mass And Rigidity": [
                ["Story", "Diaphragm", "Mass X", "Mass Y", "XCM", "YCM", "XCR", "YCR"],
                [None, None, "kN-s²/m", "kN-s²/m", "m", "m", "m", "m"],
                *[[NAMES[i], "D1", 1, 1, 10.0, 7.0, 10.5, 8.4] for i in DOWN],
            ],
        }
    pound, inch = 4.4482216152605, 0.0254  # v21: kip and inch, lb-s²/in, steps Max and Min, names without blanks
    return {
        "Story Definitions": [
            ["Tower", "Story", "Height", "MasterStory", "SimilarTo"],
            [None, None, "in", None, None],
            *[["T1", NAMES[i], HEIGHT[i] / inch, "No", "None"] for i in DOWN],
        ],
        "Mass Summary by Story": [
            ["Story", "UX", "UY", "UZ"],
            [None, "lb-s²/in", "lb-s²/in", "lb-s²/in"],
            *[[NAMES[i], MASS[i] / (pound / inch), MASS[i] / (pound / inch), 0] for i in DOWN],
        ],
        "Story Stiffness": [
            ["Story", "OutputCase", "CaseType", "StepType", "StepNum", "ShearX", "DriftX", "StiffXh", "StiffX"],
            [None, None, None, None, None, "kip", "in", "kip/in", "kip/in"],
            *[
                [NAMES[i], "SPECX", "LinRespSpec", "Max", None, FRAME.shear[i] / pound / 1e3, FRAME.drift[i] / inch,
                 9.9, k[i] / (1e3 * pound / inch)]
                for i in DOWN
            ],
        ],
        "Modal Periods And Frequencies": [
            ["OutputCase", "StepType", "StepNum", "Period"],
            ["Text", "Text", "Unitless", "Sec"],
            ["MODAL", "Mode", 1, FRAME.period],
        ],
    }  # fmt: skip


VERSIONS = ("v16", "v18", "v21")
SOME = {"v16": [], "v18": ["--case", "EQX"], "v21": []}


def write_book(sheets, path) -> None:
    """Write a workbook as the program does: title, headings, units."""
    book = openpyxl.Workbook()
    book.remove(book.active)
    for name, rows in sheets.items():
        sheet = book.create_sheet(name[:31])
        sheet.append([f"TABLE:  {name}"])
        for row in rows:
            sheet.append(row)
    book.save(path)


def write_folder(sheets, path) -> None:
    path.mkdir()
    for name, rows in sheets.items():
        with (path / f"{name}.csv").open("w", newline="") as stream:
            csv.writer(stream).writerows(rows)


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("write", [write_book, write_folder])
def test_the_stick_has_the_period_of_the_frame(folder, pound, version, write):
    """Forces that follow the first mode give storey stiffnesses of which that mode is an exact one."""
    source = "tower.xlsx" if write is write_book else "tower"
    write(layout(version), folder / source)
    code, out, err = pound("import", "etabs", source, *SOME[version])
    assert (code, err) == (0, "")
    assert "the same within 0.05 %" in out
    building = load_study(folder / "tower.yaml").group((0,)).buildings[0]
    assert building.periods[0] == pytest.approx(FRAME.period, rel=1e-6)
    assert building.mass == pytest.approx(MASS, rel=1e-7)
    assert np.diff(building.elevation, prepend=0.0) == pytest.approx(HEIGHT, rel=1e-7)
    assert building.stiffness == pytest.approx(FRAME.shear / FRAME.drift, rel=1e-7)
    text = (folder / "tower.yaml").read_text()
    assert re.search(r"SHA-256 [0-9a-f]{64}", text)
    assert "column StiffXh" not in out


def test_an_imported_study_runs(folder, pound):
    write_book(layout("v16"), folder / "tower.xlsx")
    assert pound("import", "etabs", "tower.xlsx")[0] == 0
    assert pound("check", "tower.yaml")[0] == 0
    code, out, _ = pound("run", "tower.yaml", "estimate=none", "records.duration=1 s")
    assert code == 0
    assert "tower" in out


# What is wrong is named: file, row, column, sheet, and what to write


def edit(name, place, value):
    """Return a change of one cell: sheet, (row below the title, column), value."""

    def change(sheets):
        sheets[name][place[0]][place[1]] = value

    return change


def drop(name):
    return lambda sheets: sheets.pop(name)


def drop_row(name, row):
    return lambda sheets: sheets[name].pop(row)


STIFF = {"v16": 4, "v18": 7, "v21": 8}
HEIGHTS = {"v16": "Story Data", "v18": "Story Definitions", "v21": "Story Definitions"}
NAME_COLUMN = {"v16": 0, "v18": 1, "v21": 1}


def faults(version: str):
    """Return five faults: what is changed, and what the refusal must say."""
    stiff, heights, name = STIFF[version], HEIGHTS[version], NAME_COLUMN[version]
    heading = layout(version)["Story Stiffness"][0][stiff]
    return {
        "no table": (
            drop("Mass Summary by Story"),
            ["tower.xlsx: ", "no table 'Mass Summary by Story'", "the file has"],
        ),
        "no column": (
            edit("Story Stiffness", (0, stiff), "Stiff"),
            ["tower.xlsx:2:1: ", "'Story Stiffness'", "no column 'StiffX'", *(["StiffXh"] if version != "v16" else [])],
        ),
        "no number": (
            edit("Story Stiffness", (4, stiff), "n/a"),
            [f"tower.xlsx:6:{stiff + 1}: ", "'Story Stiffness', row 6", f"'{heading}'", "'n/a' is not a finite number"],
        ),
        "other unit": (
            edit("Mass Summary by Story", (1, 1), "kN"),
            ["tower.xlsx:3:2: ", "'UX'", "'Mass Summary by Story'", "'kN' is not a unit of mass", "e.g. kg"],
        ),
        "other name": (
            edit(heights, (2, name), "Roof"),
            ["tower.xlsx", "'Mass Summary by Story' has no row for storey 'Roof'", "one name for a storey"],
        ),
        "unknown unit": (
            edit(heights, (1, 2 if name else 1), "ells"),
            [f"tower.xlsx:3:{3 if name else 2}: ", "'Height'", "'ells' is not a unit of length"],
        ),
        "no unit": (edit(heights, (1, 2 if name else 1), None), ["'Height'", "has no unit", "--units 'kN, m'"]),
        "zero": (
            edit("Mass Summary by Story", (3, 1), 0),
            ["tower.xlsx:5:2: ", "row 5, column 'UX'", "0 is not above zero"],
        ),
    }


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("fault", list(faults("v16")))
def test_wrong_tables_are_refused_by_name(folder, pound, version, fault):
    sheets = layout(version)
    change, words = faults(version)[fault]
    change(sheets)
    write_book(sheets, folder / "tower.xlsx")
    order = ["--order", "down"] if fault == "other name" else []
    code, out, err = pound("import", "etabs", "tower.xlsx", *SOME[version], *order)
    assert (code, out) == (2, "")
    assert [word for word in words if word not in err] == [], err
    assert not (folder / "tower.yaml").exists()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ([], ["has 2 load cases", "with 'StiffX' in them: EQX\n", "--case EQX"]),
        (["--case", "Dead"], ["no load case 'Dead'", "--case EQX"]),
        (["--case", "EQY"], ["storey 'Story1' has the stiffness 0", "--direction"]),
        (["--case", "EQX", "--tower", "T9"], ["no tower 'T9'", "--tower T1"]),
        (["--case", "EQX", "--width", "20 m"], ["--depth and --frequency-ratio are missing"]),
        (["--case", "EQX", "--width", "20 kN"], ["--width", "'20 kN' is no length"]),
        (["--case", "EQX", "--mode", "7"], ["has no mode 7", "name one of 1, 2"]),
        (["--case", "EQX", "--units", "m"], ["--units 'm' is not a force and a length"]),
        (["--case", "EQX", "-o", "tower.txt"], ["end it in .yaml"]),
    ],
)
def test_what_the_tables_leave_open_is_asked_for(folder, pound, options, words):
    write_book(layout("v18"), folder / "tower.xlsx")
    code, out, err = pound("import", "etabs", "tower.xlsx", *options)
    assert (code, out) == (2, "")
    assert [word for word in words if word not in err] == [], err


def test_files_that_are_no_tables_are_refused(folder, pound):
    (folder / "bad.xlsx").write_bytes(b"PK\x03\x04 no archive")
    (folder / "old.xls").write_bytes(b"\xd0\xcf\x11\xe0" + bytes(600))
    (folder / "empty.csv").write_text("\n")
    (folder / "none").mkdir()
    for name, word in (
        ("bad.xlsx", "cannot be read"), ("old.xls", "old version of Excel"), ("empty.csv", "the file is empty"),
        ("none", "no CSV file"), ("nowhere.xlsx", "no such file"),
    ):  # fmt: skip
        code, _, err = pound("import", "etabs", name)
        assert code == 2
        assert f"error: {name}: " in err
        assert word in err


def test_a_plan_follows_from_the_centres_and_what_is_asked_for(folder, pound):
    """Along y the way across the row is against x, so the eccentricity changes its sign."""
    sheets = layout("v18")
    write_book(sheets, folder / "tower.xlsx")
    sizes = ["--width", "20 m", "--depth", "14 m", "--frequency-ratio", "1.2"]
    for direction, case, expected in (("X", "EQX", 1.4), ("Y", "EQY", -0.5)):
        code, _, _ = pound("import", "etabs", "tower.xlsx", "--case", case, "--direction", direction, *sizes, "--force")
        assert code == 0
        plan = yaml.safe_load((folder / "tower.yaml").read_text())["buildings"]["tower"]["plan"]
        assert float(plan["eccentricity"].removesuffix(" %")) == pytest.approx(100 * expected / 20)
    assert pound("import", "etabs", "tower.xlsx", "--case", "EQX", "--force")[0] == 0
    text = (folder / "tower.yaml").read_text()
    assert "plan: the eccentricity is 1.4 m" in text
    assert "plan" not in yaml.safe_load(text)["buildings"]["tower"]


def test_match_period_scales_the_stiffnesses(folder, pound):
    sheets = layout("v16")
    sheets["Modal Periods and Frequencies"][2][2] = 1.1 * FRAME.period
    write_book(sheets, folder / "tower.xlsx")
    _, out, err = pound("import", "etabs", "tower.xlsx")
    assert "9.1 % shorter" in out
    assert "--match-period" in err
    code, out, err = pound("import", "etabs", "tower.xlsx", "--match-period", "--force")
    assert (code, err) == (0, "")
    assert "scaled to that of the model" in out
    building = load_study(folder / "tower.yaml").group((0,)).buildings[0]
    assert building.periods[0] == pytest.approx(1.1 * FRAME.period, rel=1e-6)


def test_a_study_of_yours_is_not_overwritten(folder, pound):
    write_book(layout("v16"), folder / "tower.xlsx")
    assert pound("import", "etabs", "tower.xlsx")[0] == 0
    code, _, err = pound("import", "etabs", "tower.xlsx")
    assert code == 2
    assert "tower.yaml" in err
    (folder / "tower.yaml").write_text("title: mine\n")
    assert pound("import", "etabs", "tower.xlsx", "--force")[0] == 2


def test_orders_that_contradict_each_other_are_refused(folder, pound):
    sheets = layout("v18")
    rows = sheets["Story Definitions"]
    rows[3], rows[4] = rows[4], rows[3]
    write_book(sheets, folder / "tower.xlsx")
    code, _, err = pound("import", "etabs", "tower.xlsx", "--case", "EQX")
    assert code == 0  # the shears of both are not in order then: the numbers in the names decide
    sheets["Mass Summary by Story"].append(["Base", 55, 55, 0])
    masses = sheets["Mass Summary by Story"]
    masses[3], masses[4] = masses[4], masses[3]
    write_book(sheets, folder / "tower.xlsx")
    code, _, err = pound("import", "etabs", "tower.xlsx", "--case", "EQX", "--force")
    assert code == 2
    assert "the base stands last; by the numbers in the names contradict each other" in err
    assert "--order" in err


def test_curves_come_from_the_workbook_of_the_other_tables(folder, pound):
    """`Story Stiffness` of a nonlinear static case, with a row for each step."""
    sheets = layout("v18")
    k = FRAME.shear / FRAME.drift
    rows = sheets["Story Stiffness"]
    for i in DOWN:
        for x in np.linspace(0, 4, 41):
            shear = k[i] * 0.01 * (x if x < 1 else 1 + 0.05 * (x - 1)) / 1e3
            rows.append([NAMES[i], "PUSHX", "NonStatic", "Step", shear, 0.01 * x, 0, 0, 0, 0, 0, 0])
    write_book(sheets, folder / "tower.xlsx")
    code, out, err = pound("import", "pushover", "tower.xlsx", "--case", "PUSHX")
    assert (code, err) == (0, "")
    assert "the same within 0.05 %" in out
    building = load_study(folder / "tower.yaml").group((0,)).buildings[0]
    assert building.yield_shear == pytest.approx(0.01 * k, rel=1e-6)


def test_the_storeys_of_a_plain_table(folder, pound):
    """Semicolons with decimal commas, and units in the headings."""
    rows = [f"{3 - n};3,2;{200 - n},5;1{n}0,5;{900 - n}" for n in range(3)]
    head = "Storey;Height [m];Mass [t];Stiffness [kN/mm];Yield shear [kN]"
    (folder / "plain.csv").write_text("\n".join([head, *rows]) + "\n")
    code, out, err = pound("import", "table", "plain.csv", "--name", "Old House")
    assert (code, out) == (2, "")
    assert "plain.csv:4:2: 'plain', row 4, column 'Height': '3,2' is not a number" in err
    assert "give `--decimal ','` if it is 3.2" in err
    code, out, err = pound("import", "table", "plain.csv", "--name", "Old House", "--decimal", ",")
    assert (code, err) == (0, "")
    assert "declared: --decimal ','" in out
    assert "by the numbers in the names" in out
    building = load_study(folder / "old-house.yaml").group((0,)).buildings[0]
    assert building.mass == pytest.approx([198.5e3, 199.5e3, 200.5e3])
    assert building.stiffness == pytest.approx([120.5e6, 110.5e6, 100.5e6])
    assert building.yield_shear == pytest.approx([898e3, 899e3, 900e3])


def test_the_order_of_storeys_is_never_guessed(folder, pound):
    (folder / "plain.csv").write_text("Storey,Height,Mass,Stiffness\nroof,3,0.2,90\nground,3,0.2,100\n")
    code, _, err = pound("import", "table", "plain.csv", "--units", "MN m")
    assert code == 2
    assert "--order up" in err
    assert pound("import", "table", "plain.csv", "--units", "MN m", "--order", "down")[0] == 0
    building = load_study(folder / "plain.yaml").group((0,)).buildings[0]
    assert building.stiffness == pytest.approx([100e6, 90e6])
    assert building.mass == pytest.approx([200e3, 200e3])


# Pushover curves


def write_storeys(folder) -> None:
    rows = [f"{name},{h},{m / 1e3}" for name, h, m in zip(NAMES, HEIGHT, MASS, strict=True)]
    (folder / "storeys.csv").write_text("\n".join(["storey,height [m],mass [t]", *rows]) + "\n")


def write_curves(folder, shear_of, steps=200, largest=5.0) -> None:
    """Write curves: the shear over k Dy of every storey is a function of its drift over Dy; Dy is 12 mm."""
    lines = ["Story,Step,Drift [mm],Shear [kN]"]
    for name, k in zip(NAMES, FRAME.shear / FRAME.drift, strict=True):
        for step, x in enumerate(np.linspace(0.0, largest, steps)):
            lines.append(f"{name},{step},{12 * x:.9g},{k * 0.012 * shear_of(x) / 1e3:.9g}")
    (folder / "curves.csv").write_text("\n".join(lines) + "\n")


def test_a_curve_of_two_lines_is_found_again_and_the_stick_has_the_period_of_the_frame(folder, pound):
    """The corner is a point of the curve."""
    write_storeys(folder)
    write_curves(folder, lambda x: x if x < 1 else 1 + 0.04 * (x - 1), steps=501)
    period = f"{FRAME.period:.9f} s"
    code, out, err = pound("import", "pushover", "curves.csv", "--storeys", "storeys.csv", "--period", period)
    assert (code, err) == (0, "")
    assert "the same within 0.05 %" in out
    building = load_study(folder / "curves.yaml").group((0,)).buildings[0]
    k = FRAME.shear / FRAME.drift
    assert building.stiffness == pytest.approx(k, rel=1e-6)
    assert building.yield_shear == pytest.approx(0.012 * k, rel=1e-6)
    assert building.hardening == pytest.approx(np.full(STOREYS, 0.04), rel=1e-5)
    assert building.periods[0] == pytest.approx(FRAME.period, rel=1e-6)
    assert (folder / "curves-fits.svg").read_bytes().startswith(b"<?xml")


def test_a_rounded_curve_keeps_its_area_and_says_its_error(folder, pound):
    write_storeys(folder)
    write_curves(folder, lambda x: np.tanh(x) + 0.03 * x)
    code, out, _ = pound("import", "pushover", "curves.csv", "--storeys", "storeys.csv", "--figure", "fits.png")
    assert code == 0
    row = next(line for line in out.splitlines() if line.startswith("Story1"))
    error = float(re.findall(r"([\d.]+) %", row)[0])
    building = load_study(folder / "curves.yaml").group((0,)).buildings[0]
    k, vy, dy = building.stiffness[0], building.yield_shear[0], building.yield_drift[0]
    last = vy + building.hardening[0] * k * (0.06 - dy)
    x = np.linspace(0.0, 5.0, 200)
    scale = (FRAME.shear / FRAME.drift)[0] * 0.012
    curve = scale * (np.tanh(x) + 0.03 * x)
    assert 0.5 * vy * dy + 0.5 * (vy + last) * (0.06 - dy) == pytest.approx(np.trapezoid(curve, 0.012 * x), rel=1e-6)
    assert last == pytest.approx(curve[-1], rel=1e-6)
    two_lines = np.where(0.012 * x < dy, k * 0.012 * x, vy + building.hardening[0] * k * (0.012 * x - dy))
    mean = np.trapezoid(np.abs(two_lines - curve), x) / 5.0 / curve[-1]
    assert error == pytest.approx(100 * mean, abs=0.02)
    assert (folder / "fits.png").read_bytes().startswith(b"\x89PNG")


def test_a_storey_that_does_not_yield_and_one_that_falls_are_told(folder, pound):
    write_storeys(folder)
    write_curves(folder, lambda x: 0.2 * x, largest=0.5)
    code, _, err = pound("import", "pushover", "curves.csv", "--storeys", "storeys.csv")
    assert code == 0
    assert err.count("its yield shear is not known") == STOREYS
    write_curves(folder, lambda x: min(x, 1.0) - 0.2 * max(x - 3.0, 0.0))
    code, _, err = pound("import", "pushover", "curves.csv", "--storeys", "storeys.csv", "--force")
    assert code == 0
    assert "loses 40 % of its shear after the peak" in err


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda text: text.replace("Shear [kN]", "Shear"), ["'Shear'", "has no unit", "curves.csv:1:4"]),
        (lambda text: text.replace("Shear [kN]", "Shear [mm]"), ["'mm' is not a unit of force"]),
        (lambda text: text.replace("Story9,", "Roof,"), ["no curve of storey Story9", "Roof"]),
        (lambda text: text.replace("Story1,3,", "Story1,3,-"), ["curves.csv:5:3", "does not grow"]),
        (lambda text: text.replace("Story1,0,0,0", "Story1,0,0,25"), ["does not begin at the origin"]),
        (lambda text: text.replace("Story1,4,", "Story1,4,x"), ["curves.csv:6:3", "is not a number"]),
        (lambda text: text.replace("Story1,3,", ",3,"), ["curves.csv:5:1", "is empty", "merged cells"]),
        (lambda text: text.splitlines()[0] + "\n", ["'curves' has no row"]),
        (lambda text: text.replace("Drift", "Way"), ["no table has the columns storey, drift and shear"]),
    ],
)
def test_wrong_curves_are_refused_by_name(folder, pound, change, words):
    write_storeys(folder)
    write_curves(folder, lambda x: min(x, 1.0), steps=20)
    (folder / "curves.csv").write_text(change((folder / "curves.csv").read_text()))
    code, out, err = pound("import", "pushover", "curves.csv", "--storeys", "storeys.csv")
    assert (code, out) == (2, "")
    assert [word for word in words if word not in err] == [], err
    assert not (folder / "curves.yaml").exists()


def test_curves_without_masses_say_what_is_missing(folder, pound):
    write_curves(folder, lambda x: min(x, 1.0), steps=20)
    code, _, err = pound("import", "pushover", "curves.csv")
    assert code == 2
    assert "no table 'Mass Summary by Story'" in err
    assert "columns storey, height, mass" in err


# Tables as they lie in offices: titles, totals, basements, gaps, other signs

PLAIN = "Storey,Height [m],Mass [t],Stiffness [kN/mm],Yield shear [kN]"
ROWS = ["3,3.2,150,107,1160", "2,3.2,200,179,1930", "1,4,210,214,2320"]


def import_plain(folder, pound, *lines, options=()):
    (folder / "plain.csv").write_text("\n".join(lines) + "\n")
    return pound("import", "table", "plain.csv", *options)


@pytest.mark.parametrize(
    ("lines", "options", "words"),
    [
        ([PLAIN], [], ["has no row of a storey"]),
        ([PLAIN.replace("Mass [t]", "Weight [kN]"), *ROWS], [], ["no column 'Mass'", "3 'Weight'", "'mass=2'"]),
        ([PLAIN.replace("Storey,", ""), *(row[2:] for row in ROWS)], [], ["no column 'Storey'", "plain.csv:1:1"]),
        ([PLAIN.replace("[t]", "[kN]"), *ROWS], [], ["plain.csv:1:3", "not a unit of mass", "'mass=Mass/9.81'"]),
        ([PLAIN.replace("Yield shear [kN]", "Hardening"), *ROWS], [], ["plain.csv:4:5", "row 4", "below 1"]),
        ([PLAIN.replace("Yield shear", "Stiffness"), *ROWS], [], ["plain.csv:1:5", "2 columns 'Stiffness'"]),
        ([PLAIN, *ROWS, ",10.4,560,,"], [], ["plain.csv:5:1", "is empty", "a total"]),
        ([PLAIN + ",Tower", *(row + ",T1" for row in ROWS)], ["--tower", "T2"], ["has no tower 'T2': T1"]),
        ([PLAIN, *ROWS], ["--tower", "T2"], ["--tower T2 has no effect"]),
        ([PLAIN, *ROWS], ["--case", "EQX"], ["--case EQX has no effect"]),
        ([PLAIN, *ROWS], ["--step", "Max"], ["--step Max has no effect"]),
        ([PLAIN, *ROWS], ["--mode", "2"], ["--mode 2 has no effect"]),
    ],
)
def test_wrong_plain_tables_are_refused_by_name(folder, pound, lines, options, words):
    code, out, err = import_plain(folder, pound, *lines, options=options)
    assert (code, out) == (2, "")
    assert [word for word in words if word not in err] == [], err
    assert not (folder / "plain.yaml").exists()


@pytest.mark.parametrize(
    ("lines", "words", "warnings"),
    [
        (["Report of 2026", "Tower of the north", PLAIN, *ROWS], ["not read: 'Report of 2026', 'Tower of the"], []),
        (
            [PLAIN, *ROWS, "0,10.4,560,500,5410"],
            ["4 storeys"],
            ["storey '0' has the height and the mass of all others"],
        ),
        ([f"{PLAIN},,", *(f"{row},," for row in ROWS)], ["3 storeys"], []),
        ([PLAIN, ROWS[0], ",,,,", *(f"{row},," for row in ROWS[1:])], ["3 storeys"], []),
        ([PLAIN, *ROWS, "Total,10.4,560,,"], ["left out: row 5 of 'plain', 'Total'", "1, 2, 3"], []),
        ([PLAIN + ",Remark", *(row + ",x" for row in ROWS)], ["columns left out: Remark"], []),
        ([PLAIN, ROWS[0], ROWS[2]], ["2 storeys"], ["leave out the number 2"]),
        ([PLAIN, *ROWS, f"{10**40},3,100,90,900"], ["4 storeys"], ["leave out the number 4, 5, 6"]),
        ([PLAIN, "-1,3,300,900,9000", "-2,3,300,900,9000", ROWS[2]], ["up -2, -1, 1"], ["-2, -1 sound as if below"]),
        ([PLAIN.replace(",", ";"), "1;4;210.000;214.000;900"], ["1 storey"], ["three digits stand behind every point"]),
        ([PLAIN, "Roof,,,,", *ROWS], [], None),
        ([f"{PLAIN},Tower", *(f"{row}," for row in ROWS[:2]), f"{ROWS[2]},T1"], ["3 storeys"], []),
    ],
)
def test_plain_tables_say_what_was_left_out_or_doubted(folder, pound, lines, words, warnings):
    """A row without numbers is no row of units: None for a refusal."""
    code, out, err = import_plain(folder, pound, *lines)
    if warnings is None:
        assert code == 2
        assert "row 2" in err
        return
    assert code == 0, err
    assert [word for word in words if word not in out] == [], out
    assert [word for word in warnings if word not in err] == [], err
    assert bool(err) == bool(warnings)


OTHER = "Ebene,Höhe [m],Gewicht [kN],,Vy [kN]"
ODD = ["3,3.2,1471.5,107,1160", "2,3.2,1962,179,1930", "1,4,2060.1,214,2320"]
SOURCES = {"storey": "1", "height": "Höhe", "mass": "Gewicht/9.81", "stiffness": "4 [kN/mm]", "yield shear": "Vy"}


@pytest.mark.parametrize("by_file", [False, True])
def test_columns_with_other_names_are_declared(folder, pound, by_file):
    """On the command line, or in a file that stays with the project; both give the study of the plain names."""
    columns = [part for item in SOURCES.items() for part in ("--column", "=".join(item))]
    if by_file:
        (folder / "columns.yaml").write_text(yaml.safe_dump(SOURCES, allow_unicode=True))
        columns = ["--columns", "columns.yaml"]
    code, out, err = import_plain(folder, pound, OTHER, *ODD, options=columns)
    assert (code, err) == (0, "")
    assert "mass: 'plain', column Gewicht [kN] x 0.101937" in out
    assert "declared: --column" in out
    found = load_study(folder / "plain.yaml").group((0,)).buildings[0]
    import_plain(folder, pound, PLAIN, *ROWS, options=["--force"])
    wanted = load_study(folder / "plain.yaml").group((0,)).buildings[0]
    for name in ("mass", "stiffness", "yield_shear", "elevation"):
        assert getattr(found, name) == pytest.approx(getattr(wanted, name), rel=1e-9)


@pytest.mark.parametrize(
    ("lines", "columns", "words"),
    [
        ([OTHER, *ODD], {}, ["no column 'Storey'", "it has 1 'Ebene', 2 'Höhe'", "--column 'storey=HEADING'"]),
        ([OTHER, *ODD], {"weight": "3"}, ["--column: 'weight' is not a quantity", "known: storey, height, mass"]),
        ([OTHER, *ODD], {"mass": "0"}, ["--column: '0' is not a column"]),
        ([OTHER, *ODD], SOURCES | {"mass": "Gewicht/32.2"}, ["plain.csv:1:3", "'kN' is not a unit of mass"]),
        ([OTHER, *ODD], SOURCES | {"stiffness": "4"}, ["column '4'", "has no unit"]),
        ([OTHER, *ODD], SOURCES | {"mass": "4/9.81"}, ["column '4'", "has no unit", "`4 [kN]`"]),
        (
            [OTHER.replace("Vy [kN", "Vy [MN"), *ODD],
            SOURCES | {"yield shear": "Vy [mN]"},
            ["in MN, and 'Vy [mN]' says"],
        ),
        ([OTHER, *ODD], SOURCES | {"yield shear": "Vy [MN]"}, ["'Vy'", "is in kN, and 'Vy [MN]' says otherwise"]),
        ([PLAIN, *ROWS], {"mass": "Weight"}, ["--column 'mass=Weight' has no effect"]),
        (ROWS, {}, ["no column 'Storey'", "it has no headings"]),
        (ROWS, {"storey": "1", "height": "2 [m]", "mass": "3 [t]", "stiffness": "4 [kN/mm]"}, ["it has no headings"]),
        ([PLAIN, *(f"{row},05" for row in ROWS)], {}, ["plain.csv:2:6: 'plain', row 2: 6 cells below 5 headings"]),
        ([PLAIN, "1,210,214,2320"], {}, ["plain.csv:2:1: 'plain', row 2: 4 cells below 5 headings"]),
        ([PLAIN, '1,4,"1,980",214,2320'], {}, ["'1,980' is not a number", "`--thousands ','` if it is 1980"]),
    ],
)
def test_what_is_not_declared_is_refused(folder, pound, lines, columns, words):
    options = [part for item in columns.items() for part in ("--column", "=".join(item))]
    code, out, err = import_plain(folder, pound, *lines, options=options)
    assert (code, out) == (2, "")
    assert [word for word in words if word not in err] == [], err


def test_a_file_of_columns_is_refused_at_its_place(folder, pound):
    (folder / "columns.yaml").write_text("mass: 3\nweight: 4\n")
    code, _, err = import_plain(folder, pound, OTHER, *ODD, options=["--columns", "columns.yaml"])
    assert code == 2
    assert "columns.yaml:2:1: 'weight' is not a quantity of a table" in err


def test_signs_of_numbers_are_declared(folder, pound):
    lines = [PLAIN.replace(",", "\t"), "1\t4,00\t1.980,5\t214\t2320"]
    code, _, err = import_plain(folder, pound, *lines, options=["--decimal", ",", "--thousands", "."])
    assert (code, err) == (0, "")
    assert load_study(folder / "plain.yaml").group((0,)).buildings[0].mass == pytest.approx([1980.5e3])
    lines = ["Storey Height Mass Stiffness", "1, 3 0.2 90", "2, 3 0.2 80"]
    options = ["--separator", "blank", "--units", "MN m", "--order", "up", "--force"]
    assert import_plain(folder, pound, *lines, options=options)[0] == 0
    assert load_study(folder / "plain.yaml").group((0,)).buildings[0].stiffness == pytest.approx([90e6, 80e6])


def test_columns_of_curves_are_declared(folder, pound):
    write_storeys(folder)
    write_curves(folder, lambda x: x if x < 1 else 1 + 0.04 * (x - 1), steps=501)
    text = (folder / "curves.csv").read_text().replace("Drift [mm],Shear [kN]", "Weg [mm],Kraft [kN]")
    (folder / "curves.csv").write_text(text)
    columns = ["--column", "drift=Weg", "--column", "shear=4"]
    code, out, err = pound("import", "pushover", "curves.csv", "--storeys", "storeys.csv", *columns)
    assert (code, err) == (0, "")
    assert "drift: 'curves', column Weg [mm]" in out
    building = load_study(folder / "curves.yaml").group((0,)).buildings[0]
    assert building.yield_shear == pytest.approx(0.012 * FRAME.shear / FRAME.drift, rel=1e-6)


@pytest.mark.parametrize(
    ("change", "code", "words"),
    [
        (drop_row("Story Definitions", 2), 2, ["row 4, column 'Story'", "'Story9' has a mass, but no row in 'Story"]),
        (
            lambda sheets: sheets["Mass Summary by Story"].append(["Total", 1770, 1770, 0]),
            0,
            ["left out: row 13 of 'Mass Summary by Story', 'Total'"],
        ),
        (
            lambda sheets: sheets["Story Stiffness"].append(["Story10", "EQX", "", None, 1, 1, 1, 1, 0, 0, 0, 0]),
            2,
            ["'Story10' has a stiffness, but no height and mass"],
        ),
        (
            lambda sheets: [rows.insert(0, ["Tower of the north"]) for rows in sheets.values()],
            0,
            ["height: 'Story Definitions'", "the same within"],
        ),
        (lambda sheets: sheets["Story Stiffness"].__delitem__(slice(2, None)), 2, ["'Story Stiffness' has no row"]),
        (edit("Story Stiffness", (3, 0), None), 2, ["tower.xlsx:5:1", "is empty", "merged cells"]),
        (
            lambda sheets: sheets["Modal Periods And Frequencies"].__delitem__(slice(2, None)),
            0,
            ["'Modal Periods And Frequencies' has no row, left out", "no table has that of the model"],
        ),
    ],
)
def test_a_storey_is_never_lost(folder, pound, change, code, words):
    sheets = layout("v18")
    change(sheets)
    write_book(sheets, folder / "tower.xlsx")
    found, out, err = pound("import", "etabs", "tower.xlsx", "--case", "EQX")
    assert found == code, err
    assert [word for word in words if word not in out + err] == [], out + err


def test_two_tables_that_could_be_meant_are_refused(folder, pound):
    rows = [PLAIN.split(","), *(row.split(",") for row in ROWS)]
    book = openpyxl.Workbook()
    for name in ("North", "South"):
        sheet = book.create_sheet(name)
        for row in rows:
            sheet.append(row)
    book.save(folder / "towers.xlsx")
    code, _, err = pound("import", "table", "towers.xlsx")
    assert code == 2
    assert "2 tables could be meant: North, South" in err
    sheets = layout("v16")
    sheets["Story Stiffness (2)"] = sheets["Story Stiffness"]
    write_book(sheets, folder / "tower.xlsx")
    book = openpyxl.load_workbook(folder / "tower.xlsx")
    book["Story Stiffness (2)"]["A1"] = "TABLE:  Story Stiffness"
    book.save(folder / "tower.xlsx")
    code, _, err = pound("import", "etabs", "tower.xlsx")
    assert code == 2
    assert "Story Stiffness, Story Stiffness (2)" in err


def test_an_order_against_the_evidence_is_told(folder, pound):
    code, out, _ = import_plain(folder, pound, PLAIN, *ROWS, options=["--order", "up", "--name", "Büro Süd"])
    assert code == 0
    assert "wrote büro-süd.yaml" in out
    assert "--order up, against the evidence: by the numbers in the names" in out
    write_book(layout("v16"), folder / "tower.xlsx")
    code, _, err = pound("import", "etabs", "tower.xlsx", "--order", "up")
    assert code == 2
    assert "--order up contradicts the column 'Elevation'" in err


def test_a_base_below_the_ground_is_told(folder, pound):
    sheets = layout("v16")
    for row in sheets["Story Data"][2:]:
        row[2] -= 4000.0
    write_book(sheets, folder / "tower.xlsx")
    code, _, err = pound("import", "etabs", "tower.xlsx")
    assert code == 0
    assert "the base lies 4 m below the ground (Elevation 0)" in err


def test_a_wrong_unit_of_the_masses_is_told_as_such(folder, pound):
    sheets = layout("v18")
    sheets["Mass Summary by Story"][1] = [None, "kg", "kg", "kg"]
    write_book(sheets, folder / "tower.xlsx")
    code, out, err = pound("import", "etabs", "tower.xlsx", "--case", "EQX")
    assert code == 0
    assert "0.0316 times as long" in out
    assert "check the units of masses" in err


@pytest.mark.parametrize(
    ("shear_of", "hardening", "words"),
    [
        (lambda x: min(x, 1.0), 0.0, []),
        (lambda x: min(x, 1.0) - 1e-5 * x, 0.0, []),
        (lambda x: min(x, 1.0) - 0.1 * max(x - 1.0, 0.0), 0.0, ["falls then", "loses 40 %"]),
        (lambda x: -min(x, 1.0), 0.0, []),
        (lambda x: 0.2 * x, 0.05, ["its yield shear is not known"]),
    ],
)
def test_a_plateau_and_a_fall_after_the_elastic_part_are_yielding(folder, pound, shear_of, hardening, words):
    write_storeys(folder)
    write_curves(folder, shear_of, steps=501)
    code, out, err = pound("import", "pushover", "curves.csv", "--storeys", "storeys.csv")
    assert code == 0, err
    assert [word for word in words if word not in err] == [], err
    assert bool(err) == bool(words)
    assert ("taken with the other sign" in out) == (shear_of(1) < 0)
    building = load_study(folder / "curves.yaml").group((0,)).buildings[0]
    k = FRAME.shear / FRAME.drift
    if hardening == 0.0:
        assert building.yield_shear == pytest.approx(0.012 * k, rel=1.1e-3)
    assert building.hardening == pytest.approx(np.full(STOREYS, hardening), abs=1e-9)


def test_the_picture_shows_what_lies_beyond_the_peak():
    drift = np.linspace(0.0, 0.01, 11)
    curve = PushoverCurve(
        "1", drift, np.minimum(drift, 0.005) * 1e8, 2.0, np.array([0.01, 0.02]), np.array([5e5, 2.5e5])
    )
    figure = draw_fits([curve], {"1": fit_two_lines(curve)}, "fits")
    lines = {line.get_label(): line for line in figure.axes[0].lines}
    assert list(lines["beyond the peak, left out"].get_xdata()) == [10.0, 20.0]
    assert figure.axes[0].get_xlim()[1] > 20.0


def test_unloading_is_no_loss_of_strength(folder, pound):
    write_storeys(folder)
    write_curves(folder, lambda x: np.tanh(x) + 0.03 * x, steps=50)
    lines = (folder / "curves.csv").read_text().splitlines()
    for name in NAMES:
        rows = [line for line in lines if line.startswith(f"{name},")]
        number, drift = len(rows), float(rows[-1].split(",")[2])
        lines += [f"{name},{number},{0.9 * drift},1", f"{name},{number + 1},{0.8 * drift},0"]
    (folder / "curves.csv").write_text("\n".join(lines) + "\n")
    code, out, err = pound("import", "pushover", "curves.csv", "--storeys", "storeys.csv")
    assert (code, err) == (0, "")
    assert out.count("where its drift does not grow") == STOREYS


def test_a_curve_without_a_storey_is_refused(folder, pound):
    write_storeys(folder)
    lines = (folder / "storeys.csv").read_text().splitlines()
    (folder / "storeys.csv").write_text("\n".join(lines[:-1]) + "\n")
    write_curves(folder, lambda x: min(x, 1.0), steps=20)
    code, _, err = pound("import", "pushover", "curves.csv", "--storeys", "storeys.csv")
    assert code == 2
    assert "no height and mass of storey Story9" in err
