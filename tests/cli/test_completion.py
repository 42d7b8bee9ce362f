"""`kreisel completion`: what a shell offers at the prompt is what the commands take."""

from __future__ import annotations

import argparse
import shutil
import subprocess
from pathlib import Path

import pytest

from kreisel import discovery
from kreisel.cli.commands import completion
from kreisel.cli.main import COMMANDS, configure, main


def script(shell: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Path:
    """The script in a file, where the shell is there to read it."""
    if shutil.which(shell) is None:
        pytest.skip(f"{shell} is not installed")
    assert main(["completion", shell]) == 0
    path = tmp_path / f"completion.{shell}"
    path.write_text(capsys.readouterr().out)
    return path


@pytest.fixture
def offered(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """What a real bash would offer for the last of some words, in a folder with two files."""
    path = script("bash", tmp_path, capsys)
    folder = tmp_path / "folder"
    (folder / "imu logs").mkdir(parents=True)
    (folder / "imu.csv").touch()

    def ask(*words: str) -> list[str]:
        program = (
            'source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1))\n'
            'complete -p kreisel >/dev/null || exit 9; _kreisel; printf "%s\\n" "${COMPREPLY[@]}"'
        )
        done = subprocess.run(
            ["bash", "-c", program, "bash", str(path), "kreisel", *words],
            cwd=folder,
            capture_output=True,
            text=True,
        )
        assert done.returncode == 0 and not done.stderr, done.stderr
        return [line for line in done.stdout.splitlines() if line]

    return ask


def test_bash_offers_the_commands(offered) -> None:
    assert offered("") == [*discovery.names(COMMANDS), "--help", "--version"]
    assert offered("es") == ["estimate"]


def test_bash_offers_the_options_of_each_command(offered) -> None:
    for command in ("estimate", "live", "doctor"):
        parser = argparse.ArgumentParser()
        configure(parser, command)
        options = [name for action in parser._actions for name in action.option_strings]
        assert offered(command, "-") == options
    assert offered("estimate", "imu.csv", "--from") == ["--from"]


def test_bash_offers_choices_names_and_files(offered) -> None:
    assert offered("allan", "--sensor", "") == ["gyro", "accel", "mag", "both", "all"]
    assert offered("estimate", "--frame", "n") == ["ned-frd", "nwu"]
    assert offered("estimate", "--frame", "=") == ["enu-flu", "ned-frd", "nwu", "ros", "matlab"]
    assert offered("estimate", "--frame", "=", "ro") == ["ros"]
    assert offered("sensors", "bmi08") == ["bmi088"]
    assert offered("completion", "") == ["bash", "zsh", "fish"]
    assert sorted(offered("estimate", "im")) == ["imu logs", "imu.csv"]
    assert sorted(offered("estimate", "-o", "imu.")) == ["imu.csv"]
    assert offered("live", "--rate", "") == []
    # Not a command of ours: nothing, and no complaint.
    assert offered("estimat", "--fr") == []


@pytest.mark.parametrize(("shell", "check"), [("bash", "-n"), ("zsh", "-n"), ("fish", "--no-execute")])
def test_shells_can_read_their_scripts(shell: str, check: str, tmp_path: Path, capsys) -> None:
    path = script(shell, tmp_path, capsys)
    done = subprocess.run([shell, check, str(path)], capture_output=True, text=True)
    assert done.returncode == 0 and not done.stderr, done.stderr
    assert f"source <(kreisel completion {shell})" in path.read_text() or shell == "fish"


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_scripts_name_every_command_and_option(shell: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["completion", shell]) == 0
    text = capsys.readouterr().out
    assert "# Completes kreisel. To install: " in text
    for command in discovery.names(COMMANDS):
        assert command in text
    for option in ("input-rate", "declination-deg", "max-heading-rmse-deg"):
        assert option in text


def test_words_that_commands_check_themselves_stand_in_their_help() -> None:
    seen = set()
    for command in discovery.names(COMMANDS):
        parser = argparse.ArgumentParser()
        configure(parser, command)
        for action in parser._actions:
            for option in {*action.option_strings} & {*completion._WORDS}:
                seen.add(option)
                assert all(word in (action.help or "") for word in completion._WORDS[option]), (
                    command,
                    option,
                )
    assert seen == {*completion._WORDS}
