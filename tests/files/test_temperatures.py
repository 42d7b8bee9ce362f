"""Tables of temperature over time."""

import numpy as np
import pytest

from kreisel.files.temperatures import read_temperature


@pytest.mark.parametrize(
    "header", ["t [s],temperature [degC]", "time;temp", "t [ms],temperature_degC", "t,Temperature [°C]"]
)
def test_a_table_of_two_columns(header, tmp_path):
    cut = ";" if ";" in header else ","
    factor = 1e3 if "ms" in header else 1.0
    path = tmp_path / "warm.csv"
    path.write_text(f"# chamber\n{header}\n0{cut}20.5\n{10 * factor}{cut}40\n", encoding="utf-8")
    history = read_temperature(path)
    np.testing.assert_array_equal(history.t, [0.0, 10.0])
    np.testing.assert_array_equal(history.temperature_degC, [20.5, 40.0])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("t,temprature\n0,1\n", "no use for a column 'temprature'. Did you mean 'temperature'"),
        ("t,temperature\n0,1\n5,\n", "line 3: no temperature"),
        ("t,temperature\n0,warm\n", "line 2, column 'temperature': 'warm' is not a number"),
        ("t,temperature\n1,20\n0,20\n", "warm.csv: t must increase strictly"),
        ("t,temperature [K]\n0,293\n", "'K' is no unit of temperature"),
    ],
)
def test_bad_tables_are_refused_with_their_line(text, message, tmp_path):
    path = tmp_path / "warm.csv"
    path.write_text(text)
    with pytest.raises(ValueError, match=message):
        read_temperature(path)


def test_no_table(tmp_path):
    with pytest.raises(OSError, match=r"cannot read .*none\.csv"):
        read_temperature(tmp_path / "none.csv")
