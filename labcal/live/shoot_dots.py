"""Dots of a shoot that grows: each picture is searched once, for advice, calibration and diagnosis."""

from pathlib import Path

from labcal.cameras.rig import Rig
from labcal.correspond.measure import Measurement, agreed, detections_of, measure_picture
from labcal.correspond.sources import shoot_sources
from labcal.errors import InputError, LabcalError
from labcal.guide.diagnosis.evidence import Evidence
from labcal.shoot.dataset import Shoot, open_shoot
from labcal.targets.catalogue import AnyTarget


class ShootDots:
    """Measurements of the pictures of a shoot, from its files, as ``labcal detect`` would make them.

    Parameters
    ----------
    folder : Path
        The shoot, which may grow and lose views.
    target : AnyTarget or None
        None where it is not known: then the shoot names it, from the view on in which the code of its print
        is read.
    """

    def __init__(self, folder: Path, target: AnyTarget | None) -> None:
        self._folder, self._target = folder, target
        self._known: dict[str, Measurement] = {}

    @property
    def target(self) -> AnyTarget | None:
        """The target that is looked for; None while nothing tells it."""
        shoot = self._shoot() if self._target is None else None
        if shoot is not None:
            self._target = shoot.manifest.target
        return self._target

    def of_view(self, view: str) -> dict[str, Measurement]:
        """Return the measurements of a view by camera; none without a target or such a view."""
        shoot, target = self._shoot(), self.target
        if shoot is None or target is None:
            return {}
        sources = [one for one in shoot_sources(shoot) if one.view == view]
        for source in sources:
            if source.image not in self._known:
                self._known[source.image] = measure_picture(source, target)
        return {source.camera: self._known[source.image] for source in sources}

    def forget(self, view: str) -> None:
        """Forget a view that has left the shoot: another one may get its name."""
        self._known = {image: one for image, one in self._known.items() if one.source.view != view}

    def all(self) -> tuple[Shoot, list[Measurement]]:
        """Return the shoot as it is now, and the measurements of all its pictures in its order.

        Raises
        ------
        InputError
            There is no view yet, or nothing tells the target.
        """
        shoot, target = open_shoot(self._folder), self.target
        if target is None:
            raise InputError(
                "No code of a print is read in the views, so that the target is not known. Show the code, or "
                "begin a new shoot with the name of the target."
            )
        found = [one for view in shoot.views() for one in self.of_view(view.name).values()]
        return shoot, agreed(found, target)

    def evidence(self, rig: Rig | None = None) -> Evidence | None:
        """Return the shoot as it is now for a diagnosis; None without views, or a target that is known.

        Parameters
        ----------
        rig : Rig, optional
            A calibration of the cameras that is known.
        """
        try:
            shoot, found = self.all()
        except LabcalError:
            return None
        target = self.target
        return None if target is None else Evidence(target, detections_of(found), shoot, tuple(found), rig)

    def _shoot(self) -> Shoot | None:
        try:
            return open_shoot(self._folder)
        except InputError:
            return None
