"""A user's kind of target that is wrong: refused when it is registered, or by what it returns."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import jaxtyping
import numpy as np
import pytest
from matplotlib.path import Path as Outline
from pydantic import BaseModel, ConfigDict

from labcal.correspond.measure import measure_picture
from labcal.correspond.sources import Source
from labcal.detect.detector import detect_dots
from labcal.detect.dots import PictureDots
from labcal.detect.flags import DotFlag, Refusal
from labcal.errors import InputError, InputTypeError
from labcal.targets import registry
from labcal.targets.artwork import export_artwork
from labcal.targets.grid import DotGrid, Polarity
from labcal.targets.registry import TargetKind, register_target

SIZE = (80, 60)
PICTURE = np.zeros(SIZE[::-1], np.uint8)


class Corners(BaseModel):
    """Four corners of a square."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    kind: Literal["corners"] = "corners"
    name: str = "four"
    description: str = ""
    cols: int = 2
    rows: int = 2
    count: int = 4
    extent_mm: tuple[float, float, float, float] = (0.0, 0.0, 10.0, 10.0)
    margin_mm: float = 5.0
    least_margin_mm: float = 0.0
    place_name: str = "corner"
    is_white_on_black: bool = False
    captions: tuple[str, str] = ("four corners", "10 mm")
    sizes: tuple[str, str] = ("10 x 10", "corner")

    def indices(self) -> np.ndarray:
        return np.array([[0, 0], [1, 0], [0, 1], [1, 1]])

    def points(self, indices: np.ndarray | None = None) -> np.ndarray:
        wanted = self.indices() if indices is None else indices
        return np.concatenate([10.0 * wanted, np.zeros((len(wanted), 1))], axis=1)

    def outer_diameters_mm(self) -> np.ndarray:
        return np.zeros(4)

    def symmetric_indices(self, indices: np.ndarray) -> tuple[np.ndarray, ...]:  # noqa: ARG002 -- the form
        return ()


class Another(Corners):
    kind: Literal["others"] = "others"  # type: ignore[assignment]


def returned(**changes: Any) -> Callable[..., PictureDots]:  # noqa: ANN401 -- whatever a user may return
    """Return a detector of four corners, of which some are not as they should be."""

    def detect(_grey: np.ndarray, board: Corners, _settings: object) -> PictureDots:
        good: dict[str, Any] = {
            "size": SIZE, "polarity": Polarity.BLACK_ON_WHITE, "refusal": None, "index": board.indices(),
            "has_id": np.ones(4, dtype=bool), "position": np.arange(8.0).reshape(4, 2),
            "covariance": np.tile(0.01 * np.eye(2), (4, 1, 1)), "misfit": np.full(4, np.nan),
            "flag": (DotFlag.OK,) * 4, "seen_at": np.zeros((4, 2)), "outline": np.full((4, 2, 2), np.nan),
        }  # fmt: skip
        return PictureDots(**(good | changes))

    return detect


def outlines(_board: Corners) -> Outline:
    return Outline.unit_rectangle()


KIND = TargetKind("corners", Corners, returned(), outlines)


@pytest.fixture(autouse=True)
def unchecked_types(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Let through what the tests' checker of annotations would refuse before labcal can."""
    monkeypatch.setattr(registry, "_KINDS", dict(registry._KINDS))
    jaxtyping.config.update("jaxtyping_disable", True)
    yield
    jaxtyping.config.update("jaxtyping_disable", False)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"name": "Charuco"}, "'Charuco' is a name of labcal's already, but for capital letters"),
        ({"name": 5}, "needs a name of letters, digits and hyphens, but has 5"),
        ({"name": "squares"}, r"its model refuses: give it kind: Literal\['squares'\]"),
        ({"model": DotGrid}, "key 'kind', which its model lacks"),
        ({"detector": None}, "'detector' should be a function of .grey, target, settings., but is None"),
        ({"detector": outlines}, "'detector' should be a function of .* .too many positional"),
        ({"outlines": returned()}, "'outlines' should be a function of .target. .missing a req"),
    ],
    ids=["capitals", "number", "literal", "model", "no-detector", "wrong-detector", "wrong-outlines"],
)
def test_a_kind_that_could_not_be_used_is_refused(changes: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        register_target(replace(KIND, **changes))
    assert "corners" not in registry.target_kinds()


def test_what_is_no_kind_is_refused_by_its_type() -> None:
    for wrong in (None, Corners):
        with pytest.raises(InputTypeError, match="should be a TargetKind"):
            register_target(wrong)  # type: ignore[arg-type]
    for model in (dict, Corners()):
        with pytest.raises(InputTypeError, match="should be a class of pydantic's BaseModel"):
            register_target(replace(KIND, model=model))


def test_kinds_are_told_apart_by_their_names_and_models() -> None:
    register_target(KIND)
    assert register_target(replace(KIND)) == KIND  # a cell of a notebook, run again
    with pytest.raises(InputError, match="'Corners' differs from 'corners', which is registered"):
        register_target(replace(KIND, name="Corners"))

    class Loose(Corners):
        kind: str = "corners"  # type: ignore[assignment]

    register_target(TargetKind("others", Another, returned(), outlines))
    register_target(TargetKind("loose", Loose, returned(), outlines))
    with pytest.raises(InputError, match="is that of the kind 'loose', from which it could not be told"):
        register_target(TargetKind("looser", Loose, returned(), outlines))


def test_a_detector_that_returns_what_it_should_is_used() -> None:
    register_target(KIND)
    dots = detect_dots(PICTURE, Corners())
    assert dots.ok.sum() == 4


@pytest.mark.parametrize(
    ("detector", "said"),
    [
        (lambda *_: {}["k"], "its 'detector' failed .KeyError: 'k'"),
        (lambda *_: (_ for _ in ()).throw(SystemExit(3)), "its 'detector' failed .SystemExit: 3"),
        (lambda *_: None, "should return PictureDots, not NoneType"),
        ("labcal.nowhere:detect", "There is no module 'labcal.nowhere'"),
        ("labcal.detect.detector:detct_dots", "Did you mean 'detect_dots'"),
        ("labcal.detect.detector", "names no function. Its form is package.module:function"),
        ("labcal.version:__doc__", "should be a function, or where one is"),
        (returned(size=(60, 80)), r"size is \(60, 80\), but the picture's is \(80, 60\)"),
        (returned(refusal="no-grid"), "refusal is 'no-grid', but should be None or a Refusal"),
        (returned(refusal=Refusal.NO_GRID), "refusal is given, though dots are ok"),
        (returned(flag=("ok",) * 4), "flag should be a tuple of DotFlag"),
        (returned(flag=(DotFlag.OK,) * 3), r"should be an array of integer and of shape \(3, 2\)"),
        (returned(position=np.zeros((3, 2))), "position should be an array of float64"),
        (returned(position=np.zeros((4, 2), np.float32)), "position should be an array of float64"),
        (returned(position=np.full((4, 2), np.nan)), "position of a dot that is ok is not near the picture"),
        (returned(position=np.full((4, 2), 1e6)), "position of a dot that is ok is not near the picture"),
        (returned(covariance=np.full((4, 2, 2), np.nan)), "should be symmetric and positive definite"),
        (returned(covariance=np.tile(-np.eye(2), (4, 1, 1))), "should be symmetric and positive definite"),
        (returned(covariance=np.ones((4, 2, 2))), "should be symmetric and positive definite"),
        (returned(index=np.zeros((4, 2), int)), "index names a place twice"),
        (returned(index=np.array([[0, 0], [1, 0], [0, 1], [9, 9]])), "none of the target's places"),
        (returned(index=np.zeros((4, 2))), "index should be an array of integer"),
        (returned(has_id=np.zeros(4, dtype=bool)), "has_id is false of a dot that is ok"),
        (returned(others=(np.zeros((4, 3), int),)), "others should be an array of integer"),
    ],
    ids=lambda one: one if isinstance(one, str) else "",
)
def test_a_detector_that_does_not_is_named(detector: Any, said: str, tmp_path: Path) -> None:  # noqa: ANN401 -- any
    register_target(replace(KIND, detector=detector))
    with pytest.raises(InputError, match=said):
        detect_dots(PICTURE, Corners())
    import cv2  # noqa: PLC0415 -- of this test alone

    path = tmp_path / "a.png"
    cv2.imwrite(str(path), PICTURE)
    result = measure_picture(Source("a", "left", str(path), None), Corners())
    assert (result.dots, result.reason is None) == (None, False)


@pytest.mark.parametrize(
    ("made", "said"),
    [
        (
            lambda _board: None,
            "'outlines' should return a matplotlib.path.Path of finite places, not NoneType",
        ),
        (lambda _board: Outline([[0.0, np.nan], [1.0, 1.0]]), "of finite places, not Path"),
        (lambda _board: {}["k"], "its 'outlines' failed .KeyError: 'k'"),
    ],
    ids=["none", "nan", "raises"],
)
def test_outlines_that_are_none_are_named(made: Callable[..., Any], said: str, tmp_path: Path) -> None:
    register_target(replace(KIND, outlines=made))
    with pytest.raises(InputError, match=said):
        export_artwork(Corners(), tmp_path / "board.png", dpi=50)
