"""Design levels of buildings by their year and seismic zone, as HAZUS assigns them.

Source: FEMA (2012). Hazus-MH 2.1, Earthquake Model, Technical Manual, Table 5.20: guidelines for the selection of
damage functions for typical buildings, by zone of the Uniform Building Code of 1994 and by age. They are of buildings
of the United States; elsewhere a design level is given in the place of a year. The table was entered without a copy of
the manual at hand to compare it with (docs/how-to/screen.md says so too)."""

from __future__ import annotations

from pounding_cli.model.archetypes import DESIGNS, list_designs

LAST_PRE_CODE_YEAR = 1940
LAST_EARLY_YEAR = 1975
"""Last years of the first and the second of the three ages."""

ZONES = ("4", "3", "2B", "2A", "1", "0")
"""Seismic zones of the Uniform Building Code, the most severe first."""

_LEVELS_BY_ZONE = {
    "4": ("pre-code", "moderate-code", "high-code"),
    "3": ("pre-code", "moderate-code", "moderate-code"),
    "2B": ("pre-code", "low-code", "moderate-code"),
    "2A": ("pre-code", "low-code", "low-code"),
    "1": ("pre-code", "pre-code", "low-code"),
    "0": ("pre-code", "pre-code", "pre-code"),
}
"""Design levels of the three ages: before 1941, 1941 to 1975, after 1975."""

_WOOD_LEVELS = {"4": "moderate-code", "3": "moderate-code", "2B": "low-code", "2A": "low-code", "1": "low-code"}
"""Design levels of wood frames (W1) where others have none (notes of the table)."""

SOURCE = "Hazus-MH 2.1 Technical Manual, Table 5.20"


def find_design(type: str, year: int, zone: str) -> str:
    """Return the design level of a building.

    Where the type does not have this level, such as unreinforced masonry of a high code, it is the strictest one that
    it has and that is no stricter.

    type : of HAZUS
    year : in which it was built
    zone : one of ZONES
    """
    age = (year > LAST_PRE_CODE_YEAR) + (year > LAST_EARLY_YEAR)
    level = _LEVELS_BY_ZONE[zone][age]
    if type == "W1" and level == "pre-code":
        level = _WOOD_LEVELS.get(zone, level)
    having = list_designs(type)
    not_stricter = [design for design in having if DESIGNS.index(design) >= DESIGNS.index(level)]
    return (not_stricter or [having[-1]])[0]
