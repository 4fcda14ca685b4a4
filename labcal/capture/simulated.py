"""Simulated cameras: pictures that the cameras of a scene would take, rendered when they are triggered."""

import time
from collections.abc import Collection

from labcal.arrays import Pose
from labcal.capture.addresses import Address
from labcal.capture.settings import SourceSettings
from labcal.capture.source import CameraInfo, Encoded, Frame, FrameSet
from labcal.errors import InputError
from labcal.render.irradiance import Case
from labcal.render.picture import picture_of
from labcal.render.sensor_response import Exposure, exposure_for
from labcal.scene.catalogue import load_scene
from labcal.scene.check import check_scene
from labcal.scene.lighting import brightest_board
from labcal.scene.model import Scene
from labcal.scene.photometry import PictureFormat
from labcal.scene.plan import built_scene, planned_takes
from labcal.scene.views import PlannedView, planned_views
from labcal.shoot.manifest import Role
from labcal.shoot.pictures import encoded_picture


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
        self._held: Pose | None = None
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
        self._held = T_world_target

    def trigger(self) -> FrameSet | None:
        """Render the next view; None where the plan has no more and the hand holds nothing."""
        if self._held is not None:
            view = PlannedView(f"hand-{self._taken + 1:02d}", Role.TRAIN, self._held, None)
            self._held = None
        elif self._views:
            view = self._views.pop(0)
        else:
            return None
        if self._exposure is None:
            raise RuntimeError("Call open() before trigger().")
        self._taken += 1
        built, suffix = built_scene(self.scene), f".{self.scene.photometry.format.value}"
        quality, now = self.scene.photometry.jpeg_quality, time.time()
        frames = {}
        for take in planned_takes(self.scene, (view,), self._seed).takes:
            picture = picture_of(built, Case(take, self._seed), self._exposure)
            data = Encoded(bytes(encoded_picture(f"picture{suffix}", picture, quality)), suffix)
            frames[take.camera] = Frame(
                picture, now, 1000.0 * self.scene.photometry.exposure_ms, encoded=data
            )
        return FrameSet(frames, view.name, view.T_world_target_nominal, view.role)

    def follow(self) -> None:
        """Return nothing: these are stills."""

    def skip(self, views: Collection[str]) -> None:
        """Leave planned views out."""
        self._views = [view for view in self._views if view.name not in views]
        self._taken = len(views)

    def close(self) -> None:
        """Forget the plan."""
        self._views = []


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
