"""Turns the name of a function that would lose derivatives into the error that says so and names the cure."""

from typing import Any

import numpy as np

_SAMPLES = "or give samples to SampledTrajectory"

_SAMPLING = "it depends on which times are asked for, not on the time alone"
_SAMPLING_DEPENDENT = {
    *(
        "cumsum",
        "cumprod",
        "cumulative_sum",
        "cumulative_prod",
        "gradient",
        "diff",
        "ediff1d",
        "trapezoid",
        "trapz",
    ),
    *(
        "unwrap",
        "convolve",
        "correlate",
        "sort",
        "argsort",
        "argmax",
        "argmin",
        "max",
        "min",
        "amax",
        "amin",
        "ptp",
    ),
    *("median", "percentile", "quantile", "std", "var", "average", "any", "all", "flip", "roll", "histogram"),
    *("unique", "nonzero", "fft", "ifft", "rfft"),
}

_CURES = {
    "unwrap": "derivatives of an angle have no jumps, so np.arctan2 needs no unwrapping",
    "gradient": "derivatives are exact here and need no samples: return the function itself",
    "cumsum": "write the integral as a formula",
    "any": "use np.where(condition, a, b)",
    "all": "use np.where(condition, a, b)",
    "max": "use np.maximum(a, b) for the larger of two functions",
    "min": "use np.minimum(a, b) for the smaller of two functions",
    "searchsorted": "use np.interp or np.select",
    "digitize": "use np.interp or np.select",
    "nan_to_num": "use np.where(condition, a, b)",
    "prod": "multiply the parts with *",
    "logaddexp2": "use np.logaddexp",
}


def no_rule(name: str) -> TypeError:
    """The error for a function that a jet has no rule for."""
    short = name.rpartition(".")[2]
    cure = _CURES.get(short, "use " + _nearest(short))
    if short in _SAMPLING_DEPENDENT:
        return TypeError(f"{name} has no derivative rule: {_SAMPLING}; {cure}, {_SAMPLES}.")
    return TypeError(f"{name} has no derivative rule; {cure}, {_SAMPLES}.")


def _nearest(short: str) -> str:
    if short.startswith("nan") and hasattr(np, short[3:]):
        return f"np.{short[3:]}"
    return "a formula of NumPy's elementary functions"


def loses_derivatives(what: str, cure: str) -> TypeError:
    """The error for a conversion that would keep the values and drop their derivatives."""
    return TypeError(f"{what} would lose the derivatives of this function of time; {cure}, {_SAMPLES}.")


def no_branch() -> TypeError:
    """The error for `if t > 1:` and its kin."""
    return TypeError(
        "a condition on the time holds at some samples and not at others, so `if`, `while`, `and`, `or`, "
        "`not`, `1 < t < 2`, min() and max() cannot follow it; use np.where(t > 1, a, b) with `&`, `|`, `~`, "
        "or np.minimum and np.maximum."
    )


def single_sample(index: Any) -> TypeError:
    """The error for t[0], t[1:] and loops over samples."""
    return TypeError(
        f"t[{_spell(index)}] depends on which times are asked for, not on the time alone; write the number "
        "itself (a start time, say), or select with a condition, t[t > 1]."
    )


def taken_as_plain_array(place: str = "") -> TypeError:
    """The error for np.asarray(t), calculating with np.array([x, y, z]), and x[:] = t on a plain array.

    place : where in the user's code, in brackets.
    """
    what = (
        "np.asarray(t), np.array([x, y, z]) before a calculation, np.vectorize, or assigning to a plain array"
    )
    return loses_derivatives(
        what, f"use t as it is, np.stack([x, y, z], axis=-1), or begin with np.zeros_like(t){place}"
    )


def not_of_time_alone(time: float) -> ValueError:
    """The error for a function whose value depends on the other times it is evaluated at."""
    return ValueError(
        f"the function's value at t = {time:.9g} s changes with the other times asked for along with it; a "
        "trajectory is a function of the time alone (no sums over samples, no len(t), no arrays of samples, "
        "no random numbers)."
    )


def _spell(index: Any) -> str:
    if isinstance(index, slice):
        parts = [index.start, index.stop] + ([] if index.step is None else [index.step])
        return ":".join("" if part is None else str(part) for part in parts)
    return str(index) if isinstance(index, int | np.integer | str) else "..."


def public_name(function: Any) -> str:
    """The name a user knows a function by: np.sin, np.linalg.norm; foreign ufuncs show no module."""
    name = str(getattr(function, "__name__", function))
    if isinstance(function, np.ufunc):
        return f"np.{name}" if getattr(np, name, None) is function else name
    module = str(getattr(function, "__module__", None) or "numpy")
    return module.replace("numpy", "np", 1) + "." + name
