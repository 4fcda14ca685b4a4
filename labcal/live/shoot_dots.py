"""Dots of a shoot that grows: each picture is searched once, for advice, calibration and diagnosis."""

from pathlib import Path

from labcal.correspond.measure import Measurement, agreed, measure_picture
from labcal.correspond.sources import shoot_sources
from labcal.errors import InputError
from labcal.shoot.dataset import Shoot, open_shoot
from labcal.targets.catalogue import AnyTarget


class ShootDots:
    """Measurements of the pictures of a shoot, from its files, as ``labcal detect`` would make them.

    Parameters
    ----------
    folder : Path
        The shoot, which may grow and lose views.
    target : AnyTarget
    """

    def __init__(self, folder: Path, target: AnyTarget) -> None:
        self._folder, self._target = folder, target
        self._known: dict[str, Measurement] = {}

    @property
    def target(self) -> AnyTarget:
        """The target that is looked for."""
        return self._target

    def of_view(self, view: str) -> dict[str, Measurement]:
        """Return the measurements of a view by camera; no camera where the shoot does not have the view."""
        shoot = self._shoot()
        sources = [] if shoot is None else [one for one in shoot_sources(shoot) if one.view == view]
        for source in sources:
            if source.image not in self._known:
                self._known[source.image] = measure_picture(source, self._target)
        return {source.camera: self._known[source.image] for source in sources}

    def forget(self, view: str) -> None:
        """Forget a view that has left the shoot: another one may get its name."""
        self._known = {image: one for image, one in self._known.items() if one.source.view != view}

    def all(self) -> tuple[Shoot, list[Measurement]]:
        """Return the shoot as it is now, and the measurements of all its pictures in its order.

        Raises
        ------
        InputError
            There is no view yet.
        """
        shoot = open_shoot(self._folder)
        found = [one for view in shoot.views() for one in self.of_view(view.name).values()]
        return shoot, agreed(found, self._target)

    def _shoot(self) -> Shoot | None:
        try:
            return open_shoot(self._folder)
        except InputError:
            return None
