"""Collapse on the command line: no failure, left out of the tables and counted, told by `show` and `compare`."""

from __future__ import annotations

from dataclasses import replace

from tests.helpers.pages import words
from tests.helpers.two_buildings import known

SOLVE = known


def collapses(scene, accuracy=1e-6, method="taylor", **_):
    """As `known`, but the right one of two buildings collapses under the strong motion where the gap is open."""
    response = known(scene, accuracy, method)
    if scene.links and scene.links[0].gap and scene.analysis == "inelastic" and scene.motion.name == "strong":
        said = "collapsed: soft storey 2, at 0.3 s"
        at = {"collapse_time": 0.3, "collapse_building": 1, "collapse_storey": 2}
        return replace(response, status="collapsed", flags=(said,), **at)
    return response


def test_run_show_and_compare(folder, pound):
    code, out, err = pound("run", "two.yaml", "-o", "a.h5", "-q", solve=collapses)
    assert (code, err) == (0, "")
    code, out, _ = pound("run", "two.yaml", "-o", "a.h5", solve=collapses)
    assert code == 0
    assert "collapsed: soft storey 2, at 0.3 s" in out
    assert "16 reused, 0 failed" in out
    shown = pound("show", "a.h5", "scene", "--format", "csv")[1]
    (line,) = [line for line in shown.splitlines() if ",collapsed," in line]
    assert line.startswith("gap,inelastic,strong,collapsed,,0.3,")
    asked = "--case", "gap", "--analysis", "inelastic"
    rows = pound("show", "a.h5", "summary", "--format", "csv", *asked)[1].splitlines()
    names = rows[0].split(",")
    for row in rows[1:]:
        cells = dict(zip(names, row.split(","), strict=True))
        assert (cells["records_used"], cells["records_collapsed"]) == ("1", "1")
    pound("run", "two.yaml", "-o", "b.h5", "-q", solve=known)
    out = pound("compare", "a.h5", "b.h5")[1]
    assert "1 with another outcome." in out
    assert "gap, inelastic, strong: collapsed" in out


def test_export_and_page(folder, pound):
    pound("run", "two.yaml", "-o", "a.h5", "-q", solve=collapses)
    assert pound("report", "a.h5", "-o", "page", "--no-figures")[0] == 0
    said = words(folder / "page" / "report.html", "simulated")
    assert "failed" not in said
    assert "(strong): collapsed: soft storey 2, at 0.3 s" in said
