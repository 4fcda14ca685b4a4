"""The cost of a plan, stated before it starts."""

import pytest

from labcal.bench.distortion.cost import expected_seconds, plain_time
from labcal.bench.distortion.plan import load_plan


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
