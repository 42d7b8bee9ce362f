"""--quiet, --json, --dry-run and several files: the same wherever they make sense."""

from __future__ import annotations

import json
from argparse import ArgumentParser
from pathlib import Path

import numpy as np
import pytest

import kreisel
from kreisel import discovery
from kreisel.cli.batch import derived, expanded
from kreisel.cli.main import COMMANDS, configure, main
from kreisel.cli.values import UsageError

N = 300
T = np.arange(N) / 100.0


def recording(seed: int = 0) -> kreisel.ImuRecording:
    rng = np.random.default_rng(seed)
    gyro, accel = 1e-3 * rng.normal(size=(2, N, 3))
    return kreisel.ImuRecording(T, gyro, accel + np.array([0.0, 0.0, 9.80665]))


@pytest.fixture
def here(tmp_path, monkeypatch) -> Path:
    """A folder with two recordings, one of them in a folder, poses, truth and a scenario."""
    monkeypatch.chdir(tmp_path)
    Path("rec/deep").mkdir(parents=True)
    kreisel.write("rec/a.csv", recording(1))
    kreisel.write("rec/deep/b.csv", recording(2))
    motion = kreisel.figure_eight(period=8.0).sample(T)
    kreisel.write("poses.npz", motion)
    Path("scene.toml").write_text(
        "duration = 1\nrate_hz = 50\n[trajectory]\nkind = 'rest'\n[[filter]]\nkind = 'dcm'\n"
    )
    return tmp_path


def files_in(folder: Path) -> list[str]:
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*"))


# What each command needs; those that write get their place with -o.
LINES = {
    "info": "rec/a.csv",
    "convert": "rec/a.csv -o new.npz",
    "estimate": "rec/a.csv -o new.npz",
    "allan": "rec/a.csv -o new",
    "calibrate": "rec/a.csv --gyro -o new.toml",
    "simulate": "poses.npz -o new --no-pictures",
    "evaluate": "poses.npz poses.npz -o new",
    "run": "scene.toml -o new --no-pictures",
    "sensors": "bmi088",
    "doctor": "",
}
DRY = ("convert", "estimate", "allan", "calibrate", "simulate", "evaluate", "run")


@pytest.mark.parametrize("command", LINES)
def test_json_is_one_object_with_a_schema_and_quiet_leaves_it_alone(command, here, capsys) -> None:
    assert main([command, *LINES[command].split(), "--json", "--quiet"]) == 0
    streams = capsys.readouterr()
    assert json.loads(streams.out)["schema"].startswith("kreisel.")
    assert streams.err == ""


@pytest.mark.parametrize("command", LINES)
def test_quiet_says_nothing_and_does_the_work(command, here, capsys) -> None:
    before = files_in(here)
    assert main([command, *LINES[command].split(), "--quiet"]) == 0
    assert capsys.readouterr() == ("", "")
    assert (files_in(here) != before) == ("-o" in LINES[command])


@pytest.mark.parametrize("command", DRY)
def test_a_dry_run_names_what_would_be_made_and_makes_nothing(command, here, capsys) -> None:
    before, line = files_in(here), [command, *LINES[command].split()]
    assert main([*line, "--dry-run"]) == 0
    text = capsys.readouterr().out
    assert text.startswith("sound: ") and "would write: new" in text and "nothing written" in text
    assert main([*line, "--dry-run", "--json"]) == 0
    plan = json.loads(capsys.readouterr().out)
    assert plan["schema"] == "kreisel.dry-run/1" and plan["command"] == command and plan["reads"]
    assert files_in(here) == before
    # What was foretold is what comes.
    assert main([*line, "--quiet"]) == 0
    assert sorted(plan["writes"]) == [f for f in files_in(here) if f not in before and Path(f).is_file()]


def test_quiet_does_not_hide_errors_and_missed_limits(here, capsys) -> None:
    assert main(["info", "nowhere.csv", "--quiet"]) == 1
    assert capsys.readouterr().err.count("\n") == 1
    turned = kreisel.AttitudeHistory(T, np.tile(np.eye(3), (N, 1, 1)))
    kreisel.write("still.npz", turned)
    assert main(["evaluate", "poses.npz", "still.npz", "--quiet", "--max-total-rmse-deg", "1"]) == 3
    streams = capsys.readouterr()
    assert streams.out == "" and "allowed 1" in streams.err


def test_every_command_can_be_quiet_and_those_with_results_speak_json() -> None:
    for command in discovery.names(COMMANDS):
        parser = ArgumentParser(prog=command)
        configure(parser, command)
        options = {name for action in parser._actions for name in action.option_strings}
        assert "--quiet" in options, command
        # What writes its data to stdout, or tells a story, has no numbers to give.
        assert "--json" in options or command in ("completion", "demo", "live"), command


def test_patterns_find_files_in_folders_too(here) -> None:
    assert expanded(["rec/**/*.csv", "rec/a.csv"]) == ["rec/a.csv", "rec/deep/b.csv"]
    Path("rec/[x].csv").write_text("a name, no pattern")
    assert expanded(["rec/[x].csv"]) == ["rec/[x].csv"]
    with pytest.raises(UsageError, match=r"no file fits 'rec/\*.bag'"):
        expanded(["rec/*.bag"])


def test_no_two_inputs_go_to_one_output(here) -> None:
    assert derived(["x/a.bag", "x/b.bag"], "out/", ".csv") == [Path("out/a.csv"), Path("out/b.csv")]
    assert derived(["x/a.bag"], "out.csv", ".csv") == [Path("out.csv")]
    assert derived(["x/y/a.bag", "x/a.bag"], "out/", ".csv") == [Path("out/y/a.csv"), Path("out/a.csv")]
    assert derived(["../x/a.bag", "a.bag"], "out/", "")[0].parts[:1] == ("out",)
    assert ".." not in str(derived(["../x/a.bag", "a.bag"], "out/", ""))
    for paths, output, said in (
        (["x/a.bag", "x/A.bag"], "out/", "two inputs would be written to out"),
        (["rec/a.csv", "rec/b.csv"], "rec", "is the input itself"),
        (["rec/a.csv", "rec/b.csv"], "poses.npz", "must be a folder for 2 inputs"),
    ):
        with pytest.raises(UsageError, match=said):
            derived(paths, output, ".csv")


@pytest.mark.parametrize(
    ("line", "made"),
    [
        ("info", []),
        ("convert -o out --to npz", ["out/a.npz", "out/b.npz"]),
        ("estimate -o out --to npz", ["out/a.npz", "out/b.npz"]),
        ("allan -o out --sensor gyro", ["out/a/allan.json", "out/b/allan.json"]),
    ],
)
def test_one_bad_file_of_many_is_named_and_the_others_are_done(line, made, here, capsys) -> None:
    Path("rec/bad.csv").write_text("t,gyro_x\n0,1\n")
    command, *options = line.split()
    assert main([command, "rec/**/*.csv", *options]) == 1
    streams = capsys.readouterr()
    assert streams.err.count("\n") == 1 and "rec/bad.csv" in streams.err
    assert "a.csv" in streams.out or "a.npz" in streams.out
    assert set(made) <= set(files_in(here)) and not any("bad" in Path(f).name for f in made)
    assert main([command, "rec/**/*.csv", *options, "--json"]) == 1
    report = json.loads(capsys.readouterr().out)
    assert len(report["files"]) == 2 and [f["file"] for f in report["failed"]] == ["rec/bad.csv"]


def test_convert_takes_the_last_name_for_its_output_as_cp_does(here, capsys) -> None:
    assert main(["convert", "rec/a.csv", "rec/deep/b.csv", "out/", "--to", "npz"]) == 0
    assert files_in(here / "out") == ["a.npz", "b.npz"]
    assert main(["convert", "rec/a.csv"]) == 2
    assert "kreisel convert IN OUT" in capsys.readouterr().err
    assert main(["convert", "rec/**/*.csv", "-o", "out"]) == 2
    assert "--to csv" in capsys.readouterr().err
