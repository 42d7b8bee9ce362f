"""`kreisel report` of a scenario, of the folder of its run, of a recording; and what it says of anything else."""

import json
import re
import sys

import numpy as np
import pytest

from kreisel.cli.main import main
from kreisel.data.attitude import AttitudeHistory
from kreisel.data.recording import ImuRecording
from kreisel.files.doors import write

pytest.importorskip("bokeh", reason="bokeh is not installed: pip install kreisel[report]")

SCENARIO = """
name = "a circle"
duration = 4.0
rate_hz = 50.0
[trajectory]
kind = "circle"
[[imu]]
name = "nose"
p_BS = [0.5, 0.0, 0.0]
sensor = "bmi088"
[environment]
field_N_uT = [0.0, 20.0, -44.0]
[[filter]]
kind = "dcm"
"""


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "circle.toml").write_text(SCENARIO)
    return tmp_path


@pytest.fixture
def resting(here):
    """A recording at rest, and two attitudes that were estimated from it."""
    t = 0.01 * np.arange(200)
    write("imu.csv", ImuRecording(t, np.zeros((200, 3)), np.tile([0.0, 0.0, 9.81], (200, 1))))
    R = np.tile(np.eye(3), (200, 1, 1))
    for name in ("mine", "other"):
        write(f"{name}.npz", AttitudeHistory(t, R))
    return here


def test_a_scenario_and_the_folder_of_its_run_give_the_same_page(here, capsys):
    assert main(["report", "circle.toml"]) == 0
    told = capsys.readouterr().out
    assert re.match(r"report\.html: \d\.\d MB, written in", told)
    assert main(["run", "circle.toml", "-o", "out", "--no-pictures"]) == 0
    assert main(["report", "out", "-o", "folder.html"]) == 0
    page = (here / "folder.html").read_text()
    assert page == (here / "report.html").read_text()
    assert "<h1>a circle</h1>" in page and "<option>nose</option>" in page


def test_a_recording_with_estimates_and_truth(resting, capsys):
    assert (
        main(["report", "imu.csv", "--estimate", "mine.npz", "--estimate", "other.npz", "-o", "a.html"]) == 0
    )
    page = (resting / "a.html").read_text()
    assert "<option>mine</option><option>other</option>" in page and 'id="errors"' not in page
    options = ["--truth", "other.npz", "--align", "heading", "--imu", "wrist:0.1,0,0", "-o", "b.html"]
    assert main(["report", "imu.csv", "--estimate", "mine.npz", *options]) == 0
    page = (resting / "b.html").read_text()
    assert 'id="errors"' in page and "at (100, 0, 0) mm in the body" in page
    assert main(["report", "imu.csv", "--truth", "mine.npz", "-o", "c.html"]) == 0


def test_a_dry_run_checks_and_writes_nothing_and_json_names_the_page(resting, capsys):
    assert main(["report", "circle.toml", "--dry-run"]) == 0
    told = capsys.readouterr().out
    assert "sound: circle.toml: a scenario of 201 samples" in told and "would write: report.html" in told
    assert main(["report", "imu.csv", "--estimate", "mine.npz", "--dry-run"]) == 0
    assert "1 IMU, 1 estimate" in capsys.readouterr().out and not list(resting.glob("*.html"))
    assert main(["report", "imu.csv", "--estimate", "mine.npz", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["schema"] == "kreisel.report/1" and told["files"] == ["report.html"]
    assert told["bytes"] == (resting / "report.html").stat().st_size


def test_what_cannot_be_is_one_sentence(resting, capsys, monkeypatch):
    def refused(code, *arguments):
        assert main(["report", *arguments]) == code
        said = capsys.readouterr().err
        assert said.count("\n") == 1 or "See: " in said
        return said

    assert "give --estimate (kreisel estimate imu.csv -o attitude.tum) or --truth" in refused(2, "imu.csv")
    assert "mine.npz is no result: it must be a scenario (.toml)" in refused(1, "mine.npz")
    assert "--truth goes with an IMU recording; circle.toml is a scenario" in refused(
        2, "circle.toml", "--truth", "mine.npz"
    )
    assert "report.json: there is no such file" in refused(1, ".")
    assert "name the file .html" in refused(2, "circle.toml", "-o", "report.pdf")
    assert "cannot read circel.toml" in refused(1, "circel.toml")
    assert "there is no such file" in refused(1, "nothing.csv")
    monkeypatch.setitem(sys.modules, "bokeh", None)
    assert "kreisel report needs bokeh: pip install 'kreisel[report]'." in refused(1, "circle.toml")
    assert not list(resting.glob("*.html"))
