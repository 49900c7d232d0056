"""A storey whose elastic range grows with its hardening."""

import math
from dataclasses import dataclass

from pounding_cli.laws.guards import HIGH, START
from pounding_cli.laws.law import Behaviour, parameter, set_line
from pounding_cli.laws.storey import StoreyLaw

K, LIMIT, A, GROWTH = range(4)  # parameters: stiffness [N/m], yield drift [m], hardening and growth [-]
UPPER_LINE, LOWER_LINE = range(2)  # history variables: shear of the yield lines at no drift [N]
LOWER, ELASTIC, UPPER = -1, 0, 1  # branches


def next_branch(e, guard):
    """From the elastic line to a yield line, and back where the drift turns."""
    k, limit = e.p[K], e.p[LIMIT]
    soft = e.p[A] * k
    if guard == START:
        e.h[UPPER_LINE], e.h[LOWER_LINE] = (k - soft) * limit, -(k - soft) * limit
        set_line(e, k, e.c, 0.0, -limit, limit)
    elif e.branch == ELASTIC:
        e.branch = UPPER if guard == HIGH else LOWER
        offset = e.h[UPPER_LINE] if e.branch == UPPER else e.h[LOWER_LINE]
        set_line(e, soft, e.c, offset, -math.inf, math.inf, e.branch)
    else:
        side, v, f = e.branch, e.v1, soft * e.v1 + e.f0
        width = 2.0 * (k * limit + e.p[GROWTH] * (side * f - k * limit)) / k
        far = v - side * width
        e.h[LOWER_LINE if side > 0 else UPPER_LINE] = f - side * k * width - soft * far
        e.branch = ELASTIC
        set_line(e, k, e.c, f - k * v, min(v, far), max(v, far))


@dataclass(frozen=True)
class Isotropic(StoreyLaw):
    """k D between the yield lines; part of the hardening widens the range between them."""

    name = "isotropic"
    behaviour = Behaviour(next_branch)

    growth: float = parameter("part of the hardening that widens the elastic range", high=1.0, open_high=False)

    def element_parameters(self):
        """k [N/m], yield drift [m], hardening and growth [-]; the stiffness comes first."""
        return *super().element_parameters(), self.growth
