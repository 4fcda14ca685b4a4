import numpy as np
import pytest
from scipy.linalg import expm

from labcal.cameras.camera import Camera
from labcal.errors import InputError
from labcal.scene.catalogue import load_scene
from labcal.scene.motion import ShutterTimes, Track
from labcal.scene.plan import planned_takes
from labcal.scene.print import TruePrint
from labcal.scene.subframes import LARGEST_STEP_PX, subframes
from labcal.scene.take import Take
from labcal.scene.truth import true_dots
from labcal.scene.views import planned_views
from labcal.shoot.truth import TrueDots
from labcal.targets.grid import DotGrid

STILL = np.zeros(3)
WIDTH, HEIGHT, FOCAL, AWAY = 640, 480, 600.0, 1200.0


def facing_pose() -> np.ndarray:
    """Return a pose square to the camera below, near the middle of its picture."""
    T_world_target = np.diag([1.0, -1.0, -1.0, 1.0])
    T_world_target[:3, 3] = [-40.0, 20.0, AWAY]
    return T_world_target


def seen(target: DotGrid, take: Take) -> TrueDots:
    """Return the dots of a flat, exact print."""
    scene = load_scene("webcam-plane").model_copy(update={"target": target})
    return true_dots(scene, TruePrint.of(target, scene.board, 0), take)


def taken(
    velocity: np.ndarray, rotation: np.ndarray, exposure_s: float, readout_s: float, lens: str = "pinhole"
) -> Take:
    """Return the picture of a target that moves in front of a camera in the world's origin."""
    dist = np.array([-0.2, 0.05, 1e-3, -2e-3, 0.0] if lens == "brown5" else [0.0] * 5)
    K = np.array([[FOCAL, 0.0, 310.0], [0.0, FOCAL, 250.0], [0.0, 0.0, 1.0]])
    return Take(
        view="one",
        camera="left",
        taken_by="left",
        device=Camera(K, lens, dist, np.eye(4), (WIDTH, HEIGHT)),
        track=Track(facing_pose(), np.array([0.0, 0.0, AWAY]), velocity, rotation),
        shutter=ShutterTimes(exposure_s, readout_s, HEIGHT),
    )


@pytest.mark.parametrize("seconds", [-0.3, 0.0, 0.7])
def test_a_track_is_a_rigid_motion_about_the_boards_middle(seconds: float) -> None:
    velocity, rotation = np.array([30.0, -20.0, 10.0]), np.array([0.5, -1.0, 2.0])
    track = taken(velocity, rotation, 0.01, 0.0).track
    R = expm(seconds * np.cross(np.eye(3), rotation))  # the matrix of x -> rotation cross x
    before = track.T_world_target
    p = np.array([[0.0, 0.0, 0.0], [50.0, 10.0, 0.0], [7.0, -3.0, 2.0]])
    start = p @ before[:3, :3].T + before[:3, 3]
    expected = (start - track.middle) @ R.T + track.middle + seconds * velocity
    T = track.at(seconds)
    np.testing.assert_allclose(p @ T[:3, :3].T + T[:3, 3], expected, atol=1e-9)
    np.testing.assert_allclose(track.carried(p, np.full(3, seconds)), expected, atol=1e-9)
    mixed = track.carried(p, np.array([0.0, seconds, 0.1]))
    np.testing.assert_allclose(mixed[1], expected[1], atol=1e-9)
    np.testing.assert_allclose(mixed[0], start[0], atol=1e-9)


def test_rows_are_exposed_from_the_top_about_the_middle_of_the_frame() -> None:
    times = ShutterTimes(0.01, 0.03, 480).middles(np.array([0.0, 239.5, 479.0]))
    np.testing.assert_allclose(times, [-0.015, 0.0, 0.015], atol=1e-15)
    assert ShutterTimes(0.01, 0.0, 480).middles(np.array([0.0, 479.0])).tolist() == [0.0, 0.0]
    assert ShutterTimes(0.01, 0.0, 1).middles(np.array([0.0])).tolist() == [0.0]


def test_with_a_rolling_shutter_a_square_moved_picture_is_sheared_as_worked_out_by_hand(
    grid: DotGrid,
) -> None:
    # Square to the camera, the image of a point runs at (a, b) px/s. Row v is read at R (v / (H - 1) - 1/2),
    # so that v = v0 + b t(v) gives v = (v0 - b R / 2) / (1 - b R / (H - 1)): an affine map of the picture.
    velocity, readout = np.array([900.0, 500.0, 0.0]), 0.04
    dots = seen(grid, taken(velocity, STILL, 0.005, readout))
    at_rest = seen(grid, taken(STILL, STILL, 0.005, readout))
    a, b = velocity[:2] * FOCAL / AWAY
    v = (at_rest.centre[:, 1] - 0.5 * b * readout) / (1.0 - b * readout / (HEIGHT - 1))
    t = readout * (v / (HEIGHT - 1) - 0.5)
    u = at_rest.centre[:, 0] + a * t
    np.testing.assert_allclose(dots.centre, np.stack([u, v], axis=-1), atol=1e-8)
    np.testing.assert_allclose(dots.centroid, dots.centre, atol=1e-8)  # affine maps keep the middle of a disc
    np.testing.assert_allclose(dots.point, at_rest.point + t[:, None] * velocity, atol=1e-8)
    assert np.ptp(t) > 1e-3


def test_with_a_global_shutter_the_truth_is_that_of_the_middle_of_the_frame(grid: DotGrid) -> None:
    moving = taken(np.array([900.0, 500.0, -300.0]), np.array([1.0, 2.0, 3.0]), 0.02, 0.0)
    at_rest = taken(STILL, STILL, 0.02, 0.0)
    for name in ("point", "centre", "centroid"):
        np.testing.assert_allclose(
            getattr(seen(grid, moving), name), getattr(seen(grid, at_rest), name), atol=1e-9
        )


def test_every_part_of_a_dot_is_where_it_is_when_its_row_is_read() -> None:
    take = taken(np.array([900.0, 500.0, -300.0]), np.array([1.0, 2.0, 3.0]), 0.02, 0.04, "brown5")
    random = np.random.default_rng(3)
    p = np.concatenate([random.uniform(0.0, 80.0, (50, 2)), np.zeros((50, 1))], axis=1)
    for point, q, seconds in zip(p, take.project(p).q, take.instants(p), strict=True):
        T = take.track.at(float(seconds))
        seen = take.device.project(T[:3, :3] @ point + T[:3, 3]).q
        np.testing.assert_allclose(seen, q, atol=1e-8)
        assert 0.04 * (q[1] / (HEIGHT - 1) - 0.5) == pytest.approx(seconds, abs=1e-12)


def test_a_point_that_outruns_the_rows_is_not_imaged() -> None:
    # The picture is read at 479 rows / 0.04 s, and the target moves faster than that.
    take = taken(np.array([0.0, 40_000.0, 0.0]), STILL, 0.0, 0.04)
    assert not take.project(np.array([[5.0, 5.0, 0.0]])).ok.any()
    behind = taken(np.array([0.0, 10.0, 0.0]), STILL, 0.0, 0.04)
    assert not behind.project(np.array([[5.0, 5.0, 2.0 * AWAY]])).ok.any()


@pytest.mark.parametrize("lens", ["pinhole", "brown5"])
@pytest.mark.parametrize(("exposure", "readout"), [(0.01, 0.0), (0.01, 0.03), (0.0, 0.03), (0.02, 0.001)])
def test_subframes_lie_close_and_average_to_each_rows_own_middle(
    grid: DotGrid, exposure: float, readout: float, lens: str
) -> None:
    take = taken(np.array([600.0, 400.0, -300.0]), np.array([1.0, -1.0, 6.0]), exposure, readout, lens)
    frames = subframes(take, grid)
    np.testing.assert_allclose(frames.weights.sum(axis=0), 1.0, atol=1e-12)
    mean = frames.seconds @ frames.weights
    np.testing.assert_allclose(mean, take.shutter.middles(np.arange(HEIGHT)), atol=1e-9 * 0.03)
    # Nothing counts outside of the row's exposure, but for the interpolation between two sub-frames.
    step = frames.seconds[1] - frames.seconds[0]
    away = np.abs(frames.seconds[:, None] - take.shutter.middles(np.arange(HEIGHT)))
    assert (away[frames.weights > 0.0] < 0.5 * exposure + step).all()
    # The variance of the times within a row is that of its exposure, and at most a step's more.
    variance = (frames.seconds**2) @ frames.weights - mean**2
    np.testing.assert_allclose(variance, exposure**2 / 12.0, atol=step**2 / 3.0)
    angle = np.linspace(0.0, 2.0 * np.pi, 100, endpoint=False)
    circle = np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], axis=-1)
    outlines = grid.points()[:, None] + 0.5 * grid.outer_diameters_mm()[:, None, None] * circle
    images = [
        take.device.project(outlines @ T[:3, :3].T + T[:3, 3]).q for T in map(take.track.at, frames.seconds)
    ]
    largest = np.linalg.norm(np.diff(images, axis=0), axis=-1).max()
    assert 0.7 * LARGEST_STEP_PX < largest < 1.02 * LARGEST_STEP_PX


def test_what_stands_still_is_one_picture(grid: DotGrid) -> None:
    for take in (taken(STILL, STILL, 0.01, 0.03), taken(np.ones(3), STILL, 0.0, 0.0)):
        frames = subframes(take, grid)
        assert frames.seconds.tolist() == [0.0]
        assert frames.weights.tolist() == [[1.0] * HEIGHT]
        assert frames.averaged == 1.0
        assert frames.rows(0) == (0, HEIGHT)


def test_the_noise_of_a_row_counts_its_subframes(grid: DotGrid) -> None:
    one_row = subframes(taken(np.array([600.0, 0.0, 0.0]), STILL, 0.0, 0.03), grid)
    assert one_row.averaged == pytest.approx(1.0, abs=0.1)  # some row falls right on a sub-frame
    blurred = subframes(taken(np.array([600.0, 0.0, 0.0]), STILL, 0.03, 0.0), grid)
    assert blurred.averaged == pytest.approx(len(blurred.seconds) - 0.5, abs=0.1)  # both ends count half


@pytest.mark.parametrize(
    ("velocity", "turn"), [("[60000, 0, 0]", 0.0), ("[1e7, 0, 1e7]", 0.0), ("[0, 0, 0]", 360.0 * 300.0)]
)
def test_what_moves_too_fast_is_refused_by_name(velocity: str, turn: float) -> None:
    scene = load_scene(
        "webcam-plane", (f"motion.velocity_mm_s={velocity}", f"motion.rotation_deg_s=[0, 0, {turn}]")
    )
    take = planned_takes(scene, planned_views(scene, 0), 0).takes[0]
    with pytest.raises(InputError, match=r"In view 'train' .* camera 'left' .* motion\.velocity_mm_s"):
        subframes(take, scene.target)


@pytest.mark.parametrize("overrides", [("shutter=rolling",), ("readout_ms=20",)])
def test_shutter_and_readout_belong_together(overrides: tuple[str, ...]) -> None:
    with pytest.raises(InputError, match="readout_ms together"):
        load_scene("webcam-plane", overrides)
