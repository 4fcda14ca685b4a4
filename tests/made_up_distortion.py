"""Findings of a benchmark of distortion with invented figures, as many as a plan asks for."""

import numpy as np

from labcal.bench.distortion.case import Measured
from labcal.bench.distortion.figures import CaseFigures, MethodFigures, RegionFigures
from labcal.bench.distortion.lines import lines_of
from labcal.bench.distortion.measurements import Measurements
from labcal.bench.distortion.page.findings import Findings
from labcal.bench.distortion.plan import load_plan

GROWTH = {"hybrid": 0.05, "two-plane": 0.2, "bundle": 2.0, "ray-net": 0.5, "mlp": 9.0, "dlt": 20.0}
"""By how much the error over the oracle's grows with the strength."""
WITHOUT_COVARIANCE = ("affine",)
REFUSES = "quadratic"


def made_up_findings(name: str, changes: tuple[str, ...] = (), seeds: int | None = None) -> Findings:
    """Return findings of a plan without pictures: errors grow with strength, and `REFUSES` has no figures."""
    plan = load_plan(name, changes, (), seeds).model_copy(update={"rendered": None})
    random = np.random.default_rng(5)
    cases = plan.cases(0)
    figures = []
    for case in cases:
        scatter = random.normal(0.0, 0.02, (len(plan.methods), len(plan.measured)))
        methods = tuple(
            _method(method, case.cell.strength, plan.measured, scatter[number])
            for number, method in enumerate(plan.methods)
        )
        figures.append(CaseFigures(trained=case.cell.points, beyond_pinhole_px=1.0, methods=methods))
    measured = Measurements(plan, 0, len(cases), lines_of(cases, figures))
    return Findings(
        measured.result(quick=False, command="labcal bench distortion -o DIR"), measured.summaries
    )


def _method(
    method: str, strength: float, regions: tuple[Measured, ...], scatter: np.ndarray
) -> MethodFigures:
    if method == REFUSES:
        return MethodFigures(method=method, reason="InputError: too few points")
    found = []
    for region, by_chance in zip(regions, scatter, strict=True):
        outside = 3.0 if region is Measured.OUTSIDE else 1.0
        ratio = 1.02 + outside * GROWTH.get(method, 1.0) * strength + float(by_chance)
        states = 0 if method in WITHOUT_COVARIANCE else 100
        found.append(
            RegionFigures(
                measured=str(region), n=100, predicted=100, rmse_mm=ratio, oracle_mm=1.0, stated=states,
                covered=min(states, 95 if ratio < 1.2 else 40), extrapolated=0,
            )
        )  # fmt: skip
    return MethodFigures(method=method, regions=tuple(found), misfit=GROWTH.get(method, 1.0) * strength > 1.5)
