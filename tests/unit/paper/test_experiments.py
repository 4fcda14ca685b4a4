"""Rows, claims and studies by name."""

import pytest

from labcal.errors import InputError, UnknownNameError
from labcal.paper.experiments import Study, experiments_named


def test_rows_and_claims_in_the_order_of_the_paper() -> None:
    found = experiments_named(["c4", "13", "1", "C1"])
    assert [row.exp for row in found.rows] == ["01", "13"]
    assert found.claims == ("C1", "C4")
    everything = experiments_named([])
    assert (len(everything.rows), len(everything.claims), everything.studies) == (22, 8, tuple(Study))
    assert experiments_named(["C2"]).rows == ()


def test_studies_by_name() -> None:
    found = experiments_named(["Explanations", "C1", "study", "07"])
    assert found.studies == (Study.STUDY, Study.EXPLANATIONS)
    assert found.names == ("07", "C1", "study", "explanations")
    assert experiments_named(["07"]).studies == ()


def test_wrong_names() -> None:
    with pytest.raises(
        UnknownNameError, match=r"row, claim or study of the paper named 'C9'. Did you mean 'C"
    ):
        experiments_named(["C9"])
    with pytest.raises(UnknownNameError, match="Did you mean 'explanations'"):
        experiments_named(["explanation"])
    with pytest.raises(InputError, match="reports no figures"):
        experiments_named(["16"])
