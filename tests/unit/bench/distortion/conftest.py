"""Summaries of cells with given figures."""

from collections.abc import Callable

import numpy as np
import pytest

from labcal.bench.distortion.case import Cell, Layout
from labcal.bench.distortion.cell_summary import CellSummary

Make = Callable[..., CellSummary]


@pytest.fixture
def summary() -> Make:
    """Return a maker of summaries: method, errors over the oracle's by seed, coverage."""

    def make(
        method: str,
        ratios: tuple[float, ...],
        coverage: float = 0.95,
        cell: Cell = Cell("water", 0.5, 0.1, 140, Layout.PLANES),  # noqa: B008 - it is frozen
        reasons: tuple[str, ...] = (),
    ) -> CellSummary:
        middle = float(np.median(ratios)) if ratios else float("nan")
        low, high = (min(ratios), max(ratios)) if ratios else (float("nan"),) * 2
        return CellSummary(
            method=method,
            cell=cell,
            measured="within",
            seeds=3,
            over_oracle=middle,
            low=low,
            high=high,
            rmse_mm=middle,
            oracle_mm=1.0,
            coverage95=coverage,
            unflagged_coverage95=coverage,
            flagged_misfit=False,
            trained=140,
            by_seed=ratios,
            reasons=reasons,
        )

    return make
