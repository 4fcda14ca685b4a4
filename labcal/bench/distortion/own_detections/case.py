"""Views of one's own that are held out together, and the methods that are measured on them."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

from labcal.bench.distortion.case import Setting
from labcal.correspond.detections import Detections
from labcal.errors import InputError
from labcal.shoot.dataset import Shoot
from labcal.shoot.manifest import Role

FOLDS = 5
"""Parts into which the views are divided where no views are there to test on."""
_LEAST_VIEWS = 2


@dataclass(frozen=True)
class OwnCase:
    """One part of the views, which methods are measured on after they learned from the others.

    Attributes
    ----------
    name : str
        Of the detections.
    fold : int
        Number of the part.
    shoot : Shoot
    detections : Detections
        Of all views.
    held_out : tuple of str
        The views of the part.
    methods : tuple of str
    seed : int
    settings : mapping
        Constructor arguments by method that differ from its defaults.
    sources : tuple of str
        Digests of the files of methods of one's own.
    """

    name: str
    fold: int
    shoot: Shoot
    detections: Detections
    held_out: tuple[str, ...]
    methods: tuple[str, ...]
    seed: int
    settings: Mapping[str, Mapping[str, Setting]] = field(default_factory=dict)
    sources: tuple[str, ...] = ()

    @property
    def key(self) -> str:
        """The name of the result file."""
        return f"{self.name}_{self.fold}"


def held_out_parts(shoot: Shoot, detected: Collection[str]) -> list[tuple[str, ...]]:
    """Return the views that are held out together: the test views, or else every fifth of the training views.

    Parameters
    ----------
    shoot : Shoot
    detected : collection of str
        The views of which there are detections.

    Raises
    ------
    InputError
        There are too few views to hold one out.
    """
    poses = shoot.nominal_poses()
    there = [view for view in shoot.views() if view.name in poses and view.name in detected]
    tested = tuple(view.name for view in there if view.role is Role.TEST)
    trained = [view.name for view in there if view.role is Role.TRAIN]
    if tested and trained:
        return [tested]
    if len(trained) < _LEAST_VIEWS:
        raise InputError(
            f"Of the detections of {shoot.folder}, {len(trained)} training views have a pose; at least "
            f"{_LEAST_VIEWS} are needed, of which one is held out. Shoot more views."
        )
    folds = min(FOLDS, len(trained))
    return [tuple(trained[number::folds]) for number in range(folds)]
