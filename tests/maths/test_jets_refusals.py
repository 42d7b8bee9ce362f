"""Nothing loses derivatives in silence: each way to do so ends in an error that names it and the cure."""

import cmath
import math
from typing import Any

import numpy as np
import pytest
import scipy.interpolate
import scipy.signal
import scipy.special

from kreisel.maths.jets import Jet, differentiate

T = np.linspace(0.0, 2.0, 12)
SAMPLES = np.sin(T)


def _into_plain_array(t: Any) -> Any:
    x = np.zeros(len(t))
    x[:] = np.sin(t)
    return x


def _into_plain_selection(t: Any) -> Any:
    x = np.zeros(len(t))
    x[t > 1] = t[t > 1] ** 2
    return x


def _in_place(t: Any) -> Any:
    x = np.zeros(len(t))
    x += np.sin(t)
    return x


def _branch(t: Any) -> Any:
    if t > 1:
        return t
    return 0 * t


ARRAY = r"np\.asarray\(t\).*np\.vectorize.*plain array.*np\.stack.*np\.zeros_like"

LOSSES: list[tuple[Any, str]] = [
    # conversions
    (lambda t: float(t), r"float\(t\).*np\.sin for math\.sin"),
    (lambda t: math.sin(t), r"`math`.*np\.sin for math\.sin"),
    (lambda t: math.floor(t), "`math`"),
    (lambda t: cmath.exp(1j * cmath.phase(t)), "`cmath`"),
    (lambda t: int(t), r"int\(t\).*np\.floor"),
    (lambda t: [1, 2, 3][t], r"table\[t\].*np\.interp"),
    (lambda t: np.asarray(t), ARRAY),
    (lambda t: np.asarray(t)[0], ARRAY),
    (lambda t: np.asarray(t).item(), ARRAY),
    (lambda t: np.asarray(t, dtype=float), ARRAY),
    (lambda t: np.array(t, float), ARRAY),
    (lambda t: np.float64(t), ARRAY),
    (lambda t: np.sin(np.asarray(t)), ARRAY),
    (lambda t: 2 * np.asarray(t), ARRAY),
    (lambda t: t - np.asarray(t).max(), ARRAY),
    (lambda t: t * np.asarray(t), ARRAY),
    (lambda t: np.asarray(t).astype(float), ARRAY),
    (lambda t: np.array([t, t, t]) * 2, ARRAY),
    (lambda t: np.array([t, t, t]).T - np.array([t, t, t]).T[0], ARRAY),
    (lambda t: np.array([t, t, 1.0]), ARRAY),
    (lambda t: np.array([t, t, np.zeros(len(t) + 1)]), ARRAY),
    (lambda t: np.polyval([t, t], 2.0), r"^np\.polyval takes t"),
    (lambda t: scipy.interpolate.CubicSpline(T, SAMPLES)(t), r"^scipy\.interpolate\.CubicSpline takes t"),
    (lambda t: np.polynomial.Polynomial([1, 2])(t), r"Polynomial takes t"),
    (np.vectorize(lambda x: 2 * x), ARRAY),
    (_into_plain_array, ARRAY),
    (_into_plain_selection, ARRAY),
    (lambda t: t.astype(float), r"t\.astype"),
    (lambda t: (t > 1).astype(str), r"t\.astype"),
    (lambda t: t.tolist(), r"t\.tolist"),
    (lambda t: t.flat[0], r"t\.flat"),
    (np.frompyfunc(lambda x: 2 * x, 1, 1), "no derivative rule"),
    (_in_place, r"np\.add with out=.*x = x \+"),
    (lambda t: np.sin(t, where=t > 1), r"np\.sin with out="),
    (lambda t: np.sin(t, dtype=np.float32), r"np\.sin with out="),
    # branches
    (_branch, r"np\.where\(t > 1, a, b\)"),
    (lambda t: t if 0 < t < 1 else 1.0, r"np\.where\(t > 1, a, b\)"),
    (lambda t: max(t, 1.0), r"np\.maximum"),
    (lambda t: t if not (t > 1) else 1.0, r"np\.where\(t > 1, a, b\)"),
    (lambda t: (t > 0 and t < 1) * t, r"`&`"),
    (lambda t: t if np.any(t > 1) else 0.0, r"np\.any.*np\.where"),
    (lambda t: t if (t > 1).all() else 0.0, r"np\.all.*np\.where"),
    # single samples
    (lambda t: t - t[0], r"t\[0\].*times are asked for"),
    (lambda t: t[-1] - t, r"t\[-1\].*times are asked for"),
    (lambda t: t[1:], r"t\[1:\]"),
    (lambda t: t[np.array([0, 1])], r"t\[...\]"),
    (lambda t: [math.sin(x) for x in t], r"t\[i\]"),
    (lambda t: 1.0 if 0.5 in t else 0.0, r"np\.where"),
    # functions of samples, and functions without a rule
    *(
        (lambda t, f=f: getattr(np, f)(t), rf"np\.{f} has no derivative rule.*times are asked for")
        for f in ("cumsum", "gradient", "diff", "max", "min", "sort", "median", "flip", "std", "unwrap")
    ),
    (lambda t: t.max(), r"np\.max has no derivative rule.*np\.maximum"),
    (lambda t: t.sum(), r"np\.sum over the samples"),
    (lambda t: np.mean(t), r"np\.mean over the samples"),
    (lambda t: np.add.reduce(t), r"np\.add\.reduce has no derivative rule"),
    (lambda t: np.nan_to_num(np.sin(t) / t), r"np\.nan_to_num.*np\.where"),
    (lambda t: np.nansum(np.stack([t, t]), axis=0), r"np\.nansum.*np\.sum"),
    (lambda t: np.prod(np.stack([t, t]), axis=0), r"np\.prod.*with \*"),
    (lambda t: np.logaddexp2(t, 1), r"np\.logaddexp2.*np\.logaddexp"),
    (lambda t: np.i0(t), r"np\.i0 has no derivative rule.*SampledTrajectory"),
    (lambda t: np.fft.fft(t), r"np\.fft\.fft"),
    (lambda t: np.where(t > 1), r"np\.where with a condition alone"),
    (lambda t: np.interp(0.5, t, t), r"np\.interp with a table"),
    (lambda t: np.linalg.norm(np.stack([t, t])), r"np\.linalg\.norm without axis"),
    (lambda t: np.einsum("i,i,i->i", t, t, t), r"np\.einsum of more than two"),
    (lambda t: scipy.special.j0(t), "j0 has no derivative rule"),
    # wrong answers
    (lambda t: None, "return"),
    (lambda t: "sin(t)", "str 'sin"),
    (lambda t: t + "1", "str '1'"),
    (lambda t: np.exp(1j * t), r"complex.*\.real"),
]


@pytest.mark.parametrize("k", range(len(LOSSES)))
@pytest.mark.parametrize("n", [1, 12])
def test_what_would_lose_derivatives_is_refused(k: int, n: int) -> None:
    function, message = LOSSES[k]
    with pytest.raises(TypeError, match=message):
        differentiate(function, T[:n], 2)


@pytest.mark.parametrize(
    "function",
    [
        lambda t: SAMPLES,
        lambda t: (t, t, SAMPLES),
        lambda t: np.linspace(0, 1, len(t)),
        lambda t: np.random.default_rng(1).random((len(t), 3)),
        lambda t: np.random.default_rng(1).random((3, len(t))),
    ],
)
def test_samples_are_refused(function: Any) -> None:
    with pytest.raises(TypeError, match=r"change from sample to sample.*SampledTrajectory"):
        differentiate(function, T, 2)


GENERATOR = np.random.default_rng(20)


@pytest.mark.parametrize(
    "function",
    [
        lambda t: t * np.linspace(0, 1, len(t)),
        lambda t: np.sin(t) + SAMPLES,
        lambda t: np.sin(t) + GENERATOR.random(),
        lambda t: t / len(t),
        lambda t: np.stack([t, t, t], -1) - np.stack([t, t, t], -1)[0],
        lambda t: np.sum(np.stack([t, t, t], -1), axis=0),
        lambda t: t * np.asarray(t > 0.5).mean(),
        lambda t: t if len(t) > 5 else (t, t, t),
    ],
)
def test_a_function_of_more_than_the_time_is_refused(function: Any) -> None:
    with pytest.raises(
        ValueError, match=r"value at t = 1\.09.* s changes with the other times|must return \(12,\)"
    ):
        differentiate(function, T, 2)


@pytest.mark.parametrize(
    ("function", "t", "order", "error", "message"),
    [
        (np.sin, [[0.0, 1.0]], 1, ValueError, r"t must be \(n,\) and finite; got shape \(1, 2\)"),
        (np.sin, [0.0, np.nan], 1, ValueError, r"t must be \(n,\) and finite"),
        (np.sin, [0.0], -1, ValueError, "order must be a whole number.*-1"),
        (np.sin, [0.0], 1.5, ValueError, "order must be a whole number.*1.5"),
        (np.sin, [0.0], True, ValueError, "order must be a whole number.*True"),
        ("sin(t)", [0.0], 1, TypeError, "function must be a function of time; got str"),
        (lambda t: (t, t), [0.0], 1, ValueError, "one quantity or three; got 2"),
        (lambda t: np.stack([t, t]), [0.0, 1.0], 1, ValueError, r"must return \(2,\) or \(2, 3\)"),
        (lambda t: (t, t, np.stack([t, t])), [0.0, 1.0], 1, ValueError, r"three quantities must be \(2,\)"),
        (
            lambda t: np.select([t > 1], [t, t]),
            [0.0, 1.0],
            1,
            ValueError,
            "a choice per condition; got 1 and 2",
        ),
    ],
)
def test_wrong_arguments_and_answers(function: Any, t: Any, order: Any, error: Any, message: str) -> None:
    with pytest.raises(error, match=message):
        differentiate(function, t, order)


def test_unknown_attributes_are_unknown() -> None:
    t = Jet.variable(T, 1)
    with pytest.raises(AttributeError, match="'sine'"):
        t.sine()
    assert not hasattr(t, "__array_interface__")


def test_errors_of_the_function_itself_pass_through() -> None:
    with pytest.raises(KeyError, match="no such gait"):
        differentiate(lambda t: {}["no such gait"], T, 1)
    with pytest.raises(ValueError, match="broadcast"):
        differentiate(lambda t: t + np.zeros(5), T, 1)


def _polynomial(t: Any) -> Any:
    return np.polynomial.Polynomial([1.0, 2.0])(t)


OTHERS = {
    "scipy.interpolate.interp1d": scipy.interpolate.interp1d(T, SAMPLES),
    "scipy.interpolate.CubicSpline": scipy.interpolate.CubicSpline(T, SAMPLES),
    "scipy.interpolate.PchipInterpolator": scipy.interpolate.PchipInterpolator(T, SAMPLES),
    "scipy.signal.chirp": lambda t: scipy.signal.chirp(t, 1.0, 5.0, 2.0),
    "numpy.polynomial.polynomial.Polynomial": _polynomial,
}


@pytest.mark.parametrize("name", OTHERS)
def test_what_takes_the_time_for_an_array_is_named_with_its_line(name: str) -> None:
    def path(t: Any) -> Any:
        return 2.0 * OTHERS[name](t)

    with pytest.raises(TypeError) as refused:
        differentiate(path, T, 2)
    message = str(refused.value)
    assert message.startswith(f"{name} takes t for a plain array and would lose the derivatives")
    assert "test_jets_refusals.py, line " in message
    assert "SampledTrajectory" in message


def test_a_mistake_that_numbers_meet_as_well_stays_what_it_is() -> None:
    with pytest.raises(ValueError, match="mismatch in its core dimension"):
        differentiate(lambda t: np.matmul(t, np.ones((3, 2))), T, 2)
