"""The lenses of the unified family against their papers, written out for one point at a time."""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from labcal.cameras.blind_pixels import require_rays_everywhere
from labcal.cameras.camera import Camera
from labcal.cameras.interop.exchange import SourceText
from labcal.cameras.interop.registry import FORMATS
from labcal.cameras.interop.rig_files import read_rig_files
from labcal.cameras.rig import Rig
from labcal.cameras.rig_file import read_rig, write_rig
from labcal.cameras.window import FlatWindow
from labcal.errors import InputError

Point = tuple[float, float]


def camera(lens: str, *dist: float, focal_px: float = 300.0) -> Camera:
    matrix = np.array([[focal_px, 0.0, 322.4], [0.0, 0.98 * focal_px, 237.1], [0.0, 0.0, 1.0]])
    return Camera(matrix, lens, np.array([*dist, *(0.0,) * (5 - len(dist))]), np.eye(4), (640, 480))


def double_sphere(p: np.ndarray, xi: float, alpha: float) -> Point:
    """Usenko et al., equations 40 to 42."""
    x, y, z = p
    d1 = math.sqrt(x**2 + y**2 + z**2)
    d2 = math.sqrt(x**2 + y**2 + (xi * d1 + z) ** 2)
    below = alpha * d2 + (1 - alpha) * (xi * d1 + z)
    return x / below, y / below


def enhanced_unified(p: np.ndarray, alpha: float, beta: float) -> Point:
    """Khomutenko et al., equations 9 and 10."""
    x, y, z = p
    rho = math.sqrt(beta * (x**2 + y**2) + z**2)
    return x / (alpha * rho + (1 - alpha) * z), y / (alpha * rho + (1 - alpha) * z)


def omnidirectional(p: np.ndarray, xi: float, k1: float, k2: float, p1: float, p2: float) -> Point:
    """Mei and Rives, section II: sphere, shift, plane, distortion; by angles."""
    x, y, z = p
    theta, phi = math.atan2(math.hypot(x, y), z), math.atan2(y, x)
    rho = math.sin(theta) / (math.cos(theta) + xi)
    u, v = rho * math.cos(phi), rho * math.sin(phi)
    radial = 1 + k1 * rho**2 + k2 * rho**4
    return (
        u * radial + 2 * p1 * u * v + p2 * (rho**2 + 2 * u**2),
        v * radial + p1 * (rho**2 + 2 * v**2) + 2 * p2 * u * v,
    )


PAPERS: dict[str, Callable[..., Point]] = {
    "double-sphere": double_sphere,
    "eucm": enhanced_unified,
    "omni-radtan": omnidirectional,
}
CASES = [
    ("double-sphere", (-0.2, 0.59)),
    ("double-sphere", (0.3, 0.3)),
    ("double-sphere", (0.0, 0.0)),
    ("eucm", (0.6, 1.1)),
    ("eucm", (0.4, 0.9)),
    ("eucm", (0.5, 1.0)),
    ("omni-radtan", (1.2, -0.1, 0.02, 1e-3, -2e-3)),
    ("omni-radtan", (0.7, -0.1, 0.05, 6e-4, -4e-4)),
    ("omni-radtan", (0.0, -0.2, 0.05, 6e-4, -4e-4)),
]


def directions(widest_deg: float, count: int = 400) -> np.ndarray:
    random = np.random.default_rng(11)
    theta, phi = np.radians(random.uniform(0.0, widest_deg, count)), random.uniform(0, 2 * np.pi, count)
    theta[0] = 0.0
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)


def end_deg(one: Camera) -> float:
    """Return where the image of a growing angle ends or turns back, by a scan of the paper's formula."""
    angles = np.linspace(1e-3, math.pi - 1e-3, 40_001)
    before = 0.0
    for angle in angles:
        p = np.array([math.sin(angle), 0.0, math.cos(angle)])
        x, y = PAPERS[one.lens](p, *one.dist[: one.model.coefficients])
        radius = math.copysign(math.hypot(x, y), x)
        if radius <= before:
            return math.degrees(angle)
        before = radius
    return 180.0


@pytest.mark.parametrize(("lens", "dist"), CASES)
def test_it_projects_as_its_paper_and_back(lens: str, dist: tuple[float, ...]) -> None:
    one = camera(lens, *dist)
    fx, fy, cx, cy = one.intrinsics
    p = directions(0.97 * end_deg(one)) * np.random.default_rng(3).uniform(200.0, 3000.0, (400, 1))
    found = one.project(p)
    assert found.ok.all()
    x, y = np.array([PAPERS[lens](row, *dist) for row in p]).T
    expected = np.stack([fx * x + cx, fy * y + cy], axis=-1)
    near = np.abs(expected - [cx, cy]).max(axis=1) < 3000.0  # of larger figures the last digits are lost
    assert near.mean() > 0.8
    np.testing.assert_allclose(found.q[near], expected[near], rtol=0, atol=1e-9)
    rays = one.rays(found.q[near])
    seen = one.in_picture(found.q[near])
    assert rays.ok[seen].all()
    unit = p[near] / np.linalg.norm(p[near], axis=1, keepdims=True)
    np.testing.assert_allclose(rays.direction[seen], unit[seen], rtol=0, atol=1e-12)
    np.testing.assert_allclose(rays.direction[rays.ok], unit[rays.ok], rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    ("lens", "dist"),
    [
        *CASES,
        ("double-sphere", (1.3, 0.2)),
        ("double-sphere", (1.3, 0.7)),
        ("double-sphere", (-0.4, 0.8)),
        ("eucm", (0.9, 0.6)),
        ("eucm", (-0.1, 1.3)),
        ("eucm", (1.1, 1.0)),
        ("omni-radtan", (1.2, -0.5, 0.0, 0.0, 0.0)),
        ("omni-radtan", (3.0, 0.1, 0.0, 0.0, 0.0)),
    ],
)
def test_beyond_its_field_it_images_nothing(lens: str, dist: tuple[float, ...]) -> None:
    one = camera(lens, *dist)
    end = end_deg(one)
    angle = np.radians(np.linspace(0.05, 179.95, 1800))
    p = np.stack([np.sin(angle), 0.0 * angle, np.cos(angle)], axis=-1)
    found = one.project(p).ok
    short, beyond = np.degrees(angle) < end - 0.06, np.degrees(angle) > end + 0.06
    assert found[short].all()
    assert not found[beyond].any()


@pytest.mark.parametrize(
    ("lens", "dist", "radius"),
    [
        # 1 / sqrt(2 alpha - 1), of the enhanced one over the root of beta (both papers).
        ("double-sphere", (-0.4, 0.8), 1 / math.sqrt(0.6)),
        ("eucm", (0.9, 0.6), 1 / math.sqrt(0.8 * 0.6)),
        ("omni-radtan", (1.5, 0.0, 0.0, 0.0, 0.0), 1 / math.sqrt(1.25)),
    ],
)
def test_pixels_outside_the_round_picture_see_nothing(
    lens: str, dist: tuple[float, ...], radius: float
) -> None:
    one = camera(lens, *dist, focal_px=150.0)
    fx, fy, cx, cy = one.intrinsics
    around = np.linspace(0, 2 * np.pi, 13)[:, None]
    share = np.array([0.2, 0.9, 0.999, 1.001, 1.5, 9.0])
    q = np.stack(
        [cx + fx * radius * share * np.cos(around), cy + fy * radius * share * np.sin(around)], axis=-1
    )
    np.testing.assert_array_equal(one.rays(q).ok, [[True, True, True, False, False, False]] * 13)


def test_they_meet_where_their_formulas_do() -> None:
    """With xi = 0 and with beta = 1 both are the unified model; with alpha = 0 a pinhole."""
    p = 900.0 * directions(70.0)
    unified = camera("eucm", 0.6, 1.0).project(p).q
    np.testing.assert_allclose(camera("double-sphere", 0.0, 0.6).project(p).q, unified, atol=1e-9)
    # f / (alpha d + (1 - alpha) z) = (f / (1 - alpha)) / (z + xi d) with xi = alpha / (1 - alpha).
    mirror = camera("omni-radtan", 1.5, focal_px=300.0 / 0.4)
    np.testing.assert_allclose(mirror.project(p).q, unified, atol=1e-9)
    pinhole = camera("pinhole").project(p).q
    for other in (camera("double-sphere", 0.0, 0.0), camera("eucm", 0.0, 1.0), camera("omni-radtan", 0.0)):
        np.testing.assert_allclose(other.project(p).q, pinhole, atol=1e-9)


@pytest.mark.parametrize(("lens", "dist"), CASES[:1] + CASES[3:4] + CASES[6:7])
def test_behind_a_window_a_ray_passes_the_point_that_is_imaged(lens: str, dist: tuple[float, ...]) -> None:
    plain = camera(lens, *dist)
    one = Camera(plain.K, lens, plain.dist, np.eye(4), plain.size, window=FlatWindow(distance_mm=20.0))
    p = 900.0 * directions(60.0)
    found = one.project(p)
    assert found.ok.all()
    rays = one.rays(found.q)
    assert np.linalg.norm(np.cross(p - rays.origin, rays.direction), axis=1).max() < 1e-6


def test_kalibrs_own_order_is_read() -> None:
    """A chain as Kalibr writes it: the lens's coefficients come before the focal lengths."""
    text = """cam0:
  cam_overlaps: []
  camera_model: ds
  distortion_coeffs: []
  distortion_model: none
  intrinsics: [-0.2, 0.6, 301.0, 302.0, 321.0, 241.0]
  resolution: [640, 480]
  rostopic: /a/image_raw
"""
    for model, parameters, distortion, lens, dist in (
        ("ds", "-0.2, 0.6", ("none", "[]"), "double-sphere", (-0.2, 0.6, 0, 0, 0)),
        ("eucm", "0.6, 1.1", ("none", "[]"), "eucm", (0.6, 1.1, 0, 0, 0)),
        (
            "omni",
            "1.2",
            ("radtan", "[-0.1, 0.02, 0.001, -0.002]"),
            "omni-radtan",
            (1.2, -0.1, 0.02, 0.001, -0.002),
        ),
        ("omni", "1.2", ("none", "[]"), "omni-radtan", (1.2, 0, 0, 0, 0)),
    ):
        own = text.replace("ds\n", f"{model}\n").replace("-0.2, 0.6", parameters)
        own = own.replace("model: none", f"model: {distortion[0]}").replace("[]\n  distortion_m", "@")
        own = own.replace("@", f"{distortion[1]}\n  distortion_m")
        record = read_text("kalibr", "camchain.yaml", own).cameras["a"]
        assert (record.lens, record.dist) == (lens, dist)
        assert record.K == ((301.0, 0.0, 321.0), (0.0, 302.0, 241.0), (0.0, 0.0, 1.0))


def read_text(name: str, file: str, text: str) -> Rig:
    return FORMATS[name].read([SourceText(Path(file), text)]).rig


def test_colmaps_own_order_is_read(tmp_path: Path) -> None:
    (tmp_path / "cameras.txt").write_text("1 EUCM 640 480 301 302 321.5 241.5 0.6 1.1\n")
    (tmp_path / "images.txt").write_text("1 1 0 0 0 0 0 0 1 a.png\n\n")
    record = read_rig_files([tmp_path], "colmap")[1].rig.cameras["a"]
    assert (record.lens, record.dist) == ("eucm", (0.6, 1.1, 0.0, 0.0, 0.0))
    assert record.K == ((301.0, 0.0, 321.0), (0.0, 302.0, 241.0), (0.0, 0.0, 1.0))


@pytest.mark.parametrize("name", ["kalibr", "colmap"])
def test_a_window_is_refused_with_these_lenses_too(name: str) -> None:
    plain = camera("eucm", 0.6, 1.1)
    one = Camera(plain.K, "eucm", plain.dist, np.eye(4), plain.size, window=FlatWindow(distance_mm=20.0))
    with pytest.raises(InputError, match="cannot hold the window of camera 'left'"):
        FORMATS[name].write(Rig.of({"left": one}), "")


@pytest.mark.parametrize(
    ("lens", "dist", "said"),
    [
        ("double-sphere", (-1.5, 0.6), r"dist\[0\] \(xi\)"),
        ("double-sphere", (0.1, 60.0), r"dist\[1\] \(alpha\)"),
        ("eucm", (0.6, -1.0), r"dist\[1\] \(beta\)"),
        ("eucm", (0.6, 0.0), r"dist\[1\] \(beta\)"),
        ("omni-radtan", (-2.0, 0.0, 0.0, 0.0, 0.0), r"dist\[0\] \(xi\)"),
        ("omni-radtan", (1.0, 1e5, 0.0, 0.0, 0.0), r"dist\[1\] \(k1\)"),
        ("omni-radtan", (1.0, -90.0, 0.0, 0.0, 0.0), "sees no direction"),
    ],
)
def test_coefficients_that_make_no_sense_are_refused(
    lens: str, dist: tuple[float, ...], said: str, tmp_path: Path
) -> None:
    path = tmp_path / "rig.json"

    def there_and_back() -> None:
        write_rig(path, Rig.of({"left": camera(lens, *dist)}))
        read_rig(path)

    with pytest.raises(InputError, match=said):
        there_and_back()


def test_a_picture_that_reaches_beyond_its_field_is_told_what_helps() -> None:
    with pytest.raises(InputError, match=r"\(eucm\) folds within its picture.*Raise the focal length"):
        require_rays_everywhere("left", camera("eucm", 0.9, 0.6, focal_px=150.0))
