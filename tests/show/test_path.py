"""The wedge points where the body points, and dots are where things are."""

from __future__ import annotations

import numpy as np
import pytest
from mpl_toolkits.mplot3d import proj3d

from kreisel.data.motion import Mount
from kreisel.maths.rotations import exp_so3
from kreisel.show import body, plot_path, style
from kreisel.show.scene import seen_box

pytestmark = pytest.mark.filterwarnings("error")


def dots(figure, colour: str) -> np.ndarray:
    """Positions (k, 3) in N of the markers of one colour."""
    scene = figure.axes[0]
    (line,) = [x for x in scene.get_lines() if x.get_color() == colour and x.get_linestyle() == "None"]
    return np.array(line.get_data_3d()).T


def test_the_wedge_is_an_arrowhead_along_x_and_flat_along_z() -> None:
    rng = np.random.default_rng(3)
    for _ in range(20):
        p, R = rng.normal(size=3), exp_so3(rng.normal(size=3))
        in_B = (body.corners(p, R, 2.0) - p) @ R
        nose = in_B[[0, 3]].mean(axis=0)
        np.testing.assert_allclose(nose / np.linalg.norm(nose), [1.0, 0.0, 0.0], atol=1e-12)
        length, width, thickness = np.ptp(in_B, axis=0)
        assert length == pytest.approx(2.0) and thickness < 0.1 * width < 0.1 * length
        np.testing.assert_allclose(in_B.mean(axis=0), 0.0, atol=1e-12)  # the centre of mass of the triangle


def test_faces_look_outwards() -> None:
    for face in body.faces(np.zeros(3), np.eye(3), 1.0):
        normal = np.cross(face[1] - face[0], face[2] - face[1])
        assert normal @ face.mean(axis=0) > 0.0
    top = body.faces(np.zeros(3), np.eye(3), 1.0)[body.FACE_COLOURS.index(style.BODY)]
    assert (top[:, 2] > 0.0).all()  # the bright side is up


def test_bodies_in_the_picture_are_where_the_motion_has_them(circle) -> None:
    motion = circle(n=1001)
    figure = plot_path(motion)
    figure.draw_without_rendering()
    scene = figure.axes[0]
    (bodies,) = [x for x in scene.collections if x.get_gid() == "bodies"]
    drawn = np.concatenate([path.vertices[:3] for path in bodies.get_paths()])
    centres = dots(figure, style.MASS)
    assert 4 <= len(centres) <= 9
    for p in centres:
        row = int(np.argmin(np.linalg.norm(motion.p_NB - p, axis=1)))
        np.testing.assert_array_equal(motion.p_NB[row], p)
        # 14 % of the path's 4 m is the length, two thirds of that lie ahead of the centre of mass.
        nose = p + 2 / 3 * 0.56 * motion.R_NB[row, :, 0]
        x, y, _ = proj3d.proj_transform(*nose, scene.get_proj())
        # The wedge is 3.5 % of its length thick to either side; the projection shrinks metres some tenfold.
        assert np.linalg.norm(drawn - (x, y), axis=1).min() < 0.035 * 0.56


def test_imu_dots_sit_at_p_plus_R_r(circle, corner_mount) -> None:
    motion = circle()
    other = Mount(p_BS=np.array([0.1, 0.0, 0.0]), name="nose")
    figure = plot_path(motion, (corner_mount, other))
    for mount, colour in ((corner_mount, style.IMU[0]), (other, style.IMU[1])):
        for mass, imu in zip(dots(figure, style.MASS), dots(figure, colour), strict=True):
            row = int(np.argmin(np.linalg.norm(motion.p_NB - mass, axis=1)))
            np.testing.assert_allclose(imu, mass + motion.R_NB[row] @ mount.p_BS, atol=1e-12)
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert "IMU" in labels and "nose" in labels and "start" in labels


def test_mounts_of_one_name_are_numbered(circle, corner_mount) -> None:
    labels = [x.get_text() for x in plot_path(circle(), (corner_mount, corner_mount)).legends[0].get_texts()]
    assert "IMU 1" in labels and "IMU 2" in labels


def test_the_paths_are_drawn_whole(circle, corner_mount) -> None:
    motion = circle()
    scene = plot_path(motion, (corner_mount,)).axes[0]
    (line,) = [x for x in scene.get_lines() if x.get_label() == "path of the centre of mass"]
    drawn = np.array(line.get_data_3d()).T
    np.testing.assert_array_equal(drawn[[0, -1]], motion.p_NB[[0, -1]])
    violet = [x for x in scene.get_lines() if x.get_color() == style.IMU[0] and x.get_linestyle() == "-"]
    assert len(violet) == 1


def test_axes_are_equal_and_named(circle) -> None:
    scene = plot_path(circle()).axes[0]
    sides = np.ptp([scene.get_xlim(), scene.get_ylim(), scene.get_zlim()], axis=1)
    # The projection maps the limits to a box with these sides.
    aspect = scene.get_box_aspect()
    np.testing.assert_allclose(aspect / aspect[0], sides / sides[0])
    labels = [scene.get_xlabel(), scene.get_ylabel(), scene.get_zlabel()]
    assert labels == ["east [m]", "north [m]", "up [m]"]


@pytest.mark.parametrize("jitter", [0.0, 1e-16])
def test_a_resting_body_stands_in_a_box_of_its_own_size(rest, corner_mount, jitter: float) -> None:
    for mounts in ((), (corner_mount,)):
        figure = plot_path(rest(jitter=jitter), mounts)
        figure.draw_without_rendering()
        scene = figure.axes[0]
        sides = np.ptp([scene.get_xlim(), scene.get_ylim(), scene.get_zlim()], axis=1)
        assert ((sides > 0.05) & (sides < 1.0)).all()
        assert len(dots(figure, style.MASS)) == 1


def test_bodies_keep_apart_however_often_the_path_returns(circle) -> None:
    motion = circle(n=5001, rate=25.0)  # twenty laps
    centres = dots(plot_path(motion), style.MASS)
    apart = np.linalg.norm(centres[:, None] - centres, axis=-1)[np.triu_indices(len(centres), 1)]
    assert len(centres) >= 6 and apart.min() > 0.56


def test_one_sample_has_a_picture_and_none_an_error(rest) -> None:
    plot_path(rest(n=1)).draw_without_rendering()
    with pytest.raises(ValueError, match="no samples"):
        plot_path(rest(n=0))


def test_the_box_fills_its_part_of_the_figure(circle, rest) -> None:
    for motion in (circle(), rest()):
        low, high = seen_box(plot_path(motion).axes[0])
        room = np.array([0.81, 0.77])
        # It touches two sides of the room of (0.09, 0.09) to (0.90, 0.86), and passes none.
        assert np.max((high - low) / room) == pytest.approx(1.0, abs=0.01)
        np.testing.assert_allclose(0.5 * (low + high), [0.495, 0.475], atol=0.01)
