"""Dots as a user gives them, resolved once: a table, or a shoot whose dots are measured or not yet."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from labcal.cameras.rig import Rig
from labcal.correspond.detections import Detections
from labcal.correspond.detections_csv import HEADER, read_detections
from labcal.correspond.measure import Measurement, detections_of, measure_pictures, refusals
from labcal.correspond.picture_lists import LIST
from labcal.correspond.picture_set import PictureSet, open_pictures, target_shown
from labcal.correspond.refused_pictures import shared_reasons
from labcal.correspond.sources import Source, shoot_sources
from labcal.errors import InputError
from labcal.paths import AnyPath, as_path
from labcal.run.executor import open_executor
from labcal.run.file_reading import first_line
from labcal.run.progress import Progress
from labcal.shoot.dataset import Shoot, is_shoot, open_shoot
from labcal.shoot.pictures import SUFFIXES
from labcal.shoot.raw_pictures import RAW_SUFFIXES
from labcal.targets.catalogue import AnyTarget, AnyTargets

_OFTEN_NO_TABLE = frozenset({LIST, *RAW_SUFFIXES})
"""Endings of files that are mostly lists of pictures, or pictures without a header."""


@dataclass(frozen=True)
class DotSource:
    """Dots to work with.

    Attributes
    ----------
    shoot : Shoot or None
        The shoot that they are of; None where a table is given alone.
    table : Detections or None
        The dots that are measured already; None where they are yet to be found in the shoot's pictures.
    """

    shoot: Shoot | None
    table: Detections | None

    @property
    def pictures(self) -> PictureSet:
        """Pictures of the shoot, in which dots are found.

        Raises
        ------
        InputError
            There is no shoot.
        """
        if self.shoot is None:
            raise InputError("A table of dots has no pictures. Its dots are in `table`.")
        return open_pictures(self.shoot)

    def target(self, given: AnyTargets | None = None, rig: Rig | None = None) -> AnyTarget:
        """Return the target that is given, by itself or by name, of the shoot, of a print or of a rig.

        The code of a print is searched in the pictures of the shoot or, where a table is given alone and the
        rig keeps no target, in those that it names and that are still there.

        Raises
        ------
        UnknownNameError, InputError
            As of :func:`~labcal.correspond.picture_set.target_shown`.
        """
        read = self.table is None or self.shoot is not None or rig is None or rig.target is None
        return target_shown(given, self.shoot, self._sources() if read else (), rig).target

    def states_target(self, rig: Rig | None = None) -> bool:
        """Tell whether a shoot, by itself or by its pictures, or a rig states the target of the dots."""
        return self.shoot is not None or (rig is not None and rig.target is not None)

    def in_pictures(self, taken: AnyTarget | None) -> AnyTarget | None:
        """Return the target by which dots are found: the shoot's own or, if it states none, `taken`."""
        stated = None if self.shoot is None else self.shoot.manifest.target
        return taken if stated is None else stated

    def _sources(self) -> list[Source]:
        """Return the pictures that dots are of, as far as they are there."""
        if self.shoot is not None:
            return shoot_sources(self.shoot)
        if self.table is None:
            return []
        lines = zip(self.table.view, self.table.camera, self.table.image, strict=True)
        named = {
            str(image): Source(str(view), str(camera), str(image), None) for view, camera, image in lines
        }
        return [source for path, source in named.items() if Path(path).is_file()]

    def showing(self, target: AnyTarget) -> Shoot | AnyTarget:
        """Return the shoot, where there is one, with the target that it is said to show; else the target."""
        if self.shoot is None:
            return target
        return self.shoot if self.shoot.manifest.target == target else self.shoot.showing(target)


def is_dot_table(given: AnyPath) -> bool:
    """Tell whether a path, given where pictures may be, is that of a table of dots."""
    path = as_path(given)
    ending = path.suffix.lower()
    if not path.is_file() or ending in SUFFIXES:
        return False
    return ending not in _OFTEN_NO_TABLE or first_line(path) == ",".join(HEADER).encode()


def open_dots(source: AnyPath | Shoot, detections: AnyPath | Detections | None = None) -> DotSource:
    """Return the dots that a table holds, or a shoot.

    Parameters
    ----------
    source : path or Shoot
        A shoot or its folder, or a table of dots.
    detections : path or Detections, optional
        The dots of the shoot, measured already.

    Raises
    ------
    InputError
        There is no such shoot or table, it cannot be read, or `detections` is given beside a table.
    """
    if not isinstance(source, Shoot):
        shoot = shoot_or_none(source)
        if shoot is None:
            if detections is not None:
                raise InputError("`detections` goes with the folder of a shoot. Give the table alone.")
            return DotSource(None, read_detections(as_path(source)))
        source = shoot
    if detections is None or isinstance(detections, Detections):
        return DotSource(source, detections)
    return DotSource(source, read_detections(as_path(detections)))


def shoot_or_none(source: AnyPath) -> Shoot | None:
    """Return the shoot that a source is; None where it is a file.

    Raises
    ------
    InputError
        It is neither.
    """
    path = as_path(source)
    if is_shoot(path):
        return open_shoot(path)
    if not path.is_file():
        there = "is not a shoot" if path.exists() else "does not exist"
        raise InputError(
            f"{source} {there}. Give a shoot's folder, or the table that 'labcal detect' writes of pictures."
        )
    return None


def dots_found(measurements: Sequence[Measurement]) -> tuple[Detections, tuple[str, ...]]:
    """Return the dots of measured pictures, and why others have none, for people.

    Raises
    ------
    InputError
        No picture could be read at all.
    """
    reasons = tuple(shared.words for shared in shared_reasons(refusals(measurements)))
    return detections_of(measurements), reasons


def dots_of_shoot(shoot: Shoot, workers: int, progress: Progress) -> Detections:
    """Return the dots of a shoot, found by its own target.

    Raises
    ------
    InputError
        No picture could be read at all.
    """
    with open_executor(workers) as executor:
        return detections_of(measure_pictures(shoot_sources(shoot), shoot.target, executor, progress))
