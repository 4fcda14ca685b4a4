"""How far methods can be trusted, in words: each sentence by the rule that it states."""

import math

import pytest
from made_up_distortion import made_up_findings

from labcal.bench.distortion.result import FamilyFigures
from labcal.bench.distortion.trust_words import reach_words, trust_entries


def figures(family: str, strength: float, worst: float, **changes: object) -> FamilyFigures:
    one = FamilyFigures(
        family=family, method="dlt", strength=strength, known_as="", over_oracle=worst, worst=worst,
        coverage95=0.95, flagged=0, cells=2,
    )  # fmt: skip
    return one.model_copy(update=changes)


@pytest.mark.parametrize(
    ("worst", "words"),
    [
        ((1.0, 1.1, 1.1), "water at every strength"),
        ((1.0, 1.1, 1.1001), "water up to strength 0.5"),
        ((1.0, 1.2, 1.0), "water without distortion"),  # what comes back beyond is luck
        ((1.2, 1.0, 1.0), "nowhere"),
        ((1.0, math.nan, 1.0), "water without distortion"),
    ],
)
def test_a_method_reaches_as_far_as_it_keeps_within_the_limit(worst: tuple[float, ...], words: str) -> None:
    own = [figures("water", strength, one) for strength, one in zip((0.0, 0.5, 1.0), worst, strict=True)]
    assert reach_words(own, 1.1) == words
    assert reach_words(own[::-1], 1.1) == words


def test_a_method_does_not_reach_where_it_refuses() -> None:
    own = [figures("water", 0.0, 1.0), figures("water", 1.0, 1.0, missing=1)]
    assert reach_words(own, 1.1) == "water without distortion"
    assert "It has no figure in 1 of 4 cells." in entry(own, [])


def test_families_of_one_reach_are_named_together() -> None:
    own = [figures(family, 1.0, worst) for family, worst in (("a", 1.0), ("b", 9.0), ("c", 1.0))]
    assert reach_words(own, 1.1) == "a, c at every strength"
    assert reach_words(own, 10.0) == "all families at every strength"


def entry(within: list[FamilyFigures], outside: list[FamilyFigures]) -> str:
    """Return the words about the first method of a plan with these figures."""
    few = ("methods=dlt,affine", "families=water", "strengths=1", "noise_px=0.1", "points=140")
    result = made_up_findings("quick", few, 1).result
    made = result.model_copy(update={"families": tuple(within), "outside": tuple(outside)})
    entries = dict(trust_entries(made))
    assert list(entries) == ["dlt", "affine"]
    assert entries["affine"].startswith("It has no figures")
    return entries["dlt"]


def test_what_is_wrong_without_a_warning_is_said() -> None:
    bad = [figures("water", 1.0, 30.0, cells=9, miscovered=3, overconfident=1, silent=2)]
    said = entry(bad, [figures("water", 1.0, 50.0)])
    assert "At most 1.1 times the oracle's error: nowhere. Worst: 30 times (water at strength 1)." in said
    assert "ellipsoids are too small (fewer than 93% of the errors) in 1 of 9 cells, without a flag" in said
    assert "They are too large (more than 97%) in 2 of 9 cells" in said
    assert "In 2 of 9 cells it errs by more than 2 times the oracle without the flag" in said
    assert said.endswith("Outside the trained volume the worst is 50 times (water at strength 1).")


def test_what_is_right_is_said() -> None:
    said = entry([figures("water", 1.0, 1.05), figures("brown", 1.0, 30.0)], [])
    assert "hold 93 to 97% of the errors, or a flag warns, in every cell" in said
    assert "Wherever it errs by more than 2 times the oracle, the flag model-misfit says so." in said
    assert "Outside" not in said
    assert "states no covariance" in entry([figures("water", 1.0, 1.0, coverage95=math.nan)], [])
