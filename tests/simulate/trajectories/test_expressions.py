"""Formulas as text: the same numbers as functions written with NumPy, and nothing but formulas."""

from __future__ import annotations

import string
import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kreisel.simulate.trajectories.expressions import expressions
from kreisel.simulate.trajectories.functions import FunctionTrajectory
from kreisel.simulate.vocabulary import FUNCTIONS

T = np.linspace(0.1, 0.9, 41)


def along_x(text, **parameters):
    """A trajectory whose x is the formula, with an attitude of its own."""
    return expressions([text, 0, "0"], ["0", 0.0, "0.1*t"], parameters)


def x_of(trajectory, t=T):
    """Position, velocity and acceleration along x (3, n)."""
    motion = trajectory.sample(t)
    return np.stack([motion.p_NB[:, 0], motion.v_NB[:, 0], motion.a_NB[:, 0]])


def test_figure_1_equals_the_functions_it_spells():
    spelt = expressions(
        ["0.8*cos(2*pi*f*t)", "0.8*sin(2*pi*f*t)", "0.3*cos(2*pi*3*f*t)"], parameters={"f": 1.0}
    )
    written = FunctionTrajectory(
        (
            lambda t: 0.8 * np.cos(2 * np.pi * 1.0 * t),
            lambda t: 0.8 * np.sin(2 * np.pi * 1.0 * t),
            lambda t: 0.3 * np.cos(2 * np.pi * 3 * 1.0 * t),
        )
    )
    t = np.arange(200) / 200.0
    ours, theirs = spelt.sample(t), written.sample(t)
    for name in ("p_NB", "v_NB", "a_NB", "R_NB", "omega_NB_B", "alpha_NB_B"):
        # The same NumPy calls on the same numbers: the same bits.
        assert getattr(ours, name).tobytes() == getattr(theirs, name).tobytes(), name


# Arguments between 0.1 and 0.9, where every function is smooth.
CALLS = {1: "t", 2: "t, 0.37", 3: "t, 0.2, 0.7"}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_every_function_has_its_derivatives(name):
    function, count = FUNCTIONS[name]
    text, shift, step = CALLS[count], 0.0, 1e-4
    if name == "interp":
        text = "t, [0, 1/2, 2], [0, 3, -1]"
    if name in ("arccosh", "acosh"):
        text, shift = "1.2 + t", 1.2
    value, slope, bend = x_of(along_x(f"{name}({text})"))

    def plain(t):
        if name == "interp":
            return np.interp(t, [0, 0.5, 2], [0, 3, -1])
        return function(t + shift, *(float(a) for a in text.split(",")[1:]))

    np.testing.assert_allclose(value, plain(T), rtol=1e-15, atol=1e-15)
    # Central differences: h^2 f''' / 6 and h^2 f'''' / 12 with derivatives up to 1e4 at 0.1, round-off
    # eps / h^2; samples within a step of a kink are left out.
    before, after = plain(T - step), plain(T + step)
    smooth = np.abs(bend) < 1e3
    for kink in (0.2, 0.37, 0.5, 0.7, 0.74):
        smooth &= np.abs(T - kink) > 2 * step
    np.testing.assert_allclose(slope[smooth], ((after - before) / (2 * step))[smooth], rtol=1e-4, atol=1e-6)
    np.testing.assert_allclose(
        bend[smooth], ((after - 2 * plain(T) + before) / step**2)[smooth], rtol=1e-3, atol=1e-5
    )


@pytest.mark.parametrize(
    ("text", "function"),
    [
        ("t if t > 0.5 else 1 - t", lambda t: np.where(t > 0.5, t, 1 - t)),
        ("where(0.2 < t < 0.4, t**2, 0)", lambda t: np.where((t > 0.2) & (t < 0.4), t**2, 0.0)),
        ("(t > 0.3) + (t > 0.6)", lambda t: (t > 0.3) * 1.0 + (t > 0.6) * 1.0),
        ("-(t >= 0.5) - (t <= 0.2)", lambda t: -((t >= 0.5) * 1.0) - (t <= 0.2)),
        ("t*(not t > 0.5 or t == 0.9)", lambda t: t * ((t <= 0.5) | (t == 0.9))),
        ("t != 0.5 and 2", lambda t: (t != 0.5) * 1.0),
        ("7.5*t // 2 + 7.5*t % 2", lambda t: 7.5 * t // 2 + 7.5 * t % 2),
        ("-2**2 + +t", lambda t: -4.0 + t),
        ("2**-t / e", lambda t: 2.0**-t / np.e),
        ("(t - 0.5)**3", lambda t: (t - 0.5) ** 3),
        ("\n  pi\t* t\n", lambda t: np.pi * t),
        ("1_000e-3 * t + 0x10 + .5", lambda t: t + 16.5),
        ("clip(t, 0.3 + 0*t, 0.6)", lambda t: np.clip(t, 0.3, 0.6)),
        ("interp(0.25, [0, 1], (0, 2)) * t", lambda t: 0.5 * t),
        ("+".join(["t/90"] * 90), lambda t: t),
    ],
)
def test_syntax_means_what_it_means_in_python(text, function):
    value = x_of(along_x(text))[0]
    # A few roundings of numbers of order one.
    np.testing.assert_allclose(value, function(T), rtol=0, atol=2e-14)


def test_pieces_are_differentiated_as_pieces():
    _, v, a = x_of(along_x("t**2 if t < 0.5 else t - 0.25"))
    np.testing.assert_allclose(v, np.where(T < 0.5, 2 * T, 1.0), rtol=1e-15)
    np.testing.assert_allclose(a, np.where(T < 0.5, 2.0, 0.0), rtol=1e-15)


def test_orientation_and_span():
    turning = expressions([0, 0, 0], ["0", "0", "w*t"], {"w": 0.3}, span=[0, 2])
    motion = turning.sample(T)
    np.testing.assert_allclose(motion.omega_NB_B, np.tile([0, 0, 0.3], (len(T), 1)), atol=1e-15)
    assert turning.span == (0.0, 2.0)
    with pytest.raises(ValueError, match="inside the span"):
        turning.sample(np.array([3.0]))
    with pytest.raises(ValueError, match="Did you mean 'tangent'"):
        expressions(["t", 0, 0], "tangnt")


HOSTILE = [
    ('__import__("os").system("x")', "column 12"),
    ("__import__(t)", "unknown function '__import__'"),
    ("t.__class__", "a dot after a name"),
    ("(1).__class__.__bases__[0]", "an index"),
    ("t[0]", "an index"),
    ("lambda: t", "column 7"),
    ("[t for t in t]", "listcomp"),
    ("sum(x for x in t)", "unknown function 'sum'"),
    ("f'{t}'", 'character "\'"'),
    ("9**9**9**9", "column 4"),
    ("2**2**2**2**2**2", "not a finite number"),
    ("9" * 3999, "too large"),
    ("1" + "0" * 400, "too large"),
    ("0x" + "f" * 1000, "too large"),
    ("(" * 3999, "column 51"),
    ("sin(" * 60 + "t" + ")" * 60, "more than 50 brackets"),
    ("-" * 3990 + "t", "deep"),
    ("not " * 900 + "t", "deep"),
    ("1**" * 1300 + "t", "deep"),
    ("t if t else " * 300 + "t", "deep"),
    ("t+" * 1900 + "t", "100 levels"),
    ("t" * 1_000_000, "at most 4000 characters"),
    ("t\x00", "column 2"),
    ("t\ud800", "column 2"),
    ("t\x1b[2J", "column 2"),
    ("𝕤in(t)", "column 1"),
    ("(x := 9)", "column 4"),
    ("t @ t", "column 3"),
    ("t << 9999999999", "no place in a formula"),
    ("sin(*[t])", "a star before an argument"),
    ("sin(**t)", "without names"),
    ("sin(x=t)", "without names"),
    ("sin(t)(t)", "only functions by name"),
    ("np.sin(t)", r"write sin\(...\)"),
    ("await t", "no place"),
    ("t in t", "compare"),
    ("t is t", "compare"),
    ("1j*t", "not a real number"),
    ("None", "not a real number"),
    ("True*t", "not a real number"),
    ("...", "not a real number"),
    ("1/0", "is inf"),
    ("where(t > 1, 0/0, t)", "column 14.*is nan"),
    ("1e999", "is inf"),
    ("sqrt(-1)", "is nan"),
    ("", "empty"),
    (" \n", "empty"),
    ("sin", "is a function"),
    ("sin(t", "not how a formula is written"),
    ("2t", "not how a formula is written"),
    ("t^2", r"write \*\*"),
    ("t > 0 & t < 1", "write `and`"),
    ("cso(t)", "did you mean 'cos'"),
    ("amplitud*t", "column 1, .*did you mean 'amplitude'"),
    ("  3*q", "column 5, .*known are t, pi, e, amplitude"),
    ("sin(t, t)", "takes 1 argument; it has 2"),
    ("min(t)", "takes 2 arguments"),
    ("interp(t, [0, 1], [1])", "same length"),
    ("interp(t, [0, 0], [1, 2])", "must increase"),
    ("interp(t, [0, t], [1, 2])", "do not depend on t"),
    ("interp(t, t, t)", "lists of numbers"),
    ("t, t", "a comma"),
]


@pytest.mark.parametrize(("text", "message"), HOSTILE, ids=[text[:24] for text, _ in HOSTILE])
def test_what_is_no_formula_is_refused_at_once(text, message):
    started = time.perf_counter()
    with pytest.raises(ValueError, match=message) as caught:
        along_x(text, amplitude=1.0)
    # Milliseconds; the bound leaves room for a machine that is busy.
    assert time.perf_counter() - started < 0.5
    told = str(caught.value)
    assert told.startswith("position[0], ")
    assert told.isprintable()
    assert len(told) < 200


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (dict(position="t"), "position must be three formulas"),
        (dict(position=["t", "t"]), "three formulas.*got 2"),
        (dict(position=[["t"], 0, 0]), r"position\[0\] must be a number"),
        (dict(position=[float("nan"), 0, 0]), "finite"),
        (dict(position=[10**400, 0, 0]), "too large"),
        (
            dict(position=[0, 0, 0], orientation=["0", "sine(t)", "0"]),
            r"orientation\[1\], .*did you mean 'sin'",
        ),
        (dict(position=[0, 0, 0], parameters={"t": 1.0}), "has the name of something"),
        (dict(position=[0, 0, 0], parameters={"sin": 1.0}), "has the name of something"),
        (dict(position=[0, 0, 0], parameters={"a b": 1.0}), "names like"),
        (dict(position=[0, 0, 0], parameters={"if": 1.0}), "names like"),
        (dict(position=[0, 0, 0], parameters={"a": "1"}), "parameter 'a' must be a number"),
        (dict(position=[0, 0, 0], parameters={"a": True}), "must be a number"),
        (dict(position=[0, 0, 0], span=[0]), "span"),
    ],
)
def test_arguments_are_checked(arguments, message):
    with pytest.raises(ValueError, match=message):
        expressions(**arguments)


PIECES = [
    *FUNCTIONS,
    *string.ascii_letters,
    *"0123456789",
    *"()[]+-*/%<>=!.,_ ",
    "**",
    "//",
    "9**9",
    "t",
    "pi",
    "e",
]
PIECES += [" if ", " else ", " and ", " or ", "not ", " for ", " in ", "lambda ", "__import__", "1e308", "=="]


def only_value_errors(text: str) -> None:
    """Read and sample `text`; anything but success or a ValueError of one line fails the test."""
    try:
        along_x(text, f=2.0).sample(T)
    except ValueError as error:
        assert "\n" not in str(error)


@settings(max_examples=300)
@given(st.text(max_size=60) | st.lists(st.sampled_from(PIECES), max_size=40).map("".join))
def test_any_text_at_all_is_a_formula_or_a_value_error(text):
    only_value_errors(text)


def formulas() -> st.SearchStrategy[str]:
    """Texts that are well formed, whatever they mean."""
    leaves = st.sampled_from(["t", "f", "pi", "0", "1", "2.5", "1e-9", "1e300"])
    joined = (
        "{}+{}",
        "{}-{}",
        "{}*({})",
        "({})/({})",
        "({})//{}",
        "({})%{}",
        "({})**({})",
        "{}<{}",
        "({}) and {}",
    )
    shapes = st.sampled_from(
        [*joined, "{} if {} else 1", *(f"{n}({{}})" for n, (_, k) in FUNCTIONS.items() if k == 1)]
    )
    twos = [f"{name}({{}},{{}})" for name, (_, count) in FUNCTIONS.items() if count == 2]
    shapes |= st.sampled_from([*twos, "where({},{},t)", "clip({},0,{})", "interp({},[0,1],[{},2])", "not {}"])
    return st.recursive(
        leaves,
        lambda inner: st.builds(lambda shape, a, b: shape.format(a, b), shapes, inner, inner),
        max_leaves=12,
    )


@settings(max_examples=300)
@given(formulas())
def test_well_formed_formulas_are_sampled_or_refused_in_a_sentence(text):
    only_value_errors(text)
