"""The film has the right length, and the body in it moves."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from kreisel.data.environment import STANDARD_GRAVITY
from kreisel.data.recording import ImuRecording
from kreisel.show import animate
from kreisel.show.animation import MOST_FRAMES, film_rows
from kreisel.show.gif import shared_palette, write_gif
from kreisel.show.style import BODY

pytestmark = pytest.mark.filterwarnings("error")


def frames(path: Path) -> tuple[list[np.ndarray], list[int]]:
    """Pictures (height, width, 3) of a GIF and how long each is shown, ms."""
    pictures, times = [], []
    with Image.open(path) as film:
        for k in range(film.n_frames):
            film.seek(k)
            pictures.append(np.asarray(film.convert("RGB")).copy())
            times.append(film.info["duration"])
    return pictures, times


def red(picture: np.ndarray) -> np.ndarray:
    """Mean (row, column) of the pixels that have the colour of the body."""
    rgb = np.array([int(BODY[k : k + 2], 16) for k in (1, 3, 5)])
    return np.argwhere((picture == rgb).all(axis=-1)).mean(axis=0)


def reading(motion) -> ImuRecording:
    up = np.array([0.0, 0.0, STANDARD_GRAVITY])
    return ImuRecording(
        t=motion.t, gyro=motion.omega_NB_B + np.sin(motion.t)[:, None], accel=motion.a_NB + up
    )


def test_frames_duration_and_size(tmp_path: Path, circle, corner_mount) -> None:
    motion = circle()
    before = motion.p_NB.copy(), motion.R_NB.copy()
    path = animate(
        motion, (corner_mount,), tmp_path / "a.gif", recording=reading(motion), fps=20.0, speed=5.0
    )
    pictures, times = frames(path)
    assert len(pictures) == 21 and times == [50] * 21  # 5 s at 5 a second, both ends shown
    assert path.stat().st_size < 500_000  # 21 frames; the budget of 125 is 3 MB
    assert list(tmp_path.iterdir()) == [path]
    np.testing.assert_array_equal(motion.p_NB, before[0])
    np.testing.assert_array_equal(motion.R_NB, before[1])


def test_the_body_moves_along_its_path(tmp_path: Path, circle) -> None:
    motion = circle(n=101, rate=0.4 * np.pi)  # one lap
    pictures, _ = frames(animate(motion, (), tmp_path / "a.gif", fps=5.0, speed=1.5))
    seen = np.array([red(picture) for picture in pictures])
    rows, _ = film_rows(motion, 5.0, 1.5)
    # Seen from 58 degrees south of east, this is to the right and that is away, which is up in the picture.
    right, away = (np.array([np.sin(a), np.cos(a), 0.0]) for a in np.deg2rad([58.0, -32.0]))
    # Perspective and the faces turned away bend the relation by a few per cent.
    assert np.corrcoef(seen[:, 1], motion.p_NB[rows] @ right)[0, 1] > 0.99
    assert np.corrcoef(-seen[:, 0], motion.p_NB[rows] @ away)[0, 1] > 0.97
    assert np.ptp(seen[:, 1]) > 150.0


def test_readings_run_along(tmp_path: Path, circle) -> None:
    motion = circle()
    pictures, _ = frames(animate(motion, (), tmp_path / "a.gif", recording=reading(motion), fps=5, speed=4))
    right = [picture[:, picture.shape[1] * 6 // 10 :] for picture in pictures]
    strong = [int((np.ptp(part.astype(int), axis=-1) > 110).sum()) for part in right]
    assert (np.diff(strong) > 0).mean() > 0.9 and strong[-1] > 3 * strong[1]


def test_a_resting_body_and_a_single_sample_have_films(tmp_path: Path, rest) -> None:
    pictures, times = frames(animate(rest(n=1), (), tmp_path / "one.gif"))
    assert len(pictures) == 1
    _, times = frames(animate(rest(), (), tmp_path / "rest.gif", recording=reading(rest()), fps=5))
    assert sum(times) == 1200  # 1 s and the last frame


def test_missing_readings_leave_out_their_dots(tmp_path: Path, rest) -> None:
    motion = rest()
    lost = np.full((len(motion), 3), np.nan)
    animate(motion, (), tmp_path / "a.gif", recording=ImuRecording(t=motion.t, gyro=lost, accel=lost), fps=2)


@pytest.mark.parametrize(("fps", "speed"), [(25.0, 1.0), (30.0, 0.5), (8.0, 3.0)])
def test_each_frame_shows_the_row_nearest_its_time(circle, fps: float, speed: float) -> None:
    motion = circle(n=777)
    rows, delay_cs = film_rows(motion, fps, speed)
    assert delay_cs == round(100 / fps)
    wanted = 0.01 * delay_cs * speed * np.arange(len(rows))
    assert np.abs(motion.t[rows] - wanted).max() <= 0.5 * np.diff(motion.t).max() + 1e-12
    assert wanted[-1] <= 5.0 < wanted[-1] + 0.01 * delay_cs * speed + 1e-9


def test_frames_come_no_faster_than_viewers_show_them(circle) -> None:
    assert film_rows(circle(), 200.0, 1.0)[1] == 2


def test_too_long_a_film_is_refused_with_the_speed_that_fits(circle) -> None:
    with pytest.raises(ValueError, match=r"1251 frames; 1200 .* speed=0\.2 or more"):
        film_rows(circle(), 25.0, 0.1)
    assert len(film_rows(circle(), 25.0, 0.2)[0]) <= MOST_FRAMES


@pytest.mark.parametrize("wrong", [{"fps": 0.0}, {"speed": -1.0}, {"speed": np.nan}])
def test_rates_must_be_positive(circle, wrong: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=f"{next(iter(wrong))} must be a positive number"):
        film_rows(circle(), **{"fps": 25.0, "speed": 1.0, **wrong})


def test_suffix_and_empty_motion_are_refused_before_anything_is_written(tmp_path: Path, circle, rest) -> None:
    with pytest.raises(ValueError, match=r"name the file \.gif"):
        animate(circle(), (), tmp_path / "a.mp4")
    with pytest.raises(ValueError, match="no samples"):
        animate(rest(n=0), (), tmp_path / "a.gif")
    assert not list(tmp_path.iterdir())


def test_flat_colours_come_back_exactly(tmp_path: Path) -> None:
    colours = np.array([[255, 255, 255], [251, 252, 253], [215, 38, 61], [0, 114, 178]], dtype=np.uint8)
    still = [colours[(np.indices((40, 60)).sum(axis=0) // 10 + k) % 4] for k in range(3)]
    with (tmp_path / "a.gif").open("wb") as out:
        write_gif(out, still, shared_palette(still), 4)
    pictures, times = frames(tmp_path / "a.gif")
    np.testing.assert_array_equal(pictures, still)
    assert times == [40, 40, 40]


def test_a_palette_keeps_named_colours_whatever_the_frames_hold() -> None:
    many = np.random.default_rng(5).integers(0, 256, (100, 100, 3)).astype(np.uint8)
    palette = shared_palette([many], ["#D7263D", "#FFC914"])
    assert palette[:2].tolist() == [[215, 38, 61], [255, 201, 20]] and len(palette) == 255
