"""Checks of marks as points: drawn specimens, measured as ``labcal measure`` does, against the truth."""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from labcal.bench.groups import Bench, Findings
from labcal.bench.marks.specimen import CODE, DICTIONARY, Specimen, specimen
from labcal.correspond.mark_measurement import mark_pixels, measure_marks
from labcal.correspond.sources import Source
from labcal.detect.marks.mark_kinds import mark_kinds
from labcal.distributions import chi2_quantile
from labcal.reconstruct.found_marks import found_marks
from labcal.reconstruct.named_points import reconstruct_named
from labcal.report.bench import Check, Figure, at_most
from labcal.run.executor import open_executor
from labcal.run.progress import NoProgress
from labcal.shoot.pictures import write_picture
from labcal.shoot.tone_curve import ToneCurve

SPECIMENS, QUICK_SPECIMENS = 30, 3
CONFIDENCE, APART = 0.95, 0.02
_CHANCE = 2.6
"""Standard errors that chance is granted: of a hundred good ones, one is beyond."""
_OFF_MM = 2.0
"""Error above which a point counts as that of another mark."""
_KINDS = {"apriltag": "corners of tags", "ring": "coded dots", "dot": "plain dots"}


def marks_in_space_findings(bench: Bench) -> Findings:
    """Return the coverage of marks' 95% ellipsoids, by kind, and how many are named wrongly or missing."""
    count = QUICK_SPECIMENS if bench.quick else SPECIMENS
    bench.progress.start("marks in space", count)
    squares: dict[str, list[np.ndarray]] = {kind: [] for kind in _KINDS}
    lengths: dict[str, list[float]] = {kind: [] for kind in _KINDS}
    wrong, marks = 0, 0
    for number in range(count):
        made = specimen(number, bench.seed)
        marks += len(made.named) + len(made.plain)
        own: dict[str, list[float]] = {kind: [] for kind in _KINDS}
        for name, error, covariance in measured(made):
            if np.linalg.norm(error) > _OFF_MM:
                wrong += 1
                continue
            kind = name.partition("-")[0]
            own[kind].append(float(error @ np.linalg.solve(covariance, error)))
            lengths[kind].append(float(error @ error))
        for kind, values in own.items():
            squares[kind].append(np.array(values))
        bench.progress.advance()
    name = f"{count} specimens with marks"
    found = sum(len(values) for values in lengths.values())
    checks = [
        at_most(f"{name}: points of another mark", float(wrong), 0.0),
        at_most(f"{name}: share of marks without a point", 1.0 - (found + wrong) / marks, 0.05),
        *(_covered(f"{name}: coverage of {words}", squares[kind]) for kind, words in _KINDS.items()),
    ]
    figures = [
        Figure(name=f"{name}: RMS error of {words}, mm", value=float(np.sqrt(np.mean(lengths[kind]))))
        for kind, words in _KINDS.items()
    ]
    return Findings(checks, figures)


def measured(made: Specimen) -> list[tuple[str, np.ndarray, np.ndarray]]:
    """Return name, error (mm) and covariance of every point of a specimen, through files of its pictures.

    Parameters
    ----------
    made : Specimen
    """
    kinds = mark_kinds([DICTIONARY.value, CODE.value, "dots"])
    with TemporaryDirectory() as folder, open_executor(1) as executor:
        sources = []
        for camera, picture in made.pictures.items():
            path = Path(folder) / f"{camera}.png"
            write_picture(path, picture)
            sources.append(Source("specimen", camera, str(path), None))
        how = (ToneCurve.LINEAR, None)
        found = measure_marks(sources, kinds, {}, how, executor, NoProgress())
    marks = found_marks(made.rig, found, mark_pixels(found, kinds, None))
    points = marks.flagged(reconstruct_named(made.rig, marks.pixels).points)
    errors = []
    for row in np.flatnonzero(np.isfinite(points.point).all(axis=1)).tolist():
        name, p = str(points.name[row]), points.point[row]
        nearest = made.plain[np.argmin(np.linalg.norm(made.plain - p, axis=1))]
        true = nearest if name.startswith("dot-") else made.named.get(name, np.full(3, np.inf))
        errors.append((name, p - true, points.covariance[row]))
    return errors


def _covered(name: str, specimens: list[np.ndarray]) -> Check:
    """Return the check that a share is 95%, up to its limit and chance; corners of one tag are not alone."""
    limit = chi2_quantile(CONFIDENCE, 3)
    shares = np.array([(values < limit).mean() for values in specimens if len(values)])
    count = sum(len(values) for values in specimens)
    least = np.sqrt(CONFIDENCE * (1.0 - CONFIDENCE) / max(1, count))
    error = max(float(shares.std(ddof=1)) / np.sqrt(len(shares)) if len(shares) > 1 else 0.0, float(least))
    inside = float(np.concatenate(specimens).size and (np.concatenate(specimens) < limit).mean())
    return at_most(f"{name} off {CONFIDENCE}", abs(inside - CONFIDENCE), APART + _CHANCE * error)
