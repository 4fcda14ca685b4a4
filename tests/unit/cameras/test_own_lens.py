"""A lens model from outside: the division model, registered without touching a file of the package."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import jaxtyping
import numpy as np
import pytest

from labcal import pipeline
from labcal.calibrate.handheld import HandheldSettings
from labcal.cameras.camera import Camera
from labcal.cameras.field import Direction, FallOff, FieldPoint, SceneRay
from labcal.cameras.interop.held_lenses import held_lenses, holding_formats, holds
from labcal.cameras.interop.registry import FORMATS
from labcal.cameras.lens import LENSES, lens_by_name, register_lens
from labcal.cameras.mathematics import Mathematics, Number
from labcal.cameras.rig import Rig
from labcal.cameras.rig_file import read_rig, write_rig
from labcal.correspond.detections import Detections
from labcal.errors import InputError, InputTypeError
from labcal.targets.grid import DotGrid

LAMBDA = -0.12
K = np.array([[700.0, 0.0, 322.4], [0.0, 704.0, 237.1], [0.0, 0.0, 1.0]])


@dataclass(frozen=True)
class Division:
    """Fitzgibbon (2001): a point at r is undistorted to r / (1 + lambda r^2), both ways in closed form."""

    name: str = "division"
    coefficients: int = 1
    names: tuple[str, ...] = ("lambda",)
    undistorted: tuple[float, ...] = (0.0,)
    ranges: tuple[tuple[float, float], ...] | None = None
    opencv: None = None
    fall_off: FallOff = FallOff.COS4
    rectilinear: bool = True
    central: bool = True
    parallel: bool = False

    def undistorted_radius(self, angle: float) -> float:
        return float(np.tan(angle))

    def formula(self, _m: Mathematics, dist: tuple[Number, ...]) -> tuple[Number, ...]:
        return dist[:1]

    def forward_parameters(self, _m: Mathematics, dist: tuple[Number, ...]) -> tuple[Number, ...]:
        return dist[:1]

    def parameters(self, _m: Mathematics, dist: tuple[Number, ...], _reach: float) -> tuple[Number, ...]:
        return dist[:1]

    def distort(
        self, m: Mathematics, parameters: tuple[Number, ...], a: Number, b: Number
    ) -> tuple[Number, Number]:
        ratio = 2.0 / (1.0 + m.sqrt(1.0 - 4.0 * parameters[0] * (a * a + b * b)))
        return a * ratio, b * ratio

    def field_point(self, m: Mathematics, parameters: tuple[Number, ...], direction: Direction) -> FieldPoint:
        X, Y, Z = direction
        depth = m.where(Z > 0.0, Z, 1.0)
        return FieldPoint(X / depth, Y / depth, (Z > 0.0) & self.is_imaged(parameters, X / depth, Y / depth))

    def undistort(self, _m: Mathematics, parameters: tuple[Number, ...], x: Number, y: Number) -> FieldPoint:
        below = 1.0 + parameters[0] * (x * x + y * y)
        return FieldPoint(x / below, y / below, below > 0.0)

    def is_imaged(self, parameters: tuple[Number, ...], a: Number, b: Number) -> Number:
        return 4.0 * parameters[0] * (a * a + b * b) < 1.0

    def chief_ray(self, m: Mathematics, _parameters: tuple[Number, ...], a: Number, b: Number) -> SceneRay:
        Z = 1.0 / m.sqrt(a * a + b * b + 1.0)
        return SceneRay((0.0 * Z, 0.0 * Z, 0.0 * Z), (a * Z, b * Z, Z), Z > 0.0)


@pytest.fixture
def division(monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """The lens, known to labcal while the test runs."""
    for name in LENSES:
        monkeypatch.setitem(LENSES, name, LENSES[name])
    register_lens(Division())
    yield "division"
    del LENSES["division"]


def pixels_of(p: np.ndarray, strength: float) -> np.ndarray:
    """Return pixels of points (mm) by the quadratic equation of the model, in NumPy alone."""
    x, y = p[:, 0] / p[:, 2], p[:, 1] / p[:, 2]
    r = np.hypot(x, y)
    distorted = np.array([min(np.roots([strength * one, -1.0, one]), key=abs) for one in r])
    return np.column_stack((K[0, 0] * x * distorted / r + K[0, 2], K[1, 1] * y * distorted / r + K[1, 2]))


def camera(name: str) -> Camera:
    return Camera(K, name, np.array([LAMBDA, 0.0, 0.0, 0.0, 0.0]), np.eye(4), (640, 480))


def test_it_projects_inverts_and_has_derivatives(division: str) -> None:
    rng = np.random.default_rng(4)
    p = rng.uniform([-300.0, -200.0, 800.0], [300.0, 200.0, 1500.0], (200, 3))
    found = camera(division).project(p)
    assert found.ok.all()
    np.testing.assert_allclose(found.q, pixels_of(p, LAMBDA), rtol=0, atol=1e-9)
    rays = camera(division).rays(found.q)
    np.testing.assert_allclose(rays.direction, p / np.linalg.norm(p, axis=1)[:, None], rtol=0, atol=1e-12)
    slope = (pixels_of(p, LAMBDA + 1e-6) - pixels_of(p, LAMBDA - 1e-6)) / 2e-6
    np.testing.assert_allclose(camera(division).intrinsic_jacobian(p)[:, :, 4], slope, rtol=0, atol=1e-5)


def test_a_rig_with_it_is_calibrated_from_dots_within_what_it_states(
    division: str, grid: DotGrid, poses: dict[str, np.ndarray], tmp_path: Path
) -> None:
    rng, T = np.random.default_rng(8), np.eye(4)
    T[0, 3] = -60.0
    parts = [
        (view, name, pixels_of((grid.points() @ P[:3, :3].T + P[:3, 3]) + shift, LAMBDA))
        for view, P in poses.items()
        for name, shift in (("left", 0.0), ("right", T[:3, 3]))
    ]
    n, count = grid.count, grid.count * len(parts)
    dots = Detections(
        view=np.repeat(np.array([part[0] for part in parts]), n),
        camera=np.repeat(np.array([part[1] for part in parts]), n),
        image=np.repeat(np.array([f"{part[0]}_{part[1]}.png" for part in parts]), n),
        size=np.tile(np.array([[640, 480]]), (count, 1)),
        index=np.tile(grid.indices().astype(np.int64), (len(parts), 1)),
        has_id=np.ones(count, dtype=bool),
        position=np.concatenate([part[2] for part in parts]) + 0.02 * rng.normal(size=(count, 2)),
        covariance=np.tile(0.02**2 * np.eye(2), (count, 1, 1)),
        flag=np.full(count, "ok", dtype="<U16"),
    )
    made = pipeline.calibrate(grid, dots, division, HandheldSettings(eccentricity_rounds=0))
    assert made.found.rms_px == pytest.approx(0.02 * np.sqrt(2.0), rel=0.2)
    for name in ("left", "right"):
        found, sigma = made.rig.camera(name), made.found.fits[name].sigma
        assert found.lens == division
        assert abs(found.dist[0] - LAMBDA) < 3.0 * sigma.dist[0] < 0.03
        off = np.abs(np.subtract(found.intrinsics, (K[0, 0], K[1, 1], K[0, 2], K[1, 2])))
        assert (off < 3.0 * np.array(sigma.intrinsics)).all()
    write_rig(tmp_path / "rig.json", made.rig)
    assert read_rig(tmp_path / "rig.json") == made.rig


def test_files_of_other_systems_refuse_it_by_name(division: str) -> None:
    rig = Rig.of({"left": camera(division)})
    assert holding_formats(division) == ("labcal",)
    for name, one in FORMATS.items():
        if name == "labcal":
            one.write(rig, ".json")
        else:
            with pytest.raises(InputError, match="division"):
                one.write(rig, one.suffixes[0])


def test_without_registration_it_is_unknown(tmp_path: Path, division: str) -> None:
    write_rig(tmp_path / "rig.json", Rig.of({"left": camera(division)}))
    LENSES.pop(division)
    try:
        with pytest.raises(InputError, match="no lens model named 'division'"):
            read_rig(tmp_path / "rig.json")
    finally:
        register_lens(Division())
    assert isinstance(lens_by_name(division), Division)


@pytest.mark.parametrize(
    ("lens", "said"),
    [
        (Division(name="brown5"), "'brown5' is a name of labcal's already"),
        (Division(name="auto"), "'auto' is a name of labcal's already"),
        (Division(name="my lens"), "letters, digits and hyphens"),
        (Division(coefficients=2), r"has 2 coefficients with the names \('lambda',\)"),
        (Division(coefficients=2, names=("k", "k")), "each with a name of its own"),
        (Division(coefficients=15, names=tuple("abcdefghijklmno")), "up to 14"),
    ],
    ids=str,
)
def test_a_lens_that_could_not_be_used_is_refused(lens: Division, said: str) -> None:
    with pytest.raises(InputError, match=said):
        register_lens(lens)
    assert "division" not in LENSES


@pytest.fixture
def unchecked_types() -> Iterator[None]:
    """Let through what the tests' checker of annotations would refuse before labcal can."""
    jaxtyping.config.update("jaxtyping_disable", True)
    yield
    jaxtyping.config.update("jaxtyping_disable", False)


@pytest.mark.usefixtures("unchecked_types")
def test_what_is_no_lens_is_told_what_it_lacks(division: str) -> None:
    class Half:
        name = "half"

    with pytest.raises(InputTypeError, match=r"it lacks coefficients, names, .*is_imaged, chief_ray"):
        register_lens(Half())  # type: ignore[arg-type]
    assert register_lens(replace(Division(), rectilinear=False)).name == division  # a cell, run again


def test_what_formats_hold_is_found_by_writing() -> None:
    # docs/reference/formats.md: what each refuses of the perspective lenses and the fisheye.
    assert not holds(FORMATS["mrcal"], "fisheye-kb4")
    assert not holds(FORMATS["mrcal"], "tilted14")
    assert holds(FORMATS["kalibr"], "fisheye-kb4")
    assert not holds(FORMATS["kalibr"], "rational8")
    assert not holds(FORMATS["colmap"], "thin-prism12")
    assert not holds(FORMATS["dice"], "fisheye-kb4")
    assert held_lenses(FORMATS["labcal"]) == tuple(LENSES)
