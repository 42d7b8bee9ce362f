"""Scores are the benchmark's, offsets are found, and what cannot run says why."""

from __future__ import annotations

import importlib.util
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from kreisel.data.attitude import Reference
from kreisel.data.trial import Trial
from kreisel.maths.rotations import exp_so3
from kreisel.study import broad
from kreisel.study.broad import Score
from tests.trials import turning_trial, write_broad

needs_vqf = pytest.mark.skipif(not broad.installed("vqf"), reason="vqf is not installed: kreisel[compare]")


@pytest.fixture(scope="module")
def trial() -> Trial:
    return turning_trial(6.0)


def test_a_reference_turned_by_known_angles_gives_those_angles_as_errors(trial: Trial) -> None:
    answer = broad.estimate("dcm", trial.recording)
    heading, tilt = np.radians([3.0, 4.0])
    turned = exp_so3(np.array([0.0, 0.0, -heading])) @ exp_so3(np.array([-tilt, 0.0, 0.0])) @ answer.R_NS
    reference = Reference(answer.t, turned, trial.reference.counts)
    found = broad.score("dcm", Trial(trial.recording, reference, "07_known"))
    assert (found.filter, found.trial) == ("dcm", "07_known")
    # The estimate is Exp(tilt) Exp(heading) of the reference: twist and swing of that product.
    assert found.heading_rmse_deg == pytest.approx(3.0, abs=1e-9)
    assert found.inclination_rmse_deg == pytest.approx(4.0, abs=1e-9)
    cosine = np.cos(heading / 2) * np.cos(tilt / 2)
    assert found.total_rmse_deg == pytest.approx(np.degrees(2 * np.arccos(cosine)), abs=1e-9)
    assert found.heading_offset_deg == pytest.approx(3.0, abs=1e-9)
    assert found.free_total_rmse_deg == pytest.approx(4.0, abs=1e-9)
    assert found.free_heading_rmse_deg == pytest.approx(0.0, abs=1e-6)


def test_the_mean_is_over_trials_and_offsets_do_not_cancel() -> None:
    one, two = Score("dcm", "a", 1, 2, 3, -4, 5, 6), Score("dcm", "b", 3, 4, 5, 6, 7, 8)
    assert broad.mean([one, two]) == Score("dcm", "mean of 2", 2, 3, 4, 5, 6, 7)


@needs_vqf
def test_filters_of_others_are_called_by_name(trial: Trial) -> None:
    answer = broad.estimate("vqf-offline", trial.recording)
    assert answer.name == "vqf-offline"
    np.testing.assert_array_equal(answer.t, trial.recording.t)


def test_names_list_ours_first() -> None:
    names = broad.filter_names()
    assert names[0] == "dcm" and {"vqf", "vqf-offline", "imufusion", "ahrs-madgwick"} < set(names)
    assert broad.installed("dcm")
    with pytest.raises(ValueError, match="Did you mean 'vqf-offline'"):
        broad.estimate("vqf-ofline", turning_trial(1.0).recording)


def test_a_package_that_is_not_there_is_named(trial: Trial, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    assert not broad.installed("imufusion")
    with pytest.raises(ValueError, match=r"imufusion needs imufusion: pip install 'kreisel\[compare\]'"):
        broad.estimate("imufusion", trial.recording)


def test_what_filters_of_others_cannot_take_is_refused(trial: Trial) -> None:
    holed = np.array(trial.recording.mag_uT)
    holed[3] = np.nan
    with pytest.raises(ValueError, match="mag_uT must be finite; row 3"):
        broad.estimate("vqf", replace(trial.recording, mag_uT=holed))
    with pytest.raises(ValueError, match="vqf needs a magnetometer"):
        broad.estimate("vqf", replace(trial.recording, mag_uT=None))


def test_trials_come_by_name_once_each(tmp_path: Path) -> None:
    for name in ("02_b.mat", "01_a.hdf5", "02_b.hdf5", "readme.txt"):
        (tmp_path / name).touch()
    assert [path.name for path in broad.trial_files(tmp_path)] == ["01_a.hdf5", "02_b.mat"]


def test_folders_without_trials_are_named(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="has no trials of BROAD"):
        broad.trial_files(tmp_path)
    with pytest.raises(ValueError, match="is not a folder"):
        broad.trial_files(tmp_path / "nowhere")


def test_every_filter_meets_every_trial(tmp_path: Path) -> None:
    for name in ("01_a", "02_b"):
        write_broad(tmp_path / f"{name}.mat", turning_trial(4.0))
    found = list(broad.scores(["dcm"], broad.trial_files(tmp_path)))
    assert [(score.filter, score.trial) for score in found] == [("dcm", "01_a"), ("dcm", "02_b")]
