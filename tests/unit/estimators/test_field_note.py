"""A hybrid says where it used no residual field."""

from dataclasses import replace

import numpy as np
import pytest

from labcal import Model, examples, pipeline
from labcal.estimators.hybrid import Hybrid
from labcal.estimators.training import training_of
from labcal.report.fit_result import FitOutcome, fit_result, fit_table
from labcal.run.progress import NoProgress

QUICK = pipeline.FitSettings(lens="brown5", rehearsal=False)


@pytest.fixture(scope="module")
def model() -> Model:
    return pipeline.fit(examples.TARGET, examples.detections(), "hybrid", QUICK)


def test_where_no_field_is_used_the_model_says_so(model: Model) -> None:
    affine = pipeline.fit(examples.TARGET, examples.detections(), "affine", QUICK)
    assert model.field_px == (0.0, 0.0)
    assert model.field_note is not None
    assert "as by 'bundle'" in model.field_note
    assert "field_px=[0.0, 0.0]" in repr(model)
    assert affine.field_px is None
    assert affine.field_note is None


class FieldOfOne(Hybrid):
    """A hybrid of which the right camera alone has a field."""

    @property
    def field_px_(self) -> np.ndarray:
        return np.array([0.0, 0.31])


def test_of_one_camera_without_a_field_the_name_is_said(model: Model) -> None:
    estimator = FieldOfOne(model.estimator.lens, model.estimator.image_sizes)
    estimator.__dict__.update(model.estimator.__dict__)
    assert "used for left, where" in str(replace(model, estimator=estimator).field_note)


def test_the_document_and_the_table_have_it(model: Model) -> None:
    target = examples._target()
    training = training_of(target, examples.detections(), QUICK, NoProgress())
    result = fit_result(training, [FitOutcome("hybrid", "model.safetensors", model)])
    assert result.models[0].field_px == (0.0, 0.0)
    assert result.models[0].notes == (model.field_note,)
    assert str(model.field_note) in str(fit_table(result, rehearsed=False).caption)
