"""``labcal bench detect``: all checks of the detector."""

from pathlib import Path

from labcal.bench.boards.april_grids import april_grid_findings
from labcal.bench.boards.charucos import charuco_findings
from labcal.bench.boards.chessboards import chessboard_findings
from labcal.bench.boards.traced_boards import traced_board_findings
from labcal.bench.detect.accuracy import accuracy_findings
from labcal.bench.detect.bias import bias_checks
from labcal.bench.detect.developed import developed_findings
from labcal.bench.detect.hostile import hostile_findings
from labcal.bench.detect.real import real_findings
from labcal.bench.detect.speed import speed_findings
from labcal.bench.detect.suite import suite_findings
from labcal.bench.groups import Findings, Groups, measured_groups
from labcal.bench.marks.coded_dots import coded_dot_findings
from labcal.bench.marks.in_space import marks_in_space_findings
from labcal.bench.marks.tags import tag_findings
from labcal.bench.settings import BenchSettings
from labcal.report.bench import BenchResult
from labcal.run.progress import Progress

GROUPS: Groups = {
    "suite": suite_findings,
    "accuracy": accuracy_findings,
    "developed": developed_findings,
    "real": real_findings,
    "bias": lambda bench: Findings(bias_checks(bench.seed), []),
    "speed": speed_findings,
    "hostile": hostile_findings,
    "chessboards": chessboard_findings,
    "april-grids": april_grid_findings,
    "charuco": charuco_findings,
    "traced-boards": traced_board_findings,
    "coded-dots": coded_dot_findings,
    "tags": tag_findings,
    "marks-in-space": marks_in_space_findings,
}


def bench_detect(folder: Path, settings: BenchSettings, progress: Progress) -> BenchResult:
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
        There is no such group of checks.
    OutputError
        The folder exists already.
    DeviceError
        There is no LLVM library for the renderer.
    """
    return measured_groups("detect", GROUPS, folder, settings, progress)
