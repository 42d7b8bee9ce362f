"""evo, run as a program over our files, measures the same angle between truth and estimate."""

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest

from kreisel.data.trajectory import Poses
from kreisel.evaluate.attitude_errors import attitude_errors
from kreisel.files.doors import write
from kreisel.maths.rotations import exp_so3, matrix_from_euler

EVO = shutil.which("evo_ape", path=os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]]))


@pytest.mark.skipif(EVO is None, reason="evo is not installed: pip install kreisel[oracle]")
@pytest.mark.parametrize("t0_ns", [0, 1_700_000_000_123_456_789])
def test_total_error_is_evos_rotation_ape(tmp_path, rng, t0_ns):
    t = np.cumsum(rng.uniform(0.02, 0.06, 500))
    R_true = matrix_from_euler(np.cumsum(rng.normal(scale=0.1, size=(500, 3)), axis=0))
    # From a milliradian to half a turn.
    dtheta = rng.normal(size=(500, 3))
    dtheta *= (np.geomspace(1e-3, 3.1, 500) / np.linalg.norm(dtheta, axis=1))[:, None]
    truth = Poses(t, np.zeros((500, 3)), R_true, t0_ns=t0_ns)
    estimate = Poses(t, np.zeros((500, 3)), exp_so3(dtheta) @ R_true, t0_ns=t0_ns)
    write(tmp_path / "truth.tum", truth)
    write(tmp_path / "estimate.tum", estimate)

    command = [EVO, "tum", "truth.tum", "estimate.tum", "-r", "angle_deg", "--save_results", "ape.zip"]
    environment = os.environ | {"HOME": str(tmp_path), "USERPROFILE": str(tmp_path), "MPLBACKEND": "Agg"}
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    with zipfile.ZipFile(tmp_path / "ape.zip") as results, results.open("error_array.npy") as stream:
        theirs = np.load(stream)

    ours = attitude_errors(truth, estimate)
    np.testing.assert_allclose(np.degrees(ours.total), theirs, rtol=0, atol=1e-6)
    assert ours.summary().total_rmse_deg == pytest.approx(np.sqrt(np.mean(theirs**2)), abs=1e-6)
