"""Pictures from outside this project, if they are available: photographs and renderings."""

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from labcal.bench.detect.freed import photo_checks, rendered_checks
from labcal.bench.groups import Bench, Findings
from labcal.correspond.detections import Detections
from labcal.correspond.measure import detections_of, measure_picture
from labcal.correspond.sources import find_sources
from labcal.report.bench import Check, at_most
from labcal.run.progress import Progress
from labcal.targets.catalogue import AnyTarget, load_target

VARIABLE = "LABCAL_REAL_DATA"
"""Environment variable with the folder that holds the sets."""
PAIR = {"_0": "left", "_1": "right"}


@dataclass(frozen=True)
class RealSet:
    """One set of pictures."""

    folder: str
    target: str
    endings: dict[str, str]
    """Camera by ending of the name; empty for one camera."""
    pictures: int
    checks: Callable[[str, Detections, AnyTarget], list[Check]]
    """The checks of its dots, by the name of the set."""


SETS = (
    RealSet("photos", "rings-10x8", PAIR, 14, photo_checks),
    RealSet("rendered_black", "rings-14x10", PAIR, 20, rendered_checks),
    RealSet("rendered_white", "rings-14x10", {}, 5, rendered_checks),
)


def real_home() -> Path | None:
    """Return the folder that holds the sets, if it is available."""
    home = os.environ.get(VARIABLE)
    return Path(home) if home is not None and Path(home).is_dir() else None


def real_findings(bench: Bench) -> Findings:
    """Return whether every picture is indexed, and the residuals of each camera.

    Nothing but a note where the pictures are not at hand.
    """
    home = real_home()
    if home is None:
        return Findings([], [], (f"real: left out, since ${VARIABLE} names no folder of pictures",))
    checks: list[Check] = []
    bench.progress.start("real pictures", sum(one.pictures for one in SETS))
    for one in SETS:
        target = load_target(one.target)
        lost, found = _measured(one, home, target, bench.progress)
        checks.append(at_most(f"{one.folder}: pictures not indexed, of {one.pictures}", lost, 0))
        checks += one.checks(one.folder, found, target)
    return Findings(checks, [])


def _measured(one: RealSet, home: Path, target: AnyTarget, progress: Progress) -> tuple[int, Detections]:
    """Return the number of pictures of a set that are missing or not indexed, and the dots of the others."""
    measurements = []
    for source in find_sources([str(home / one.folder)], one.endings):
        measurements.append(measure_picture(source, target))
        progress.advance()
    indexed = sum(found.indexed for found in measurements)
    return one.pictures - indexed, detections_of(measurements)
