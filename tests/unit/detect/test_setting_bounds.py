"""Every setting of detection at both of its ends, and just beyond: results that make sense, or a refusal."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np
import pytest
from annotated_types import Ge, Gt, Le, Lt
from pydantic.fields import FieldInfo

from labcal.detect.detector import detect_dots
from labcal.detect.dots import PictureDots
from labcal.detect.flags import DotFlag, Refusal
from labcal.detect.settings import DEFAULTS, DetectSettings, detect_settings
from labcal.errors import InputError, InputTypeError, UnknownNameError
from labcal.targets.catalogue import AnyTarget, load_target
from labcal.targets.charuco_opencv import opencv_board

RINGS = load_target("rings-10x8")
BOARD = load_target("charuco-12x9").model_copy(update={"squares": (7, 5)})
FINE = 4


@dataclass(frozen=True)
class End:
    """A bound of a setting: the last value that is permitted, and the first one that is not."""

    stage: str
    name: str
    side: str
    within: object
    beyond: object

    def __str__(self) -> str:
        return f"{self.stage}.{self.name}-{self.side}"


def bounds_of(field: FieldInfo) -> tuple[list[object], bool, int | None]:
    """Return the constraints of a number, whether it is whole, and the length of a tuple of it."""
    parts = getattr(field.annotation, "__args__", ())
    if not parts:
        return list(field.metadata), field.annotation is int, None
    nested = [bound for part in parts[0].__metadata__ for bound in getattr(part, "metadata", [part])]
    return nested, parts[0].__origin__ is int, len(field.default)


def ends() -> Iterator[End]:
    for stage in DetectSettings.model_fields:
        for name, field in type(getattr(DEFAULTS, stage)).model_fields.items():
            bounds, is_whole, length = bounds_of(field)
            for bound in bounds:
                upwards = isinstance(bound, Ge | Gt)
                limit = next(iter(vars_of(bound).values()))
                away, inward = (-math.inf, math.inf) if upwards else (math.inf, -math.inf)
                beside = [
                    limit + math.copysign(1, to) if is_whole else math.nextafter(limit, to)
                    for to in (away, inward)
                ]
                within, beyond = (limit, beside[0]) if isinstance(bound, Ge | Le) else (beside[1], limit)
                if length is not None:
                    within, beyond = (within,) * length, (beyond,) * length
                yield End(stage, name, "low" if upwards else "high", within, beyond)


def vars_of(bound: object) -> dict[str, float]:
    assert isinstance(bound, Ge | Gt | Le | Lt)
    return {name: getattr(bound, name) for name in ("ge", "gt", "le", "lt") if hasattr(bound, name)}


ENDS = list(ends())


def drawn(target: AnyTarget) -> np.ndarray:
    """Return a small picture of a grid with rings: sheared, noisy, cut at the left and at the bottom."""
    big = np.full((230 * FINE, 260 * FINE), 210.0, np.float32)
    for col, row in target.indices():
        x, y = (8 + 24 * col + 2 * row) * FINE, (224 - 25 * row - col) * FINE
        cv2.circle(big, (int(x), int(y)), 7 * FINE, 30.0, -1, cv2.LINE_AA)
        if (int(col), int(row)) in target.ring_indices:
            cv2.circle(big, (int(x), int(y)), 3 * FINE, 210.0, -1, cv2.LINE_AA)
    return seen(big)


def seen(fine: np.ndarray) -> np.ndarray:
    """Return a picture as a camera takes it of a fine one: blurred, in pixels, with noise."""
    height, width = fine.shape[0] // FINE, fine.shape[1] // FINE
    grey = cv2.GaussianBlur(fine, (0, 0), 0.7 * FINE).reshape(height, FINE, width, FINE).mean((1, 3))
    grey += np.random.default_rng(2).normal(0, 1.0, grey.shape)
    return np.clip(np.round(grey), 0, 255).astype(np.uint8)


@pytest.fixture(scope="module")
def pictures() -> dict[str, tuple[np.ndarray, AnyTarget]]:
    """Pictures of dots, of nothing, of noise, and of a part of a ChArUco board."""
    noise = np.random.default_rng(0).integers(0, 255, (120, 160)).astype(np.uint8)
    art = opencv_board(BOARD).generateImage((7 * 30 * FINE, 5 * 30 * FINE), marginSize=0)
    board = seen(cv2.copyMakeBorder(art, *[10 * FINE] * 4, cv2.BORDER_CONSTANT, value=255).astype(np.float32))
    return {
        "dots": (drawn(RINGS), RINGS),
        "nothing": (np.full((60, 80), 128, np.uint8), RINGS),
        "noise": (noise, RINGS),
        "board": (board[:, 30:], BOARD),
    }


@pytest.fixture(scope="module")
def places(pictures: dict[str, tuple[np.ndarray, AnyTarget]]) -> dict[str, dict[tuple[int, int], np.ndarray]]:
    """Return where the dots of each picture are, as the defaults find them."""
    found = {name: detect_dots(*picture) for name, picture in pictures.items()}
    assert found["dots"].ok.sum() > 60
    assert found["board"].ok.sum() > 15
    assert found["nothing"].refusal is Refusal.NO_DOTS
    return {name: placed(dots) for name, dots in found.items()}


def placed(dots: PictureDots) -> dict[tuple[int, int], np.ndarray]:
    """Return the places of the dots that are ok, by their ids."""
    return {
        (int(i), int(j)): q for (i, j), q in zip(dots.index[dots.ok], dots.position[dots.ok], strict=True)
    }


def require_sense(dots: PictureDots, known: dict[tuple[int, int], np.ndarray]) -> None:
    """Raise unless every dot that is ok is near the one of that id, with a covariance that is one."""
    assert dots.refusal is None or not dots.ok.any()
    if not dots.ok.any():
        return
    assert (np.linalg.eigvalsh(dots.covariance[dots.ok]) > 0).all()
    for index, q in placed(dots).items():
        assert np.isfinite(q).all()
        assert np.hypot(*(q - known.get(index, q))) < 0.5, index


def with_partner(end: End, value: object) -> DetectSettings:
    """Return settings with one changed; where another one bounds it, that one is changed alike."""
    partner = {
        "min_ray_samples": "max_ray_samples",
        "max_ray_samples": "min_ray_samples",
        "ring_hole_share": "faint_hole_share",
        "faint_hole_share": "ring_hole_share",
    }
    given = {end.name: value}
    try:
        return DetectSettings(**{end.stage: given})
    except InputError as error:
        if "contradict" not in str(error):
            raise
    if end.name in partner:
        return DetectSettings(**{end.stage: {**given, partner[end.name]: value}})
    other = {
        "dot_level_from_radii": ("dot_level_to_radii", 0.9999999),
        "dot_level_to_radii": ("dot_level_from_radii", 0.05),
    }
    name, bound = other[end.name]
    least = 0.9999998 if end.side == "high" else 0.06
    return DetectSettings(**{end.stage: {end.name: least, name: bound}})


def test_every_setting_has_both_bounds() -> None:
    sides = {(end.stage, end.name): set[str]() for end in ENDS}
    for end in ENDS:
        sides[end.stage, end.name].add(end.side)
    declared = {
        (stage, name)
        for stage in DetectSettings.model_fields
        for name in type(getattr(DEFAULTS, stage)).model_fields
    }
    assert sides.keys() == declared
    assert all(found == {"low", "high"} for found in sides.values())


@pytest.mark.parametrize("end", ENDS, ids=str)
def test_beyond_its_bound_it_is_refused_by_name(end: End) -> None:
    name = rf"detect\.{end.stage}\.{end.name} should be .*\(.* to .*; default"
    with pytest.raises(InputError, match=name):
        DetectSettings(**{end.stage: {end.name: end.beyond}})
    text = ",".join(map(repr, end.beyond)) if isinstance(end.beyond, tuple) else repr(end.beyond)
    with pytest.raises(InputError, match=name):
        detect_settings([f"detect.{end.stage}.{end.name}={text}"])


@pytest.mark.parametrize("end", [end for end in ENDS if end.name.endswith("_px")][:3], ids=str)
@pytest.mark.parametrize(
    "value", ["nan", "inf", "-inf", "", "wide", "0x10", "1,5", True, None, [3.0], float("nan")]
)
def test_what_is_no_number_is_refused(end: End, value: object) -> None:
    with pytest.raises(InputError, match=rf"detect\.{end.stage}\.{end.name} should be"):
        DetectSettings(**{end.stage: {end.name: value}})


@pytest.mark.slow  # a minute for all of them
@pytest.mark.parametrize("end", ENDS, ids=str)
def test_at_its_bound_detection_gives_sense(
    end: End,
    pictures: dict[str, tuple[np.ndarray, AnyTarget]],
    places: dict[str, dict[tuple[int, int], np.ndarray]],
) -> None:
    settings = with_partner(end, end.within)
    wanted = ("board",) if end.stage == "corner" else ("dots", "noise", "nothing")
    for name in (*wanted, "board") if end.stage in {"edge", "grid"} else wanted:
        require_sense(detect_dots(*pictures[name], settings), places[name])


def test_a_board_of_which_no_corner_is_measured_is_refused(
    pictures: dict[str, tuple[np.ndarray, AnyTarget]],
) -> None:
    picture, board = pictures["board"]
    dots = detect_dots(picture, board, DetectSettings(corner={"frame_margin_px": 1000.0}))  # type: ignore[arg-type]
    assert dots.refusal is Refusal.TOO_FEW_DOTS
    assert len(dots.flag) > 15


def test_settings_of_python_are_refused_as_those_of_the_command_line() -> None:
    with pytest.raises(UnknownNameError, match=r"Did you mean 'detect\.edge\.max_iterations'"):
        DetectSettings(edge={"max_iteration": 3})  # type: ignore[arg-type]
    with pytest.raises(UnknownNameError, match=r"Did you mean 'detect\.edge'"):
        DetectSettings(edges={})  # type: ignore[call-arg]
    with pytest.raises(InputTypeError, match=r"detect\.edge should be EdgeSettings, or a mapping .*, not 3"):
        DetectSettings(edge=3)  # type: ignore[arg-type]
    for stage in ("grid", "segmentation"):
        whole = getattr(DEFAULTS, stage).model_copy()
        assert DetectSettings(**{stage: whole}) == DEFAULTS


def test_no_fisheyes_are_given_as_text_too() -> None:
    none = DetectSettings(grid={"fisheye_fields_deg": ()})  # type: ignore[arg-type]
    assert detect_settings(none.changes()) == none
    assert detect_settings("detect.edge.max_iterations=7").edge.max_iterations == 7
    with pytest.raises(InputError, match="at most 20"):
        detect_settings(["detect.grid.fisheye_fields_deg=" + ",".join(["100"] * 21)])


def found(picture: np.ndarray, **grid: float) -> PictureDots:
    return detect_dots(picture, RINGS, DetectSettings(grid=grid))  # type: ignore[arg-type]


def test_settings_of_rings_have_the_effect_that_they_state(
    pictures: dict[str, tuple[np.ndarray, AnyTarget]],
) -> None:
    picture, _ = pictures["dots"]
    i, j = RINGS.ring_indices[0]
    x, y = 8 + 24 * i + 2 * j, 224 - 25 * j - i
    assert found(picture).refusal is None
    # The middle of a ring may be so dark; so bright must it be.
    assert found(picture, ring_outlier_sigma=1000.0, ring_hole_share=0.999).refusal is Refusal.NO_RINGS
    assert found(picture, faint_hole_share=0.998, ring_hole_share=0.999).refusal is Refusal.NO_RINGS
    # Two rings do where the third may be anything but a full dot.
    hidden = picture.copy()
    cv2.circle(hidden, (x, y), 5, 40, -1)
    assert found(hidden).refusal is Refusal.NO_RINGS
    assert found(hidden, full_dot_share=1e-6).refusal is None
    # Rings may fit worse than full dots.
    quality = {"max_ring_misfit_factor": 1.0001, "min_noise_share": 0.0, "min_variance_share": 0.0}
    dots = detect_dots(picture, RINGS, DetectSettings(quality=quality))  # type: ignore[arg-type]
    flags = {(int(a), int(b)): flag for (a, b), flag in zip(dots.index, dots.flag, strict=True)}
    assert DotFlag.BAD_FIT in {flags[ring] for ring in RINGS.ring_indices}
