"""Turns RGB frames into a GIF whose frames share one palette, without dithering.

Dithering would turn flat areas into noise that moves from frame to frame and that compresses badly. Drawn
frames have few colours: the most frequent ones are taken as they are and the rest go to the nearest of them.
Pixels that did not change are written as transparent.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any, BinaryIO

import numpy as np
import numpy.typing as npt

Bytes = npt.NDArray[np.uint8]

# Light grey panels and white paper still differ in six bits; eight would take a table of 16 million.
_DROPPED_BITS = 2
_COLOURS = 255
_UNCHANGED = 255  # the index after the last colour


def write_gif(out: BinaryIO, frames: Iterable[Bytes], palette: Bytes, delay_cs: int) -> None:
    """Write `frames`, each (height, width, 3), shown for `delay_cs` hundredths of a second, over and over."""
    from PIL import Image

    table = np.zeros((256, 3), dtype=np.uint8)
    table[: len(palette)] = palette

    def pictures() -> Iterator[Image.Image]:
        for indices in _changes(frames, palette):
            picture = Image.fromarray(indices)
            picture.putpalette(table.tobytes())
            yield picture

    stream = pictures()
    next(stream).save(
        out,
        format="GIF",
        save_all=True,
        append_images=stream,
        duration=10 * delay_cs,
        loop=0,
        disposal=1,
        transparency=_UNCHANGED,
        palette=table.tobytes(),
        optimize=False,
    )


def shared_palette(samples: Sequence[Bytes], always: Sequence[str] = ()) -> Bytes:
    """The colours (k, 3) to keep: those of `always` ("#rrggbb"), then the most frequent of `samples`.

    Colours that share their upper six bits count as one, so that the shades along an edge do not crowd
    out a small but different patch.
    """
    named = np.array([[int(c[i : i + 2], 16) for i in (1, 3, 5)] for c in always], dtype=np.uint8)
    seen = np.concatenate([_packed(sample).ravel() for sample in samples])
    colours, counts = np.unique(seen, return_counts=True)
    colours = colours[np.argsort(-counts, kind="stable")]
    frequent = np.stack([colours >> 16, colours >> 8 & 255, colours & 255], axis=1).astype(np.uint8)
    candidates = np.concatenate([named.reshape(-1, 3), frequent])
    _, first = np.unique(_packed(candidates >> _DROPPED_BITS), return_index=True)
    return np.asarray(candidates[np.sort(first)[:_COLOURS]])


def _changes(frames: Iterable[Bytes], palette: Bytes) -> Iterator[Bytes]:
    """Palette indices (height, width) of each frame, `_UNCHANGED` where the frame before had the same."""
    nearest = _nearest(palette)
    shown: Bytes | None = None
    for frame in frames:
        indices = nearest[_packed(frame >> _DROPPED_BITS, 6)]
        yield indices if shown is None else np.where(indices == shown, np.uint8(_UNCHANGED), indices)
        shown = indices


def _nearest(palette: Bytes) -> Bytes:
    """Index of the nearest colour of `palette` for every colour of six bits a channel (262144,)."""
    from scipy.spatial import cKDTree

    level = np.arange(64)
    grid = np.stack(np.meshgrid(level, level, level, indexing="ij"), axis=-1).reshape(-1, 3) * 4.0 + 1.5
    indices = cKDTree(palette.astype(float)).query(grid)[1].astype(np.uint8)
    # A colour of the palette is itself, however the middle of its cell lies.
    indices[_packed(palette[::-1] >> _DROPPED_BITS, 6)] = np.arange(len(palette), dtype=np.uint8)[::-1]
    return indices


def _packed(rgb: npt.NDArray[np.integer[Any]], bits: int = 8) -> npt.NDArray[np.intp]:
    """One integer for each colour of `rgb` (..., 3)."""
    r, g, b = np.moveaxis(rgb.astype(np.intp), -1, 0)
    return np.asarray(r << 2 * bits | g << bits | b)
