"""Mistakes of a photographer, made on purpose to test whether labcal detects them."""

from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from labcal.cameras.camera import Camera
from labcal.errors import InputError
from labcal.geometry.poses import from_rotation_vector, pose
from labcal.rng import generator
from labcal.scene.motion import Track
from labcal.scene.take import Take
from labcal.targets.one_kind import grid_of
from labcal.targets.target import PrintableTarget

PITCH_FACTOR = 1.03
DRIFT_MM = 4.0
DRIFT_DEG = 0.4
KNOCK_MM = 3.0
KNOCK_DEG = 0.5
REFOCUS = 0.01
"""Relative change of the focal length."""
DEFOCUS = 0.002
"""Standard deviation of the blur, as a share of the picture's width; most rings stay rings."""


class Mistake(StrEnum):
    """The kind of a mistake."""

    SWAPPED_CAMERAS = "swapped-cameras"
    BOARD_TURNED = "board-turned"
    WRONG_PITCH = "wrong-pitch"
    UNSYNCHRONISED = "unsynchronised"
    CAMERA_KNOCKED = "camera-knocked"
    OUT_OF_FOCUS = "out-of-focus"
    REFOCUSED = "refocused"


_OF_A_PAIR = {Mistake.SWAPPED_CAMERAS, Mistake.UNSYNCHRONISED, Mistake.CAMERA_KNOCKED}
_BETWEEN_VIEWS = {*_OF_A_PAIR, Mistake.BOARD_TURNED, Mistake.REFOCUSED} - {Mistake.UNSYNCHRONISED}


@dataclass(frozen=True)
class Shooting:
    """Pictures as planned."""

    takes: tuple[Take, ...]
    on_stage: bool
    """True if a stage reports the poses of the target."""
    training: frozenset[str]
    """Views that are trained on."""
    seed: int
    """Seed of the run."""
    size: float = 1.0
    """Size of the mistake, as a multiple of its usual size."""

    @property
    def views(self) -> list[str]:
        """Names of the views, in order."""
        return list(dict.fromkeys(take.view for take in self.takes))

    @property
    def cameras(self) -> list[str]:
        """Names of the cameras, in order."""
        return list(dict.fromkeys(take.camera for take in self.takes))


@dataclass(frozen=True)
class Outcome:
    """Pictures as taken, with the mistake."""

    takes: tuple[Take, ...]
    """In the planned order."""
    wrong: str | None = None
    """Description of the mistake."""
    wrong_views: tuple[str, ...] = ()
    """Names of the views that the mistake concerns."""


def printed_target(target: PrintableTarget, mistake: Mistake | None, size: float = 1.0) -> PrintableTarget:
    """Return the target as printed, which a mistake can make different from its description.

    Raises
    ------
    InputError
        The mistake takes a grid of dots, and the target is of another kind.
    """
    if mistake is not Mistake.WRONG_PITCH:
        return target
    factor, grid = _pitch_factor(size), grid_of(target, f"The mistake '{mistake}' is made with")
    return grid.model_copy(
        update={"pitch_x_mm": factor * grid.pitch_x_mm, "pitch_y_mm": factor * grid.pitch_y_mm}
    )


def make_mistake(mistake: Mistake, shooting: Shooting) -> Outcome:
    """Return the pictures with a mistake.

    Raises
    ------
    InputError
        The mistake cannot be made here: it takes two cameras, several views, or a stage.
    """
    _require_possible(mistake, shooting)
    _require_size(mistake, shooting.size)
    return _MADE[mistake](shooting)


def _require_possible(mistake: Mistake, shooting: Shooting) -> None:
    """Raise if the mistake has no meaning or no effect here."""
    if mistake in _OF_A_PAIR and len(shooting.cameras) < 2:  # noqa: PLR2004 -- a pair
        raise InputError(
            f"The mistake '{mistake}' takes two cameras, but the scene has one. Add a camera, or choose "
            "another mistake."
        )
    if mistake is Mistake.BOARD_TURNED and not shooting.on_stage:
        raise InputError(
            f"The mistake '{mistake}' means nothing for a target in the hand, whose poses are not "
            "given. Take a scene with a stage."
        )
    if mistake in _BETWEEN_VIEWS and len(shooting.views) < 2:  # noqa: PLR2004 -- one as meant, one not
        raise InputError(
            f"The mistake '{mistake}' happens between views, but there is only one. Take more views."
        )


def _require_size(mistake: Mistake, size: float) -> None:
    """Raise if a mistake of that size has no meaning."""
    if mistake is Mistake.BOARD_TURNED and size != 1.0:
        raise InputError(
            f"The mistake '{mistake}' has no size: a board lies turned or not. Leave mistake_size out."
        )
    if mistake is Mistake.SWAPPED_CAMERAS and size > 1.0:
        raise InputError(
            f"The size of the mistake '{mistake}' is the share of the later views that are exchanged: "
            f"at most 1, but mistake_size is {size:g}."
        )


def _pitch_factor(size: float) -> float:
    """Return the ratio of the printed pitch to the declared one."""
    return 1.0 + size * (PITCH_FACTOR - 1.0) if size != 1.0 else PITCH_FACTOR


def _later_views(shooting: Shooting) -> tuple[str, ...]:
    """Return the views from the middle one on."""
    views = shooting.views
    return tuple(views[len(views) // 2 :])


def _direction(shooting: Shooting, *names: str) -> np.ndarray:
    """Draw a unit vector."""
    drawn = generator(shooting.seed, "mistake", *names).normal(size=3)
    return np.asarray(drawn / np.linalg.norm(drawn))


def _swap_cameras(shooting: Shooting) -> Outcome:
    """Exchange the pictures of the first two cameras; if the size is small, in the last views only."""
    first, second, *_ = shooting.cameras
    other = {first: second, second: first}
    later = _later_views(shooting)
    later = later[-max(1, round(shooting.size * len(later))) :]
    by_name = {(take.view, take.camera): take for take in shooting.takes}
    sizes = {name: by_name[(later[0], name)].device.size for name in (first, second)}
    if sizes[first] != sizes[second]:
        raise InputError(
            f"The mistake '{Mistake.SWAPPED_CAMERAS}' needs pictures of one size, but those of camera "
            f"'{first}' have {sizes[first]} and those of '{second}' {sizes[second]} pixels. Make them alike."
        )
    takes = tuple(
        replace(by_name[(take.view, other[take.camera])], camera=take.camera)
        if take.view in later and take.camera in other
        else take
        for take in shooting.takes
    )
    return Outcome(takes, f"The pictures of cameras '{first}' and '{second}' are exchanged.", later)


def _turn_board(shooting: Shooting) -> Outcome:
    """Turn the board on the stage in one view, the middle one of training if there are others to compare."""
    views = shooting.views
    training = [view for view in views if view in shooting.training]
    chosen = training[len(training) // 2] if len(training) > 1 else views[-1]
    takes = tuple(
        replace(take, track=_half_turned(take.track)) if take.view == chosen else take
        for take in shooting.takes
    )
    return Outcome(takes, "The board lies turned by 180 degrees about its normal.", (chosen,))


def _half_turned(track: Track) -> Track:
    """Return a track with the board turned about its own normal through its middle."""
    turn = from_rotation_vector(np.pi * track.T_world_target[:3, 2], track.middle)
    T_world_target: np.ndarray = turn @ pose(np.eye(3), -track.middle) @ track.T_world_target
    return replace(track, T_world_target=T_world_target)


def _print_another_pitch(shooting: Shooting) -> Outcome:
    """Describe the mistake of :func:`printed_target`."""
    percent = 100.0 * (_pitch_factor(shooting.size) - 1.0)
    return Outcome(
        shooting.takes,
        f"The dots are printed {percent:.3g}% further apart than the target says, from dot (0, 0); their "
        "diameters are right.",
        tuple(shooting.views),
    )


def _expose_later(shooting: Shooting) -> Outcome:
    """Move the target between the exposures of the first two cameras, differently in each view."""
    second = shooting.cameras[1]
    drift_mm, drift_deg = shooting.size * DRIFT_MM, shooting.size * DRIFT_DEG
    takes = []
    for take in shooting.takes:
        if take.camera == second:
            turn = np.radians(drift_deg) * _direction(shooting, Mistake.UNSYNCHRONISED, take.view, "turn")
            move = drift_mm * _direction(shooting, Mistake.UNSYNCHRONISED, take.view, "move")
            drift = replace(take.track, velocity=move, rotation=turn).at(1.0)
            track = replace(take.track, T_world_target=drift, middle=take.track.middle + move)
            takes.append(replace(take, track=track))
        else:
            takes.append(take)
    return Outcome(
        tuple(takes),
        f"Camera '{second}' exposes later than the others; the target has drifted by {drift_mm:g} mm and "
        f"{drift_deg:g} degrees by then.",
        tuple(shooting.views),
    )


def _knock_camera(shooting: Shooting) -> Outcome:
    """Rotate and move the second camera about its own centre, from the middle view on."""
    second, later = shooting.cameras[1], _later_views(shooting)
    knock_mm, knock_deg = shooting.size * KNOCK_MM, shooting.size * KNOCK_DEG
    turn = np.radians(knock_deg) * _direction(shooting, Mistake.CAMERA_KNOCKED, "turn")
    move = knock_mm * _direction(shooting, Mistake.CAMERA_KNOCKED, "move")
    knock = from_rotation_vector(turn, move)
    takes = tuple(
        replace(take, device=replace(take.device, T_cam_world=knock @ take.device.T_cam_world))
        if take.camera == second and take.view in later
        else take
        for take in shooting.takes
    )
    return Outcome(
        takes,
        f"Camera '{second}' has been knocked: turned by {knock_deg:g} degrees and moved by {knock_mm:g} mm.",
        later,
    )


def _lose_focus(shooting: Shooting) -> Outcome:
    """Blur the pictures of the second camera, or of the only one."""
    blurred = shooting.cameras[:2][-1]
    defocus = shooting.size * DEFOCUS
    takes = tuple(
        replace(take, defocus_px=defocus * take.device.size[0]) if take.camera == blurred else take
        for take in shooting.takes
    )
    return Outcome(
        takes,
        f"Camera '{blurred}' is out of focus: a blur with a standard deviation of {100.0 * defocus:g}% of "
        "the picture's width on top of the lens's own.",
        tuple(shooting.views),
    )


def _refocus(shooting: Shooting) -> Outcome:
    """Lengthen the focal length of the second camera, or of the only one, from the middle view on."""
    changed, later = shooting.cameras[:2][-1], _later_views(shooting)
    factor = 1.0 + shooting.size * REFOCUS
    takes = tuple(
        replace(take, device=_refocused(take.device, factor))
        if take.camera == changed and take.view in later
        else take
        for take in shooting.takes
    )
    return Outcome(
        takes,
        f"Camera '{changed}' has been refocused: its focal length is {100.0 * (factor - 1.0):.3g}% longer.",
        later,
    )


def _refocused(device: Camera, factor: float) -> Camera:
    """Return a camera with another focal length; principal point and distortion stay."""
    K = device.K.copy()
    K[[0, 1], [0, 1]] *= factor
    return replace(device, K=K)


_MADE = {
    Mistake.SWAPPED_CAMERAS: _swap_cameras,
    Mistake.BOARD_TURNED: _turn_board,
    Mistake.WRONG_PITCH: _print_another_pitch,
    Mistake.UNSYNCHRONISED: _expose_later,
    Mistake.CAMERA_KNOCKED: _knock_camera,
    Mistake.OUT_OF_FOCUS: _lose_focus,
    Mistake.REFOCUSED: _refocus,
}
