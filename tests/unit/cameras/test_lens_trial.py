"""A user's lens model that is wrong is refused when it is registered, with the part that is wrong."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import jaxtyping
import numpy as np
import pytest

from labcal.cameras.camera import Camera
from labcal.cameras.field import FallOff, FieldPoint
from labcal.cameras.lens import LENSES, MOST_COEFFICIENTS, register_lens
from labcal.cameras.lens_trial import require_working
from labcal.cameras.opencv_model import FISHEYE
from labcal.cameras.perspective import Perspective
from labcal.errors import InputError, InputTypeError

X = np.array([0.0, 0.1])


@pytest.fixture(autouse=True)
def unchecked_types(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Let through what the tests' checker of annotations would refuse before labcal can."""
    for name in LENSES:
        monkeypatch.setitem(LENSES, name, LENSES[name])
    jaxtyping.config.update("jaxtyping_disable", True)
    yield
    jaxtyping.config.update("jaxtyping_disable", False)
    LENSES.pop("mine", None)


@dataclass(frozen=True)
class Mine(Perspective):
    """Brown's k1 and k2 under another name, with whatever is set in its place."""

    opencv = None
    undistorted: Any = (0.0, 0.0)
    names: Any = ("k1", "k2")
    ranges: Any = None
    fall_off: Any = FallOff.COS4


MINE = Mine("mine", 2)


def changed(name: str, method: object) -> Mine:
    """Return an object whose class has another method or attribute."""
    made: Mine = dataclass(frozen=True)(type("Changed", (Mine,), {name: method}))("mine", 2)
    return made


@pytest.mark.parametrize("name", LENSES)
def test_labcals_lenses_pass(name: str) -> None:
    require_working(LENSES[name], MOST_COEFFICIENTS)


def test_one_that_works_is_registered_again_and_again() -> None:
    for _ in range(2):
        assert register_lens(MINE) is MINE


@pytest.mark.parametrize(
    ("lens", "said"),
    [
        (replace(MINE, name="Brown5"), "'Brown5' is a name of labcal's already, but for capital letters"),
        (replace(MINE, name="Auto"), "but for capital letters: 'auto'"),
        (replace(MINE, name=None), "needs a name of letters, digits and hyphens, but has None"),
        (replace(MINE, name="mi\n"), "needs a name of letters, digits and hyphens"),
        (replace(MINE, names="kq"), "each with a name of its own, in a tuple"),
        (replace(MINE, names=(1, 2)), "each with a name of its own, in a tuple"),
        (replace(MINE, coefficients=2.0), r"has 2\.0 coefficients"),
        (replace(MINE, undistorted=(0.0,)), "'undistorted' is .* should be a tuple of 2 finite numbers"),
        (replace(MINE, undistorted=(0.0, np.nan)), "'undistorted' is .* should be a tuple of 2 finite"),
        (
            replace(MINE, ranges=((1.0, -1.0), (0.0, 1.0))),
            "'ranges' is .* should be None, or a tuple of 2",
        ),
        (replace(MINE, ranges=((0.5, 1.0), (0.0, 1.0))), "'undistorted' is .* not within its ranges"),
        (replace(MINE, fall_off="cos4"), "'fall_off' is 'cos4', but should be None, or a FallOff"),
        (changed("opencv", FISHEYE), None),
        (changed("opencv", "fisheye"), "'opencv' is 'fisheye', but should be None, or a model"),
        (changed("central", "yes"), "'central' is 'yes', but should be True or False"),
    ],
    ids=lambda one: one if isinstance(one, str) else "",
)
def test_what_it_declares_wrongly_is_named(lens: Mine, said: str | None) -> None:
    if said is None:  # k1 and k2 are names of the fisheye's, too
        assert register_lens(lens) is lens
        return
    with pytest.raises(InputError, match=said):
        register_lens(lens)
    assert "mine" not in LENSES


@pytest.mark.parametrize(
    ("name", "method", "said"),
    [
        ("distort", lambda _self, _p, a, b: (a, b), "'distort' failed .TypeError"),
        ("distort", lambda _self, _m, _p, a, b: (a * np.nan, b), "'distort' should return 2 finite float64"),
        ("distort", lambda _self, _m, _p, a, b: [a, b], "'distort' should return 2 finite float64"),
        ("distort", lambda _self, _m, _p, a, b: (a, b, a), "'distort' should return 2 finite float64"),
        ("distort", lambda *_: {}["k"], "'distort' failed .KeyError: 'k'"),
        ("distort", lambda *_: (_ for _ in ()).throw(SystemExit(3)), "'distort' failed .SystemExit: 3"),
        (
            "distort",
            lambda _self, _m, p, a, b: (
                np.sqrt(a * a + p[0]) * np.sign(a),
                np.sqrt(b * b + p[0]) * np.sign(b),
            ),
            "'distort' for dual numbers, which carry derivatives, failed .TypeError",
        ),
        ("distort", lambda _self, _m, _p, a, b: (a, b), "'distort' does not depend on the coefficient 'k1'"),
        ("undistort", lambda _self, _m, _p, x, y: FieldPoint(2.0 * x, y, x == x), "does not lead back"),  # noqa: PLR0124 -- an array that is true
        ("undistort", lambda _self, _m, _p, x, y: (x, y, True), "'undistort' should return a FieldPoint"),
        ("undistort", lambda _self, _m, _p, x, y: FieldPoint(x, y, x > 9.0), "'undistort' should state"),
        ("is_imaged", lambda _self, _p, a, _b: a > 9.0, "'field_point' should state, in an array"),
        ("formula", lambda _self, _m, dist: list(dist), "'formula' should return a tuple of numbers"),
        (
            "formula",
            lambda _self, _m, dist: (*dist[:-1], np.nan),
            "'formula' should return a tuple of numbers",
        ),
        ("forward_parameters", lambda _self, _m, _d: (7.0,), "should begin with what 'formula' returns"),
        ("parameters", lambda _self, _m, _d, _r: (7.0,), "should begin with what 'forward_parameters' ret"),
        ("chief_ray", lambda *_: None, "'chief_ray' should return a SceneRay"),
        ("undistorted_radius", lambda _self, _angle: -1.0, "'undistorted_radius' is -1.0 for 0.1 rad"),
        ("rectilinear", property(lambda _self: {}["r"]), "its 'rectilinear' failed .KeyError: 'r'"),
    ],
)
def test_what_it_computes_wrongly_is_named(name: str, method: object, said: str) -> None:
    lens = changed(name, method)
    with pytest.raises(InputError, match=said):
        register_lens(lens)
    assert "mine" not in LENSES


def test_a_wrong_derivative_is_found() -> None:
    """The values are those of Brown's lens, but the part of k2 is taken for a constant."""

    class Half(Mine):
        def distort(self, m, parameters, a, b):  # noqa: ANN001, ANN202 -- as the protocol has it
            k2 = getattr(parameters[1], "value", parameters[1])
            return super().distort(m, (parameters[0], k2, *parameters[2:]), a, b)

    with pytest.raises(InputError, match="'distort' has a derivative by k2 of 0, but its values change by"):
        register_lens(dataclass(frozen=True)(Half)("mine", 2, (0.0, 0.5)))


def test_a_class_is_not_taken_for_an_object() -> None:
    with pytest.raises(InputTypeError, match="is an object, but Mine is a class"):
        register_lens(Mine)  # type: ignore[arg-type]
    with pytest.raises(InputTypeError, match="class 'NoneType' is no lens model: it lacks name"):
        register_lens(None)  # type: ignore[arg-type]


def test_where_a_lens_gives_no_number_nothing_is_imaged() -> None:
    """Near the axis it is one; farther out it returns NaN and states that it images."""

    class Holey(Mine):
        def distort(self, m, parameters, a, b):  # noqa: ANN001, ANN202 -- as the protocol has it
            x, y = super().distort(m, parameters, a, b)
            return m.where(a * a + b * b < 0.04, x, np.nan), y

    register_lens(dataclass(frozen=True)(Holey)("mine", 2))
    K = np.array([[500.0, 0, 320], [0, 500, 240], [0, 0, 1]])
    camera = Camera(K, "mine", np.zeros(5), np.eye(4), (640, 480))
    found = camera.project([[0.0, 0, 1], [0.5, 0, 1], [np.inf, 0, 1], [np.nan, 0, 1]])
    assert found.ok.tolist() == [True, False, False, False]
    assert np.isnan(found.q[1:]).all()
