"""Turns figure 1's functions into exact tangential motion by kreisel and by nested JAX derivatives; compares.

Run: .venv/bin/python benchmarks/bench_exact.py [samples]     (one thread, one core; default 1000000)

The other side is what one writes with JAX: angles from the velocity, their derivatives by jax.jvp nested as
deep as needed, everything in one jitted function in float64, in blocks of several sizes. Without JAX only
kreisel is measured. Limit: the loop takes 3 sincos and 1 atan2 a sample (about 40 ns with good vector code),
and 27 numbers out are 216 bytes. The copy goes into memory that is there already; both others touch theirs for
the first time, which alone costs 200 ns here. Ours computes jets array by array, some 150 passes over a block.
"""

from __future__ import annotations

import os
import statistics
import sys
import time

os.environ.update(OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", NUMBA_NUM_THREADS="1")
os.environ["XLA_FLAGS"] = "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
if hasattr(os, "sched_setaffinity"):
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})

import numpy as np

from kreisel import FunctionTrajectory

ROUNDS = 7
JAX_BLOCKS = (8192, 65536, 0)  # 0: everything at once
NUMBERS_OUT = 27  # p, v, a, R, omega, alpha


def position(t, xp):
    return (
        0.8 * xp.cos(2.0 * xp.pi * t),
        0.8 * xp.sin(2.0 * xp.pi * t),
        0.3 * xp.cos(6.0 * xp.pi * t),
    )


def nested_jax():
    """A jitted function t (n,) -> p, v, a, R, omega, alpha, or None where JAX is absent."""
    try:
        import jax
    except ImportError:
        return None
    jax.config.update("jax_enable_x64", True)
    jnp = jax.numpy

    def rate(function):
        """(value, derivative in time) of a function of t (n,)."""
        return lambda t: jax.jvp(function, (t,), (jnp.ones_like(t),))[1]

    def p(t):
        return position(t, jnp)

    v = rate(p)
    a = rate(v)

    def angles(t):
        x, y, z = v(t)
        return -jnp.arcsin(z / jnp.sqrt(x * x + y * y + z * z)), jnp.arctan2(y, x)

    def omega(t):
        pitch, _ = angles(t)
        pitch_rate, heading_rate = rate(angles)(t)
        return -heading_rate * jnp.sin(pitch), pitch_rate, heading_rate * jnp.cos(pitch)

    def everything(t):
        pitch, heading = angles(t)
        cy, sy, cz, sz = jnp.cos(pitch), jnp.sin(pitch), jnp.cos(heading), jnp.sin(heading)
        R = [[cz * cy, -sz, cz * sy], [sz * cy, cz, sz * sy], [-sy, jnp.zeros_like(t), cy]]
        vectors = [jnp.stack(x, axis=-1) for x in (p(t), v(t), a(t), omega(t), rate(omega)(t))]
        return (*vectors, jnp.stack([jnp.stack(row, axis=-1) for row in R], axis=-2))

    return jax.jit(everything)


def theirs(compiled, t: np.ndarray, block: int):
    """Blocks of one shape (it compiles once a shape), each waited for and copied into arrays of the whole."""
    out = [np.empty((len(t), *shape)) for shape in ((3,),) * 5 + ((3, 3),)]
    size = block or len(t)
    for low in range(0, len(t) - size + 1, size):
        for whole, part in zip(out, compiled(t[low : low + size]), strict=True):
            whole[low : low + size] = part
    return out


def ours(trajectory: FunctionTrajectory, t: np.ndarray):
    return trajectory.sample(t)


def copying(source: np.ndarray, target: np.ndarray) -> None:
    """As many bytes as come out, into memory that is there."""
    np.copyto(target, source)


def seconds(function, *arguments) -> float:
    started = time.perf_counter()
    function(*arguments)
    return time.perf_counter() - started


def agreement(motion, answer) -> float:
    """Largest difference between both sides, relative to the size of each quantity."""
    mine = (motion.p_NB, motion.v_NB, motion.a_NB, motion.omega_NB_B, motion.alpha_NB_B, motion.R_NB)
    return max(float(np.abs(a - b).max() / np.abs(a).max()) for a, b in zip(mine, answer, strict=True))


def main() -> None:
    n = int(float(sys.argv[1])) if len(sys.argv) > 1 else 1_000_000
    n = max(n // 65536, 1) * 65536
    t = np.arange(n) / 200.0
    trajectory = FunctionTrajectory(lambda u: position(u, np))
    source = np.ones((n, NUMBERS_OUT))
    compiled = nested_jax()
    ours(trajectory, t[:65536])
    jobs = {
        "copy of the same bytes": (copying, source, np.zeros_like(source)),
        "kreisel": (ours, trajectory, t),
    }
    if compiled is not None:
        for block in JAX_BLOCKS:
            jobs[f"JAX, nested jvp, {f'blocks of {block}' if block else 'all at once'}"] = (
                theirs,
                compiled,
                t,
                block,
            )
            theirs(compiled, t[: block or n], block)
        print(
            f"largest relative difference {agreement(ours(trajectory, t[:65536]), compiled(t[:65536])):.1e}"
        )
    rows = [{name: seconds(*job) for name, job in jobs.items()} for _ in range(ROUNDS)]
    print(f"{'':34}{'ns/sample':>10}{'time / kreisel':>16}{'speed / copy':>14}")
    for name in jobs:
        cost = statistics.median(row[name] for row in rows) / n * 1e9
        ratio = statistics.median(row[name] / row["kreisel"] for row in rows)
        share = statistics.median(row["copy of the same bytes"] / row[name] for row in rows)
        print(f"{name:34}{cost:10.0f}{ratio:16.2f}{share:14.1%}")
    if compiled is None:
        print("JAX is not installed: pip install jax to compare")


if __name__ == "__main__":
    main()
