"""Recordings larger than memory: samples a second, peak memory, and the share of reading, kernel and writing.

python benchmarks/bench_long.py fly 1e9                 generated while they are estimated, nothing kept
python benchmarks/bench_long.py disk 1e8 --folder DIR   from an NPZ file to an NPZ file; 320 bytes of disk a sample
"""

from __future__ import annotations

import argparse
import resource
import tempfile
import time
from collections import deque
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TypeVar

import numpy as np

from kreisel import DcmFilter, ImuRecording, MekfFilter, read_blocks, run_long, write_blocks

BLOCK = 1 << 17
RATE_HZ = 200.0
FILTERS = {
    "published": DcmFilter.as_published(),
    "dcm": DcmFilter(),
    "mekf": MekfFilter(),
}

Item = TypeVar("Item")


def recording(samples: int) -> Iterator[ImuRecording]:
    """A body that nods and turns, with white noise of its own in every sample; gyroscope and accelerometer."""
    rng = np.random.default_rng(1)
    for first in range(0, samples, BLOCK):
        t = np.arange(first, min(first + BLOCK, samples)) / RATE_HZ
        pitch, rate = 0.3 * np.sin(t), 0.3 * np.cos(t)
        gyro, accel = rng.standard_normal((2, len(t), 3))
        gyro *= 1e-3
        gyro[:, 1] += rate
        gyro[:, 2] += 0.2
        accel *= 0.02
        accel[:, 0] -= 9.80665 * np.sin(pitch)
        accel[:, 2] += 9.80665 * np.cos(pitch)
        yield ImuRecording(t, gyro, accel)


class Clocked:
    """Time spent in what an iterator draws from."""

    def __init__(self) -> None:
        self.seconds = 0.0

    def of(self, items: Iterable[Item]) -> Iterator[Item]:
        """The same items."""
        iterator = iter(items)
        while True:
            begin = time.perf_counter()
            item = next(iterator, None)
            self.seconds += time.perf_counter() - begin
            if item is None:
                return
            yield item


def fly(samples: int, name: str) -> None:
    """Estimate what is made on the fly."""
    making, running = Clocked(), Clocked()
    attitudes = running.of(run_long(FILTERS[name], making.of(recording(samples))))
    (last,) = deque(attitudes, maxlen=1)
    told(samples, {"making samples": making.seconds, "filter": running.seconds - making.seconds})
    print(f"attitude at {last.t[-1]:.3f} s: {np.degrees(last.euler[-1]).round(3).tolist()} deg")


def disk(samples: int, name: str, folder: Path) -> None:
    """Estimate from a file into a file, and take both away."""
    with tempfile.TemporaryDirectory(dir=folder) as place:
        source, target = Path(place) / "imu.npz", Path(place) / "attitude.npz"
        begin = time.perf_counter()
        write_blocks(source, recording(samples))
        print(
            f"written {source.stat().st_size / 1e9:.1f} GB in {time.perf_counter() - begin:.0f} s, not counted below"
        )
        reading, running = Clocked(), Clocked()
        begin = time.perf_counter()
        write_blocks(target, running.of(run_long(FILTERS[name], reading.of(read_blocks(source)))))
        whole = time.perf_counter() - begin
        kernel = running.seconds - reading.seconds
        told(samples, {"reading": reading.seconds, "filter": kernel, "writing": whole - running.seconds})
        print(f"{source.stat().st_size / 1e9:.1f} GB in, {target.stat().st_size / 1e9:.1f} GB out")


def told(samples: int, parts: dict[str, float]) -> None:
    """Print the shares."""
    whole = sum(parts.values())
    for part, seconds in parts.items():
        speed = samples / seconds / 1e6
        print(
            f"{part:15s} {seconds:8.1f} s  {100.0 * seconds / whole:4.0f} %  {speed:6.2f} million samples/s"
        )
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    print(f"{'all':15s} {whole:8.1f} s; peak resident memory {peak:.0f} MB")


def main() -> None:
    """Read the arguments, run."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("what", choices=("fly", "disk"))
    parser.add_argument("samples", type=float)
    parser.add_argument("--filter", choices=tuple(FILTERS), default="published")
    parser.add_argument("--folder", type=Path, default=Path(tempfile.gettempdir()))
    args = parser.parse_args()
    if args.what == "fly":
        fly(int(args.samples), args.filter)
    else:
        disk(int(args.samples), args.filter, args.folder)


if __name__ == "__main__":
    main()
