import json
from io import StringIO

from labcal.cli.console import rendered
from labcal.report.bench import BenchResult, at_most, bench_table
from labcal.run.json_text import to_json


def test_a_figure_is_good_up_to_its_limit_and_nan_never() -> None:
    assert at_most("a", 0.5, 0.5).ok
    assert not at_most("a", 0.51, 0.5).ok
    assert not at_most("a", float("nan"), 0.5).ok


def test_the_document_has_the_keys_of_the_design_and_null_for_nan() -> None:
    checks = (at_most("good", 1.0, 2.0), at_most("lost", float("nan"), 2.0))
    result = BenchResult(bench="render", quick=True, checks=checks)
    document = json.loads(to_json(result))
    assert document["checks"][0] == {"name": "good", "value": 1.0, "limit": 2.0, "ok": True}
    assert document["checks"][1]["value"] is None
    assert BenchResult.model_validate(document).failed == 1


def test_the_table_says_what_was_missed() -> None:
    result = BenchResult(bench="render", quick=False, checks=(at_most("slow", 3.0, 2.0),))
    shown = rendered(bench_table(result), StringIO())  # as the commands print it
    assert "0 of 1 good" in shown
    assert "missed" in shown
    assert "[" not in shown
