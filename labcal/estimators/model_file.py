"""Fitted models on disk: safetensors with a JSON header. Loading never runs code from the file."""

from collections.abc import Sequence
from dataclasses import asdict, fields
from enum import StrEnum
from pathlib import Path

import numpy as np
import safetensors.numpy
from safetensors import SafetensorError, safe_open

from labcal.arguments import object_of
from labcal.bounds import MOST_MM
from labcal.cameras.record import CameraRecord
from labcal.cameras.rig import Rig
from labcal.cameras.rig_covariance import wrong_parameters
from labcal.errors import InputError, OutputError
from labcal.estimators.expected_error import ExpectedError
from labcal.estimators.model import Model, TrainingBox
from labcal.estimators.model_header import VERSION, ModelHeader, header_of
from labcal.estimators.stored_estimator import checked_array, stored_estimator
from labcal.estimators.stored_state import in_rows, stored_arrays, stored_facts, stored_parameters
from labcal.paths import AnyPath, as_path
from labcal.run.file_kinds import recognised_by
from labcal.run.file_reading import require_file
from labcal.run.outputs import write_file

# One key only: safetensors writes several in no fixed order, and the same model should give the same bytes.
_METADATA_KEY = "labcal"
_BOX_PREFIX = "box."
_LENGTH_BYTES = 8
_MOST_BYTES = 2**28
_HEADER_BEGINS = f'{{"__metadata__":{{"{_METADATA_KEY}":'.encode()
KIND = recognised_by(
    "a model",
    lambda content: content[_LENGTH_BYTES:].startswith(_HEADER_BEGINS) and b"labcal-model" in content,
)


class ModelKind(StrEnum):
    """The kinds of a MODEL on the command line."""

    FITTED = "fitted model"
    RIG = "rig"


def model_kind(path: AnyPath) -> ModelKind:
    """Return whether a file holds a fitted model or JSON, which only a rig can be.

    Parameters
    ----------
    path : str or os.PathLike
        The file; its name does not matter.

    Raises
    ------
    InputError
        The file cannot be read, or begins like neither.
    """
    path = as_path(path)
    require_file(path, "model", _MOST_BYTES)
    with path.open("rb") as handle:
        begin = handle.read(64)
    # A safetensors file begins with the length of its header, which begins with a brace.
    if (
        begin[_LENGTH_BYTES : _LENGTH_BYTES + 1] == b"{"
        and begin[_LENGTH_BYTES - 2 : _LENGTH_BYTES] == b"\0\0"
    ):
        return ModelKind.FITTED
    if begin.lstrip().startswith(b"{"):
        return ModelKind.RIG
    raise InputError(f"{path} is neither a model from `labcal fit` nor a rig.json from `labcal calibrate`.")


def save_model(path: AnyPath, model: Model, *, force: bool = False) -> None:
    """Write a fitted model.

    Parameters
    ----------
    path : str or os.PathLike
        The file to appear.
    model : Model
        What to write.
    force : bool
        Replace a model that exists.

    Raises
    ------
    OutputError
        The file exists and `force` is not set, or it cannot be written.
    InputError
        The method is one of one's own, and does not set what it states that it consists of.

    Examples
    --------
    >>> from labcal import examples, load_model, pipeline, save_model
    >>> quick = pipeline.FitSettings(lens="brown5", rehearsal=False)
    >>> model = pipeline.fit(examples.TARGET, examples.detections(), "dlt", quick)
    >>> save_model("model.safetensors", model)
    >>> load_model("model.safetensors") == model
    True
    """
    estimator = object_of(model, Model, "model").estimator
    arrays = stored_arrays(estimator)
    for field in fields(TrainingBox):
        arrays[_BOX_PREFIX + field.name] = in_rows(getattr(model.box, field.name))
    header = ModelHeader(
        format="labcal-model",
        version=VERSION,
        method=estimator.method,
        parameters=stored_parameters(estimator),
        facts=stored_facts(estimator),
        inputs=estimator.n_features_in_,
        outputs=estimator.n_outputs_,
        cameras=model.cameras,
        image_sizes=model.image_sizes,
        planar=model.box.planar,
        digest="",
        resected=None if model.resected is None else tuple(map(CameraRecord.of, model.resected)),
        rehearsed=None if model.rehearsed is None else _figures(model.rehearsed),
        calibration=model.calibration,
        covariance=model.covariance,
        stage=model.stage,
        calibrated_on=model.calibrated_on or None,
        held_out=model.held_out or None,
    ).signed(arrays)
    content = safetensors.numpy.save(arrays, {_METADATA_KEY: header.text()})
    write_file(as_path(path), content, kind=KIND, force=force)


def save_models(models: Sequence[tuple[Path, Model]], *, force: bool = False) -> None:
    """Write several models or, where the disk refuses one, leave none that was not there before.

    Parameters
    ----------
    models : sequence of (Path, Model)
        Files to appear, and what to write.
    force : bool
        Replace models that exist.

    Raises
    ------
    OutputError
        As of :func:`save_model`.
    """
    written: list[Path] = []
    try:
        for path, model in models:
            new = not path.exists()
            save_model(path, model, force=force)
            written += [path] if new else []
    except OutputError:
        for path in written:
            path.unlink()
        raise


def load_model(path: AnyPath, method: object | None = None) -> Model:
    """Read a fitted model; its predictions are the same bytes as before it was saved.

    Parameters
    ----------
    path : str or os.PathLike
        A file that :func:`save_model` wrote.
    method : str, type or object, optional
        The method of one's own that it was fitted with, as for :func:`labcal.pipeline.fit`; none of a method
        of labcal's. It is fitted to the stored training data once more, since only code of labcal's is run
        for the sake of a file, and predicts the same up to rounding.

    Returns
    -------
    Model

    Raises
    ------
    InputError
        The file cannot be read, is truncated, is of another kind or of a newer version, has been changed, or
        holds what its method does not have; or its method is one of one's own, and not named.
    UnknownNameError
        The method is not known here.

    Examples
    --------
    >>> from labcal import examples, load_model, pipeline
    >>> quick = pipeline.FitSettings(lens="brown5", rehearsal=False)
    >>> model = pipeline.fit(examples.TARGET, examples.detections(), "dlt", quick)
    >>> model.save("model.safetensors")
    >>> load_model("model.safetensors")
    Model(method=dlt, cameras=['left', 'right'], outputs=3, calibrated_on=8 views)
    """
    path = as_path(path)
    header, arrays = _content(path)
    box = _box(path, header, arrays)
    estimator = stored_estimator(path, header, arrays, method)
    resected = None
    if header.resected is not None:
        pairs = zip(header.cameras, header.resected, strict=False)
        resected = tuple(record.sensible_camera(name) for name, record in pairs)
    rehearsed = None if header.rehearsed is None else _rehearsed(path, header.rehearsed)
    return Model(
        estimator,
        header.cameras,
        header.image_sizes,
        box,
        resected,
        rehearsed,
        header.calibration,
        header.covariance,
        header.calibrated_on or (),
        header.held_out or (),
        stage=header.stage,
    )


def training_views(path: AnyPath) -> tuple[str, ...]:
    """Return the names of the training views of a model of any method; empty if they are not known.

    Raises
    ------
    InputError
        The file is no whole model.
    """
    return _content(as_path(path))[0].calibrated_on or ()


def placing_rig(path: AnyPath) -> Rig | None:
    """Return the rig that placed the training dots of a model of any method; as :attr:`Model.placed_by`.

    Raises
    ------
    InputError
        The file is no whole model, or its cameras and their covariance do not belong together.
    """
    path = as_path(path)
    header, _ = _content(path)
    if header.covariance is None or header.resected is None:
        return None
    records = dict(zip(header.cameras, header.resected, strict=False))
    wrong = wrong_parameters(records, header.covariance)
    if wrong is not None:
        raise InputError(
            f"The cameras of the model {path} and their covariance differ: {wrong}. Fit it again."
        )
    return Rig(cameras=records, calibration=header.calibration, covariance=header.covariance)


def _content(path: Path) -> tuple[ModelHeader, dict[str, np.ndarray]]:
    """Return the header and the arrays of a file that is whole."""
    require_file(path, "model", _MOST_BYTES)
    try:
        with safe_open(path, framework="numpy") as file:
            metadata = file.metadata() or {}
            arrays = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118 - no mapping
    except SafetensorError as error:
        raise InputError(
            f"The model {path} is truncated, damaged, or no model at all ({error}). Fit it again, or copy it "
            "anew."
        ) from error
    except OSError as error:
        raise InputError(f"The model {path} cannot be read: {error.strerror or error}.") from error
    header = header_of(path, metadata.get(_METADATA_KEY))
    if header.signed(arrays).digest != header.digest:
        raise InputError(
            f"The model {path} has been changed since it was written: its digest is wrong. Fit it again."
        )
    return header, arrays


def _figures(rehearsed: ExpectedError) -> dict[str, float | None]:
    """Return an expected error as a mapping, with null for NaN, which JSON does not have."""
    return {name: None if np.isnan(value) else value for name, value in asdict(rehearsed).items()}


def _rehearsed(path: Path, figures: dict[str, float | None]) -> ExpectedError:
    """Return the expected error of a mapping."""
    known = {field.name for field in fields(ExpectedError)}
    if not known - {"adjustment_mm", "stage_mm"} <= figures.keys() <= known:  # which older files do not have
        raise InputError(
            f"The model {path} has an expected error in a form that this version of labcal does not know."
        )
    return ExpectedError(
        **{name: float("nan") if value is None else value for name, value in figures.items()}
    )


def _box(path: Path, header: ModelHeader, arrays: dict[str, np.ndarray]) -> TrainingBox:
    """Return the checked training box."""
    outputs, inputs = (header.outputs,), (header.inputs,)
    box = TrainingBox(
        low_mm=checked_array(path, arrays, _BOX_PREFIX + "low_mm", outputs),
        high_mm=checked_array(path, arrays, _BOX_PREFIX + "high_mm", outputs),
        low_px=checked_array(path, arrays, _BOX_PREFIX + "low_px", inputs),
        high_px=checked_array(path, arrays, _BOX_PREFIX + "high_px", inputs),
    )
    farthest = max(np.abs(box.low_mm).max(initial=0.0), np.abs(box.high_mm).max(initial=0.0))
    upright = (box.low_mm <= box.high_mm).all() and (box.low_px <= box.high_px).all()
    if farthest > MOST_MM or not upright:
        raise InputError(f"The volume in which the model {path} was trained is none. Fit it again.")
    return box
