"""Turns recordings and the attitude estimated of them, block by block, into rows of a table with its totals."""

from __future__ import annotations

import math
from argparse import Namespace
from collections.abc import Iterable, Iterator, Sequence
from operator import itemgetter
from pathlib import Path
from typing import Any

import numpy as np

from kreisel.cli.batch import SHOWN
from kreisel.cli.reports import described_by
from kreisel.data.attitude import AttitudeHistory
from kreisel.data.median import RunningMedian
from kreisel.data.recording import ImuRecording

_SHARES = ("rest", "disturbed", "held")

_HEADER = ("recording", "samples", "span, s", "rate, Hz", "at rest", "disturbed", "held", "gyro bias, deg/s")


class Found:
    """What the summary tells of a recording, gathered from its blocks."""

    def __init__(self) -> None:
        self._samples, self._first, self._last = 0, 0.0, np.empty(0)
        self._steps = RunningMedian()
        self._magnetometer = self._is_trial = False
        self._flags = dict.fromkeys(("rest", "disturbed", "held"), 0)
        self._bias: list[float] | None = None

    def take(self, block: ImuRecording, is_trial: bool) -> None:
        """Take in what was read."""
        self._first = self._first if self._samples else float(block.t[0])
        self._samples += len(block)
        self._steps.add(np.diff(block.t, prepend=self._last))
        self._last = block.t[-1:]
        self._magnetometer, self._is_trial = block.mag_uT is not None, is_trial

    def of(self, attitudes: Iterable[AttitudeHistory]) -> Iterator[AttitudeHistory]:
        """The same blocks, of which is taken in what was estimated."""
        for block in attitudes:
            for name in self._flags:
                self._flags[name] += int(np.count_nonzero(getattr(block, name)))
            self._bias = None if block.gyro_bias is None else np.degrees(block.gyro_bias[-1]).tolist()
            yield block

    @property
    def described(self) -> str:
        """What was read, in a few words."""
        return described_by(ImuRecording.__name__, self._samples, float(self._last[0] - self._first))

    def summary(self) -> dict[str, Any]:
        """Everything, for people and programs."""
        return {
            "samples": self._samples,
            "span_s": float(self._last[0] - self._first),
            "rate_hz": 1.0 / self._steps.value() if self._samples > 1 else None,
            "magnetometer": self._magnetometer,
            **{f"{name}_share": count / self._samples for name, count in self._flags.items()},
            "gyro_bias_deg_s": self._bias,
            "has_reference": self._is_trial,
        }


def table_of(args: Namespace, files: Sequence[dict[str, Any]]) -> list[str]:
    """The summary of what was estimated of `files`, the first of them one by one, with what to do next."""
    from kreisel.cli.tables import plain

    north = "true" if args.declination_deg is not None else "magnetic"
    tuning = "".join(f", {pair}" for pair in args.set)
    smooth = ", smoothed" if args.smooth else ""
    lines = [f"{args.filter}, mode {args.mode or 'auto'}{smooth}{tuning}; north is {north} north", ""]
    feet = [_total(files), _worst(files)] if len(files) > 1 else []
    lines += [*plain(_HEADER, [_row(file) for file in files[:SHOWN]], feet), ""]
    if len(files) > SHOWN:
        lines.append(f"shown: the first {SHOWN} of {len(files)}; --json has all")
    lines += _extremes(files) if len(files) > 1 else []
    if args.output is None:
        lines.append("nothing written: -o attitude.tum keeps the attitude")
    else:
        lines.append(
            f"written: {f'{len(files)} files in {args.output}' if len(files) > 1 else files[0]['output']}"
        )
    return [*lines, "next: " + (_next(files[0]) if len(files) == 1 else _next_of_several(args, files))]


def _row(file: dict[str, Any]) -> list[str]:
    rate, bias = file["rate_hz"], file["gyro_bias_deg_s"]
    return [
        file["file"],
        str(file["samples"]),
        f"{file['span_s']:.4g}",
        "-" if rate is None else f"{rate:.4g}",
        *(_percent(_share(file, name)) for name in _SHARES),
        "-" if bias is None else " ".join(f"{x:+.3f}" for x in bias),
    ]


def _share(file: dict[str, Any], name: str) -> float | None:
    """Without a magnetometer nobody knows what was disturbed."""
    known = name != "disturbed" or file["magnetometer"]
    return float(file[f"{name}_share"]) if known else None


def _percent(share: float | None) -> str:
    return "-" if share is None else f"{100.0 * share:.3g} %"


def _total(files: Sequence[dict[str, Any]]) -> list[str]:
    samples, span = sum(file["samples"] for file in files), math.fsum(file["span_s"] for file in files)
    return [
        f"all {len(files)}",
        str(samples),
        f"{span:.4g}",
        "",
        *(_percent(_mean(files, n)) for n in _SHARES),
        "",
    ]


def _mean(files: Sequence[dict[str, Any]], name: str) -> float | None:
    """The share of all samples of the files that tell it."""
    known = [(share, file["samples"]) for file in files if (share := _share(file, name)) is not None]
    whole = sum(samples for _, samples in known)
    return math.fsum(share * samples for share, samples in known) / whole if whole else None


def _worst(files: Sequence[dict[str, Any]]) -> list[str]:
    """The least or most of each column, whichever is worse for an attitude."""
    rates = [file["rate_hz"] for file in files if file["rate_hz"] is not None]
    most = [_percent(_share(file, name) if (file := _most(files, name)) else None) for name in _SHARES[1:]]
    biased = _most_biased(files)
    return [
        "worst",
        str(min(file["samples"] for file in files)),
        f"{min(file['span_s'] for file in files):.4g}",
        f"{min(rates):.4g}" if rates else "-",
        _percent(min(file["rest_share"] for file in files)),
        *most,
        _row(biased)[-1] if biased else "-",
    ]


def _extremes(files: Sequence[dict[str, Any]]) -> list[str]:
    """Which recordings to look at first."""
    found = {f"most {name}": _most(files, name) for name in _SHARES[1:]} | {
        "largest bias": _most_biased(files)
    }
    return [f"{what}: {file['file']}" for what, file in found.items() if file is not None]


def _most(files: Sequence[dict[str, Any]], name: str) -> dict[str, Any] | None:
    """The first file that has the largest share above none."""
    shares = [(_share(file, name) or 0.0, file) for file in files]
    share, file = max(shares, key=itemgetter(0))
    return file if share else None


def _most_biased(files: Sequence[dict[str, Any]]) -> dict[str, Any] | None:
    known = [file for file in files if file["gyro_bias_deg_s"] is not None]
    return max(known, key=lambda file: math.hypot(*file["gyro_bias_deg_s"]), default=None)


def _next(file: dict[str, Any]) -> str:
    truth = file["file"] if file["has_reference"] else "TRUTH"
    return f"kreisel evaluate {truth} {file['output'] or 'attitude.tum'} -o report/"


def _next_of_several(args: Namespace, files: Sequence[dict[str, Any]]) -> str:
    place = Path(args.output or "attitudes")
    suffix = Path(files[0]["output"] or ".tum").suffix
    return f"kreisel evaluate TRUTHS/ '{place / '**' / f'*{suffix}'}' -o report/"
