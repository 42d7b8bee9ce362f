"""Many recordings at once: each has the bits it has alone, in lanes, in threads and in any company."""

import dataclasses

import numpy as np
import pytest

from kreisel.data.attitude import AttitudeHistory
from kreisel.data.recording import ImuRecording
from kreisel.estimate.batch import run_all, run_batch
from kreisel.estimate.filters.dcm import DcmFilter
from kreisel.estimate.run import run
from kreisel.maths.kernels import LANES
from tests.estimate.filters.turning import Array, tumbling, turning
from tests.estimate.test_run import FILTERS

COLUMNS = ("R_NS", "gyro_bias", "a_N", "rest", "disturbed", "held")
PUBLISHED = DcmFilter.as_published(1.0, 0.01, 0.02)


def recordings(rng: np.random.Generator, runs: int, n: int = 300) -> tuple[Array, Array, Array, Array]:
    """Stamps (n,) and readings (runs, n, 3) of hands that tumble noisy sensors."""
    t = np.cumsum(rng.uniform(0.005, 0.015, n))
    alone = [turning(t, tumbling(t, rng))[0] for _ in range(runs)]
    readings = [
        np.stack([np.asarray(getattr(r, name)) for r in alone]) for name in ("gyro", "accel", "mag_uT")
    ]
    gyro, accel, mag = (x + rng.normal(0.0, 0.05, x.shape) for x in readings)
    return t, gyro, accel, mag


def same(a: AttitudeHistory, b: AttitudeHistory) -> bool:
    columns = COLUMNS if a.sigma is None else (*COLUMNS, "sigma")
    alike = all(np.array_equal(getattr(a, c), getattr(b, c), equal_nan=True) for c in columns)
    return alike and (a.sigma is None) == (b.sigma is None)


@pytest.mark.parametrize("threads", [1, 3])
@pytest.mark.parametrize("filter", FILTERS)
def test_a_run_has_the_same_bits_in_company(
    filter: DcmFilter, threads: int, rng: np.random.Generator
) -> None:
    # One tile of lanes and some runs that are left over.
    t, gyro, accel, mag = recordings(rng, LANES + 3)
    batch = run_batch(filter, t, gyro, accel, mag, threads=threads)
    assert len(batch) == LANES + 3
    for k in range(len(batch)):
        assert same(batch[k], run(filter, ImuRecording(t, gyro[k], accel[k], mag_uT=mag[k])))


@pytest.mark.parametrize("filter", [DcmFilter(), DcmFilter(mode="6", coning=True), PUBLISHED])
def test_faults_of_one_lane_stay_in_it(filter: DcmFilter, rng: np.random.Generator) -> None:
    t, gyro, accel, mag = recordings(rng, LANES, 800)
    # All in step for a while; then a start that comes late in one lane, whose windows close elsewhere for good.
    if rng.random() < 0.5:
        accel[2, :20] = np.nan
    # Gaps in the middle of a block and over its end, a blow, sensors that are slow, dead or begin late.
    gyro[5, 100:104] = np.nan
    gyro[6, 125:131] = 1e3
    accel[7, rng.random(800) < 0.3] = 0.0
    accel[4, 250] = 1e4
    mag[8, np.arange(800) % 3 > 0] = np.nan
    mag[9] = 0.0
    mag[3, 500:] = mag[3, 500]
    gyro[10, 200:220] *= 40.0
    gyro[11, 300:] = accel[11, 300:] = 0.0
    batch = run_batch(filter, t, gyro, accel, mag, threads=1)
    for k in range(LANES):
        assert same(batch[k], run(filter, ImuRecording(t, gyro[k], accel[k], mag_uT=mag[k])))


@pytest.mark.parametrize("filter", [DcmFilter(), PUBLISHED])
def test_a_start_before_any_magnetometer(filter: DcmFilter, rng: np.random.Generator) -> None:
    t, gyro, accel, mag = recordings(rng, LANES, 400)
    mag[:, :150] = np.nan
    t[200:] += 1.0
    for field in (mag, None):
        batch = run_batch(filter, t, gyro, accel, field, threads=1)
        for k in range(LANES):
            alone = ImuRecording(t, gyro[k], accel[k], mag_uT=None if field is None else field[k])
            assert same(batch[k], run(filter, alone))


@pytest.mark.parametrize("filter", [DcmFilter(), PUBLISHED])
def test_the_lanes_are_used(
    filter: DcmFilter, rng: np.random.Generator, monkeypatch: pytest.MonkeyPatch
) -> None:
    used = []
    monkeypatch.setattr(DcmFilter, "batch_of_rows", lambda self, *given: used.append(given[3].shape[0]))
    t, gyro, accel, mag = recordings(rng, LANES, 40)
    run_batch(filter, t, gyro, accel, mag, threads=1)
    assert used == [LANES]


@pytest.mark.parametrize("told", [{"lanes": LANES // 2}, {"sigma": 0}], ids=["fewer lanes", "sigma"])
def test_a_filter_that_lanes_do_not_fit_goes_run_by_run(
    told: dict[str, int], rng: np.random.Generator, monkeypatch: pytest.MonkeyPatch
) -> None:
    other = type("Other", (DcmFilter,), {"__slots__": (), **told})()
    monkeypatch.setattr(DcmFilter, "batch_of_lanes", lambda self, *given: pytest.fail("went abreast"))
    t, gyro, accel, mag = recordings(rng, LANES, 40)
    for runs in (LANES // 2, LANES):
        batch = run_batch(other, t, gyro[:runs], accel[:runs], mag[:runs], threads=1)
        for k in range(runs):
            alone = run(DcmFilter(), ImuRecording(t, gyro[k], accel[k], mag_uT=mag[k]))
            assert np.array_equal(batch[k].R_NS, alone.R_NS)


@pytest.mark.parametrize("filter", [DcmFilter(mode="6"), PUBLISHED])
def test_first_attitudes_are_taken(filter: DcmFilter, rng: np.random.Generator) -> None:
    t, gyro, accel, _ = recordings(rng, LANES, 40)
    R_NS = np.linalg.qr(rng.normal(size=(LANES, 3, 3)))[0]
    R_NS *= np.linalg.det(R_NS)[:, None, None]
    batch = run_batch(filter, t, gyro, accel, R_NS=R_NS)
    for k in range(LANES):
        assert same(batch[k], run(filter, ImuRecording(t, gyro[k], accel[k]), R_NS[k]))


@pytest.mark.parametrize("filter", [DcmFilter(), PUBLISHED])
@pytest.mark.parametrize("threads", [1, 3])
def test_recordings_of_all_kinds_in_one_list(
    filter: DcmFilter, threads: int, rng: np.random.Generator
) -> None:
    t, gyro, accel, mag = recordings(rng, LANES + 4, 200)
    given = [ImuRecording(t, g, a, mag_uT=m, t0_ns=7) for g, a, m in zip(gyro, accel, mag, strict=True)]
    given[3] = dataclasses.replace(given[3], mag_uT=None)
    given[5] = ImuRecording(t[:90], gyro[5, :90], accel[5, :90], mag_uT=mag[5, :90], name="short")
    found = run_all(filter, given, threads=threads)
    assert len(found) == len(given)
    for history, recording in zip(found, given, strict=True):
        assert same(history, run(filter, recording))
        assert (history.name, history.t0_ns) == (recording.name, recording.t0_ns)
    assert run_all(filter, []) == []


def test_accelerations_of_a_batch_are_those_of_its_runs(rng: np.random.Generator) -> None:
    t, gyro, accel, mag = recordings(rng, 3, 40)
    batch = run_batch(PUBLISHED, t, gyro, accel, mag)
    # What the batch keeps of its input does not change behind its back.
    accel[:] = 0.0
    for k in range(3):
        assert np.array_equal(batch.a_N[k], batch[k].a_N)


def test_what_does_not_fit_is_refused(rng: np.random.Generator) -> None:
    t, gyro, accel, mag = recordings(rng, 2, 20)
    with pytest.raises(ValueError, match="gyro must be"):
        run_batch(DcmFilter(), t, gyro[0], accel, mag)
    with pytest.raises(ValueError, match="accel must be"):
        run_batch(DcmFilter(), t, gyro, accel[:, :10], mag)
    with pytest.raises(ValueError, match="needs a magnetometer"):
        run_batch(DcmFilter(mode="9"), t, gyro, accel)
    with pytest.raises(ValueError, match="needs a magnetometer"):
        run_all(DcmFilter(mode="9"), [ImuRecording(t, gyro[0], accel[0])])


def test_inputs_are_left_alone(rng: np.random.Generator) -> None:
    given = recordings(rng, LANES, 40)
    before = [x.copy() for x in given]
    batch = run_batch(PUBLISHED, *given)
    assert all(np.array_equal(a, b) for a, b in zip(given, before, strict=True))
    assert all(x.flags.writeable for x in given) and not batch.R_NS.flags.writeable
