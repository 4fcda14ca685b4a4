"""Lenses and windows whose rays pass no single point: against Snell, Fermat and a ray tracer of its own."""

import numpy as np
import pytest

from labcal.cameras.blind_pixels import require_rays_everywhere
from labcal.cameras.camera import Camera
from labcal.cameras.prescription import Prescription, load_prescription, paraxial, prescription_names
from labcal.cameras.record import CameraRecord
from labcal.cameras.window import FlatWindow, Wave, WavyWindow
from labcal.errors import InputError

POSE = np.eye(4)
POSE[:3, 3] = [15.0, -20.0, 30.0]
WATER = FlatWindow(distance_mm=200.0, tilt_x_deg=30.0, tilt_y_deg=-8.0, thickness_mm=12.0, behind_index=1.333)
AIR = FlatWindow(distance_mm=80.0, tilt_y_deg=25.0, thickness_mm=20.0)
WAVES = WavyWindow(
    waves=(
        Wave(amplitude_px=(3.0, 0.5), period_px=300.0, direction_deg=20.0, phase_deg=50.0),
        Wave(amplitude_px=(-1.0, 3.0), period_px=300.0, direction_deg=75.0),
    )
)


def make(lens: str, focal_px: float = 700.0, **parts: object) -> Camera:
    K = np.array([[focal_px, 0.0, 322.4], [0.0, focal_px, 237.1], [0.0, 0.0, 1.0]])
    dist = {"brown5": [-0.3, 0.09, 6e-4, -4e-4, 0.0], "fisheye-kb4": [-0.04, 0.01, -0.006, 0.001, 0.0]}
    return Camera(K, lens, np.array(dist.get(lens, [0.0] * 5)), POSE, (640, 480), **parts)


CAMERAS = {
    "webcam prescription": make("prescription", prescription=load_prescription("webcam-doublet")),
    "double gauss": make("prescription", 1200.0, prescription=load_prescription("double-gauss")),
    "water": make("brown5", window=WATER),
    "pane in air": make("pinhole", window=AIR),
    "waves": make("brown5", window=WAVES),
    "fisheye behind waves": make("fisheye-kb4", 260.0, window=WAVES),
    "prescription in water": make(
        "prescription", prescription=load_prescription("webcam-doublet"), window=WATER
    ),
}


@pytest.fixture(params=CAMERAS)
def camera(request: pytest.FixtureRequest) -> Camera:
    """One of the cameras above."""
    return CAMERAS[request.param]


@pytest.fixture
def pixels() -> np.ndarray:
    """Pixels all over a picture of 640 x 480."""
    return np.random.default_rng(8).uniform([-0.5, -0.5], [639.5, 479.5], (400, 2))


def test_points_on_a_ray_are_imaged_at_its_pixel(camera: Camera, pixels: np.ndarray) -> None:
    rays = camera.rays(pixels)
    assert rays.ok.all()
    for along in (300.0, 1500.0, 20000.0):
        found = camera.project(rays.origin + along * rays.direction)
        assert found.ok.all()
        np.testing.assert_allclose(found.q, pixels, rtol=0, atol=1e-8)


def test_jacobians_are_the_slopes(camera: Camera, pixels: np.ndarray) -> None:
    rays = camera.rays(pixels)
    p = rays.origin + 1200.0 * rays.direction
    slopes = [(camera.project(p + h).q - camera.project(p - h).q) / 2e-2 for h in 1e-2 * np.eye(3)]
    np.testing.assert_allclose(camera.point_jacobian(p), np.stack(slopes, axis=-1), rtol=0, atol=1e-6)


@pytest.mark.parametrize("name", ["water", "fisheye behind waves"])
def test_the_intrinsic_jacobian_is_the_slope(name: str, pixels: np.ndarray) -> None:
    camera = CAMERAS[name]
    p = camera.rays(pixels).origin + 900.0 * camera.rays(pixels).direction
    found = camera.intrinsic_jacobian(p)

    def moved(number: int, step: float) -> np.ndarray:
        K, dist = camera.K.copy(), camera.dist.copy()
        if number < 4:
            K[((0, 0), (1, 1), (0, 2), (1, 2))[number]] += step
        else:
            dist[number - 4] += step
        return Camera(K, camera.lens, dist, POSE, camera.size, window=camera.window).project(p).q

    for number in range(found.shape[-1]):
        step = 1e-2 if number < 4 else 1e-6
        slope = (moved(number, step) - moved(number, -step)) / (2 * step)
        np.testing.assert_allclose(found[..., number], slope, rtol=1e-5, atol=1e-5, err_msg=str(number))


@pytest.mark.parametrize("window", [WATER, AIR])
def test_light_takes_the_quickest_path_through_a_window(window: FlatWindow, pixels: np.ndarray) -> None:
    """Fermat: moving the points where a ray crosses the faces changes the path at second order only."""
    camera = make("pinhole", window=window)
    rays = camera.rays(pixels)
    to_camera = POSE[:3, 3]
    end = rays.origin + 700.0 * rays.direction + to_camera
    far = rays.origin + to_camera
    normal = np.array(window.parameters[:3])
    straight = make("pinhole").rays(pixels).direction
    near = straight * (window.distance_mm / (straight @ normal))[:, None]
    np.testing.assert_allclose(far @ normal, window.distance_mm + window.thickness_mm, atol=1e-9)
    across = np.linalg.svd(normal[None])[2][1:]

    def path(at_near: np.ndarray, at_far: np.ndarray) -> np.ndarray:
        in_glass = window.glass_index * np.linalg.norm(at_far - at_near, axis=1)
        behind = window.behind_index * np.linalg.norm(end - at_far, axis=1)
        return np.linalg.norm(at_near, axis=1) + in_glass + behind

    for step in 1e-3 * across:
        np.testing.assert_allclose(path(near + step, far), path(near - step, far), rtol=0, atol=1e-9)
        np.testing.assert_allclose(path(near, far + step), path(near, far - step), rtol=0, atol=1e-9)


def test_waves_displace_the_picture(pixels: np.ndarray) -> None:
    u, v = pixels.T
    shift = np.zeros_like(pixels)
    for wave in WAVES.waves:
        angle = np.radians(wave.direction_deg)
        along = (u * np.cos(angle) + v * np.sin(angle)) / wave.period_px
        shift += np.sin(2 * np.pi * along + np.radians(wave.phase_deg))[:, None] * wave.amplitude_px
    expected = make("brown5").rays(pixels + shift).direction
    np.testing.assert_allclose(CAMERAS["waves"].rays(pixels).direction, expected, rtol=0, atol=1e-12)
    assert np.linalg.norm(shift, axis=1).max() > 3.0


def traced_in(lens: Prescription, origin: np.ndarray, direction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Trace rays from the scene with spheres and Snell as vectors; s grows towards the film.

    Returns the places at the stop and on the film.
    """
    p, v = origin.copy(), direction.copy()
    vertex, index, at_stop = 0.0, 1.0, np.empty(0)
    for number, surface in enumerate(lens.surfaces):
        if surface.radius_mm is None:
            p = p + ((vertex - p[:, 2]) / v[:, 2])[:, None] * v
            normal = np.tile([0.0, 0.0, -1.0], (len(p), 1))
        else:
            centre = np.array([0.0, 0.0, vertex + surface.radius_mm])
            b = np.einsum("ni,ni->n", p - centre, v)
            root = np.sqrt(b**2 - ((p - centre) ** 2).sum(axis=1) + surface.radius_mm**2)
            p = p + (-b - np.sign(surface.radius_mm) * root)[:, None] * v
            normal = (p - centre) / surface.radius_mm
        if number == lens.stop:
            at_stop = p.copy()
        cosine = -np.einsum("ni,ni->n", normal, v)
        ratio = index / surface.index
        v = ratio * v + (ratio * cosine - np.sqrt(1 - ratio**2 * (1 - cosine**2)))[:, None] * normal
        last, index = vertex, surface.index
        vertex += surface.gap_mm
    film = last + paraxial(lens).film_mm
    return at_stop, p + ((film - p[:, 2]) / v[:, 2])[:, None] * v


@pytest.mark.parametrize(("lens", "focal_px"), [("webcam-doublet", 700.0), ("double-gauss", 1200.0)])
@pytest.mark.parametrize("focus_mm", [None, 900.0])
def test_chief_rays_pass_the_stop_and_reach_their_pixel(
    lens: str, focal_px: float, focus_mm: float | None, pixels: np.ndarray
) -> None:
    prescription = load_prescription(lens).model_copy(update={"focus_mm": focus_mm})
    camera = make("prescription", focal_px, prescription=prescription)
    rays = camera.rays(pixels)
    # The lens's axis runs from the scene to the film, the camera's z into the scene.
    turn = np.diag([1.0, 1.0, -1.0])
    near_axis = paraxial(prescription)
    origin = (rays.origin + POSE[:3, 3]) @ turn + [0.0, 0.0, near_axis.entrance_pupil_mm]
    at_stop, at_film = traced_in(prescription, origin, -rays.direction @ turn)
    np.testing.assert_allclose(at_stop[:, :2], 0.0, atol=1e-9)
    expected = -(pixels - [322.4, 237.1]) / focal_px * near_axis.focal_mm
    np.testing.assert_allclose(at_film[:, :2], expected, rtol=0, atol=1e-9)


def test_a_thin_lens_is_what_paraxial_optics_says() -> None:
    stop = {"radius_mm": None, "gap_mm": 0.0, "index": 1.0, "diameter_mm": 5.0}
    front = {"radius_mm": 60.0, "gap_mm": 1e-6, "index": 1.5, "diameter_mm": 9.0}
    back = {"radius_mm": -60.0, "gap_mm": 0.0, "index": 1.0, "diameter_mm": 9.0}
    lens = {"name": "thin", "surfaces": [stop, front, back], "stop": 0}
    at_infinity = paraxial(Prescription.model_validate(lens))
    assert at_infinity.focal_mm == pytest.approx(60.0, rel=1e-6)  # 1 / ((n - 1) (1/R1 - 1/R2))
    assert at_infinity.film_mm == pytest.approx(60.0, rel=1e-6)
    near = paraxial(Prescription.model_validate({**lens, "focus_mm": 300.0}))
    assert 1 / near.film_mm == pytest.approx(1 / 60 - 1 / 300, rel=1e-6)


def test_the_double_gauss_has_the_focal_length_of_its_table() -> None:
    assert paraxial(load_prescription("double-gauss")).focal_mm == pytest.approx(100.0, rel=0.01)
    assert set(prescription_names()) == {"double-gauss", "webcam-doublet"}


def test_beyond_its_field_a_prescription_sees_nothing_and_says_so() -> None:
    camera = make("prescription", 300.0, prescription=load_prescription("webcam-doublet"))
    rays = camera.rays(np.array([[322.4, 237.1], [639.0, 479.0]]))
    np.testing.assert_array_equal(rays.ok, [True, False])
    with pytest.raises(InputError, match=r"pixel .* sees no direction. Raise focal_px"):
        require_rays_everywhere("left", camera)


def test_points_before_the_window_are_not_imaged() -> None:
    camera = CAMERAS["water"]
    assert not camera.project(np.array([[0.0, 0.0, 150.0], [0.0, 0.0, -400.0]]) - POSE[:3, 3]).ok.any()


def test_records_keep_glass_and_surfaces(camera: Camera, pixels: np.ndarray) -> None:
    text = CameraRecord.of(camera).model_dump_json()
    again = CameraRecord.model_validate_json(text).camera()
    np.testing.assert_array_equal(again.rays(pixels).direction, camera.rays(pixels).direction)


@pytest.mark.parametrize(
    ("lens", "parts", "said"),
    [
        ("prescription", {}, "has a prescription if"),
        ("pinhole", {"prescription": load_prescription("double-gauss")}, "and only then"),
    ],
)
def test_a_prescription_goes_with_its_lens_name(lens: str, parts: dict[str, object], said: str) -> None:
    with pytest.raises(InputError, match=said):
        make(lens, **parts)
