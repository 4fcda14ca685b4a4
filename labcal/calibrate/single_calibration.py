"""Single-camera calibration from all views of a hand-held target."""

from dataclasses import dataclass, replace
from os import PathLike

import numpy as np

from labcal.arguments import choice_of, object_of, set_checked, whole_number
from labcal.arrays import Vectors3
from labcal.calibrate.adjustment.free_dots import adjust_dots
from labcal.calibrate.adjustment.observations import Observations, observations_of
from labcal.calibrate.adjustment.rounds import Adjusted, adjust_in_rounds
from labcal.calibrate.adjustment.state import Freedom, Lenses, RigState
from labcal.calibrate.dot_treatment import DotTreatment
from labcal.calibrate.eccentricity import ROUNDS
from labcal.calibrate.freed_dots import FreedDots
from labcal.calibrate.lens_start import (
    LensStart,
    camera_as_lens,
    start_from_camera,
    start_from_pictures,
)
from labcal.calibrate.one_lens import TwoLenses
from labcal.calibrate.parallel_views import refuse_parallel_views
from labcal.calibrate.rig_start import SingleCamera
from labcal.cameras.rig import Rig
from labcal.cameras.rig_file import read_rig
from labcal.correspond.detections import Detections
from labcal.errors import InputError
from labcal.paths import AnyPath
from labcal.targets.catalogue import AnyTarget
from labcal.targets.places import DotPlaces, read_places
from labcal.wording import counted

MIN_VIEWS = 3
"""Views that a camera needs: two fix four intrinsics of a plane target, the third checks them."""


@dataclass(frozen=True)
class HandheldSettings:
    """Settings of a calibration from a hand-held target.

    Examples
    --------
    >>> from labcal.pipeline import HandheldSettings
    >>> HandheldSettings(dot_places="freed").eccentricity_rounds
    2
    """

    lenses: Lenses | str = Lenses.FREE
    """Lenses are estimated (``"free"``), or kept as in `start` (``"fixed"``)."""
    start: Rig | AnyPath | None = None
    """Rig of the initial values, or the path of its file; OpenCV gives them if this is None."""
    dot_places: DotTreatment | str = DotTreatment.AUTO
    """Places of dots on the print are estimated (``"freed"``), taken as ``"declared"``, or estimated where
    held-out views show that it is better (``"auto"``)."""
    dots: DotPlaces | AnyPath | None = None
    """Places of the dots on this print, as an earlier calibration with freed dots found them, or the path of
    their file: dots are kept there, and the errors of these places enter the covariance."""
    eccentricity_rounds: int = ROUNDS
    """Number of computations of the eccentricity; 0 if pixels are images of centres."""

    def __post_init__(self) -> None:
        """Check the settings.

        Raises
        ------
        UnknownNameError, InputTypeError
            One is of a wrong type, or no word for the treatment of lenses.
        InputError
            The lenses of no rig are to be kept, a number is negative, or there is no rig in a file.
        """
        values = {
            "lenses": choice_of(self.lenses, Lenses, "lenses"),
            "start": None if self.start is None else _rig_of(self.start),
            "dot_places": choice_of(self.dot_places, DotTreatment, "dot_places"),
            "dots": None if self.dots is None else _places_of(self.dots),
            "eccentricity_rounds": whole_number(self.eccentricity_rounds, "eccentricity_rounds", 0),
        }
        set_checked(self, values)
        if self.start is None and self.lenses is Lenses.FIXED:
            raise InputError("`lenses='fixed'` keeps the lenses of a rig. Give that rig: `start='rig.json'`.")
        if self.dots is not None and self.dot_places == DotTreatment.FREED:
            raise InputError(
                "`dots` keeps the dots where they were measured, `dot_places='freed'` estimates them anew. "
                "Give one of the two."
            )

    @property
    def places(self) -> DotPlaces | None:
        """The measured places of dots, read where a path was given."""
        return self.dots if isinstance(self.dots, DotPlaces) else None

    def dots_of(self, target: AnyTarget) -> Vectors3:
        """Return the places of all dots in the target's frame, mm: as measured, or else as declared.

        Raises
        ------
        InputError
            The measured places are those of another target.
        """
        if self.places is None:
            return target.points()
        if self.places.target != target:
            named, given = self.places.target.name, target.name
            other = f"'{given}'" if named != given else "one of this name with other dimensions"
            raise InputError(
                f"The places in `dots` are those of the target '{named}', but the dots are of {other}. Give "
                "the places of this print, or leave `dots` out."
            )
        return self.places.points()

    def measured(self, usable: Detections, target: AnyTarget) -> Detections:
        """Return the dots whose places were measured, where places are given; all of them otherwise.

        Raises
        ------
        InputError
            The measured places are those of another target, or of none of these dots.
        """
        self.dots_of(target)
        if self.places is None:
            return usable
        known = self.places.freed()[usable.index[:, 1] * target.cols + usable.index[:, 0]]
        if not known.any():
            raise InputError(
                "None of these dots has a measured place in `dots`. Give the places of this print."
            )
        return usable.where(known)

    @property
    def start_rig(self) -> Rig | None:
        """The rig of the initial values, read where a path was given."""
        return self.start if isinstance(self.start, Rig) else None


def _places_of(given: DotPlaces | AnyPath) -> DotPlaces:
    if isinstance(given, str | PathLike):
        return read_places(given)
    return object_of(given, DotPlaces, "dots")


def _rig_of(given: Rig | AnyPath) -> Rig:
    if isinstance(given, str | PathLike):
        return read_rig(given)
    return object_of(given, Rig, "start")


@dataclass(frozen=True)
class AdjustedDots:
    """An adjustment of one camera or of several."""

    adjusted: Adjusted
    observations: Observations
    freed: FreedDots | None


@dataclass(frozen=True)
class SingleCalibration:
    """A camera calibrated from all its views."""

    name: str
    dots: Detections
    result: AdjustedDots
    single: SingleCamera
    """Its input to the adjustment of the rig."""
    two_lenses: TwoLenses | None = None
    """Groups of its views that were taken through different lenses; None where one lens explains all."""

    def with_freed_dots(self, target: AnyTarget, settings: HandheldSettings) -> "SingleCalibration":
        """Return the camera, which was calibrated with the dots as declared, adjusted with free dots.

        Raises
        ------
        InputError
            As in :func:`~labcal.calibrate.adjustment.free_dots.adjust_dots`.
        """
        flat, rounds = self.result, settings.eccentricity_rounds
        free = adjust_dots(flat.adjusted, flat.observations, target, Lenses(settings.lenses), rounds)
        end = free.adjusted.state
        single = replace(self.single, camera=end.cameras[0], T_cam_target=end.T_world_target)
        return replace(self, result=AdjustedDots(free.adjusted, free.observations, free.dots), single=single)

    def on_print(self, dots: FreedDots, settings: HandheldSettings) -> "SingleCalibration":
        """Return the camera adjusted once more, with dots where several cameras together found them."""
        before = self.result
        seen = before.observations.where(dots.freed[before.observations.dot])
        state = replace(before.adjusted.state, dots=dots.place)
        freedom = Freedom(Lenses(settings.lenses), np.zeros((dots.place.size, 0)))
        radii = 0.5 * dots.target.outer_diameters_mm()
        adjusted = adjust_in_rounds(state, seen, freedom, radii, settings.eccentricity_rounds)
        single = replace(
            self.single, camera=adjusted.state.cameras[0], T_cam_target=adjusted.state.T_world_target
        )
        return replace(self, result=AdjustedDots(adjusted, seen, None), single=single)

    def among(self, views: tuple[str, ...]) -> "SingleCalibration":
        """Return the same camera with its views numbered as they stand among `views`, the rig's."""
        number = {view: place for place, view in enumerate(views)}
        numbers = np.array([number[view] for view in self.dots.views], dtype=np.int64)
        return replace(self, single=replace(self.single, views=numbers))


def calibrate_single(
    name: str, entering: Detections, target: AnyTarget, lens: str, settings: HandheldSettings
) -> SingleCalibration:
    """Calibrate one camera from all its views."""
    dots = entering.where(entering.camera == name)
    start = _lens_start(dots, name, target, lens, settings)
    state = RigState((start.camera,), start.T_cam_target, settings.dots_of(target))
    result = adjusted(state, observations_of(dots, target, (name,), dots.views), target, settings)
    end, unnumbered = result.adjusted.state, np.arange(len(dots.views))
    single = SingleCamera(name, end.cameras[0], unnumbered, end.T_world_target)
    return SingleCalibration(name, dots, result, single).among(entering.views)


def _lens_start(
    dots: Detections, name: str, target: AnyTarget, lens: str, settings: HandheldSettings
) -> LensStart:
    """Return initial values of a camera, from a given rig or from its own pictures."""
    needed = MIN_VIEWS if settings.lenses is Lenses.FREE else 1
    if len(dots.views) < needed:
        raise InputError(
            f"Camera '{name}' has {counted(len(dots.views), 'usable view')}, but needs {needed} at "
            "different tilts."
        )
    pictures = dots.by_view()
    size = dots.picture_size(name)
    if settings.start_rig is None:
        start = start_from_pictures(pictures, target, lens)
        refuse_parallel_views(pictures, target, start.camera, settings.eccentricity_rounds)
        return start
    known = settings.start_rig.camera(name)
    if known.size != size:
        raise InputError(
            f"Camera '{name}' of the rig to start from takes pictures of {known.size[0]} x {known.size[1]}, "
            f"but these are {size[0]} x {size[1]}."
        )
    return start_from_camera(pictures, target, camera_as_lens(known, lens, name))


def adjusted(
    start: RigState, observations: Observations, target: AnyTarget, settings: HandheldSettings
) -> AdjustedDots:
    """Adjust with the dots as declared and, where they are to be freed, once more with free dots."""
    freedom = Freedom(Lenses(settings.lenses), np.zeros((3 * target.count, 0)))
    radii = 0.5 * target.outer_diameters_mm()
    flat = adjust_in_rounds(start, observations, freedom, radii, settings.eccentricity_rounds)
    if settings.dot_places is not DotTreatment.FREED:
        return AdjustedDots(flat, observations, None)
    free = adjust_dots(flat, observations, target, Lenses(settings.lenses), settings.eccentricity_rounds)
    return AdjustedDots(free.adjusted, free.observations, free.dots)
