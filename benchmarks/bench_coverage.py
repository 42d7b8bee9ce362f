"""Turns presets at rest into how often the 95 % intervals of N, B and K read back hold what their datasheets state.

    python benchmarks/bench_coverage.py [--draws 20]

A short record tells the white noise, one of two hours the flicker and the walk. Readings are taken faster than is
asked for and averaged, as one does, so that neither bandwidth nor word length matters; what the least significant bit
adds to the white noise is counted in. No datasheet states a random walk: presets get one besides, from hardly
visible to plain. Only terms that are there count, and only of sensors whose white noise is stated: flicker alone
would tell of the ends of its simulated band.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from kreisel import Imu, ImuRecording, NoiseModel, allan, rest
from kreisel.evaluate.allan import TERMS
from kreisel.simulate.presets import load, names

SEED = 32
SHORT = (2000.0, 40_000, 40)  # Hz, readings, readings in an average: 20 s
LONG = (50.0, 360_000, 25)  # two hours
WALKS = (
    3.0,
    10.0,
    30.0,
    100.0,
)  # where the walk is as strong as the white noise, in frequencies of the record
ALLOWED = (0.90, 0.98)

Counts = dict[str, list[bool]]


def averaged(imu: Imu, plan: tuple[float, int, int], seed: int) -> ImuRecording:
    rate, readings, together = plan
    measured = imu.record(rest().sample(np.arange(readings) / rate), seed).measured
    mean = {name: getattr(measured, name).reshape(-1, together, 3).mean(axis=1) for name in ("gyro", "accel")}
    return ImuRecording(t=measured.t[::together], **mean)


def count(imu: Imu, truths: dict[str, Any], plan: tuple[float, int, int], seed: int, counts: Counts) -> None:
    """Add to `counts` whether each interval of a term that is there holds it."""
    record = averaged(imu, plan, seed)
    for sensor, truth in truths.items():
        if not any(values.any() for values in truth.values()):
            continue
        fit = allan(record, sensor)
        for term, values in truth.items():
            found = getattr(fit, term)
            covered = (found.low <= values) & (values <= found.high)
            counts[term] += covered[values > 0.0].tolist()


def truth_of(noise: NoiseModel, step: Any, rate: float) -> dict[str, Any]:
    white = np.sqrt(noise.white_noise**2 + np.where(noise.white_noise > 0.0, step**2 / 12.0 / rate, 0.0))
    return dict(zip(TERMS, (white, noise.bias_instability, noise.bias_random_walk), strict=True))


def triads_of(name: str) -> dict[str, Any]:
    gyro, accel, _ = load(name).triads()
    both = {"gyro": gyro, "accel": accel}
    return {sensor: triad for sensor, triad in both.items() if triad.noise.white_noise.all()}


def of_preset(name: str, draws: int) -> Iterator[tuple[Any, ...]]:
    triads = triads_of(name)
    wandering = any(t.noise.bias_instability.any() or t.noise.bias_random_walk.any() for t in triads.values())
    for plan in (SHORT, LONG) if wandering else (SHORT,):
        truths = {sensor: truth_of(t.noise, np.asarray(t.step), plan[0]) for sensor, t in triads.items()}
        if plan is SHORT:  # twenty seconds do not tell a floor of minutes
            truths = {sensor: {"N": truth["N"]} for sensor, truth in truths.items()}
        for seed in range(draws):
            yield Imu.from_preset(name), truths, plan, seed_of(name, plan[1], seed)


def with_walks(name: str, draws: int) -> Iterator[tuple[Any, ...]]:
    rate, readings, _ = LONG
    noises = {"accel": NoiseModel()} | {sensor: triad.noise for sensor, triad in triads_of(name).items()}
    for k in WALKS:
        walking = {
            sensor: replace(
                noise, bias_random_walk=np.pi * k / (readings / rate) * noise.white_noise, turn_on_bias=0.0
            )
            for sensor, noise in noises.items()
        }
        truths = {sensor: truth_of(noise, np.zeros(3), rate) for sensor, noise in walking.items()}
        for seed in range(draws):
            yield Imu.from_noise(walking["gyro"], walking["accel"]), truths, LONG, seed_of(name, int(k), seed)


def seed_of(name: str, *numbers: int) -> int:
    """One seed for each recording: with the same one all presets would make the same noise, scaled."""
    return int(np.random.SeedSequence([SEED, *name.encode(), *numbers]).generate_state(1)[0])


def cells(counts: Counts) -> str:
    return "  ".join(
        f"{np.mean(held):.3f} of {len(held):4d}" if held else f"{'-':>13}" for held in counts.values()
    )


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--draws", type=int, default=6, help="recordings of each length and preset")
    args = parser.parse_args()
    every: Counts = {term: [] for term in TERMS}
    print(f"seed {SEED}\n{'':<26}" + "".join(f"{term:<15}" for term in TERMS))
    walked = ("bmi088", "adis16470", "adis16495-1", "mti300", "stim300")
    for label, recipe, chosen in (("", of_preset, names()), (" + walk", with_walks, walked)):
        for name in chosen:
            counts: Counts = {term: [] for term in TERMS}
            for parts in recipe(name, args.draws):
                count(*parts, counts)
            print(f"{name + label:<26}{cells(counts)}", flush=True)
            for term, held in counts.items():
                every[term] += held
    print(f"{'all':<26}{cells(every)}")
    return int(any(not ALLOWED[0] <= np.mean(held) <= ALLOWED[1] for held in every.values()))


if __name__ == "__main__":
    sys.exit(main())
