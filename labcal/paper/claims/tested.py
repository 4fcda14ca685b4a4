"""The tests of the claims, run: pictures where arms need them, every run, the verdicts."""

from collections.abc import Sequence
from concurrent.futures import Executor
from pathlib import Path

from labcal.paper.claims.arm_run import ArmFigures, arm_figures
from labcal.paper.claims.outcome import claim_results, claim_runs
from labcal.paper.claims.pictured import needed_shoots, pictured_data
from labcal.paper.claims.plan import claims_plan
from labcal.render.shoot import RenderSettings
from labcal.report.claims import ClaimResult
from labcal.run.cases import run_cases
from labcal.run.progress import Progress


def tested_claims(
    names: Sequence[str],
    folder: Path,
    most_seeds: int | None,
    rendering: RenderSettings,
    executor: Executor,
    progress: Progress,
) -> tuple[ClaimResult, ...]:
    """Test claims, and return them with their verdicts.

    Parameters
    ----------
    names : sequence of str
        Of the plan.
    folder : Path
        Where shoots and results of single runs are kept, in ``claim-shoots`` and ``claim-runs``; those of an
        interrupted run are used.
    most_seeds : int, optional
        Fewer pairs than the plan asks for.
    rendering : RenderSettings
        Rays a pixel and workers of the shoots.
    executor : Executor
    progress : Progress
    """
    plan = claims_plan()
    claims = {name: plan.claims[name] for name in names}
    needed = needed_shoots(claims.values(), most_seeds)
    pictured = pictured_data(needed, folder / "claim-shoots", rendering, progress)
    runs = claim_runs(claims, pictured, most_seeds)
    found = run_cases(runs, arm_figures, ArmFigures, folder / "claim-runs", executor, progress)
    figures = {run.key: one for run, one in zip(runs, found, strict=True)}
    return claim_results(claims, figures, most_seeds)
