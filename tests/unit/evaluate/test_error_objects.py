"""Errors as a document and as a notebook has them."""

import json

import numpy as np

from labcal import examples, load_target, pipeline
from labcal.evaluate.against_truth import TruthErrors
from labcal.evaluate.own_lengths import errors_of_lengths
from labcal.evaluate.scored_views import ScoredPart
from labcal.run.json_text import to_json

PART = ScoredPart(2, ("a", "b"), None)
ERROR = np.array([[0.3, 0.0, 0.4], [0.0, 0.0, 0.2]])
TRUTH = TruthErrors(
    2,
    (0.15, 0.0, 0.3),
    0.35,
    0.381,
    0.485,
    0.5,
    float("nan"),
    0.5,
    "none",
    "all points",
    3,
    PART,
    ERROR,
    examples.points().where([0, 100]),
)


def test_the_document_has_its_keys_in_their_order_and_no_arrays() -> None:
    found = json.loads(to_json(TRUTH))
    assert list(found) == [
        "n", "mean_signed_mm", "mae_mm", "rmse_mm", "p95_mm", "max_mm", "limit_mm", "coverage95",
        "alignment", "scored", "not_scored", "n_ok", "views_scored", "views_calibrated_on",
        "coverage95_distances", "coverage95_planes", "coverage95_motions", "n_planes", "n_motions",
    ]  # fmt: skip
    assert found["views_scored"] == ["a", "b"]
    lengths = errors_of_lengths(examples.points(), load_target(examples.TARGET))
    assert list(json.loads(to_json(lengths))) == [
        "n", "length_error_mm", "epipolar_rms_px", "scale_ppm",
        "n_ok", "views_scored", "views_calibrated_on",
    ]  # fmt: skip


def test_the_histogram_holds_every_error_and_marks_what_is_known() -> None:
    (axes,) = TRUTH.plot().axes
    assert sum(bar.get_height() for bar in axes.patches) == 2
    assert axes.get_xlabel() == "length of the error (mm)"
    assert [line.get_xdata()[0] for line in axes.lines] == [0.381]  # the limit is not known
    lengths = pipeline.evaluate(examples.points(), load_target(examples.TARGET))
    (axes,) = lengths.plot().axes
    assert sum(bar.get_height() for bar in axes.patches) == lengths.n
    assert lengths.error.shape == (lengths.n,)
    assert np.sqrt((lengths.error**2).mean()) == lengths.length_error_mm.rms
    assert repr(lengths).startswith(f"LengthErrors(n={lengths.n}, rms=0.0")
