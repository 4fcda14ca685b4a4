"""Protocols of a plan: files, tables, refusals, and the same bytes from one process or two."""

import csv
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from labcal.bench.distortion import bench
from labcal.bench.distortion.bench import bench_distortion
from labcal.bench.distortion.cost import announcement
from labcal.bench.distortion.plan import load_plan
from labcal.bench.distortion.protocols.figures import ORACLE
from labcal.bench.distortion.protocols.protocol import ProtocolData
from labcal.bench.distortion.protocols.registry import PROTOCOLS
from labcal.bench.distortion.protocols.result import ProtocolResult
from labcal.bench.distortion.protocols.run import measured_protocols
from labcal.bench.distortion.protocols.tables import protocol_table
from labcal.bench.distortion.requested_plan import plan_of
from labcal.bench.distortion.result import distortion_table
from labcal.bench.settings import BenchSettings
from labcal.cli.console import rendered
from labcal.errors import InputError
from labcal.run.executor import open_executor
from labcal.run.progress import NoProgress

SMALL = ("families=brown", "strengths=0.4", "noise_px=0.1", "points=60", "methods=dlt,two-plane")


def measured(folder: Path, seeds: int) -> ProtocolResult:
    plan = load_plan("quick", (*SMALL, "protocols=josa-volume"), seeds=seeds)
    with open_executor(1) as executor:
        (found,) = measured_protocols(plan, 0, folder, executor, NoProgress())
    return found


def test_figures_stand_beside_those_that_were_published(tmp_path: Path) -> None:
    josa = measured(tmp_path, seeds=2)
    assert [one.method for one in josa.methods] == [ORACLE, "dlt", "two-plane"]
    oracle, dlt, two_plane = ({one.quantity: one for one in method.figures} for method in josa.methods)
    assert oracle["RMS error"].median < two_plane["RMS error"].median < 1.1 * oracle["RMS error"].median
    assert dlt["RMS error"].median > 5.0 * oracle["RMS error"].median  # it has no distortion
    assert oracle["RMS error"].low < oracle["RMS error"].median < oracle["RMS error"].high
    with (tmp_path / "protocols.csv").open(encoding="utf-8") as text:
        lines = list(csv.DictReader(text))
    values = {
        (line["method"], line["seed"]): float(line["value"])
        for line in lines
        if line["quantity"] == "RMS error"
    }
    assert set(values) == {(method, seed) for method in (ORACLE, "dlt", "two-plane") for seed in "01"}
    assert sum(values["dlt", seed] for seed in "01") / 2 == pytest.approx(dlt["RMS error"].median)
    published = {line["quantity"]: float(line["value"]) for line in lines if line["origin"] == "published"}
    assert published == {"greatest error": 2.5, "standard deviation of lengths of 1000 mm": 1.5}
    shown = rendered(protocol_table(josa), sys.stdout)
    assert "published:" in shown


def test_a_case_without_data_has_its_reason_in_every_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(_seed: int) -> ProtocolData:
        raise InputError("The cameras are lost.")

    monkeypatch.setitem(PROTOCOLS, "josa-volume", replace(PROTOCOLS["josa-volume"], data=fails))
    made = measured(tmp_path, seeds=1)
    assert [one.reasons for one in made.methods] == [("The cameras are lost.",)] * 3
    with (tmp_path / "protocols.csv").open(encoding="utf-8") as text:
        lines = [line for line in csv.DictReader(text) if line["origin"] == "measured"]
    assert {(line["value"], line["reason"]) for line in lines} == {("nan", "The cameras are lost.")}
    assert "published" in rendered(protocol_table(made), sys.stdout)


@pytest.mark.slow
def test_two_processes_give_the_bytes_of_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for cores in (1, 2):
        monkeypatch.setattr(bench, "usable_cores", lambda cores=cores: cores)
        settings = BenchSettings(quick=True, overrides=(*SMALL, "protocols=josa-volume"), seeds=2)
        made = bench_distortion(tmp_path / str(cores), settings, NoProgress())
        assert "published:" in rendered(distortion_table(made), sys.stdout)
    for file in ("protocols.csv", "results.json"):
        assert (tmp_path / "1" / file).read_bytes() == (tmp_path / "2" / file).read_bytes()


def test_an_unknown_protocol_is_refused_at_once_and_the_nearest_is_offered() -> None:
    with pytest.raises(InputError, match="Did you mean 'josa-volume'"):
        plan_of(BenchSettings(quick=True, overrides=("protocols=josa-volum",)))
    with pytest.raises(InputError, match="a level stands twice"):
        plan_of(BenchSettings(quick=True, overrides=("protocols=josa-volume,josa-volume",)))


def test_cases_of_protocols_count_in_what_is_said_before_the_start() -> None:
    plain = plan_of(BenchSettings(quick=True))
    assert not plain.protocols
    assert announcement(plain).startswith("292 cases")
    assert plan_of(BenchSettings(quick=True, overrides=("protocols=none",))) == plain
    more = plan_of(BenchSettings(quick=True, overrides=("protocols=josa-volume",)))
    assert announcement(more).startswith("295 cases")
    assert set(load_plan("full").protocols) == set(PROTOCOLS)


def test_published_figures_are_of_quantities_of_the_protocol() -> None:
    for protocol in PROTOCOLS.values():
        names = {quantity.name for quantity in protocol.quantities}
        assert {one.quantity for one in protocol.published} <= names
        assert protocol.same
        assert protocol.different
