"""Simulated cameras: pictures that the cameras of a scene would take, rendered when they are triggered."""

import time
from collections.abc import Collection
from dataclasses import replace

import numpy as np

from labcal.arrays import Pose
from labcal.capture.addresses import Address
from labcal.capture.settings import SourceSettings
from labcal.capture.source import CameraInfo, Encoded, Frame, FrameSet
from labcal.errors import InputError
from labcal.render.delivery import sensor_picture
from labcal.render.irradiance import Case
from labcal.render.picture import exposed
from labcal.render.sensor_response import Exposure, Shot, exposure_for
from labcal.scene.catalogue import load_scene
from labcal.scene.check import check_scene
from labcal.scene.lighting import brightest_board
from labcal.scene.model import Scene
from labcal.scene.photometry import Photometry, PictureFormat
from labcal.scene.plan import built_scene, planned_takes
from labcal.scene.views import PlannedView, planned_views
from labcal.shoot.manifest import Role
from labcal.shoot.pictures import encoded_picture

LOOKS = 3
"""Different pictures of what is seen before a view is taken."""
_Exposed = tuple[np.ndarray, Photometry, Exposure, Shot | None]


class SimulatedCameras:
    """The cameras of a scene.

    The target stands where the scene's plan puts it, view after view, or where a simulated hand holds it
    (:meth:`hold`).

    Parameters
    ----------
    scene : Scene
    name : str
        The address, for people.
    seed : int
        Of noise and of the plan.
    """

    live = False

    def __init__(self, scene: Scene, name: str, seed: int) -> None:
        self.scene, self._name, self._seed = scene, name, seed
        self._views: list[PlannedView] = []
        self._held: PlannedView | None = None
        self._light: tuple[PlannedView, dict[str, _Exposed]] | None = None
        self._seen: list[FrameSet] = []
        self._exposure: Exposure | None = None
        self._taken = 0

    def open(self) -> None:
        """Check the scene, and plan its views.

        Raises
        ------
        InputError
            Something in the scene cannot be.
        """
        if self.scene.photometry.format is PictureFormat.EXR:
            raise InputError(
                f"The scene '{self.scene.name}' delivers light (EXR), not pictures. Give it another format: "
                "photometry.format=png."
            )
        check_scene(self.scene, self._seed, None)
        self._views = list(planned_views(self.scene, self._seed))
        self._exposure = exposure_for(self.scene.photometry, brightest_board(self.scene, tuple(self._views)))

    def describe(self) -> tuple[CameraInfo, ...]:
        """Return the scene's cameras."""
        exposure_us = 1000.0 * self.scene.photometry.exposure_ms
        return tuple(
            CameraInfo(name, f"{self._name}, simulated", camera.size, exposure_us)
            for name, camera in self.scene.cameras.items()
        )

    def hold(self, T_world_target: Pose) -> None:
        """Hold the target at a pose (4, 4), mm, for the next picture, in place of the next planned view."""
        self._seen = []
        self._held = PlannedView(f"hand-{self._taken + 1:02d}", Role.TRAIN, T_world_target, None)

    def peek(self) -> FrameSet | None:
        """Return what the cameras see before the next view is taken.

        :data:`LOOKS` pictures have noise of their own, and then come again: to develop one takes longer than
        a camera takes to deliver it.
        """
        view = self._coming()
        if not self._seen or self._seen[0].view != getattr(view, "name", None):
            self._seen = []
        if len(self._seen) < LOOKS:
            look = self._pictures(f"look {len(self._seen) + 1}")
            if look is None:
                return None
            self._seen.append(look)
            return look
        self._seen = [*self._seen[1:], self._seen[0]]
        return self._seen[-1]

    def trigger(self) -> FrameSet | None:
        """Render the next view; None where the plan has no more and the hand holds nothing."""
        taken = self._pictures("")
        if taken is None:
            return None
        if self._held is not None:
            self._held = None
        else:
            self._views.pop(0)
        self._taken += 1
        return taken

    def _coming(self) -> PlannedView | None:
        """Return the view that is taken next."""
        return self._held or next(iter(self._views), None)

    def _pictures(self, look: str) -> FrameSet | None:
        """Return the pictures of the next view, or of a look at it, whose noise is another one."""
        view = self._coming()
        if view is None:
            return None
        if self._exposure is None:
            raise RuntimeError("Call open() before trigger().")
        if self._light is None or self._light[0] is not view:
            built = built_scene(self.scene)
            takes = planned_takes(self.scene, (view,), self._seed).takes
            lights = {one.camera: exposed(built, Case(one, self._seed), self._exposure) for one in takes}
            self._light = (view, lights)
        suffix, now = f".{self.scene.photometry.format.value}", time.time()
        frames = {}
        for name, (light, photometry, exposure, shot) in self._light[1].items():
            drawn = replace(shot, view=f"{shot.view} {look}") if shot is not None and look else shot
            picture = sensor_picture(light, photometry, exposure, drawn)
            quality = self.scene.photometry.jpeg_quality
            data = None if look else Encoded(bytes(encoded_picture(f"p{suffix}", picture, quality)), suffix)
            frames[name] = Frame(picture, now, 1000.0 * self.scene.photometry.exposure_ms, encoded=data)
        return FrameSet(frames, view.name, view.T_world_target_nominal, view.role)

    def follow(self) -> None:
        """Return nothing: these are stills."""

    def skip(self, views: Collection[str]) -> None:
        """Leave planned views out."""
        self._views = [view for view in self._views if view.name not in views]
        self._taken = len(views)

    def close(self) -> None:
        """Forget the plan."""
        self._views, self._light, self._seen = [], None, []


def source_of(address: Address, settings: SourceSettings) -> SimulatedCameras:
    """Return the source of a scene's cameras.

    Raises
    ------
    UnknownNameError, InputError
        There is no such scene.
    """
    scene = load_scene(address.place, settings.overrides)
    if settings.exposure_us is not None:
        photometry = scene.photometry.model_copy(update={"exposure_ms": 1e-3 * settings.exposure_us})
        scene = scene.model_copy(update={"photometry": photometry})
    return SimulatedCameras(scene, str(address), settings.seed)
