"""Scale factors, and what Table 1's own scales rest on."""

import numpy as np
import pytest

from pounding_cli.errors import InputError
from pounding_cli.records import GRAVITY, Motion, arias, arias_factor, entry, names, pga_factor

SHAKE = Motion("shake", 0.01, np.random.default_rng(1).standard_normal(500))
OTHER = Motion("other", 0.02, np.random.default_rng(2).standard_normal(900))


def test_arias_factor_reaches_the_target_motion() -> None:
    assert arias(SHAKE.scaled(arias_factor(SHAKE, OTHER))) == pytest.approx(arias(OTHER), rel=1e-13)


def test_arias_factor_reaches_a_value() -> None:
    assert arias(SHAKE.scaled(arias_factor(SHAKE, 1.2))) == pytest.approx(1.2, rel=1e-13)


def test_arias_factor_to_itself_is_one() -> None:
    assert arias_factor(SHAKE, SHAKE) == 1.0


def test_pga_factor_reaches_the_peak() -> None:
    assert SHAKE.scaled(pga_factor(SHAKE, 0.35 * GRAVITY)).pga == pytest.approx(0.35 * GRAVITY, rel=1e-14)


def test_rest_and_targets_at_or_below_zero_are_refused() -> None:
    rest = Motion("rest", 0.1, np.zeros(5))
    for call in (
        lambda: arias_factor(rest, SHAKE),
        lambda: pga_factor(rest, 1.0),
        lambda: arias_factor(SHAKE, rest),
        lambda: arias_factor(SHAKE, -1.0),
        lambda: pga_factor(SHAKE, 0.0),
        lambda: pga_factor(SHAKE, float("nan")),
    ):
        with pytest.raises(InputError):
            call()


def test_table1_scales_follow_from_the_facts_but_for_taft() -> None:
    """Arias scaling over Table 1's windows gives its last column, except Taft: 1.565 against 1.75 printed."""
    target = entry("elcentro").facts.arias
    found = {name: (target / entry(name).facts.arias) ** 0.5 for name in names()}
    assert found["elcentro"] == 1.0
    assert found["parkfield"] == pytest.approx(0.822, abs=5e-4)
    assert found["taft"] == pytest.approx(1.565, abs=5e-4)
    for name in ("eureka", "olympia", "parkfield"):
        assert found[name] == pytest.approx(entry(name).scale, abs=5e-3)
