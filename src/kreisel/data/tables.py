"""Turns nouns into pandas DataFrames and xarray Datasets whose columns say their unit and frame."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Iterator
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from kreisel.data.cards import Card, Shown, course, span

if TYPE_CHECKING:
    import pandas
    import xarray

AXES = ("x", "y", "z")

_NOTES = 5
"""Notes that a notebook shows below a table."""


@dataclasses.dataclass(frozen=True, slots=True)
class Quantity:
    """What a field of a noun measures."""

    column: str  # what its columns are called in tables, before _x, _y, _z
    unit: str  # "1" for a number without one
    frame: str  # the axes its components are in; "" where it has none
    meaning: str


QUANTITIES = MappingProxyType(
    {
        "t": Quantity("t", "s", "", "time after t0_ns"),
        "p_NB": Quantity("p", "m", "N", "position of the body"),
        "v_NB": Quantity("v", "m/s", "N", "velocity of the body"),
        "a_NB": Quantity("a", "m/s^2", "N", "acceleration of the body, gravity not in it"),
        "R_NB": Quantity("R", "1", "N from B", "rotation matrix of the body: v_N = R_NB v_B"),
        "omega_NB_B": Quantity("omega", "rad/s", "B", "angular rate of the body in N"),
        "alpha_NB_B": Quantity("alpha", "rad/s^2", "B", "derivative of the angular rate"),
        "theta_sigma": Quantity("theta_sigma", "rad", "B", "standard error of the attitude"),
        "a_sigma": Quantity("a_sigma", "m/s^2", "N", "standard error of a_NB"),
        "omega_sigma": Quantity("omega_sigma", "rad/s", "B", "standard error of omega_NB_B"),
        "alpha_sigma": Quantity("alpha_sigma", "rad/s^2", "B", "standard error of alpha_NB_B"),
        "gyro": Quantity("gyro", "rad/s", "S", "gyroscope: angular rate of the sensor in N"),
        "accel": Quantity("accel", "m/s^2", "S", "accelerometer: specific force, +g up at rest"),
        "mag_uT": Quantity("mag", "uT", "S", "magnetic field"),
        "gyro_sigma": Quantity("gyro_sigma", "rad/s", "S", "standard error of gyro"),
        "accel_sigma": Quantity("accel_sigma", "m/s^2", "S", "standard error of accel"),
        "dtheta": Quantity("dtheta", "rad", "S", "turn over the interval, as a rotation vector"),
        "dv": Quantity("dv", "m/s", "S", "velocity gained over the interval, gravity not in it"),
        "dp": Quantity("dp", "m", "S", "position gained over the interval beyond velocity and gravity"),
        "gyro_noise": Quantity("gyro_noise", "rad/s", "S", "deviation of the gyroscope's white noise"),
        "accel_noise": Quantity("accel_noise", "m/s^2", "S", "deviation of the accelerometer's white noise"),
        "mag_noise_uT": Quantity("mag_noise", "uT", "S", "deviation of the magnetometer's white noise"),
        "R_NS": Quantity("R", "1", "N from S", "rotation matrix of the sensor: v_N = R_NS v_S"),
        "gyro_bias": Quantity("gyro_bias", "rad/s", "S", "bias of the gyroscope"),
        "a_N": Quantity("a", "m/s^2", "N", "acceleration of the sensor, gravity not in it"),
        "sigma": Quantity("sigma_dtheta", "rad", "N", "standard deviation of the attitude error"),
        "rest": Quantity("rest", "1", "", "taken to be at rest"),
        "disturbed": Quantity("disturbed", "1", "", "magnetometer not trusted"),
        "held": Quantity("held", "1", "", "gyro sample missing, last rate held"),
        "counts": Quantity("counts", "1", "", "sample of the reference that counts"),
    }
)
"""Every field with numbers of every noun."""

CONSTANTS = ("gyro_noise", "accel_noise", "mag_noise_uT")
"""Those of them with one value per axis, (3,), for all rows."""

INCREMENTS = ("dtheta", "dv", "dp")
"""Those of them with one row per interval, one fewer than there are stamps."""


class Tabular(Shown):
    """What a noun of arrays over time gains: the tables others work with."""

    __slots__ = ()

    def card(self) -> Card:
        """One row per field: what it measures, in which unit and axes, and what it spans."""
        t = self.t  # type: ignore[attr-defined]
        notes = getattr(self, "notes", ())
        return Card(course(self, t), ("", "unit", "frame", "span", "meaning"), _described(self), _said(notes))

    def to_pandas(self) -> pandas.DataFrame:
        """One row per time stamp, indexed by t in s; attitude as the quaternion q_w, q_x, q_y, q_z.

        Increments stand at the end of their interval, and the row of the first stamp is NaN.
        `attrs` of the frame: noun, name, t0_ns, and by column `units` and `frames`; what is one value for all
        rows, such as gyro_noise, is there as well. Needs pandas: pip install 'kreisel[data]'.
        """
        library = _installed("pandas", "to_pandas")
        columns: dict[str, npt.NDArray[Any]] = {}
        attrs: dict[str, Any] = {**_about(self), "units": {"t": "s"}, "frames": {}}
        for name, array in arrays_of(self):
            quantity = QUANTITIES[name]
            if name in CONSTANTS:
                attrs[name] = array.tolist()
                continue
            for label, column in _columns(quantity.column, at_ends(name, array)):
                columns[label] = column
                attrs["units"][label] = quantity.unit
                if quantity.frame:
                    attrs["frames"][label] = quantity.frame
        t = columns.pop("t")
        table: pandas.DataFrame = library.DataFrame(columns, index=library.Index(t, name="t"))
        table.attrs = attrs
        return table

    def to_xarray(self) -> xarray.Dataset:
        """Every field to the bit under its own name, over the dimensions t, axis (x, y, z), row and column.

        Increments are over the dimension interval, of which there is one fewer than t.

        Attributes of a variable: units, frame, long_name; of the dataset: noun, name, t0_ns and notes. Data with an
        epoch has `time`, datetime64[ns], beside t. Needs xarray: pip install 'kreisel[data]'.
        """
        dataset = _installed("xarray", "to_xarray").Dataset(attrs=_about(self))
        for name, array in arrays_of(self):
            quantity = QUANTITIES[name]
            about = {"units": quantity.unit, "frame": quantity.frame, "long_name": quantity.meaning}
            dataset[name] = (_dimensions(name, array), array, {k: v for k, v in about.items() if v})
        for dimension in ("axis", "row", "column"):
            if dimension in dataset.dims:
                dataset = dataset.assign_coords({dimension: list(AXES)})
        labelled: xarray.Dataset = dataset.assign_coords(_epoch(dataset))
        return labelled


def arrays_of(data: Any) -> Iterator[tuple[str, npt.NDArray[Any]]]:
    """The fields of a noun that hold arrays, by name."""
    for field in dataclasses.fields(data):
        value = getattr(data, field.name)
        if isinstance(value, np.ndarray):
            yield field.name, value


def at_ends(name: str, array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """`array` with one row per stamp: increments at the end of their interval, NaN at the first stamp."""
    return np.concatenate([np.full((1, 3), np.nan), array]) if name in INCREMENTS else array


def _described(data: Any) -> Iterator[tuple[str, str, str, str, str]]:
    for name, array in arrays_of(data):
        quantity = QUANTITIES[name]
        # Elements of a matrix of directions say nothing.
        spanned = "" if array.ndim == 3 else span(array)
        unit = "" if quantity.unit == "1" else quantity.unit
        yield name, unit, quantity.frame, spanned, quantity.meaning


def _said(notes: tuple[Any, ...]) -> tuple[str, ...]:
    """The first notes, and how many there are beside them."""
    texts = tuple(note.text for note in notes[:_NOTES])
    return texts if len(notes) <= _NOTES else (*texts, f"and {len(notes) - _NOTES} more notes")


def _about(data: Any) -> dict[str, Any]:
    about = {"noun": type(data).__name__, "name": data.name, "t0_ns": data.t0_ns}
    notes = getattr(data, "notes", ())
    return about | ({"notes": json.dumps([dataclasses.asdict(note) for note in notes])} if notes else {})


def _columns(stem: str, array: npt.NDArray[Any]) -> Iterator[tuple[str, npt.NDArray[Any]]]:
    if array.ndim == 1:
        yield stem, array
    elif array.ndim == 2:
        yield from ((f"{stem}_{axis}", array[:, k]) for k, axis in enumerate(AXES))
    else:
        from kreisel.maths.rotations import quat_wxyz_from_matrix, rotation_defect

        # A reference may have lost sight: what is no rotation there becomes NaN.
        known = np.isfinite(array).all(axis=(1, 2))
        known[known] = rotation_defect(array[known]) < 1e-6
        quat = np.full((len(array), 4), np.nan)
        quat[known] = quat_wxyz_from_matrix(array[known])
        yield from ((f"q_{part}", quat[:, k]) for k, part in enumerate(("w", *AXES)))


def _dimensions(name: str, array: npt.NDArray[Any]) -> tuple[str, ...]:
    if array.ndim == 1:
        return ("axis",) if name in CONSTANTS else ("t",)
    if name in INCREMENTS:
        return ("interval", "axis")
    return ("t", "axis") if array.ndim == 2 else ("t", "row", "column")


def _epoch(dataset: xarray.Dataset) -> dict[str, Any]:
    """The coordinate `time` of data with an epoch; nothing for times since a start."""
    t0_ns = int(dataset.attrs["t0_ns"])
    if not t0_ns:
        return {}
    ns = np.int64(t0_ns) + np.rint(dataset["t"].values * 1e9).astype(np.int64)
    # Said here, because xarray would else choose seconds for the file, and floats to hold them.
    encoding = {"units": "nanoseconds since 1970-01-01", "dtype": "int64"}
    return {"time": ("t", ns.astype("datetime64[ns]"), {"long_name": "t0_ns + t"}, encoding)}


def _installed(module: str, method: str) -> Any:
    from importlib import import_module

    try:
        return import_module(module)
    except ImportError:
        raise ImportError(f"{method} needs {module}: pip install 'kreisel[data]'.") from None
