"""The stated sigmas of a calibration against the scatter of samples of its views."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64

from labcal.calibrate.adjustment.observations import Observations, observations_of
from labcal.calibrate.adjustment.rounds import adjust_in_rounds
from labcal.calibrate.adjustment.state import Freedom, Lenses, RigState
from labcal.calibrate.budget.error_sources import ErrorSources
from labcal.calibrate.camera_covariance import CameraCovariance
from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.calibrate.usable_dots import usable_dots
from labcal.cameras.camera import Camera
from labcal.cameras.optics import INTRINSICS
from labcal.correspond.detections import Detections
from labcal.errors import InputError
from labcal.rng import generator
from labcal.targets.catalogue import AnyTarget

SAMPLES = 20
_FEWEST_VIEWS = 3


@dataclass(frozen=True)
class BootstrapScatter:
    """Scatter over samples of views over the scatter that stated sigmas imply, roots of mean squares.

    Attributes
    ----------
    focal : float
        Of fx and fy of both cameras.
    middle : float
        Of their principal points.
    baseline : float
    """

    focal: float
    middle: float
    baseline: float

    @classmethod
    def of(
        cls, dots: Detections, target: AnyTarget, lens: str, seed: int, eccentricity_rounds: int = 2
    ) -> "BootstrapScatter":
        """Calibrate a pair from all views, and from samples of half of them, and compare.

        Parameters
        ----------
        dots : Detections
        target : AnyTarget
            Its dots are kept where they are declared.
        lens : str
        seed : int
            Of the draw.
        eccentricity_rounds : int, optional
            0 where pixels are images of centres.

        Raises
        ------
        InputError
            The views are too few for halves, or determine no rig.

        Notes
        -----
        Samples are drawn without replacement (the bootstrap of m out of n; Politis, Romano and Wolf 1999),
        each with the views that it left out as the next one, so that all views count alike. A sample with
        replacement of ten views holds six or seven, whose sigmas are those of a smaller set. One
        without is a calibration as any other, with sigmas of its own. Its views are among those of the
        calibration from all of them: the expected square distance of both is the difference of their
        variances (Hausman 1978). Every sample starts from the rig of all views.
        """
        settings = HandheldSettings(dot_places="declared", eccentricity_rounds=eccentricity_rounds)
        whole = calibrate_handheld(dots, target, lens, settings)
        kept = usable_dots(whole.outliers.left_out(dots), target)
        names = tuple(whole.rig.cameras)
        cameras = tuple(whole.rig.camera(name) for name in names)
        if len(whole.views) < 2 * _FEWEST_VIEWS or whole.covariance is None:
            raise InputError(
                f"Of {len(whole.views)} views half are too few for a rig of a pair. Give {2 * _FEWEST_VIEWS} "
                "or more."
            )
        observations = observations_of(
            kept.where(np.isin(kept.view, whole.views)), target, names, whole.views
        )
        everything = RigState(cameras, whole.T_world_target, target.points())
        radii = 0.5 * target.outer_diameters_mm()
        freedom = Freedom(Lenses.FREE, np.zeros((everything.dots.size, 0)))
        numbers, variances = _numbers(cameras), _variances(cameras, whole.covariance)
        random = generator(seed, "bench solve", "bootstrap")
        off, expected = [], []
        for drawn in _balanced_halves(len(whole.views), random):
            state = replace(everything, T_world_target=everything.T_world_target[drawn])
            seen = _of_views(observations, drawn)
            found = adjust_in_rounds(state, seen, freedom, radii, eccentricity_rounds)
            covariance = CameraCovariance.of(found, ErrorSources.of(found, seen, None))
            off.append(_numbers(found.state.cameras) - numbers)
            expected.append(_variances(found.state.cameras, covariance) - variances)
        ratio = np.square(off).mean(axis=0) / np.mean(expected, axis=0)
        of_lens = ratio[:-1].reshape(len(cameras), 2, 2)
        by_kind = of_lens[:, 0].mean(), of_lens[:, 1].mean(), ratio[-1]
        return cls(*(float(np.sqrt(one)) for one in by_kind))


def _balanced_halves(views: int, random: np.random.Generator) -> list[np.ndarray]:
    """Return samples of half of the views, two and two without a view in common."""
    found: list[np.ndarray] = []
    for _ in range(SAMPLES // 2):
        order = random.permutation(views)
        found += [np.sort(order[: views // 2]), np.sort(order[views - views // 2 :])]
    return found


def _of_views(observations: Observations, drawn: np.ndarray) -> Observations:
    """Return the observations of some views, which are numbered anew."""
    seen = observations.where(np.isin(observations.view, drawn))
    return replace(seen, view=np.searchsorted(drawn, seen.view))


def _numbers(cameras: tuple[Camera, ...]) -> Float64[np.ndarray, " numbers"]:
    """Return fx, fy, cx, cy of every camera and the baseline, px and mm."""
    baseline = float(np.linalg.norm(cameras[1].T_cam_world[:3, 3]))
    return np.array([*(value for camera in cameras for value in camera.intrinsics), baseline])


def _variances(cameras: tuple[Camera, ...], of: CameraCovariance) -> Float64[np.ndarray, " numbers"]:
    """Return the stated variances of the same numbers."""
    shift = cameras[1].T_cam_world[:3, 3]
    along = shift / np.linalg.norm(shift)
    at = slice(of.pose[1].start + 3, of.pose[1].stop)
    lenses = [of.covariance[i, i] for own in of.lens for i in range(own.start, own.start + INTRINSICS)]
    return np.array([*lenses, along @ of.covariance[at, at] @ along])
