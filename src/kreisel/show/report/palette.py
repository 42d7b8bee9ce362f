"""The colours of a page, light and dark, as CSS variables; the light ones are those of every other picture."""

from __future__ import annotations

from kreisel.show import body, style

_LIGHT = {
    "paper": "#F4F6F8",
    "panel": style.PAPER,
    "ink": style.INK,
    "faint": style.FAINT_INK,
    "grid": style.GRID,
    "edge": "#D4DAE0",
    "accent": style.BODY,
    "cursor": style.BODY,
    "estimate": style.XYZ[2],
    "path": style.PATH,
    "shadow": style.SHADOW,
    **dict(zip("xyz", style.XYZ, strict=True)),
    **{f"imu-{k}": colour for k, colour in enumerate(style.IMU)},
}

# Lighter twins of the same hues: each has a contrast of 4.5 or more on the dark panel.
_DARK = {
    "paper": "#0E1318",
    "panel": "#161D25",
    "ink": "#E4EAF0",
    "faint": "#9AA8B6",
    "grid": "#27313B",
    "edge": "#33404C",
    "accent": "#FF6B7D",
    "cursor": "#FF6B7D",
    "estimate": "#5DB7EE",
    "path": "#8C9BAA",
    "shadow": "#2A343E",
    "x": "#FF8A3D",
    "y": "#2BC79A",
    "z": "#5DB7EE",
    "imu-0": "#C77DFF",
    "imu-1": "#9D6BE0",
    "imu-2": "#E0AAFF",
    "imu-3": "#B4A0F0",
}

_EITHER = {
    "mass": style.MASS,
    **{f"face-{k}": colour for k, colour in enumerate(body.FACE_COLOURS)},
    "body-edge": style.BODY_BELOW,
}


def css_variables() -> str:
    """Rules that set every colour, for a root with and without data-theme="dark"."""
    return (
        f":root {{ color-scheme: light; {_declared(_LIGHT | _EITHER)} }}\n"
        f':root[data-theme="dark"] {{ color-scheme: dark; {_declared(_DARK)} }}\n'
    )


def _declared(colours: dict[str, str]) -> str:
    return " ".join(f"--{name}: {colour};" for name, colour in colours.items())
