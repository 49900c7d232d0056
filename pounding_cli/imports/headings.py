"""Titles of the tables of frame programs, and headings of their columns, by what they hold."""

from __future__ import annotations

HEIGHT_TABLES = ("Story Definitions", "Story Data", "Storey Definitions", "Storey Data")
MASS_TABLES = ("Mass Summary by Story", "Story Mass Summary", "Masses by Story")
STIFFNESS_TABLES = ("Story Stiffness", "Storey Stiffness")
PERIOD_TABLES = ("Modal Periods And Frequencies", "Modal Periods")
RATIO_TABLES = ("Modal Participating Mass Ratios",)
CENTRE_TABLES = ("Centers Of Mass And Rigidity", "Center Of Mass And Rigidity", "Centers Of Mass And Rigidity Data")

STOREY_HEADINGS = ("Story", "Storey", "Name", "Story Name", "Storey Name", "Level", "Floor")
HEIGHT_HEADINGS = ("Height", "Story Height", "Storey Height")
ELEVATION_HEADINGS = ("Elevation", "Elev", "Story Elevation")
CASE_HEADINGS = ("Output Case", "Load Case", "Load Case/Combo", "Case", "Case/Combo", "Load")
STEP_TYPE_HEADINGS = ("Step Type",)
STEP_NUMBER_HEADINGS = ("Step Number", "Step Num", "Step")
TOWER_HEADINGS = ("Tower",)
MODE_HEADINGS = ("Mode", "Step Num", "Step Number")
PERIOD_HEADINGS = ("Period",)
YIELD_SHEAR_HEADINGS = ("Yield shear", "Vy", "Strength", "Shear strength")
HARDENING_HEADINGS = ("Hardening", "Hardening ratio")
"""Headings of columns, the best one first."""

_SHEAR = ("Shear", "Story Shear", "Storey Shear", "V")
_DRIFT = ("Drift", "Story Drift", "Storey Drift", "Interstorey Drift")
HEADINGS_OF_DIRECTION = {
    direction: {
        "mass": (f"U{direction}", f"U{number}", f"Mass {direction}", "Mass"),
        "stiffness": (f"Stiff{direction}", f"Stiffness {direction}", "Stiffness", "K"),
        "shear": (f"Shear {direction}", f"V{direction}", *_SHEAR),
        "drift": (f"Drift {direction}", *_DRIFT),
        "ratio": (f"U{direction}", f"U{number}"),
    }
    for number, direction in ((1, "X"), (2, "Y"))
}
"""Direction -> what is read -> headings, the best one first."""
