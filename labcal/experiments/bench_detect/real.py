"""Pictures that this project did not make, where they are at hand: photographs and renderings."""

import os
from dataclasses import dataclass
from pathlib import Path

from labcal.correspond.detections import Detections
from labcal.correspond.measure import detections_of, measure_picture
from labcal.correspond.sources import find_sources
from labcal.experiments.bench_detect.findings import Bench, Findings
from labcal.report.bench import Check, at_most
from labcal.run.progress import Progress
from labcal.solve.handheld import calibrate_handheld
from labcal.targets.catalogue import load_target
from labcal.targets.grid import DotGrid

VARIABLE = "LABCAL_REAL_DATA"
"""Environment variable with the folder that holds the sets."""
LENS = "brown-k1k2"
PAIR = {"_0": "left", "_1": "right"}


@dataclass(frozen=True)
class RealSet:
    """One set of pictures."""

    folder: str
    target: str
    endings: dict[str, str]
    """Camera by ending of the name; empty for one camera."""
    pictures: int
    rms_px: float
    """Limit of the reprojection error with a flat and perfect board."""


SETS = (
    RealSet("photos", "rings-10x8", PAIR, 14, 0.54),
    RealSet("rendered_black", "rings-14x10", PAIR, 20, 0.009),
    RealSet("rendered_white", "rings-14x10", {}, 5, 0.009),
)


def real_findings(bench: Bench) -> Findings:
    """Return whether every picture is indexed, and how well each camera explains its dots.

    Nothing but a note where the pictures are not at hand.
    """
    home = os.environ.get(VARIABLE)
    if home is None or not Path(home).is_dir():
        return Findings([], [], (f"real: left out, since ${VARIABLE} names no folder of pictures",))
    checks: list[Check] = []
    bench.progress.start("real pictures", sum(one.pictures for one in SETS))
    for one in SETS:
        target = load_target(one.target)
        lost, found = _measured(one, Path(home), target, bench.progress)
        checks.append(at_most(f"{one.folder}: pictures not indexed, of {one.pictures}", lost, 0))
        checks += set_checks(one, found, target)
    return Findings(checks, [])


def _measured(one: RealSet, home: Path, target: DotGrid, progress: Progress) -> tuple[int, Detections]:
    """Return how many pictures of a set are missing or not indexed, and the dots of the others."""
    measurements = []
    for source in find_sources([str(home / one.folder)], one.endings):
        measurements.append(measure_picture(source, target))
        progress.advance()
    indexed = sum(found.indexed for found in measurements)
    return one.pictures - indexed, detections_of(measurements)


def set_checks(one: RealSet, found: Detections, target: DotGrid) -> list[Check]:
    """Return the reprojection error of every camera, calibrated alone with a flat and perfect board."""
    fits = calibrate_handheld(found, target, LENS).fits
    return [
        at_most(f"{one.folder}: RMS of camera {camera} alone, px", fit.rms_px, one.rms_px)
        for camera, fit in fits.items()
    ]
