"""What a file of error terms holds of a disturbed field, in whichever world it is written."""

import numpy as np
import pytest

from kreisel.cli.error_terms import write_error_terms
from kreisel.data.environment import Environment
from kreisel.simulate.disturbances.step import FieldStep
from kreisel.simulate.imu import Imu
from kreisel.simulate.trajectories.rest import rest

FIELD = [1.0, 20.0, -44.0]


# East, north, up as that world's N has them.
@pytest.mark.parametrize(
    ("world", "expected"),
    [("enu-flu", [3.0, -4.0, 12.0]), ("ned-frd", [-4.0, 3.0, -12.0]), ("nwu", [-4.0, -3.0, 12.0])],
)
def test_the_disturbance_is_in_the_n_of_its_world(world, expected, tmp_path):
    disturbed = Environment(field_N_uT=FIELD, disturbances=[FieldStep([3.0, -4.0, 12.0], start=0.0)])
    # Turned, so that axes of the sensor would show.
    motion = rest(phi=(0.1, 0.2, 0.3)).sample(np.arange(4.0))
    write_error_terms(tmp_path / "e.npz", Imu(environment=disturbed).record(motion, 1), world)
    with np.load(tmp_path / "e.npz") as terms:
        np.testing.assert_array_equal(terms["disturbance_N_uT"], np.tile(expected, (4, 1)))


def test_an_undisturbed_world_has_no_such_term(tmp_path):
    motion = rest().sample(np.arange(4.0))
    peaceful = Imu(environment=Environment(field_N_uT=FIELD)).record(motion, 1)
    write_error_terms(tmp_path / "e.npz", peaceful, "enu-flu")
    with np.load(tmp_path / "e.npz") as terms:
        assert "disturbance_N_uT" not in terms.files and "ideal_mag_uT" in terms.files
