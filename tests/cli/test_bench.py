"""`kreisel bench broad` on trials whose truth is known."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from kreisel.cli.main import main
from kreisel.study import broad
from tests.trials import turning_trial, write_broad


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("broad")
    for name in ("01_short", "02_longer"):
        write_broad(folder / f"{name}.mat", turning_trial(4.0 + len(name) / 4))
    return folder


def test_the_table_has_every_trial_and_the_mean(folder, capsys) -> None:
    assert main(["bench", "broad", str(folder), "--filter", "dcm"]) == 0
    streams = capsys.readouterr()
    assert streams.err == ""
    lines = streams.out.splitlines()
    assert lines[0] == "dcm: ours, defaults"
    assert [line.split()[0] for line in lines[2:5]] == ["01_short", "02_longer", "mean"]
    summary = lines[-1 - broad.installed("vqf") :]
    assert any(line.startswith("dcm") for line in summary)


def test_json_has_the_same_for_programs_and_the_ratio(folder, capsys) -> None:
    assert main(["bench", "broad", str(folder), "--filter", "dcm", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["schema"] == "kreisel.bench.broad/1"
    scores = [score for score in found["scores"] if score["filter"] == "dcm"]
    (mean,) = (mean for mean in found["means"] if mean["filter"] == "dcm")
    total = sum(score["total_rmse_deg"] for score in scores)
    assert mean["total_rmse_deg"] == pytest.approx(total / 2)
    if broad.installed("vqf"):
        (yardstick,) = (mean for mean in found["means"] if mean["filter"] == "vqf")
        assert mean["ratio_to_vqf"] == pytest.approx(mean["total_rmse_deg"] / yardstick["total_rmse_deg"])
        assert yardstick["ratio_to_vqf"] == 1.0


def test_without_the_yardstick_there_is_no_ratio(folder, capsys, monkeypatch) -> None:
    monkeypatch.setattr(broad, "installed", lambda name: name == "dcm")
    assert main(["bench", "broad", str(folder), "--json"]) == 0
    (mean,) = json.loads(capsys.readouterr().out)["means"]
    assert mean["filter"] == "dcm" and mean["ratio_to_vqf"] is None
    assert main(["bench", "broad", str(folder)]) == 0
    assert "vqf" not in capsys.readouterr().out


def test_scores_and_picture_are_written(folder, tmp_path, capsys) -> None:
    out = tmp_path / "out"
    assert main(["bench", "broad", str(folder), "--filter", "dcm", "-o", str(out)]) == 0
    assert sorted(path.name for path in out.iterdir()) == ["scores.json", "scores.png"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--filter", "dmc"], "Did you mean 'dcm'"),
        (["--filter", "kalman"], "--filter must be one of 'dcm'"),
    ],
)
def test_unknown_filters_are_one_line(arguments, message, folder, capsys) -> None:
    assert main(["bench", "broad", str(folder), *arguments]) == 2
    err = capsys.readouterr().err
    assert message in err and err.count("\n") == 1


def test_a_folder_without_trials_is_one_line(tmp_path, capsys) -> None:
    assert main(["bench", "broad", str(tmp_path)]) == 1
    assert "has no trials of BROAD" in capsys.readouterr().err
