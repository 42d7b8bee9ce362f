"""What every disturbance promises: a field of time and place alone, which acts in its span and nowhere else."""

import numpy as np
import pytest

from kreisel import discovery
from kreisel.data.environment import Disturbance, Environment

PACKAGE = "kreisel.simulate.disturbances"


@pytest.fixture(params=discovery.names(PACKAGE))
def disturbance(request: pytest.FixtureRequest) -> Disturbance:
    plugin = discovery.load(PACKAGE, request.param)
    made = plugin.example()
    assert isinstance(made, plugin.DISTURBANCE) and isinstance(made, Disturbance)
    return made


def path(rng: np.random.Generator, n: int = 60) -> tuple[np.ndarray, np.ndarray]:
    """Times around the examples' own, and a path that stays half a metre from their magnet."""
    t = np.sort(rng.uniform(-3.0, 8.0, n))
    return t, np.stack([np.cos(t), 0.5 * np.sin(t) - 0.2, 0.3 * t], axis=1)


def test_it_changes_the_field(disturbance: Disturbance, rng: np.random.Generator) -> None:
    added = disturbance.added_N_uT(*path(rng))
    assert added.shape == (60, 3) and np.isfinite(added).all()
    # A tenth of a microtesla is what a good magnetometer notices.
    assert np.abs(added).max() > 0.1


def test_a_row_does_not_depend_on_the_others(disturbance: Disturbance, rng: np.random.Generator) -> None:
    t, p = path(rng)
    whole = disturbance.added_N_uT(t, p)
    for rows in (slice(0, 1), slice(7, 31), slice(0, None, 9)):
        # A product of matrices may sum in another order.
        np.testing.assert_allclose(disturbance.added_N_uT(t[rows], p[rows]), whole[rows], rtol=1e-14)
    assert disturbance.added_N_uT(t[:0], p[:0]).shape == (0, 3)


def test_outside_its_span_it_adds_nothing(disturbance: Disturbance, rng: np.random.Generator) -> None:
    t, p = path(rng)
    first, last = disturbance.span
    assert first < last
    outside = (t < first) | (t > last)
    assert not disturbance.added_N_uT(t, p)[outside].any()


def test_inputs_are_left_alone_and_parameters_are_checked(
    disturbance: Disturbance, rng: np.random.Generator
) -> None:
    t, p = path(rng)
    copies = t.copy(), p.copy()
    disturbance.added_N_uT(t, p)
    np.testing.assert_array_equal(t, copies[0])
    np.testing.assert_array_equal(p, copies[1])
    parameters = {name: getattr(disturbance, name) for name in type(disturbance).__dataclass_fields__}
    for name in parameters:
        for bad in (np.nan, [1.0, 2.0], "north"):
            with pytest.raises((ValueError, TypeError), match=name):
                type(disturbance)(**{**parameters, name: bad})


def test_environments_add_them_up(disturbance: Disturbance, rng: np.random.Generator) -> None:
    t, p = path(rng)
    both = Environment(field_N_uT=[1.0, 20.0, -44.0], disturbances=[disturbance, disturbance])
    np.testing.assert_allclose(both.disturbance_N_uT(t, p), 2.0 * disturbance.added_N_uT(t, p), rtol=1e-15)
    with pytest.raises(ValueError, match="disturbances need a magnetic field to disturb; give field_N_uT"):
        Environment(disturbances=[disturbance])
