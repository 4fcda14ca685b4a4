"""A method of one's own among those whose error is measured over the limit."""

import importlib
from pathlib import Path

import pytest

from labcal.bench.groups import Bench
from labcal.bench.settings import BenchSettings
from labcal.bench.solve import limits
from labcal.bench.solve.bench import bench_solve
from labcal.bench.solve.families import FAMILIES
from labcal.errors import InputError
from labcal.run.progress import NoProgress

OWN = "sklearn.linear_model:LinearRegression"


@pytest.mark.slow
def test_a_method_of_ones_own_is_measured_beside_and_checked_for_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pinhole = tuple(family for family in FAMILIES if family.name == "pinhole")
    for module in (limits, importlib.import_module("labcal.bench.solve.comparison")):
        monkeypatch.setattr(module, "FAMILIES", pinhole)
    monkeypatch.setattr(limits, "METHODS", ("dlt", "affine"))
    found = limits.limit_findings(Bench(True, 0, tmp_path, NoProgress(), (OWN, "affine")))
    references = {figure.name: figure.value for figure in found.references}
    name = "limits, pinhole: {}, RMS error over the oracle's".format
    assert references[name(OWN)] == pytest.approx(
        references[name("affine")], rel=1e-6
    )  # it is the same model
    assert sum("affine, RMS" in figure for figure in references) == 1  # named twice, measured once
    assert not any(OWN in check.name for check in found.checks)


@pytest.mark.parametrize(
    ("methods", "groups", "said"),
    [
        (("no_such_package:Class",), (), "There is no module 'no_such_package'"),
        (("afine",), (), "Did you mean 'affine'"),
        ((OWN,), ("training",), "measured in the group 'limits'"),
    ],
)
def test_what_cannot_be_measured_is_refused_at_once(
    methods: tuple[str, ...], groups: tuple[str, ...], said: str, tmp_path: Path
) -> None:
    settings = BenchSettings(quick=True, groups=groups, methods=methods)
    with pytest.raises(InputError, match=said):
        bench_solve(tmp_path / "out", settings, NoProgress())
    assert not any(tmp_path.iterdir())
