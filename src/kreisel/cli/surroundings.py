"""Turns the options that name a place and a date into the environment there, and an environment into a line of text."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from typing import TYPE_CHECKING

import numpy as np

from kreisel.cli.values import UsageError, as_typed
from kreisel.data.environment import Environment

if TYPE_CHECKING:
    from kreisel.study.scenario import Scenario


def add_place_arguments(parser: ArgumentParser, dated: bool = True) -> None:
    """--place, --date (where `dated`: it gives a magnetic field) and --turning."""
    parser.add_argument(
        "--place",
        metavar="LAT,LON[,HEIGHT]",
        help="where on the Earth the origin is, in deg (north and east positive) and m: gives gravity; in the south "
        "written with =, as in --place=-33.9,18.4",
    )
    parser.set_defaults(date=None)
    if dated:
        parser.add_argument(
            "--date",
            metavar="YYYY-MM-DD",
            help="the day, for the magnetic field at --place: the IMUs get magnetometers",
        )
    parser.add_argument(
        "--turning",
        action="store_true",
        help="the Earth turns: its rate in the gyroscopes, Coriolis in the accelerometers (default: it rests)",
    )


def environment_at(args: Namespace) -> Environment:
    """The environment that --place, --date and --turning describe; standard gravity alone without them."""
    from kreisel.study.building import surroundings
    from kreisel.study.scenario import EnvironmentRecipe
    from kreisel.study.signature import Place

    if args.place is None:
        for option in ("date", "turning"):
            if getattr(args, option):
                raise UsageError(f"--{option} says nothing without a place; give --place LAT,LON too.")
        return Environment()
    latitude, longitude, *height = parse_place(args.place)
    with as_typed():
        recipe = EnvironmentRecipe(
            latitude_deg=latitude,
            longitude_deg=longitude,
            height_m=height[0] if height else 0.0,
            date=args.date,
            turning=args.turning,
        )
        return surroundings(recipe, Place("--place"))


def parse_place(text: str) -> list[float]:
    """Two or three numbers of "LAT,LON[,HEIGHT]"."""
    try:
        numbers = [float(part) for part in text.split(",")]
    except ValueError:
        numbers = []
    if len(numbers) not in (2, 3):
        raise UsageError(f"--place takes LAT,LON or LAT,LON,HEIGHT, such as 48.14,11.58,520; got {text!r}.")
    return numbers


def describe_place(latitude_deg: float, longitude_deg: float, height_m: float) -> str:
    """Latitude, longitude and height as an atlas has them: "33.9 S, 18.4 E, 12 m"."""
    north, east = "S" if latitude_deg < 0.0 else "N", "W" if longitude_deg < 0.0 else "E"
    return f"{abs(latitude_deg):g} {north}, {abs(longitude_deg):g} {east}, {height_m:g} m"


def describe_gravity(environment: Environment) -> str:
    """Gravity, and how fast N turns, if it does."""
    gravity = f"gravity {np.linalg.norm(environment.g_N):.6g} m/s^2"
    rate = float(np.rad2deg(np.linalg.norm(environment.omega_IN_N))) * 3600.0
    return f"{gravity}; N turns with the Earth, {rate:.4g} deg/h" if rate else gravity


def describe_field(field_N_uT: np.ndarray) -> str:
    """Strength and dip of a magnetic field in N."""
    dip = np.rad2deg(np.arctan2(-field_N_uT[2], np.hypot(*field_N_uT[:2])))
    return f"magnetic field {np.linalg.norm(field_N_uT):.4g} uT, dip {dip:.1f} deg"


def describe_declination(environment: Environment) -> str:
    """Which way magnetic north lies of true north, and how filters hear of it."""
    if environment.declination is None:
        return "no declination, as the field is vertical"
    degrees = float(np.rad2deg(environment.declination))
    told = f"tell filters by --declination-deg{'=' if degrees < 0.0 else ' '}{degrees:.2f}"
    return f"declination {abs(degrees):.2f} deg {'west' if degrees < 0.0 else 'east'} of true north ({told})"


def describe_free_heading(scenario: Scenario) -> list[str]:
    """A line where a filter cannot know north and its errors count as if it could."""
    from kreisel.study.building import surroundings

    lost = [each.name for each in scenario.filters if each.align is None and each.start_error_deg is None]
    if not lost or surroundings(scenario.environment).field_N_uT is not None:
        return []
    return [
        f"no magnetic field, so that nothing tells {', '.join(lost)} where north is: "
        'align = "heading" in its table leaves the constant part out of its errors'
    ]
