"""Turns a calibration into a TOML file and back."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

from kreisel.atomic import replacing
from kreisel.data.calibration import Calibration, TriadCalibration
from kreisel.data.checks import choice
from kreisel.files.doors import PathLike

_UNITS = {"gyro": "rad/s", "accel": "m/s^2", "mag": "uT"}
_ENTRIES = ("unit", "bias", "bias_error", "matrix", "matrix_error")


def write_calibration(path: PathLike, calibration: Calibration) -> None:
    """Write the triads that are known; OSError where the place cannot be written."""
    import tomli_w

    known = {name: getattr(calibration, name) for name in _UNITS if getattr(calibration, name) is not None}
    table = {
        name: {"unit": _UNITS[name], **{entry: getattr(triad, entry).tolist() for entry in _ENTRIES[1:]}}
        for name, triad in known.items()
    }
    head = "# reading = matrix * truth + bias, sensor axes; the errors are standard errors\n\n"
    with replacing(path) as out:
        out.write((head + tomli_w.dumps(table)).encode())


def read_calibration(path: PathLike) -> Calibration:
    """What `write_calibration` wrote; ValueError with the key where the file is not sound."""
    source = Path(path)
    try:
        table = tomllib.loads(source.read_text(encoding="utf-8"))
        for name in table:
            choice("a sensor", name, tuple(_UNITS))
        return Calibration(**{name: _triad(name, entries) for name, entries in table.items()})
    except OSError as error:
        raise type(error)(f"cannot read {source}: {error.strerror}.") from None
    except (ValueError, TypeError) as error:
        raise ValueError(f"{source} is no calibration: {error}") from None


def _triad(name: str, entries: Any) -> TriadCalibration:
    if not isinstance(entries, dict):
        raise ValueError(f"{name} must be a table [{name}].")
    for key in entries:
        choice(f"a key of [{name}]", key, _ENTRIES)
    choice(f"unit of [{name}]", entries.get("unit"), (_UNITS[name],))
    return TriadCalibration(**{key: value for key, value in entries.items() if key != "unit"})
