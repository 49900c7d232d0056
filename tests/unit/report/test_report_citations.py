"""References: complete, well formed, and just those that a study's laws, codes, scales and methods call for."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from pounding_cli.laws import link_laws, storey_laws
from pounding_cli.methods import METHODS
from pounding_cli.report.citations import citations, motions
from pounding_cli.report.references import REFERENCES, named_in
from pounding_cli.study import load_study
from pounding_cli.study.system_study import load_system

STUDY = """\
records: {use: [elcentro], duration: 5 s}
buildings:
  stiff: {storeys: 3, period: 0.36 s}
  soft: {storeys: 3, period: 0.60 s, yield_shear: never}
  unused: {like: stiff, yield: {code: UBC-1994}}
group: [stiff, soft]
cases:
  first: {link: pounding, gap: 5 cm}
"""


@pytest.fixture
def cited(tmp_path):
    """Keys and uses of what a study rests on, with replacements made in STUDY, solved by some methods."""

    def load(*changes, source="real", methods=("taylor",)):
        text = STUDY
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        path = tmp_path / "a.yaml"
        path.write_text(text)
        found = citations("run", load_study(path).resolved(), {"elcentro": source}, methods)
        return {citation.reference.key: citation.uses for citation in found}

    return load


ALWAYS = {"pounding_cli", "spiliopoulos1996", "jorba2005"}
DASHPOT = {"anagnostopoulos1988"}
IMPACT = {"anagnostopoulos1992", *DASHPOT}


@pytest.mark.parametrize(
    ("changes", "keys"),
    [
        ((), {*IMPACT, "ubc1991"}),
        ((("link: pounding, gap: 5 cm", "link: connector, gap: 5 cm"),), {*DASHPOT, "westermo1989", "ubc1991"}),
        ((("link: pounding, gap: 5 cm", "link: infill, gap: 5 cm"),), {*IMPACT, "ubc1991"}),
        ((("link: pounding, gap: 5 cm", "link: none"),), {"ubc1991"}),
        (
            (("link: pounding, gap: 5 cm", "link: connector, gap: 5 cm, floors: [1], elsewhere: pounding"),),
            {*IMPACT, "westermo1989", "ubc1991"},
        ),
        (
            (("gap: 5 cm}", "gap: 5 cm, by_floor: {2: {link: connector}}}"),),
            {*IMPACT, "westermo1989", "ubc1991"},
        ),
        ((("gap: 5 cm}", "gap: 5 cm, pairs: [connector]}"),), {*IMPACT, "westermo1989", "ubc1991"}),
        ((("[stiff, soft]", "[unused, soft]"),), {*IMPACT, "ubc1994"}),
        ((("[stiff, soft]", "[soft, soft]"),), IMPACT),
        ((("soft: {", "soft: {storey_law: peak-oriented, "),), {*IMPACT, "ubc1991", "clough1966", "ibarra2005"}),
        (
            (("soft: {", "soft: {storey_law: imk-peak-oriented, capping_ductility: 4, post_capping_slope: 0.1, "),),
            {*IMPACT, "ubc1991", "ibarra2005"},
        ),
        ((("soft: {", "soft: {storey_law: bouc-wen, "),), {*IMPACT, "ubc1991", "bouc1967", "wen1976"}),
        ((("5 s}", "5 s, scale: {arias: taft}}"),), {*IMPACT, "ubc1991", "arias1970"}),
        ((("5 s}", "5 s, scale: table1}"),), {*IMPACT, "ubc1991", "arias1970"}),
    ],
)
def test_a_study_cites_what_it_uses_and_no_more(cited, changes, keys):
    assert set(cited(*changes)) == ALWAYS | keys


@pytest.mark.parametrize(
    ("methods", "solved", "judged"),
    [
        (["taylor"], {"jorba2005"}, {"jorba2005"}),
        (["exponential"], {"moler2003"}, {"moler2003"}),
        (["exponential", "taylor"], {"moler2003", "jorba2005"}, {"moler2003", "jorba2005"}),
        (["newmark"], {"newmark1959"}, {"jorba2005"}),  # fixed steps are judged by a series
        (["central-difference"], {"newmark1959", "bathe1996"}, {"jorba2005"}),
    ],
)
@pytest.mark.parametrize("estimate", ["none", "all"])
def test_the_methods_are_those_that_ran(cited, methods, solved, judged, estimate):
    found = cited(("cases:", f"estimate: {estimate}\ncases:"), methods=methods)

    def used(what):
        return {key for key, uses in found.items() if any(use.startswith(what) for use in uses)}

    assert used("the method of solution") == solved
    assert used("the finer runs") == (judged if estimate == "all" else set())


def test_stand_ins_cite_their_synthesis(cited):
    assert "lilhanand1988" in cited(source="stand-in")
    assert "lilhanand1988" not in cited(source="real")
    told = {source.name: source.text for source in motions({"eureka": "stand-in", "taft": "real", "mine": "user"})}
    assert "Boore, Stewart, Seyhan and Atkinson (2014)" in told["eureka"]
    assert "Taft, Lincoln School Tunnel" in told["taft"]
    assert "cite its source" in told["taft"]
    assert told["mine"] == "your own file: cite its source"


def test_the_other_systems():
    wall = load_system(Path("configs/fig8.yaml"), "wall")
    keys = {citation.reference.key for citation in citations("wall", wall.resolved(), {})}
    assert keys == {"pounding_cli", "spiliopoulos1996", "anagnostopoulos1992", "gustafsson2020", "wood1980"}
    two = load_system(Path("configs/fig5.yaml"), "connector")
    keys = {citation.reference.key for citation in citations("connector", two.resolved(), {})}
    assert keys == {"pounding_cli", "spiliopoulos1996", "westermo1989"}


def test_a_dashpot_of_the_connector_is_cited(tmp_path):
    path = tmp_path / "a.yaml"
    path.write_text("title: x\nsecond: {frequency_ratio: 0.6}\nconnector: {stiffness: 0.2 k1, damping_ratio: 0.1}\n")
    keys = {c.reference.key for c in citations("connector", load_system(path, "connector").resolved(), {})}
    assert "anagnostopoulos1988" in keys


@pytest.mark.parametrize("name", METHODS)
def test_every_source_of_a_method_has_a_reference(name):
    """As many references as the method's own citation names years."""
    source = METHODS[name].source
    assert sorted(str(r.year) for r in named_in(source)) == sorted(re.findall(r"\((\d{4})\)", source))


def test_no_reference_is_idle():
    rest = {key for method in METHODS.values() for key in (r.key for r in named_in(method.source))}
    rest |= {f"ubc{edition}" for edition in (1985, 1988, 1991, 1994)} | ALWAYS | IMPACT
    rest |= {key for law in (*link_laws().values(), *storey_laws().values()) for key, _ in law.citation}
    rest |= {"jeng1992", "derkiureghian1981", "asce2017", "en1998", "gb50011-2010"}  # of the rules of `pound gap`
    rest |= {"vamvatsikos2004", "efron1993", "jalayer2015", "baker2015"}  # of `pound fragility`
    rest |= {"saltelli2010", "campolongo2007", "iwanaga2022"}  # of `pound sensitivity`
    rest |= {"storn1997", "nelder1965"}  # of `pound optimise`
    assert set(REFERENCES) == rest | {"westermo1989", "arias1970", "lilhanand1988", "gustafsson2020", "wood1980"}


@pytest.mark.parametrize("key", REFERENCES)
def test_bibtex_is_well_formed(key):
    """Braces close, every field is filled, and a name is "Family, A. B."."""
    entry = REFERENCES[key].bibtex
    assert re.fullmatch(rf"@\w+{{{key},\n(  \w+ = {{.+}},?\n)+}}", entry)
    depth = 0
    for sign in re.sub(r"\\.", "", entry):
        depth += {"{": 1, "}": -1}.get(sign, 0)
        assert depth >= 0
    assert depth == 0
    if "{{" not in entry.split("author = ")[1].split("\n")[0]:
        people = re.search(r"author = {(.*)}", entry)[1].split(" and ")
        assert all(re.fullmatch(r"[\w -]+, [A-ZÀ]\.([ -][A-Z]\.)*", person) for person in people)
    assert not re.search(r"(?<!\\)[&%]", entry)


def test_text_is_one_sentence_a_part():
    assert REFERENCES["hilber1977"].text == (
        "Hilber, H. M., Hughes, T. J. R. & Taylor, R. L. (1977). Improved numerical dissipation for time integration "
        "algorithms in structural dynamics. Earthquake Engineering & Structural Dynamics 5(3), 283-292. "
        "doi:10.1002/eqe.4290050306"
    )
    assert REFERENCES["ubc1991"].text == (
        "International Conference of Building Officials (1991). Uniform Building Code, 1991 edition. "
        "Whittier, California."
    )
