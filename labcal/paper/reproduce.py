"""The experiments of the paper, all or some: shoots, detections, training runs, one document."""

import json
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from labcal.arguments import one_text, set_checked, texts, truth_value, whole_number
from labcal.correspond.dot_source import dots_of_shoot
from labcal.paper.claims.plan import plan_digest
from labcal.paper.claims.tested import tested_claims
from labcal.paper.experiments import Experiments, Study, experiments_named
from labcal.paper.explanations.explained import PICTURED_ROWS, explained, undisturbed_outcomes
from labcal.paper.pictured import kept_shoot, pictured_problems
from labcal.paper.problem import Problem
from labcal.paper.row_runs import row_results, row_runs
from labcal.paper.rows import NOT_REPORTED, ROWS, SCENES, Data, PaperRow
from labcal.paper.study.cells import studied
from labcal.paper.summary import least_squares_readings
from labcal.paper.training_run import TrainingOutcome, run_training
from labcal.paths import AnyPath, as_path
from labcal.render.shoot import RenderSettings
from labcal.report.reproduction import Reproduction, ShownPicture
from labcal.report.reproduction_page import reproduction_page
from labcal.report.study import StudyCell
from labcal.run.cases import run_cases
from labcal.run.executor import open_executor
from labcal.run.json_text import to_json
from labcal.run.machine import package_version
from labcal.run.made import PROVENANCE, provenance_text
from labcal.run.outputs import write_file
from labcal.run.progress import Progress
from labcal.run.unfinished import unfinished_folder

MAX_EPOCHS = 5000
"""The paper's."""
QUICK_EPOCHS = 300
QUICK_SPP = 8
FULL_SEEDS, QUICK_SEEDS = 10, 1
QUICK_PAIRS = 2
"""Of a claim in a quick run; too few to decide any."""
_PACKAGES = ("labcal", "mitsuba", "numpy", "opencv-contrib-python-headless", "torch")


@dataclass(frozen=True)
class ReproduceSettings:
    """Settings of a reproduction.

    Examples
    --------
    >>> from labcal.pipeline import ReproduceSettings
    >>> ReproduceSettings().runs, ReproduceSettings(quick=True).runs
    (10, 1)
    >>> ReproduceSettings(experiments=("01", "C4")).selected.claims
    ('C4',)
    """

    experiments: Sequence[str] = ()
    """Numbers of rows, claims, ``"study"`` and ``"explanations"``: ``("01", "C1")``; all where empty."""
    quick: bool = False
    seeds: int | None = None
    """Runs of every reading of a row; 10, or 1 when quick, where not given.

    Claims have those of their plan.
    """
    seed: int = 0
    """The first of them, and that of the pictures."""
    workers: int = 1
    scheduler: str | None = None
    """Of a Dask cluster for the training runs: an address, or ``"local"``; pictures are rendered here."""
    force: bool = False

    def __post_init__(self) -> None:
        """Check the settings.

        Raises
        ------
        UnknownNameError
            The paper has no such row or claim, and there is no such study.
        InputError, InputTypeError
            One is of a wrong type, a number is too small, or the paper has no figures of a row.
        """
        named = texts(self.experiments, "experiments")
        values = {
            "experiments": experiments_named(named).names if named else (),
            "quick": truth_value(self.quick, "quick"),
            "seeds": None if self.seeds is None else whole_number(self.seeds, "seeds", 1),
            "seed": whole_number(self.seed, "seed", 0),
            "workers": whole_number(self.workers, "workers", 1),
            "scheduler": None if self.scheduler is None else one_text(self.scheduler, "scheduler"),
            "force": truth_value(self.force, "force"),
        }
        set_checked(self, values)

    @property
    def selected(self) -> Experiments:
        """Rows, claims and studies in the order of the paper."""
        return experiments_named(self.experiments)

    @property
    def trained_rows(self) -> tuple[PaperRow, ...]:
        """The selected rows, and those that a study needs."""
        selected = self.selected
        needed = PICTURED_ROWS if Study.EXPLANATIONS in selected.studies else ()
        return tuple(row for row in ROWS if row in (*selected.rows, *needed))

    @property
    def seed_range(self) -> range:
        """The seeds of the runs."""
        return range(self.seed, self.seed + self.runs)

    @property
    def runs(self) -> int:
        """Number of runs of every reading."""
        return self.seeds or (QUICK_SEEDS if self.quick else FULL_SEEDS)

    @property
    def max_epochs(self) -> int:
        """Training steps after which a network stops."""
        return QUICK_EPOCHS if self.quick else MAX_EPOCHS

    @property
    def rendering(self) -> RenderSettings:
        """The settings of rendered shoots."""
        return RenderSettings(spp=QUICK_SPP if self.quick else None, seed=self.seed, workers=self.workers)

    @property
    def restrictions(self) -> tuple[str, ...]:
        """Description of what is left out."""
        if not self.quick:
            return ()
        return (
            f"pictures are rendered with {QUICK_SPP} rays a pixel",
            f"training stops after {QUICK_EPOCHS} epochs where the paper allows {MAX_EPOCHS}",
            f"claims are tested on {QUICK_PAIRS} seeds, which decide none",
        )


def reproduce(folder: AnyPath, settings: ReproduceSettings, progress: Progress) -> Reproduction:
    """Reproduce rows, claims and studies of the paper into a new folder: results, a page, shoots and cases.

    Parameters
    ----------
    folder : str or os.PathLike
        The folder to appear; what an interrupted run left is taken up again.
    settings : ReproduceSettings
    progress : Progress

    Raises
    ------
    OutputError
        The folder exists and may not be replaced, or it cannot be written.
    InputError
        The scheduler's address is none.
    DeviceError
        The renderer does not work on this machine, or the scheduler does not answer.
    """
    folder = as_path(folder)
    began = time.time()
    with (
        open_executor(settings.workers, settings.scheduler) as executor,
        unfinished_folder(folder, _command(settings), force=settings.force) as working,
    ):
        selected = settings.selected
        problems, pictures = _pictured(working, settings, progress)
        cases = [
            case
            for row in settings.trained_rows
            for case in row_runs(row, problems, settings.seed_range, settings.max_epochs)
        ]
        outcomes = run_cases(cases, run_training, TrainingOutcome, working / "cases", executor, progress)
        claims = tested_claims(
            selected.claims,
            working,
            QUICK_PAIRS if settings.quick else None,
            settings.rendering,
            executor,
            progress,
        )
        study: tuple[StudyCell, ...] = ()
        if Study.STUDY in selected.studies:
            study = studied(working, settings.seed_range, settings.max_epochs, executor, progress)
        explanations = None
        if Study.EXPLANATIONS in selected.studies:
            undisturbed = undisturbed_outcomes(cases, outcomes)
            seeds = settings.seed_range
            explanations = explained(problems, undisturbed, working, seeds, executor, progress)
        rows = row_results(selected.rows, cases, outcomes, settings.runs)
        result = Reproduction(
            rows=rows,
            least_squares=least_squares_readings(rows),
            not_reported=NOT_REPORTED,
            claims=claims,
            claims_plan_sha256=plan_digest() if claims else None,
            study=study,
            explanations=explanations,
            quick=settings.quick,
            restrictions=settings.restrictions,
            pictures=pictures,
        )
        write_file(working / "results.json", to_json(result), force=True)
        write_file(working / "index.html", reproduction_page(result, working), force=True)
        write_file(working / PROVENANCE, _provenance(settings, time.time() - began), force=True)
    return result


def _pictured(
    working: Path, settings: ReproduceSettings, progress: Progress
) -> tuple[dict[Data, dict[str, Problem]], tuple[ShownPicture, ...]]:
    """Return the problems of rows from pictures, and one picture of every shoot."""
    problems: dict[Data, dict[str, Problem]] = {}
    pictures = []
    for data in dict.fromkeys(row.data for row in settings.trained_rows if row.pictured):
        scene = SCENES[data]
        shoot = kept_shoot(working / "shoots" / scene, scene, settings.rendering, progress)
        problems[data] = pictured_problems(data, shoot, dots_of_shoot(shoot, settings.workers, progress))
        for camera, file in shoot.views()[0].images.items():
            path = (shoot.folder / file).relative_to(working).as_posix()
            pictures.append(ShownPicture(scene=SCENES[data], caption=f"{SCENES[data]}, {camera}", file=path))
    return problems, tuple(pictures)


def _command(settings: ReproduceSettings) -> str:
    """Return everything that determines the results."""
    return "reproduce " + json.dumps(
        {
            "reproduce": [row.exp for row in settings.selected.rows],
            "claims": settings.selected.claims,
            "studies": settings.selected.studies,
            "plan": plan_digest() if settings.selected.claims else None,
            "quick": settings.quick,
            "runs": settings.runs,
            "seed": settings.seed,
        }
    )


def _provenance(settings: ReproduceSettings, seconds: float) -> bytes:
    """Return ``run.json``, which differs between runs."""
    versions = {package: package_version(package) for package in _PACKAGES}
    return provenance_text(
        {
            "seconds": seconds,
            "workers": settings.workers,
            "scheduler": settings.scheduler,
            "versions": versions,
        }
    )
