"""The advisor of a guided capture: detects, calibrates on the way, and asks for the pose that helps most."""

from dataclasses import replace

import numpy as np
from jaxtyping import Float64, Int

from labcal.arrays import Mask, Pose, Vectors3
from labcal.capture.advice import Advice
from labcal.capture.guide_settings import FEWEST_STATED, GuideSettings
from labcal.capture.source import CameraInfo, FrameSet
from labcal.correspond.detections import Detections
from labcal.correspond.gathering import gather, joined
from labcal.correspond.sources import Source
from labcal.detect.detector import detect_dots
from labcal.geometry.poses import transform
from labcal.guide.next_pose.candidates import HandReach
from labcal.guide.next_pose.choice import next_pose
from labcal.guide.next_pose.findable import Findable
from labcal.guide.next_pose.first_poses import FIRST_POSES, first_outlines
from labcal.guide.next_pose.picture_faults import picture_faults, repeated
from labcal.guide.next_pose.rough_rig import RoughRig
from labcal.guide.next_pose.standing import Standing
from labcal.guide.next_pose.words import HeldBefore, lacks_words, pose_words
from labcal.rng import generator
from labcal.run.threads import one_blas_thread
from labcal.targets.catalogue import AnyTarget

CELLS = (6, 8)
"""Rows and columns of the grid of a picture in which found dots are counted."""
FEWEST_VIEWS = 3
"""Views from which on a calibration is tried."""
ROUGHLY = HandReach(np.zeros(3), 4, 0.75, 1.3)
"""Before there is a calibration: not as near and not as far as later."""
_FEWEST_DOTS = 12
"""Of a picture that counts."""


class GuidedCapture:
    """An :class:`~labcal.capture.advice.Advisor` that calibrates after each view.

    Parameters
    ----------
    target : AnyTarget
    settings : GuideSettings
    seed : int
        Of the poses to choose from.
    """

    def __init__(self, target: AnyTarget, settings: GuideSettings, seed: int) -> None:
        self._target, self._settings, self._seed = target, settings, seed
        self._sizes: dict[str, tuple[int, int]] = {}
        self._findable = Findable.of(target)
        self._tables: list[Detections] = []
        self._faults: tuple[str, ...] = ()
        self._sharpest: dict[str, float] = {}
        self._standing: Standing | None = None
        self._last: Pose | None = None
        self._reach = HandReach(np.zeros(3), 4)
        self._asked: tuple[Pose, int] | None = None
        self._judged = 0

    @property
    def standing(self) -> Standing | None:
        """The calibration so far; None before there is one."""
        return self._standing

    @property
    def dots(self) -> Detections | None:
        """The dots of all usable views; None before there is one."""
        return joined(self._tables) if self._tables else None

    def begin(self, cameras: tuple[CameraInfo, ...]) -> None:
        """Learn the cameras and the sizes of their pictures; the first one is the world."""
        self._sizes = {one.name: one.size for one in cameras}

    def judge(self, taken: FrameSet, view: str) -> tuple[str, ...]:
        """Detect the target in a set that entered the shoot, and return its faults, for people."""
        found = {
            name: frame.dots or detect_dots(frame.picture, self._target)
            for name, frame in taken.frames.items()
        }
        sources = [Source(view, name, f"{view}_{name}.png", found[name].size) for name in found]
        self._sizes |= {name: frame.size for name, frame in taken.frames.items()}
        faults = picture_faults(taken.frames, found, self._sharpest)
        self.enter(gather(sources, found.values()), view)
        self._faults = (*faults, *self._faults)
        return self._faults

    @one_blas_thread()
    def forget(self, view: str) -> None:
        """Forget a view that has left the shoot, and calibrate without it."""
        self._tables = [table for table in self._tables if view not in table.view.tolist()]
        self._faults, self._asked, self._last = (), None, None
        self._standing = None
        if len(self._tables) >= FEWEST_VIEWS:
            settings = self._settings
            self._standing = Standing.of(
                joined(self._tables), self._target, settings.lens, settings.volume_mm, None
            )

    @one_blas_thread()
    def enter(self, dots: Detections, view: str) -> None:
        """Take in the dots of a view, and calibrate with them.

        Parameters
        ----------
        dots : Detections
            Of this view, in all cameras.
        view : str
        """
        self._judged += 1
        self._faults = ()
        usable = dots.where(dots.has_id & (dots.flag == "ok"))
        for name in dict.fromkeys(usable.camera.tolist()):
            if (usable.camera == name).sum() < _FEWEST_DOTS:
                usable = usable.where(usable.camera != name)
        self._narrow(len(set(usable.camera.tolist())))
        if len(usable) == 0:
            return
        self._tables.append(usable)
        if len(self._tables) < FEWEST_VIEWS:
            return
        settings = self._settings
        self._standing = Standing.of(
            joined(self._tables), self._target, settings.lens, settings.volume_mm, self._standing
        )
        if self._standing is None:
            return
        poses = self._standing.poses
        self._last = poses.get(view, self._last)
        before = repeated(poses, view, self._findable.middle)
        if before is not None:
            self._faults = (f"the pose is nearly that of {before}, and adds little",)

    @one_blas_thread()
    def advise(self) -> Advice:
        """Return what to do next, and the error that is reached."""
        standing, wanted = self._standing, self._settings.wanted_mm
        coverage = self._coverage()
        stated = standing if len(self._tables) >= FEWEST_STATED else None
        base = Advice(
            words="",
            outlines={},
            T_world_target=None,
            reached_mm=None if stated is None else _finite(stated.reached_mm),
            calibration_mm=None if stated is None else _finite(stated.calibration_mm),
            wanted_mm=wanted,
            faults=self._faults,
            coverage=coverage,
            lacks=tuple(lacks_words(list(coverage.items()))) if standing else (),
            views=len(self._tables),
            done=False,
            sizes=self._sizes,
            shape_mm=None if stated is None or len(self._sizes) == 1 else _finite(stated.shape_mm),
        )
        if standing is None:
            return self._before_calibration(base)
        if wanted is not None and base.reached_mm is not None and base.reached_mm <= wanted:
            words = f"Done: the expected error is {base.reached_mm:.3g} mm, and {wanted:.3g} mm was asked for"
            return replace(base, words=words, done=True)
        self._reach = self._reach_from(standing.centre, self._reach)
        asked = self._next(standing, self._reach)
        if asked is None:
            words = "Hold the target anywhere that no view shows it yet, tilted another way"
            return replace(base, words=words)
        self._asked = asked[0], int(asked[1].sum())
        outlines = _outlines(standing, asked, self._findable)
        return replace(base, words=self._words(standing, asked), outlines=outlines, T_world_target=asked[0])

    def _before_calibration(self, base: Advice) -> Advice:
        """Return the first pose, then the one chosen by the rough rig; where there is none, tilts."""
        number = len(self._tables)
        rough = RoughRig.of(self._tables, self._sizes, self._target, self._settings) if number else None
        asked = None if rough is None else self._next(rough, self._reach_from(rough.centre, ROUGHLY))
        if rough is None or asked is None:
            first = self._tables[0] if self._tables else None
            known = {name: size for name, size in self._sizes.items() if all(size)}  # watch: tells it later
            outlines = first_outlines(number, known, first, self._target) if known else {}
            return replace(base, words=FIRST_POSES[number % len(FIRST_POSES)].words, outlines=outlines)
        self._last = rough.poses[-1]
        return replace(
            base, words=self._words(rough, asked), outlines=_outlines(rough, asked, self._findable)
        )

    def _reach_from(self, centre: Vectors3, of: HandReach) -> HandReach:
        """Return a reach about a place; upright alone, of a target that looks the same when turned."""
        turned = self._target.symmetric_indices(self._target.indices()[:1])
        return replace(of, centre=centre, quarters=1 if turned else 4)

    def _next(self, known: Standing | RoughRig, reach: HandReach) -> tuple[Pose, Mask] | None:
        """Return the pose to ask for, and a mask of the cameras that will find the target."""
        random = generator(self._seed, "poses of a guided capture", str(self._judged))
        return next_pose(known.volume, known.covariance, self._findable, known.variance, reach, random)

    def _narrow(self, found: int) -> None:
        """Ask no more for distances at which fewer cameras than thought found the target."""
        if self._asked is not None and self._standing is not None:
            T, expected = self._asked
            if found < expected:
                place = T[:3, :3] @ self._findable.middle + T[:3, 3]
                share = self._reach.share(self._standing.cameras, place)
                self._reach = self._reach.without(share)
        self._asked = None

    def _words(self, known: Standing | RoughRig, asked: tuple[Pose, Mask]) -> str:
        T, sees = asked
        names = [name for name, sure in zip(known.names, sees, strict=True) if sure]
        cameras = [camera for camera, sure in zip(known.cameras, sees, strict=True) if sure]
        words = pose_words(
            names, cameras, T, self._findable.middle, HeldBefore(self._last, known.distance_share)
        )
        wanted = self._settings.wanted_mm
        if wanted is not None and isinstance(known, Standing) and known.noise_mm > wanted:
            words += (
                f". The {wanted:.3g} mm asked for cannot be reached: the noise of a point's own pixels alone "
                f"is {known.noise_mm:.3g} mm"
            )
        return words

    def _coverage(self) -> dict[str, Int[np.ndarray, "rows columns"]]:
        counts = {name: np.zeros(CELLS, dtype=np.int64) for name in self._sizes}
        for table in self._tables:
            for name, cells in counts.items():
                q = table.position[table.camera == name]
                col, row = (((q + 0.5) / self._sizes[name]) * CELLS[::-1]).astype(int).T
                np.add.at(cells, (np.clip(row, 0, CELLS[0] - 1), np.clip(col, 0, CELLS[1] - 1)), 1)
        return counts


def _outlines(
    known: Standing | RoughRig, asked: tuple[Pose, Mask], target: Findable
) -> dict[str, Float64[np.ndarray, "corner 2"]]:
    """Return the outline to fill in each camera that will find the target."""
    outline = transform(asked[0], target.outline())
    cameras = zip(known.names, known.cameras, asked[1], strict=True)
    return {name: camera.project(outline).q for name, camera, sure in cameras if sure}


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None
