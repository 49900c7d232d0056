"""What is refused of buildings and of the group, with its place and what to write instead."""

from __future__ import annotations

import pytest

STIFF = "stiff: {storeys: 3, period: 0.36 s, mass: 200 t}"
SOFT = "soft: {like: stiff, period: 0.60 s}"
GROUP = "group: [stiff, soft]"

# (old, new with § where the problem stands, words of the message, words of the hint)
CASES = {
    "like nobody": ("like: stiff", "like: §stif", "no building 'stif' is defined", "did you mean 'stiff'?"),
    "no storeys": (STIFF, "stiff: §{period: 0.36 s}", "'storeys' is missing", "storeys: 5"),
    "no period": (STIFF, "stiff: §{storeys: 3}", "neither 'period' nor 'stiffness'", "period: 0.36 s"),
    "half a storey": ("storeys: 3", "storeys: §3.5", "'3.5' is not a whole number", "e.g. 5"),
    "zero storeys": ("storeys: 3", "storeys: §0", "must be at least 1", "at least 1"),
    "masses of another building": (
        "200 t",
        "§[200 t, 200 t]",
        "mass has 2 values for 3 storeys",
        "write 3 values",
    ),
    "weights of another building": (
        STIFF,
        "stiff: {storeys: 3, period: 0.36 s, p_delta: §[9 MN, 6 MN]}",
        "p_delta has 2 values for 3 storeys",
        "write 3 values from the ground up, or `true`",
    ),
    "negative weight": (
        STIFF,
        "stiff: {storeys: 3, period: 0.36 s, p_delta: [9 MN, 6 MN, §-3 MN]}",
        "the weight on a storey is -3e+06 N",
        "e.g. 9000 kN",
    ),
    "unstable at rest": (
        STIFF,
        "stiff: {storeys: 3, period: 8 s, mass: 200 t, p_delta: §true}",
        "stiff: P-Delta leaves storey 1 no stiffness: theta = P / (k h) is ",
        "make it, or its foundation, stiffer",
    ),
    "overturned on its foundation": (
        SOFT,
        "soft: {like: stiff, period: 0.60 s, p_delta: §true, "
        "foundation: {inertia: 100 t m2, rocking_stiffness: 3e7 N m}}",
        "soft: its weight overturns it on its rocking foundation",
        "make it, or its foundation, stiffer",
    ),
    "stiffness beside period": (
        STIFF,
        "stiff: {storeys: 3, period: 0.36 s, §stiffness: [3e9, 2e9, 1e9]}",
        "'stiffness' and 'period' cannot both be given",
        "'stiffness' stands in place of 'period' and 'taper'",
    ),
    "yield beside yield_shear": (
        STIFF,
        "stiff: {storeys: 3, period: 0.36 s, yield: {zone: 0.4}, §yield_shear: never}",
        "'yield_shear' and 'yield' cannot both be given",
        "remove one",
    ),
    "rayleigh beside damping": (
        STIFF,
        "stiff: {storeys: 3, period: 1 s, damping: 5 %, §rayleigh: {alpha: 1, beta: 0.01}}",
        "'rayleigh' and 'damping' cannot both be given",
        "remove one",
    ),
    "damping in percent without the sign": (
        STIFF,
        "stiff: {storeys: 3, period: 1 s, damping: §5}",
        "is 5",
        "e.g. 5 %",
    ),
    "exponent of Bouc-Wen that is no whole number": (
        STIFF,
        "stiff: {storeys: 3, period: 1 s, storey_law: bouc-wen, wen_exponent: §1.5}",
        "'1.5' is not a whole number",
        "write a whole number from 1 to 20",
    ),
    "exponent of Bouc-Wen of 0": (
        STIFF,
        "stiff: {storeys: 3, period: 1 s, storey_law: bouc-wen, wen_exponent: §0}",
        "at least 1",
        "at least 1",
    ),
    "gamma of Bouc-Wen of 1": (
        STIFF,
        "stiff: {storeys: 3, period: 1 s, storey_law: bouc-wen, wen_gamma: §1}",
        "it must be at least -1 and at most 0.99",
        "e.g. 0.5",
    ),
    "gamma of Bouc-Wen for another law": (
        STIFF,
        "stiff: {storeys: 3, period: 1 s, §wen_gamma: 0.5}",
        "'wen_gamma' does not apply to storey_law: bilinear",
        "it belongs to bouc-wen",
    ),
    "hardening of 1": (STIFF, "stiff: {storeys: 3, period: 1 s, hardening: §1}", "below 1", "0.05"),
    "unknown code": (
        STIFF,
        "stiff: {storeys: 3, period: 1 s, yield: {code: §UBC-1990}}",
        "'UBC-1990' is not known",
        "'UBC-1985', 'UBC-1988', 'UBC-1991' or 'UBC-1994'",
    ),
    "Rw in 1985": (
        STIFF,
        "stiff: {storeys: 3, period: 1 s, yield: {code: UBC-1985, §Rw: 12}}",
        "UBC-1985 has no Rw",
        "`K: 0.67`",
    ),
    "K in 1991": (STIFF, "stiff: {storeys: 3, period: 1 s, yield: {§K: 1}}", "UBC-1991 has no K", "`Rw: 12`"),
    "no K in 1985": (
        STIFF,
        "stiff: {storeys: 3, period: 1 s, yield: §{code: UBC-1985}}",
        "'K' is missing",
        "K: 0.67",
    ),
    "no zone in 1985": (
        STIFF,
        "stiff: {storeys: 3, period: 1 s, yield: §{code: UBC-1985, K: 1}}",
        "'zone' is missing",
        "zone: 1",
    ),
    "zone number": (STIFF, "stiff: {storeys: 3, period: 1 s, yield: {zone: §4}}", "factor Z is 4", "0.4"),
    "foundation that cannot move": (
        STIFF,
        "stiff: {storeys: 3, period: 1 s, foundation: §{}}",
        "cannot move",
        "foundation: fixed",
    ),
    "foundation mass without sway": (
        STIFF,
        "stiff: {storeys: 3, period: 1 s, foundation: {mass: §100 t, inertia: 1 t m2, rocking_stiffness: 1e9 N m}}",
        "'mass' has no effect without 'sway_stiffness'",
        "give 'sway_stiffness' too",
    ),
    "foundation without inertia": (
        STIFF,
        "stiff: {storeys: 3, period: 1 s, foundation: §{rocking_stiffness: 1e9 N m}}",
        "'inertia' is missing: 'rocking_stiffness' needs it",
        "above 0",
    ),
    "group of unknown names": (
        GROUP,
        "group: [stiff, §sofft]",
        "no building 'sofft' is defined",
        "did you mean 'soft'?",
    ),
    "group of one": (
        GROUP,
        "group: §[stiff]",
        "the group has 1 building: pounding takes two",
        "at least two",
    ),
    "group of 21": (
        GROUP,
        "group: §[" + ", ".join(["stiff"] * 21) + "]",
        "the group has 21 buildings",
        "at most 20",
    ),
    "group is a word": (GROUP, "group: §stiff", "'stiff' is not a list", "[first, second, ...]"),
    "no common floor": (
        SOFT + "\n" + GROUP,
        "soft: {like: stiff, height: 2.9 m}\ngroup: [stiff, §soft]",
        "no floor at one elevation: 3, 6, 9 against 2.9, 5.8, 8.7 m",
        "storey heights agree",
    ),
    "no common floor by a slip": (
        SOFT + "\n" + GROUP,
        "soft: {like: stiff, height: 3 cm}\ngroup: [stiff, §soft]",
        "no floor at one elevation: 3, 6, 9 against 0.03, 0.06, 0.09 m",
        "a storey height of soft is 3 cm: did you mean 3 m?",
    ),
    "base shear as a force": (
        STIFF,
        "stiff: {storeys: 3, period: 1 s, yield: {base_shear: §900 kN}}",
        "'900 kN' is a force: the base shear is given as a part of the weight W",
        "0.10 W",
    ),
    "base shear beside a code": (
        STIFF,
        "stiff: {storeys: 3, period: 1 s, yield: {code: UBC-1991, §base_shear: 0.1 W}}",
        "'base_shear' and 'code' cannot both be given",
        "remove one",
    ),
    "distribution without base shear": (
        STIFF,
        "stiff: {storeys: 3, period: 1 s, yield: §{distribution: uniform}}",
        "'base_shear' is missing",
        "0.10 W",
    ),
    "unknown distribution": (
        STIFF,
        "stiff: {storeys: 3, period: 1 s, yield: {base_shear: 0.1, distribution: §linear}}",
        "'linear' is not known",
        "'triangular', 'uniform', 'parabolic', 'asce7' or 'ubc'",
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_refused(name, refused):
    old, new, message, hint = CASES[name]
    refused((old, new), message=message, hint=hint)
