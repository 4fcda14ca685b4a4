"""Seconds of each method: what is measured, how a shared fit counts, and their files."""

import csv
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from jaxtyping import Float64

from labcal.bench.distortion import measuring
from labcal.bench.distortion.case import Case, Cell, Layout, Measured
from labcal.bench.distortion.cell_data import cell_data
from labcal.bench.distortion.figures import CaseFigures, MethodFigures, RegionFigures
from labcal.bench.distortion.method_seconds import predict_seconds_per_1000, seconds_table, timings_table
from labcal.cli.console import rendered
from labcal.estimators.bundle import Bundle
from labcal.estimators.dlt import Dlt
from labcal.estimators.hybrid import Hybrid
from labcal.estimators.surrogate_validation import Surrogate, takes_from

CELL = Cell("brown", 0.2, 0.1, 60, Layout.PLANES, fault="bend-1")
BOTH = (Measured.WITHIN, Measured.OUTSIDE)
CASE = Case(CELL, 0, ("dlt", "hybrid", "affine"), BOTH, 50)
FIT, PREDICT = 0.05, 0.08


class Slow(Dlt):
    """DLT that waits."""

    def fit(self, X: Float64[np.ndarray, "n inputs"], Y: Float64[np.ndarray, "n outputs"]) -> "Slow":
        """Fit, and wait."""
        time.sleep(FIT)
        super().fit(X, Y)
        return self

    def predict_with_covariance(
        self, X: Float64[np.ndarray, "n inputs"], pixel_covariance: Float64[np.ndarray, "n cameras 2 2"]
    ) -> tuple[Float64[np.ndarray, "n 3"], Float64[np.ndarray, "n 3 3"]]:
        """Predict, and wait."""
        time.sleep(PREDICT)
        return super().predict_with_covariance(X, pixel_covariance)


def test_fit_and_prediction_are_measured_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(measuring, "prepared", lambda _case, _method: Slow())
    monkeypatch.setattr(measuring, "surrogate_of", lambda *_of: None)
    (found,) = measuring.measured_case(Case(CELL, 0, ("slow",), BOTH, 50)).methods
    assert found.fit_seconds >= FIT
    assert all(one.predict_seconds >= PREDICT for one in found.regions)
    assert found.shared_seconds == 0.0
    assert predict_seconds_per_1000(found) >= 1000.0 * 2.0 * PREDICT / 100.0


def test_who_takes_from_the_hybrid_is_told_its_seconds(monkeypatch: pytest.MonkeyPatch) -> None:
    data = cell_data(Case(CELL, 0, ("hybrid",), BOTH, 50))
    hybrid = Hybrid("brown5", measuring._SIZES).fit(data.X, data.Y)
    known = np.zeros((1, 2, 2, 2))
    surrogate = Surrogate(hybrid, data.Y[:1], data.X[:1], known, 1.0, np.zeros((1, 3)), hybrid_seconds=7.0)
    monkeypatch.setattr(measuring, "surrogate_of", lambda *_of: surrogate)
    monkeypatch.setattr(measuring, "validate_on", lambda *_of: None)
    settings = {"hybrid": {"lens": "brown5"}, "bundle": {"lens": "pinhole"}}
    found = measuring.measured_case(Case(CELL, 0, ("hybrid", "bundle", "dlt"), BOTH, 50, settings))
    assert [one.shared_seconds for one in found.methods] == [7.0, 0.0, 0.0]
    assert takes_from(surrogate, Bundle("brown5", measuring._SIZES))
    assert not takes_from(surrogate, Bundle("brown5", measuring._SIZES, behind_index=1.333))
    assert not takes_from(surrogate, Hybrid("pinhole", measuring._SIZES))
    assert not takes_from(surrogate, Dlt())


def figures(method: str, fit: float, predict: float, shared: float = 0.0) -> MethodFigures:
    region = RegionFigures(
        measured="within", n=50, predicted=50, rmse_mm=1.0, oracle_mm=1.0, stated=50, covered=47,
        extrapolated=0, predict_seconds=predict,
    )  # fmt: skip
    return MethodFigures(method=method, regions=(region,), fit_seconds=fit, shared_seconds=shared)


def test_a_line_for_each_case_and_method_and_a_median_of_them(tmp_path: Path) -> None:
    refused = MethodFigures(method="affine", reason="too few points")
    first = CaseFigures(methods=(figures("dlt", 0.1, 0.01), figures("hybrid", 0.5, 0.02, 3.0), refused))
    second = CaseFigures(methods=(figures("dlt", 0.3, 0.03), figures("hybrid", 0.7, 0.02, 4.0), refused))
    undrawn = CaseFigures(reason="nothing seen")
    file = tmp_path / "timings.csv"
    file.write_text(timings_table([CASE] * 3, [first, second, undrawn], [9.0, 8.0, 0.1]), encoding="utf-8")
    lines = list(csv.DictReader(file.read_text(encoding="utf-8").splitlines()))
    assert [line["method"] for line in lines] == ["dlt", "hybrid", "affine"] * 3
    assert {line["fault"] for line in lines} == {"bend-1"}
    assert [line["fit_seconds"] for line in lines] == ["0.1", "0.5", "nan", "0.3", "0.7", "nan"] + ["nan"] * 3
    assert lines[0]["predict_seconds_per_1000"] == "0.2"
    assert [line["seconds"] for line in lines[::3]] == ["9.0", "8.0", "0.1"]
    rows = [row.split("│")[1:5] for row in rendered(seconds_table(file), sys.stdout).splitlines()]
    assert [[cell.strip() for cell in row] for row in rows if len(row) == 4] == [
        ["dlt", "0.200", "0.000", "0.400"], ["hybrid", "4.100", "3.500", "0.400"], ["affine", "-", "-", "-"]
    ]  # fmt: skip


@pytest.mark.parametrize(("method", "said"), [("bundle", 1), ("hybrid", 0), ("dlt", 0)])
def test_a_shared_fit_is_explained_where_a_method_takes_from_it(
    tmp_path: Path, method: str, said: int
) -> None:
    shared = 0.0 if method == "dlt" else 3.5
    figures = CaseFigures(methods=(MethodFigures(method=method, fit_seconds=0.2, shared_seconds=shared),))
    file = tmp_path / "timings.csv"
    file.write_text(timings_table([replace(CASE, methods=(method,))], [figures], [9.0]), encoding="utf-8")
    assert rendered(seconds_table(file), sys.stdout).count("bundle is faster") == said
