"""What several commands are given: a shoot or its detections, and the target that it shows."""

from pathlib import Path
from typing import TYPE_CHECKING

from labcal.cli.session import Session

if TYPE_CHECKING:
    from labcal.correspond.detections import Detections
    from labcal.targets.catalogue import AnyTarget


def read_or_detect(source: str, target: "AnyTarget | None", workers: int, session: Session) -> "Detections":
    """Return the dots in a table, or find them in the pictures of a shoot.

    A shoot brings its own target where none is given. Pictures without ids are told as warnings.
    """
    from labcal.correspond.detections import read_detections
    from labcal.correspond.measure import detections_of
    from labcal.correspond.sources import shoot_sources
    from labcal.shoot.dataset import open_shoot
    from labcal.workflow import measure

    if Path(source).is_file():
        return read_detections(Path(source))
    shoot = open_shoot(Path(source))
    with session.progress() as progress:
        measurements = measure(shoot_sources(shoot), target or shoot.target, workers, progress)
    for found in measurements:
        if found.reason is not None:
            session.warn(f"{found.source.image}: {found.reason}")
    return detections_of(measurements)
