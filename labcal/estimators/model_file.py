"""Fitted models on disk: safetensors with a JSON header. Loading never runs code from the file."""

from dataclasses import asdict, fields
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import safetensors.numpy
from safetensors import SafetensorError, safe_open

from labcal.bounds import MOST_MM, MOST_WEIGHT
from labcal.cameras.record import CameraRecord
from labcal.errors import InputError, LabcalError
from labcal.estimators.expected_error import ExpectedError
from labcal.estimators.model import Model, TrainingBox
from labcal.estimators.model_header import VERSION, ModelHeader, Value, header_of
from labcal.estimators.stored_state import in_rows, stored_arrays, stored_facts, stored_parameters
from labcal.paths import AnyPath, as_path
from labcal.run.file_kinds import recognised_by
from labcal.run.file_reading import require_file
from labcal.run.outputs import write_file

if TYPE_CHECKING:
    from labcal.estimators.estimator import PointEstimator  # imports scikit-learn

# One key only: safetensors writes several in no fixed order, and the same model should give the same bytes.
METADATA_KEY = "labcal"
BOX_PREFIX = "box."
LENGTH_BYTES = 8
_MOST_BYTES = 2**28
_MOST_COUNT = 2**31
"""Of an integer that an estimator is constructed with."""
_HEADER_BEGINS = f'{{"__metadata__":{{"{METADATA_KEY}":'.encode()
KIND = recognised_by(
    "a model",
    lambda content: content[LENGTH_BYTES:].startswith(_HEADER_BEGINS) and b"labcal-model" in content,
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
    if begin[LENGTH_BYTES : LENGTH_BYTES + 1] == b"{" and begin[LENGTH_BYTES - 2 : LENGTH_BYTES] == b"\0\0":
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
    estimator = model.estimator
    arrays = stored_arrays(estimator)
    for field in fields(TrainingBox):
        arrays[BOX_PREFIX + field.name] = in_rows(getattr(model.box, field.name))
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
        calibrated_on=model.calibrated_on or None,
        held_out=model.held_out or None,
    ).signed(arrays)
    content = safetensors.numpy.save(arrays, {METADATA_KEY: header.text()})
    write_file(as_path(path), content, kind=KIND, force=force)


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
    estimator = _estimator(path, header, arrays, method)
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
        header.calibrated_on or (),
        header.held_out or (),
    )


def training_views(path: AnyPath) -> tuple[str, ...]:
    """Return the names of the training views of a model of any method; empty if they are not known.

    Raises
    ------
    InputError
        The file is no whole model.
    """
    return _content(as_path(path))[0].calibrated_on or ()


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
    header = header_of(path, metadata.get(METADATA_KEY))
    if header.signed(arrays).digest != header.digest:
        raise InputError(
            f"The model {path} has been changed since it was written: its digest is wrong. Fit it again."
        )
    return header, arrays


def _estimator(
    path: Path, header: ModelHeader, arrays: dict[str, np.ndarray], method: object | None
) -> "PointEstimator":
    """Return the fitted estimator; only attributes that its class declares are set."""
    # Both import scikit-learn, which a reader of a header, or of a rig, does without.
    from labcal.estimators.user_method import UserMethod  # noqa: PLC0415 -- see above
    from labcal.estimators.user_model import estimator_to_fill, fit_as_stored  # noqa: PLC0415 -- see above

    estimator = estimator_to_fill(path, header, method)
    defaults = header.parameters if isinstance(estimator, UserMethod) else estimator.get_params()
    if header.parameters.keys() != defaults.keys() or header.facts.keys() != set(estimator.fitted_facts):
        raise InputError(
            f"The model {path} names parameters that the method '{header.method}' does not have."
        )
    if not isinstance(estimator, UserMethod):
        unknown = [name for name, value in header.parameters.items() if not _like(value, defaults[name])]
        if unknown:
            raise InputError(
                f"The model {path} has a '{unknown[0]}' that '{header.method}' does not take. Fit it again."
            )
        estimator.set_params(**header.parameters)
    estimator.n_features_in_ = header.inputs
    estimator.n_outputs_ = header.outputs
    estimator.single_output_ = False
    for name, value in header.facts.items():
        setattr(estimator, name, value)
    try:
        wanted = estimator.stored_arrays()
        if any(type(side) is not int for spec in wanted for side in spec.shape):
            raise TypeError  # noqa: TRY301 -- reported below, like errors of the method itself
    except LabcalError:
        raise
    except (TypeError, ValueError, LookupError, ArithmeticError) as error:
        raise InputError(
            f"The facts in the model {path} are none of '{header.method}'. Fit it again."
        ) from error
    for attribute, shape in wanted:
        setattr(estimator, attribute, _checked(path, arrays, attribute, shape))
    if isinstance(estimator, UserMethod):
        fit_as_stored(path, estimator)
    return estimator


def _like(value: Value, default: object) -> bool:
    """Tell whether a parameter has the type of its default and is within bounds."""
    match default:
        case bool() | str():
            return type(value) is type(default)
        case int():
            return isinstance(value, int) and not isinstance(value, bool) and 0 <= value <= _MOST_COUNT
        case float():
            return (
                isinstance(value, int | float)
                and not isinstance(value, bool)
                and 0.0 <= float(value) <= MOST_WEIGHT
            )
        case _:  # widths of layers, picture sizes, or nothing
            counts = [] if value is None else np.ravel(np.array(value, dtype=object)).tolist()
            return all(type(count) is int and 1 <= count <= _MOST_COUNT for count in counts)


def _figures(rehearsed: ExpectedError) -> dict[str, float | None]:
    """Return an expected error as a mapping, with null for NaN, which JSON does not have."""
    return {name: None if np.isnan(value) else value for name, value in asdict(rehearsed).items()}


def _rehearsed(path: Path, figures: dict[str, float | None]) -> ExpectedError:
    """Return the expected error of a mapping."""
    if figures.keys() != {field.name for field in fields(ExpectedError)}:
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
        low_mm=_checked(path, arrays, BOX_PREFIX + "low_mm", outputs),
        high_mm=_checked(path, arrays, BOX_PREFIX + "high_mm", outputs),
        low_px=_checked(path, arrays, BOX_PREFIX + "low_px", inputs),
        high_px=_checked(path, arrays, BOX_PREFIX + "high_px", inputs),
    )
    farthest = max(np.abs(box.low_mm).max(initial=0.0), np.abs(box.high_mm).max(initial=0.0))
    upright = (box.low_mm <= box.high_mm).all() and (box.low_px <= box.high_px).all()
    if farthest > MOST_MM or not upright:
        raise InputError(f"The volume in which the model {path} was trained is none. Fit it again.")
    return box


def _checked(path: Path, arrays: dict[str, np.ndarray], name: str, shape: tuple[int, ...]) -> np.ndarray:
    """Return one array of the file if it has the shape that the method needs."""
    array = arrays.get(name)
    if array is None or array.dtype != np.float64 or array.shape != shape or not np.isfinite(array).all():
        raise InputError(f"The model {path} lacks the array '{name}' as finite float64 of shape {shape}.")
    if np.abs(array).max(initial=0.0) > MOST_WEIGHT:
        raise InputError(f"The model {path} holds a number beyond {MOST_WEIGHT:g} in '{name}'. Fit it again.")
    return array
