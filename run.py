"""Makes this checkout's own environment in .venv, then runs the demo or the tests in it.

    python3 run.py demo [arguments of `kreisel demo`]
    python3 run.py test [arguments of pytest]
    python3 run.py setup                       only make the environment
    python3 run.py --with dev,oracle setup     ... with more extras of pyproject.toml (remembered)

Needs Python 3.11 or newer with pip, and nothing else. The first run downloads the dependencies
(about 650 MB installed); later runs start at once. Delete .venv to start afresh.
"""

import sys

# Before everything else, so that an old Python says this instead of a syntax error further down.
if sys.version_info < (3, 11):  # noqa: UP036
    sys.exit(
        f"run.py: kreisel needs Python 3.11 or newer; this is {sys.version.split()[0]} ({sys.executable}).\n"
        "        Run it with a newer one, for example: python3.12 run.py demo"
    )

import hashlib
import json
import os
import shutil
import subprocess
import time
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent
VENV = ROOT / ".venv"
STAMP = VENV / "kreisel-install.json"
BIN = VENV / ("Scripts" if os.name == "nt" else "bin")
PYTHON = BIN / ("python.exe" if os.name == "nt" else "python")
# Inside an activated environment this is the Python that made it: the one to build the next from.
BASE_PYTHON = getattr(sys, "_base_executable", None) or sys.executable

NO_INSTALLER = f"""found neither pip (22.3 or newer) nor uv. Install pip for {sys.executable}:
        Debian, Ubuntu   sudo apt install python3-pip
        Fedora           sudo dnf install python3-pip
        elsewhere        {sys.executable} -m ensurepip, or https://pip.pypa.io/en/stable/installation"""


class Failure(Exception):
    """What the user is told in one line, in place of a traceback."""


def main(arguments: list[str]) -> int:
    """Exit code of the command that was asked for."""
    arguments, extras = take_extras(arguments)
    command, *rest = arguments or ["help"]
    if command in ("help", "-h", "--help"):
        print(__doc__)
        return 0
    if command not in ("demo", "test", "setup"):
        print(f"run.py: no command {command!r}; there are demo, test and setup", file=sys.stderr)
        return 2
    ensure_environment(extras | {"test", "report"})
    if command == "demo":
        return replace_by([str(BIN / "kreisel"), "demo", *rest])
    if command == "test":
        os.chdir(ROOT)
        return replace_by([str(PYTHON), "-m", "pytest", *rest])
    return 0


def take_extras(arguments: list[str]) -> tuple[list[str], set[str]]:
    """`--with a,b` split off the front of the arguments."""
    if not arguments or arguments[0] != "--with":
        return arguments, set()
    if len(arguments) < 3:
        raise Failure("--with needs a list and a command, as in: python3 run.py --with dev,oracle test")
    return arguments[2:], {name.strip() for name in arguments[1].split(",") if name.strip()}


def ensure_environment(extras: set[str]) -> None:
    """.venv holding the project, editable, with `extras` and with those it was given before."""
    stamp, available = read_stamp(), available_extras()
    if not extras <= available:
        raise Failure(f"no extra {', '.join(extras - available)}; there are {', '.join(sorted(available))}")
    wanted = sorted(extras | available.intersection(stamp.get("extras", [])))
    key, base = fingerprint(wanted), f"{sys.implementation.cache_tag} {ROOT}"
    whole = stamp.get("complete", False) and PYTHON.exists() and set(stamp["packages"]) <= packages()
    if whole and stamp["key"] == key:
        return
    if not PYTHON.exists() or (stamp.get("mine") and not (whole and stamp["base"] == base)):
        make_environment()
    # An environment that somebody else made is filled, never deleted.
    stamp = {"mine": read_stamp().get("mine", False), "base": base, "extras": wanted}
    write_stamp(stamp)  # not complete: an install that is cut short is done again from the start
    install(wanted)
    write_stamp({**stamp, "key": key, "packages": sorted(packages()), "complete": True})


def available_extras() -> set[str]:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return set(project["optional-dependencies"])


def fingerprint(extras: list[str]) -> str:
    """Changes whenever something has to be installed."""
    about = (ROOT / "pyproject.toml").read_bytes()
    return hashlib.sha256(
        about + repr((sys.implementation.cache_tag, str(ROOT), extras)).encode()
    ).hexdigest()


def packages() -> set[str]:
    """Names in site-packages; whatever was there after the install has to stay there."""
    found = [*VENV.glob("lib/python*/site-packages/*"), *VENV.glob("Lib/site-packages/*")]
    return {path.name for path in found if path.name != "__pycache__"}


def read_stamp() -> dict:
    """What the last install wrote down, or nothing where that cannot be read."""
    try:
        stamp = json.loads(STAMP.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return stamp if isinstance(stamp, dict) else {}


def write_stamp(stamp: dict) -> None:
    STAMP.write_text(json.dumps(stamp, indent=1), encoding="utf-8")


def make_environment() -> None:
    """An empty .venv, without pip: many systems ship venv but not the ensurepip that would bring it."""
    if Path(sys.prefix).resolve() == VENV:
        raise Failure(f"{VENV} has to be made again, but is active: run `deactivate` first")
    say(f"making .venv with Python {sys.version.split()[0]}")
    if VENV.exists():
        shutil.rmtree(VENV)
    VENV.mkdir()
    write_stamp({"mine": True})
    make = [BASE_PYTHON, "-m", "venv", "--without-pip", str(VENV)]
    call(make, "could not make .venv; Debian and Ubuntu may need: sudo apt install python3-venv")


def install(extras: list[str]) -> None:
    """The project and its dependencies into .venv."""
    command = [*installer(), "-e", f"{ROOT}[{','.join(extras)}]"]
    say(f"installing kreisel[{','.join(extras)}] into it (the first time takes a minute or two)")
    started = time.monotonic()
    call(command, "the installation failed, for the reason above (no network?)")
    say(f"installed in {time.monotonic() - started:.0f} s")


def installer() -> list[str]:
    """The command that installs into .venv, made of what this machine has."""
    quiet = ["install", "-qq", "--disable-pip-version-check", "--no-input"]
    for python in dict.fromkeys([sys.executable, BASE_PYTHON]):
        pip = [python, "-m", "pip", "--python", str(PYTHON)]
        if runs([*pip, "--version"]):
            return [*pip, *quiet]
    uv = shutil.which("uv")
    if uv:
        return [uv, "pip", "install", "--quiet", "--python", str(PYTHON)]
    own_pip = [str(PYTHON), "-m", "pip"]
    if runs([*own_pip, "--version"]) or runs([str(PYTHON), "-m", "ensurepip"]):
        return [*own_pip, *quiet]
    raise Failure(NO_INSTALLER)


def runs(command: list[str]) -> bool:
    return subprocess.run(command, capture_output=True, stdin=subprocess.DEVNULL).returncode == 0


def call(command: list[str], failure: str) -> None:
    """Run `command`, whose own words are shown only when it fails."""
    done = subprocess.run(
        command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    if done.returncode != 0:
        raise Failure(f"{' '.join(command)}\n{done.stdout.rstrip()}\nrun.py: {failure}")


def replace_by(command: list[str]) -> int:
    """Become `command`, so that its exit code and signals are ours."""
    sys.stdout.flush()
    if os.name == "nt":  # exec there returns to the shell before the new program is done
        return subprocess.call(command)
    os.execv(command[0], command)


def say(line: str) -> None:
    print(f"run.py: {line}", file=sys.stderr, flush=True)


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except (Failure, OSError) as error:
        sys.exit(f"run.py: {error}")
    except KeyboardInterrupt:
        print("\nrun.py: interrupted; run it again to go on", file=sys.stderr)
        sys.exit(130)
