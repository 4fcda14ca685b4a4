"""Rendered pictures behind a lens: cells hold the rays of their pixels, and edges have no staircases."""

import cv2
import numpy as np
import pytest
from blurred_edge import mean_in_squares
from scipy.spatial.transform import Rotation

from labcal.bench.held_board import BARE_BOARD, CAMERA, blurred_scene, board_scene, still_take
from labcal.detect.detector import detect_dots
from labcal.geometry.poses import pose
from labcal.render.film import Places, Shading, traced_cells
from labcal.render.irradiance import Case, render_light
from labcal.render.laboratories import Laboratories
from labcal.render.laboratory import Draw
from labcal.render.sensor_response import Exposure, read_sensor
from labcal.render.variant import MONO, renderer
from labcal.scene.camera import CameraDescription
from labcal.scene.model import Scene
from labcal.scene.photometry import Photometry
from labcal.scene.take import Take
from labcal.targets.chessboard import Chessboard

BOARD = Chessboard(kind="chessboard", name="board", cols=8, rows=6, square_mm=40.0)
DISTORTION = (-0.2, 0.05, 1e-3, -5e-4, 0.0)


def held(
    width: int, height: int, spp: int, turn: tuple[float, float, float], board: Chessboard = BOARD
) -> tuple[Scene, Take]:
    """Return a chessboard before a distorting camera, 1 m away, and its only take."""
    camera = CameraDescription(
        size=(width, height), focal_px=1.6 * width, lens="brown5", dist=DISTORTION,
        eye_mm=(0.0, 0.0, 1000.0), look_at_mm=(0.0, 0.0, 0.0),
    )  # fmt: skip
    scene = board_scene(board, camera, spp)
    R = Rotation.from_rotvec(turn).as_matrix()
    return scene, still_take(scene, pose(R, -R @ board.points().mean(axis=0)))


def rendered(scene: Scene, take: Take, shading: Shading | None = None) -> np.ndarray:
    with renderer(MONO) as mi:
        return render_light(Laboratories(mi, scene, 0), Case(take, 0), shading)


def bare(scene: Scene) -> Scene:
    """Return a scene whose board is white all over."""
    return scene.model_copy(update={"board": scene.board.model_copy(update={"dark": scene.board.light})})


@pytest.mark.parametrize(("count", "side"), [(64, 4), (16, 2), (6, 2), (1, 2)])
def test_cells_hold_the_rays_of_their_pixels(count: int, side: int) -> None:
    scene, take = held(64, 48, count, (0.1, 0.2, 0.05))
    pixels = Places.of(np.arange(64 * 48), 64)
    with renderer(MONO) as mi:
        laboratory = Laboratories(mi, scene, 0).of_size((64, 48))
        laboratory.place(take.track.at(0.0))
        rays, draw = laboratory.rays_of(take.device), Draw(5, count, 0, count)
        whole = laboratory.trace(rays, slice(0, 48), draw).ravel()
        found = traced_cells(laboratory, rays, pixels, draw, side)
    np.testing.assert_allclose(found.light.mean(axis=(1, 2)), whole, rtol=1e-5)
    assert (found.rays is None) == (count % side**2 == 0)
    if found.rays is not None:
        np.testing.assert_allclose(found.rays.sum(axis=(1, 2)), side**2, rtol=1e-6)
        assert np.ptp(found.rays) > 0.0


@pytest.mark.parametrize("spp", [1, 6, 16])
def test_even_light_stays_even(spp: int) -> None:
    """However many rays fell into the cells of a pixel."""
    scene, take = held(64, 48, spp, (0.0, 0.0, 0.0))
    light = rendered(blurred_scene(bare(scene), 0.8), take)
    np.testing.assert_allclose(light[20:28, 20:44], BARE_BOARD, rtol=1e-5)


def test_what_a_shading_holds_back_is_blurred_as_the_board_is(monkeypatch: pytest.MonkeyPatch) -> None:
    scene, take = held(64, 48, 64, (0.0, 0.0, 0.0))
    normal, inside = np.array([0.6, 0.8]), (slice(20, 28), slice(20, 44))
    v, u = np.mgrid[:48, :64]

    def distance(q: np.ndarray) -> np.ndarray:
        return np.asarray((q - [31.7, 23.9]) @ normal)

    def half(q: np.ndarray) -> np.ndarray:
        return (distance(q) > 0.0).astype(np.float64)

    blurred = blurred_scene(bare(scene), 1.2)
    light, sharp = rendered(blurred, take, half), rendered(bare(scene), take, half)
    true = mean_in_squares(distance(np.stack([u, v], axis=-1)), normal, 1.2)[inside]
    assert np.ptp(true) > 0.99
    np.testing.assert_allclose(light[inside] / BARE_BOARD, true, atol=0.02)
    np.testing.assert_allclose(sharp[inside] / BARE_BOARD, half(np.stack([u, v], axis=-1))[inside], rtol=1e-5)
    monkeypatch.setattr("labcal.render.irradiance.CELLS_AT_ONCE", 1)
    np.testing.assert_array_equal(rendered(blurred, take, half), light)


def test_a_picture_does_not_depend_on_how_many_rows_a_film_has(monkeypatch: pytest.MonkeyPatch) -> None:
    for spp in (4, 6):
        scene, take = held(64, 160, spp, (0.1, 0.2, 0.05))
        blurred = blurred_scene(scene, 0.8)
        whole = rendered(blurred, take)
        with monkeypatch.context() as patched:
            patched.setattr("labcal.render.irradiance.CELLS_AT_ONCE", 1)
            np.testing.assert_array_equal(whole, rendered(blurred, take))


def test_what_lies_beyond_the_frame_is_blurred_into_the_picture() -> None:
    """Pixels at the frame were repeated beyond it, which moved corners near it by many of their errors."""
    scene, take = held(64, 48, 1024, (0.1, 0.2, 0.05), BOARD.model_copy(update={"square_mm": 110.0}))
    wider = scene.cameras[CAMERA].model_copy(
        update={"size": (84, 68), "focal_px": 1.6 * 64, "principal_px": (10.0 + 31.5, 10.0 + 23.5)}
    )
    scene = blurred_scene(scene, 2.3)
    all_ = scene.model_copy(update={"cameras": {CAMERA: wider}})
    inner = rendered(all_, still_take(all_, take.track.T_world_target))[10:-10, 10:-10]
    off = (rendered(scene, take) - inner) / np.ptp(inner)
    rim = np.ones(off.shape, dtype=bool)
    rim[4:-4, 4:-4] = False
    rim[:8, :8] = rim[:8, -8:] = rim[-8:, :8] = rim[-8:, -8:] = False  # beyond the farthest place of the lens
    assert np.ptp(inner[rim]) > 0.5 * np.ptp(inner)
    assert np.abs(off[rim]).max() < 0.01


def test_a_rendered_edge_is_that_of_a_lens_before_the_sensor() -> None:
    """The edge is tilted by 1 in 20 against the rows; blurred pixels would be off by 0.024 of the step."""
    camera = CameraDescription(
        size=(64, 40), focal_px=600.0, lens="pinhole", eye_mm=(0.0, 0.0, 1000.0), look_at_mm=(0.0, 0.0, 0.0)
    )
    scene = board_scene(BOARD.model_copy(update={"square_mm": 200.0}), camera, 16384)
    R = Rotation.from_rotvec((0.0, 0.0, np.arctan(1.0 / 20.0))).as_matrix()
    take = still_take(scene, pose(R, -R @ [100.0, 203.0, 0.0]))  # the middle of an edge, and 3 mm
    light = rendered(blurred_scene(scene, 0.8), take).astype(np.float64)
    ends = take.project(np.array([[0.0, 200.0, 0.0], [200.0, 200.0, 0.0]])).q
    along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    normal = np.array([-along[1], along[0]])
    v, u = np.mgrid[:40, :64]
    distance = (np.stack([u, v], axis=-1) - ends[0]) @ normal
    true = mean_in_squares(distance, normal, 0.8)[8:-8, 8:-8]
    low, high = light[[8, -9], 32]
    assert abs(high - low) > 0.5
    assert np.abs((light[8:-8, 8:-8] - low) / (high - low) - true).max() < 1e-3


def test_corners_are_where_projection_puts_them() -> None:
    """Blurred pixels had corners that were off by 0.006 px at this blur; some 0.0003 px are the rays'."""
    scene, take = held(320, 240, 1024, (0.05, 0.25, 0.05))
    sensor = Photometry(
        blur_px=0.8,
        format="png",
        bits=16,
        adc_bits=16,
        tone_curve="linear",
        full_well_e=1e9,
        read_noise_e=0.0,
    )
    light = rendered(scene.model_copy(update={"photometry": sensor}), take)
    dots = detect_dots(read_sensor(light, sensor, Exposure(1.0, (1.0, 1.0, 1.0)), None), BOARD)
    T = take.device.T_cam_world @ take.track.T_world_target
    fx, fy, cx, cy = take.device.intrinsics
    K = np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
    q = cv2.projectPoints(BOARD.points(), cv2.Rodrigues(T[:3, :3])[0], T[:3, 3], K, np.array(DISTORTION))[0]
    assert dots.ok.sum() >= BOARD.count - 2
    off = dots.position[dots.ok] - q[dots.index[dots.ok] @ [1, BOARD.cols], 0]
    assert np.sqrt((off**2).sum(axis=1).mean()) < 0.001
