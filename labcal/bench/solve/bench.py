"""``labcal bench solve``: all checks of the solvers."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from labcal.bench.diagnose.findings import diagnose_findings
from labcal.bench.groups import Groups, measured_groups
from labcal.bench.marks.coded_dots import coded_dot_findings
from labcal.bench.marks.in_space import marks_in_space_findings
from labcal.bench.marks.tags import tag_findings
from labcal.bench.settings import BenchSettings
from labcal.bench.solve.adjustment import adjustment_findings
from labcal.bench.solve.boards import board_findings
from labcal.bench.solve.budget import budget_findings
from labcal.bench.solve.certify import certify_findings
from labcal.bench.solve.check import check_findings
from labcal.bench.solve.compare import compare_findings
from labcal.bench.solve.guided import guided_findings
from labcal.bench.solve.limits import limit_findings
from labcal.bench.solve.mistakes import mistake_findings
from labcal.bench.solve.mrcal import mrcal_findings
from labcal.bench.solve.real import real_findings
from labcal.bench.solve.rehearsal import rehearsal_findings
from labcal.bench.solve.training import training_findings
from labcal.errors import InputError, UnknownNameError
from labcal.estimators.method_choice import estimator_of
from labcal.report.bench import BenchResult
from labcal.run.progress import Progress
from labcal.wording import listed

_OF_METHODS = "limits"
_OF_CASES = frozenset(
    (
        _OF_METHODS,
        "mistakes",
        "coverage",
        "certify",
        "check",
        "compare",
        "rehearse",
        "diagnose",
        "guided",
        "boards",
    )
)
"""Groups whose cases may be done by a cluster."""
GROUPS: Groups = {
    _OF_METHODS: limit_findings,
    "training": training_findings,
    "adjustment": adjustment_findings,
    "mistakes": mistake_findings,
    "coverage": budget_findings,
    "certify": certify_findings,
    "check": check_findings,
    "compare": compare_findings,
    "rehearse": rehearsal_findings,
    "real": real_findings,
    "mrcal": mrcal_findings,
}
_OF_MARKS: Groups = {
    "coded-dots": coded_dot_findings,
    "tags": tag_findings,
    "marks-in-space": marks_in_space_findings,
}
"""Groups of ``labcal bench detect`` that are a part of the budget."""
_OF_SHOOTS: Groups = {"diagnose": diagnose_findings, "guided": guided_findings, "boards": board_findings}
"""Groups of many simulated shoots, which are measured only where they are named."""
TOGETHER: Mapping[str, tuple[str, ...]] = {
    "budget": ("coverage", "certify", "check", "compare", "rehearse", "real", *_OF_MARKS)
}
"""Names of several groups: all that the error budget of a measurement rests on."""


def bench_solve(folder: Path, settings: BenchSettings, progress: Progress) -> BenchResult:
    """Measure every check and write ``results.json``.

    Parameters
    ----------
    folder : Path
        It appears when all is measured.
    settings : BenchSettings
    progress : Progress

    Raises
    ------
    UnknownNameError
        There is no such group of checks, or no such method.
    InputError
        A method is none, or is named where the group that measures methods is left out; a scheduler is named
        where all groups with cases are.
    OutputError
        The folder exists already.
    """
    settings = _expanded(settings)
    for method in settings.methods:
        estimator_of(method)  # tells now, not after an hour, whether there is such a method
    if settings.methods and settings.groups and _OF_METHODS not in settings.groups:
        raise InputError(
            f"Methods are measured in the group '{_OF_METHODS}', which is not among those that are named. "
            "Name it, too, or no method."
        )
    if settings.scheduler is not None and settings.groups and not _OF_CASES.intersection(settings.groups):
        raise InputError(
            f"`scheduler` is for the groups {listed(sorted(_OF_CASES))}, none of which is among those that "
            "are named. Leave it out, or name one of them."
        )
    groups = {**GROUPS, **_OF_MARKS, **_OF_SHOOTS} if settings.groups else GROUPS
    return measured_groups("solve", groups, folder, settings, progress)


def _expanded(settings: BenchSettings) -> BenchSettings:
    """Return the settings with the groups that a name of several stands for.

    Raises
    ------
    UnknownNameError
        There is no group of a name.
    """
    known = (*GROUPS, *_OF_MARKS, *_OF_SHOOTS, *TOGETHER)
    for wanted in settings.groups:
        if wanted not in known:
            raise UnknownNameError("group of checks", wanted, known)
    groups = [group for wanted in settings.groups for group in TOGETHER.get(wanted, (wanted,))]
    return replace(settings, groups=tuple(dict.fromkeys(groups)))
