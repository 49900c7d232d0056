"""The catalogue of notes: what may be doubtful in a study, and what a reader should know of its numbers, by code.

A note names its code, `[unit]`; `pound explain unit` prints its entry, and a study silences it by `accept: [unit]`.
A refusal has no code: its message and hint are complete, and nothing silences it.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Severity(StrEnum):
    """How bad it is.

    ERROR : the input is refused, or the numbers that it marks mean nothing; it cannot be accepted
    DOUBT : the input is allowed, but hardly meant
    NOTE : it limits what the numbers say
    """

    ERROR = "error"
    DOUBT = "doubt"
    NOTE = "note"


@dataclass(frozen=True)
class Note:
    """An entry of the catalogue.

    code : the word that stands for it
    title : what it says, in a few words
    severity : how bad it is
    explanation : why it is said, and what to do about it
    """

    code: str
    title: str
    severity: Severity
    explanation: str

    @property
    def can_be_accepted(self) -> bool:
        """Return whether a study may silence it."""
        return self.severity is not Severity.ERROR


_INPUTS = (
    (
        "unit",
        "a number without a unit",
        "A number without a unit is read in SI: 5 is 5 m, 0.3 of an acceleration is 0.3 m/s2. The note says what it "
        "was read as, and in which units it would be usual. Write the unit; nothing else changes.",
    ),
    (
        "value",
        "a value beyond what buildings have",
        "A mass, height, gap, damping ratio or another value lies outside the range that buildings have. Most often "
        "its unit is wrong: kg for t, m for cm. The note names the range, where it comes from and the value that may "
        "be meant. The run takes the value as it is.",
    ),
    (
        "period",
        "a period beyond what buildings of so many storeys have",
        "Measured periods are near a tenth of a second for each storey. One that is far from it mostly comes of a "
        "stiffness or a mass in a wrong unit. A building on a moving base is compared as a whole, on that base.",
    ),
    (
        "strength",
        "a yield shear beyond what buildings of this weight have",
        "Codes design for a base shear of 2 to 30 % of the weight; with overstrength a building reaches about its "
        "weight. A yield shear far outside makes every ductility meaningless. Check its unit, and the masses.",
    ),
    (
        "link",
        "a link far softer or stiffer than usual",
        "A contact much softer than a storey lets floors pass through each other; a spring or damper far below the "
        "stiffness or weight of a floor does nothing, one far above joins the floors rigidly. The note compares it "
        "with the stiffest storey or the heaviest floor.",
    ),
    (
        "damper-steps",
        "a viscous damper that takes very many steps near rest",
        "A viscous damper whose exponent is below 1 is a stiff dashpot where floors hardly move, and the integrator "
        "follows it in short steps. The numbers are right, but the run takes long. `straight_below` sets the "
        "velocity below which it acts as a linear dashpot.",
    ),
    (
        "slope",
        "a link whose ends are not at one height",
        "A joint between floors of different heights acts level unless its `distance` is written, which gives its "
        "angle; a steep one has little stiffness along the row; a contact between floors that do not face each other "
        "strikes nothing real.",
    ),
    (
        "nowhere",
        "a link that stands nowhere",
        "No floors, or no slab and columns, face each other in the pairs that the link is for, so that it is left "
        "out. Name both of its ends, or describe the columns that are struck.",
    ),
    (
        "blows",
        "blows on columns that are left out",
        "Where floors are not at one height, slabs strike columns. Such a blow is simulated only if the building says "
        "which share of its columns is struck (`columns:`). Without it these blows are missing from all numbers, "
        "which errs on the unsafe side; `columns: none` says that walls stand there.",
    ),
    (
        "peak",
        "an unlikely peak of the ground",
        "Few motions were ever recorded above 2 g, and damage begins near 0.05 g. A peak outside mostly has a wrong "
        "unit in the file's declaration, or a wrong factor under `scale`.",
    ),
    (
        "factor",
        "a scale factor that is a unit in disguise",
        "A factor of 9.81 or 0.01 on motions from files turns one unit of acceleration into another. Declare the unit "
        "of the file in its place, so that the program can check it.",
    ),
    (
        "duration",
        "a duration that cuts or exceeds a motion",
        "The duration asked for is longer than the motion, or keeps less than half of its energy (Arias intensity).",
    ),
    (
        "vertical",
        "a file that is named like a vertical component",
        "The motion shakes the buildings sideways. Files of vertical components are mostly named so.",
    ),
    (
        "time-step",
        "a time step that no accelerograph has",
        "Accelerographs sample 50 to 1000 times a second. Another step mostly comes of minutes taken for seconds, or "
        "of sample numbers taken for times.",
    ),
    (
        "stated-unit",
        "a file that states another unit than the study declares",
        "The unit that is declared counts. The file itself names another one.",
    ),
    (
        "spike",
        "one sample far beyond all others",
        "One sample is several times the largest other: a spike of the instrument, or a number of the heading that "
        "was taken for a sample.",
    ),
    (
        "drifting-ground",
        "a motion after which the ground moves on, or ends far away",
        "The samples have an offset, or a time step that is too long. Near a fault the ground may end some metres "
        "away; ten are the most that was ever measured. `baseline:` takes an offset away, or says that it is meant.",
    ),
    (
        "suite",
        "motions that do not meet what the code of their target asks for",
        "The code whose spectrum the motions are scaled to also asks for a number of motions, a range of periods and "
        "a part of the target that the mean spectrum must not fall below. The study does not do what the note names.",
    ),
    (
        "held-period",
        "a mass that varies beside a period that is held",
        "A building that is given by its period keeps it: where the mass varies the stiffness follows, and with a "
        "code's strength the yield shears too. The note has the lines that hold the stiffness instead.",
    ),
    (
        "archetype",
        "a building type taken beyond its number of storeys",
        "HAZUS gives each type for a range of storeys. Outside it, its numbers are extrapolated.",
    ),
    (
        "accidental",
        "displacements of codes without an accidental eccentricity",
        "Codes move the centre of mass by 5 % of the width to either side. The displacements with which `gap` "
        "compares count the twist under forces through the centres of mass alone; `accidental: +-5 %` moves them.",
    ),
    (
        "shift",
        "a place along the street that has no effect",
        "The neighbours have no plan, so that each is as wide as the building, wherever that stands.",
    ),
    (
        "eccentricity",
        "a centre of stiffness far from the centre of mass",
        "A core at one end with frames at the other gives an eccentricity of a third of the width. More mostly comes "
        "of a wrong place or stiffness of a line.",
    ),
    (
        "rotary-inertia",
        "a rotary inertia that no floor of this width has",
        "The radius of gyration of a floor is 0.2 to 0.8 of its width. Beyond, the unit of the inertia is mostly "
        "wrong.",
    ),
    (
        "twist-frequency",
        "a building that turns far slower or faster than it sways",
        "Frames at all edges give a ratio of 1 to 1.5, a core in the middle 0.7, walls at all edges 2.",
    ),
    (
        "across",
        "lines across the row that do not resist the twist as usual",
        "Lines across the row resist the twist by their distance from the centre of mass. Where all stand at it they "
        "do nothing; where their centre stands off it, floors that twist also move along the street, which is left "
        "out.",
    ),
    (
        "printed-dashpot",
        "the dashpot of eq. (7) as printed",
        "Equation (7) of the paper has the unit 1/s as printed, so that its dashpot depends on the unit of mass. The "
        "default has the dashpot that gives the coefficient of restitution.",
    ),
)
"""Doubts about studies: code, title and explanation."""

_NUMBERS = (
    (
        "stiffness",
        "accelerations and link forces of blows depend on the impact stiffness",
        "Floor accelerations and link forces of floors that strike grow with the square root of the impact stiffness, "
        "which is unknown; storey shears, drifts and ductilities hardly change with it. Sweep it to see the effect: "
        "`impact.stiffness: {values: [5 x stiffest storey, 20 x stiffest storey, 100 x stiffest storey], middle: 20 x "
        "stiffest storey}`.",
    ),
    (
        "heights",
        "storey heights are assumed",
        "The study writes no height of these buildings: 3 m a storey are taken. Heights decide which floors meet, and "
        "drift ratios.",
    ),
    (
        "dashpots",
        "dashpots of infills and connectors are assumed",
        "Infills and connectors have the damping ratio of the impact's restitution unless their `damping_ratio` is "
        "written.",
    ),
    (
        "ductility",
        "a ductility demand beyond 10",
        "Few buildings reach a ductility of 10 before they fail; beyond it the storey law does not describe them. Read "
        "such a storey as failed. Yield levels of the working stress of old codes give such ductilities; real "
        "buildings are stronger, `yield: {overstrength: ...}`.",
    ),
    (
        "drift",
        "an interstorey drift beyond 5 %",
        "Most storeys lose their strength below a drift of 5 %. What then decides, P-Delta and collapse, is simulated "
        "only if the study asks for it (`p_delta: true`, `collapse:`).",
    ),
    (
        "acceleration",
        "a floor acceleration beyond 5 g",
        "Beyond 5 g it is that of a blow, which lasts for milliseconds and grows with the root of the contact "
        "stiffness, which is unknown. If the building alone has as much, the unit or scale of a motion is wrong.",
    ),
    (
        "penetration",
        "floors that press into each other by more than a slab is thick",
        "The contact is too soft: write a stiffness of 20 times the stiffest storey or more.",
    ),
    (
        "crushed",
        "filling compressed beyond its thickness",
        "The material in the gap was pressed to nothing. Beyond its thickness an infill is as stiff as an impact. The "
        "flag names the floors and by how much.",
    ),
    (
        "passing",
        "floors pass through each other by more than a tenth of a storey height, as no contact does",
        "The contact is so soft that the floors change places. Write a stiffness of 20 times the stiffest storey.",
    ),
    (
        "isolators",
        "isolators moved beyond their capacity",
        "The base moved further than the isolators can, as the study gives it. They are simulated on; real ones fail "
        "or lift off.",
    ),
    (
        "collapse",
        "a storey collapsed",
        "The drift of a storey passed the limit of its building, `collapse:`, at the time named. Peaks up to then do "
        "not describe the response to the whole motion, and tables and means leave them out.",
    ),
    (
        "columns",
        "columns overloaded",
        "Columns that a slab struck, or that a link ends on, carried more than their share of the storey's yield "
        "shear. The flag names building, storey and the largest demand over capacity. Columns that nothing loaded are "
        "not flagged.",
    ),
    (
        "baseline",
        "a building alone has no result, so its ratios are left out",
        "A ratio needs the building alone. It collapsed, or its time history failed: its ratios mean nothing. The "
        "demands beside its neighbours are in the tables.",
    ),
    (
        "zero-baseline",
        "a ratio to zero, left out",
        "The building alone has a response of zero, as a rigid one has no ductility demand.",
    ),
    (
        "sensitive",
        "ill-conditioned: a small change of the motion changes the peaks",
        "The sensitivity is above 100: a small relative change of the motion changes a peak by more than a hundred "
        "times as much, or decides whether a storey collapses. Digits of one such time history are chance. Use more "
        "motions and report the spread.",
    ),
    (
        "error",
        "less accurate than asked",
        "Finer runs did not reach the accuracy asked for; the flag gives the error that is left.",
    ),
    (
        "no-error",
        "no error estimate",
        "The finer run for the estimate failed; the flag gives its status, or what such runs may cost.",
    ),
    (
        "cut-short",
        "error estimate cut short",
        "Runs for the estimate were stopped, because they took 100 times the steps of the run itself: the error may "
        "be larger than the estimate.",
    ),
    (
        "retried",
        "solved once more, more finely",
        "The first run failed with the status named, and one that is a hundred times as fine came to an end.",
    ),
    (
        "halved-steps",
        "time steps cut in half, because Newton found no root where a contact force jumps",
        "The fixed-step method cut these steps in half.",
    ),
    (
        "residual-drift",
        "no residual drift",
        "The drifts at rest are not known: nothing damps the free vibration, or the scene does not come to rest in "
        "600 s or 50,000 steps after the motion, or it collapsed.",
    ),
)
"""What limits numbers: code, title and explanation."""

_MEANINGLESS = (
    (
        "struck",
        "a joint closes more than the gap, so the floors would have struck",
        "The floors have a connector or a damper between them and no impact element, so that they pass through each "
        "other where real floors strike: the numbers of this time history mean nothing. Add `pounding` to the `links` "
        "of the case, or widen the gap. The flag names the joint, its floors and by how much.",
    ),
)
"""What takes the meaning from numbers: code, title and explanation."""

NOTES = {
    code: Note(code, title, severity, explanation)
    for entries, severity in (
        (_INPUTS, Severity.DOUBT),
        (_NUMBERS, Severity.NOTE),
        (_MEANINGLESS, Severity.ERROR),
    )
    for code, title, explanation in entries
}
"""The catalogue by code."""
