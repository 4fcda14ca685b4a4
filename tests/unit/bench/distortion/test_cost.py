"""The cost of a plan, stated before it starts."""

from pathlib import Path

import pytest

from labcal.bench.distortion import cost
from labcal.bench.distortion.cost import announcement, expected_seconds, plain_time
from labcal.bench.distortion.plan import load_plan
from labcal.cli import main
from labcal.errors import InputError
from labcal.pipeline import BenchSettings, bench


def test_the_hybrid_counts_in_every_plan() -> None:
    """Every case fits it, for the flags of all methods."""
    alone, with_dlt = (
        expected_seconds(load_plan("smallest", [f"methods={methods}"]), 1)
        for methods in ("hybrid", "hybrid,dlt")
    )
    assert expected_seconds(load_plan("smallest", ["methods=dlt"]), 1) == with_dlt > alone


@pytest.mark.parametrize(
    ("seconds", "words"), [(0.2, "1 second"), (1.4, "1 second"), (2.6, "3 seconds"), (7200.0, "2 hours")]
)
def test_a_time_is_in_words(seconds: float, words: str) -> None:
    assert plain_time(seconds) == words


def test_the_announcement_is_of_this_machine_now(monkeypatch: pytest.MonkeyPatch) -> None:
    plan = load_plan("quick")
    monkeypatch.setattr(cost, "usable_cores", lambda: 2)
    monkeypatch.setattr(cost, "core_pace", lambda: 1.0)
    monkeypatch.setattr(cost, "crowding", lambda _workers, _seconds: 1.0)
    idle = plain_time(expected_seconds(plan, 2))
    assert announcement(plan) == f"300 cases of 5 methods: about {idle} on 2 cores"
    monkeypatch.setattr(cost, "core_pace", lambda: 3.0)
    monkeypatch.setattr(cost, "crowding", lambda _workers, seconds: seconds / seconds + 1.0)
    crowded = plain_time(6.0 * expected_seconds(plan, 2))
    assert announcement(plan).endswith(f"about {crowded} on 2 cores, which other programs use, too")
    alone = plain_time(expected_seconds(plan, 1))
    assert announcement(plan, "tcp://host:8786").endswith(f"{alone} of work for one core, on a cluster")


def test_long_work_begins_only_on_request(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["bench", "distortion", "-o", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert "This is long work: 24,810 cases of 9 methods: about " in said
    assert "Add --yes to begin it, or measure less: --quick, fewer levels (--set), fewer --seeds." in said
    with pytest.raises(InputError, match="Add `yes=True` to begin it"):
        bench("distortion", tmp_path / "out", BenchSettings(scheduler="local"))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "settings",
    [
        BenchSettings(yes=True),
        BenchSettings(scheduler="tcp://host:8786"),
        BenchSettings(quick=True),
        BenchSettings(plan="smallest"),
    ],
)
def test_what_is_requested_short_or_elsewhere_begins(settings: BenchSettings) -> None:
    name = settings.plan or ("quick" if settings.quick else "full")
    cost.require_consent(load_plan(str(name)), settings)
