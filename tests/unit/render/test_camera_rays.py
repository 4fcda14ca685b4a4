import numpy as np
import pytest

from labcal.cameras.camera import Camera
from labcal.cameras.prescription import load_prescription
from labcal.cameras.window import FlatWindow, Wave, WavyWindow
from labcal.render.camera_rays import CameraRays, Pixels, Shading
from labcal.render.samples import Samples
from labcal.render.variant import MONO, Jit, renderer
from labcal.scene.camera import Aperture, CameraDescription
from labcal.scene.catalogue import load_scene

PLAIN = Shading()
WEBCAM = load_scene("webcam-plane").cameras["left"]


def changed(**values: object) -> CameraDescription:
    """Return the webcam with some things different."""
    return CameraDescription.model_validate({**WEBCAM.model_dump(), "dist": (), **values})


LARGE = {"size": (5472, 3648), "principal_px": None}
RATIONAL = (0.9, -0.4, 0.0006, -0.0004, 0.05, 1.25, -0.2, 0.03)
PRISM = (0.002, -0.001, -0.0015, 0.0008)
WAVE = {"amplitude_px": (3.0, 1.0), "period_px": 300.0, "direction_deg": 30.0}
CAMERAS = {
    "webcam": WEBCAM,
    "still": load_scene("still-plane").cameras["right"],
    "pinhole": changed(lens="pinhole"),
    "brown, 20 megapixels": changed(**LARGE, focal_px=5200.0, dist=(-0.2, 0.05, 0.0004, -0.0006)),
    "rational, 20 megapixels": changed(**LARGE, focal_px=5200.0, lens="rational8", dist=RATIONAL),
    "thin prism": changed(lens="thin-prism12", dist=(*RATIONAL, *PRISM)),
    "tilted": changed(lens="tilted14", dist=(*RATIONAL, *PRISM, 0.06, -0.09)),
    "fisheye of 155 degrees": changed(lens="fisheye-kb4", focal_px=300.0, dist=(-0.04, 0.01, -0.006, 0.001)),
    "double sphere of 155 degrees": changed(lens="double-sphere", focal_px=240.0, dist=(-0.2, 0.6)),
    "eucm of 145 degrees": changed(lens="eucm", focal_px=300.0, dist=(0.6, 1.1)),
    "omnidirectional of 160 degrees": changed(
        lens="omni-radtan", focal_px=640.0, dist=(1.2, -0.1, 0.02, 6e-4, -4e-4)
    ),
    "telecentric, 12 mm across": changed(
        lens="telecentric", focal_px=100.0, dist=(-2e-3, 1e-5, 2e-5, -3e-5, 1e-7)
    ),
    "prescription": changed(lens="prescription", prescription="webcam-doublet"),
    "prescription, 20 megapixels": changed(
        **LARGE, focal_px=12000.0, lens="prescription", prescription="double-gauss"
    ),
    "water": changed(window=FlatWindow(distance_mm=200.0, tilt_x_deg=30.0, behind_index=1.333).model_dump()),
    "waves": changed(window=WavyWindow(waves=(Wave.model_validate(WAVE),)).model_dump()),
}


def pixels(mi: Jit, q: np.ndarray) -> Pixels:
    """Return positions on a picture, each a pixel of its own with one sample."""
    lane = mi.UInt32(np.arange(len(q), dtype=np.uint32))
    return Pixels(mi.Float64(q[:, 0]), mi.Float64(q[:, 1]), Samples(mi, lane, mi.UInt32(0), mi.UInt32(7), 1))


def traced(mi: Jit, camera: CameraRays, q: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return origins, directions and weights of the rays of pixels."""
    ray, weight = camera.rays(pixels(mi, q))
    direction = np.array(ray.d, np.float64).T
    # The rays of a central camera share one origin.
    return np.broadcast_to(np.array(ray.o, np.float64).T, direction.shape), direction, np.array(weight)


def spread(camera: Camera, count: int = 100_000) -> np.ndarray:
    """Return random pixels all over a picture."""
    width, height = camera.size
    return np.random.default_rng(5).uniform([-0.5, -0.5], [width - 0.5, height - 0.5], (count, 2))


@pytest.mark.parametrize("name", CAMERAS)
def test_rays_for_mitsuba_are_the_cameras_own(name: str) -> None:
    camera = CAMERAS[name].camera()
    q = spread(camera)
    with renderer(MONO) as mi:
        origin, direction, weight = traced(mi, CameraRays(mi, camera, None, PLAIN), q)
    assert (weight == 1.0).all()
    rays = camera.rays(q)
    np.testing.assert_allclose(origin, rays.origin, rtol=0, atol=2e-4)  # float32 of some 2000 mm
    back = camera.project(rays.origin + 1500.0 * direction)
    assert back.ok.all()
    assert np.linalg.norm(back.q - q, axis=1).max() < 1e-3


def test_coefficients_left_out_are_those_of_no_distortion() -> None:
    """Zeros would be no lens of the enhanced unified model, whose beta is positive."""
    assert changed(lens="eucm").camera().dist.tolist() == [0.5, 1.0, 0.0, 0.0, 0.0]
    assert changed(lens="brown5", dist=(-0.1,)).camera().dist.tolist() == [-0.1, 0.0, 0.0, 0.0, 0.0]
    with pytest.raises(ValueError, match=r"dist\[1\] \(beta\) is -1"):
        changed(lens="eucm", dist=(0.6, -1.0))


def test_where_the_lens_has_no_ray_the_picture_is_black() -> None:
    camera = WEBCAM.model_copy(update={"dist": (-0.9, 0.0, 0.0, 0.0, 0.0)}).camera()
    q = spread(camera, 20_000)
    expected = camera.rays(q).ok
    with renderer(MONO) as mi:
        origin, direction, weight = traced(mi, CameraRays(mi, camera, None, PLAIN), q)
    got = weight > 0.0
    assert not expected.all()
    # Right at the fold Newton converges slowly and gives up a little earlier: black, never wrong.
    assert not (got & ~expected).any()
    assert (got != expected).mean() < 0.01
    assert np.isfinite(origin).all()
    assert np.isfinite(direction).all()


@pytest.mark.parametrize("lens", ["brown5", "double-gauss"])
def test_an_open_lens_is_sharp_where_it_is_focused(lens: str) -> None:
    optics = {"lens": "brown5"} if lens == "brown5" else {"lens": "prescription", "prescription": lens}
    focal = {"focal_px": 1400.0, "principal_px": None}
    open_at = {"aperture": {"diameter_mm": 20.0, "focus_mm": 800.0}}
    description = changed(**optics, **focal, **open_at)
    camera = description.camera()
    q = np.tile([[319.5, 239.5], [420.0, 300.0]], (4000, 1))
    with renderer(MONO) as mi:
        origin, direction, weight = traced(mi, CameraRays(mi, camera, description.aperture, PLAIN), q)
    forward = camera.T_cam_world[2, :3]
    passes = weight > 0.0
    assert passes.mean() > 0.5
    spreads = []
    for distance in (800.0, 1600.0):
        along = (distance - (origin - camera.centre) @ forward) / (direction @ forward)
        seen = camera.project(origin + along[:, None] * direction).q - q
        spreads.append(np.sqrt((np.linalg.norm(seen[passes], axis=1) ** 2).mean()))
    # Focused near by, a real lens has its film farther away, and so a larger picture.
    ahead = camera.centre + 1600.0 * forward
    scale = 1600.0 * np.linalg.norm(camera.point_jacobian(ahead) @ camera.T_cam_world[0, :3])
    # A disc of 20 mm, out of focus from 800 to 1600 mm.
    expected = 20.0 / np.sqrt(8.0) * (1 / 800 - 1 / 1600) * scale
    assert spreads[1] == pytest.approx(expected, rel=0.05)
    assert spreads[0] < (1e-3 if lens == "brown5" else 0.6)  # a real lens has aberrations, too
    assert Aperture.model_validate(open_at["aperture"]) == description.aperture


def test_light_falls_off_with_the_fourth_power_of_the_cosine_and_towards_the_corners() -> None:
    camera = changed(lens="pinhole", principal_px=None).camera()
    q = np.array([[319.5, 239.5], [639.5, 479.5], [0.0, 239.5]])
    cosine = 700.0 / np.sqrt(700.0**2 + ((q - [319.5, 239.5]) ** 2).sum(axis=1))
    with renderer(MONO) as mi:
        _, _, weight = traced(mi, CameraRays(mi, camera, None, Shading(fall_off=True)), q)
        np.testing.assert_allclose(weight, cosine**4, rtol=1e-6)
        _, _, weight = traced(mi, CameraRays(mi, camera, None, Shading(vignetting=0.3)), q)
        np.testing.assert_allclose(weight[:2], [1.0, 0.7], atol=1e-6)


def test_a_prescription_loses_as_much_light_closed_as_open() -> None:
    """The polynomial of a closed lens against the rays that pass an open one."""
    closed = changed(lens="prescription", prescription="double-gauss", focal_px=900.0, principal_px=None)
    lens = load_prescription("double-gauss")
    widest = lens.surfaces[lens.stop].diameter_mm / 0.6893742
    opened = closed.model_copy(update={"aperture": Aperture(diameter_mm=0.99999 * widest, focus_mm=1e7)})
    places = np.array([[319.5, 239.5], [450.0, 300.0], [639.0, 479.0]])
    with renderer(MONO) as mi:
        falling = CameraRays(mi, closed.camera(), None, Shading(fall_off=True))
        _, _, expected = traced(mi, falling, places)
        wide_open = CameraRays(mi, opened.camera(), opened.aperture, PLAIN)
        found = [traced(mi, wide_open, np.tile(q, (40_000, 1)))[2].mean() for q in places]
    assert expected[2] < 0.8 * expected[0]
    np.testing.assert_allclose(found, expected, atol=0.02)


def test_the_variant_in_use_before_is_put_back() -> None:
    with renderer(MONO) as mi:
        before = mi.variant()
        with renderer("llvm_ad_rgb"):
            assert mi.variant() == "llvm_ad_rgb"
        assert mi.variant() == before
