"""Results files made to mislead, under checksums that fit: refused by name before anything is read."""

from __future__ import annotations

import resource

import h5py
import numpy as np
import pytest

from pounding_cli.errors import InputError
from pounding_cli.store import open_results, write_results
from pounding_cli.store.files import opened
from pounding_cli.store.structure import number, text
from pounding_cli.study import Axis
from tests.helpers.plans import known, small_plan
from tests.helpers.sealing import edited


@pytest.fixture
def results(tmp_path):
    plan = small_plan()
    write_results(tmp_path / "r.h5", plan, {digest: known(scene) for digest, scene in plan.scenes.items()})
    return tmp_path / "r.h5"


def external_storage(file, secret):
    shape = file["V"].shape
    del file["V"]
    file.create_dataset("V", shape, "f8", external=[(str(secret), 0, h5py.h5f.UNLIMITED)])


def virtual_dataset(file, secret):
    with h5py.File(secret.with_suffix(".h5"), "w") as other:
        other["V"] = np.ones(file["V"].shape)
    layout = h5py.VirtualLayout(file["V"].shape, "f8")
    layout[...] = h5py.VirtualSource(str(secret.with_suffix(".h5")), "V", file["V"].shape)
    del file["V"]
    file.create_virtual_dataset("V", layout)


def external_link(file, secret):
    with h5py.File(secret.with_suffix(".h5"), "w") as other:
        other["text"] = "secret"
    del file["study/text"]
    file["study/text"] = h5py.ExternalLink(str(secret.with_suffix(".h5")), "text")


def linked_history(file, secret):
    with h5py.File(secret.with_suffix(".h5"), "w") as other:
        other["scene/time"] = np.arange(3.0)
    file["histories/0"] = h5py.ExternalLink(str(secret.with_suffix(".h5")), "scene")


def soft_link(file, secret):
    del file["V"]
    file["V"] = h5py.SoftLink("/V0")


def declared(shape, **storage):
    def change(file, secret):
        del file["V"]
        file.create_dataset("V", shape, "f8", **storage)

    return change


def other_shape(file, secret):
    shape = file["V"].shape
    del file["V"]
    file["V"] = np.ones((*shape[:-1], shape[-1] + 1))


def words_for_numbers(file, secret):
    shape = file["V"].shape
    del file["V"]
    file["V"] = np.full(shape, "text", object)


def pairs(file, secret):
    shape = file["V"].shape
    del file["V"]
    file["V"] = np.zeros(shape, "i8,f8")


def value(name, at, value):
    def change(file, secret):
        file[name][at] = value

    return change


def scalar(name, text):
    def change(file, secret):
        del file[name]
        file[name] = text

    return change


def along_cases(name):
    """A dataset of buildings or motions has the cases as its first dimension."""

    def change(file, secret):
        values = file[name][()]
        del file[name]
        file[name] = np.stack([values, values])
        file[name].dims[0].attach_scale(file["case"])
        for place, dim in enumerate(("building", "storey"), start=1):
            file[name].dims[place].attach_scale(file[dim])

    return change


def named_type(file, secret):
    file["a_type"] = np.dtype("f8")


def attribute(name, value):
    def change(file, secret):
        file.attrs[name] = value

    return change


def not_utf8(name):
    return attribute(name, np.array(b"\xff\xfe", h5py.string_dtype()))


FORGED = {
    "external storage": (external_storage, "its V takes its values from another file"),
    "virtual dataset": (virtual_dataset, "its V takes its values from another file"),
    "external link": (external_link, "its study/text leads to another place or another file"),
    "external link for a kept scene": (linked_history, "its histories/0 leads to another place or another file"),
    "soft link": (soft_link, "its V leads to another place"),
    "declared size": (declared((4 * 10**8,)), "its V declares 400000000 values, more than the file can hold"),
    "declared size in chunks": (declared((10**5, 10**4), chunks=True), "more than the file can hold"),
    "other shape": (other_shape, "its V has the shape"),
    "words for numbers": (words_for_numbers, "its V holds texts"),
    "pairs": (pairs, "its V holds neither numbers nor texts"),
    "version as array": (attribute("format_version", np.arange(3)), "its format version is not a number"),
    "version NaN": (attribute("format_version", np.nan), "its format version is not a number"),
    "version empty": (attribute("format_version", h5py.Empty("f")), "its format version is not a number"),
    "version in words": (attribute("format_version", "three"), "its format version is not a number"),
    "title no text": (attribute("title", 3.0), "its title is not a text"),
    "title no UTF-8": (not_utf8("title"), "an attribute is not UTF-8"),
    "swept keys no names": (attribute("swept", "[[3]]"), "its swept is not a list of names"),
    "swept keys no list": (attribute("swept", "3"), "does not hold what results hold"),
    "link of an unknown building": (value("link_left", 0, "tower"), "its link_left and link_right name no neighbours"),
    "link to itself": (value("link_right", 0, "stiff"), "its link_left and link_right name no neighbours"),
    "link at no floor": (value("link_floor", 0, 7), "its link_floor is not a floor"),
    "gap without end": (value("gap", (0, 0), np.inf), "its gap is not finite"),
    "storeys from 0": (value("storey", 0, 0), "its storey does not count from 1"),
    "a case twice": (value("case", 0, "gap"), "its case names one twice"),
    "an analysis twice": (value("analysis", 0, "inelastic"), "its analysis names one twice"),
    "an unknown analysis": (value("analysis", 0, "plastic"), "its analysis is not one of"),
    "cases of another study": (
        value("study/resolved", (), '{"cases": {"gap": {}, "wide": {}}}'), "its case is not that of its study"
    ),
    "cases no list": (scalar("case", "gap"), "its case is not a list"),
    "buildings along the cases": (along_cases("mass"), "its mass has dimensions that are not swept keys"),
    "a named type": (named_type, "its a_type is neither a dataset nor a group"),
    "a table is missing": (lambda file, secret: file.pop("V"), "its V is missing"),
    "no height": (value("height", (0, 0), np.nan), "its height is not positive and finite"),
    "no period": (value("period", 0, -1.0), "its period is not positive and finite"),
}  # fmt: skip


@pytest.mark.parametrize("name", FORGED)
def test_a_forged_file_is_refused_by_name(results, tmp_path, name):
    change, words = FORGED[name]
    secret = tmp_path / "secret.txt"
    secret.write_text("root:x:0:0:" * 1000)
    with edited(results) as file:
        change(file, secret)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(InputError, match=words) as refused:
        open_results(results).storey()
    assert refused.value.problems[0].hint
    assert refused.value.problems[0].file == str(results)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 200_000  # [kB]


def test_a_swept_value_that_is_not_finite_is_refused(tmp_path):
    plan = small_plan(axes=(Axis(("impact.restitution",), ((0.4,), (0.6,))),))
    write_results(tmp_path / "r.h5", plan, {digest: known(scene) for digest, scene in plan.scenes.items()})
    with edited(tmp_path / "r.h5") as file:
        file["impact.restitution"][1] = np.nan
    with pytest.raises(InputError, match=r"its impact\.restitution is not finite"):
        open_results(tmp_path / "r.h5")


def test_a_file_is_checked_again_once_it_has_changed(results):
    open_results(results)
    with edited(results) as file:
        soft_link(file, None)
    with pytest.raises(InputError, match="leads to another place"):
        open_results(results)


def test_a_file_is_checked_once(results, monkeypatch):
    checked = []

    def check_study(file):
        checked.append(file)

    monkeypatch.setattr("pounding_cli.store.files.check_study", check_study)
    for _ in range(3):
        with opened(results):
            pass
    assert len(checked) == 1


@pytest.mark.parametrize("read", [number, text])
def test_what_is_missing_is_named(results, read):
    with h5py.File(results) as file, pytest.raises(InputError, match="its no such thing is no"):
        read(file.attrs, "no_such_thing")
