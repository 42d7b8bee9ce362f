"""Turns a table of times and temperatures into the history of a sensor's temperature."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from kreisel.data.temperature import TemperatureHistory
from kreisel.files.doors import PathLike
from kreisel.files.named_rows import Known, named_rows

_COLUMNS = {
    "t": Known("time", "s", ("time", "t_s", "time_s")),
    "temperature": Known("temperature", "degC", ("temperature_degc", "temp", "temp_degc", "degc")),
}


def read_temperature(path: PathLike) -> TemperatureHistory:
    """The history in a table with the columns t [s] and temperature [degC].

    Raises ValueError with file, line and column, OSError where there is no file.
    """
    path = Path(path)
    file, rows = named_rows(path, _COLUMNS)
    for k, row in enumerate(rows):
        for name in _COLUMNS:
            if name not in row:
                raise file.error(
                    k, f"no {name}. Needed are t and temperature; remove the row, or fill its cells."
                )
    t, degrees = (np.array([float(row[name]) for row in rows]) for name in _COLUMNS)
    try:
        return TemperatureHistory(t, degrees)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
