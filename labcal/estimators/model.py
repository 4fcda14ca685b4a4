"""A fitted method together with what it was fitted to: cameras, picture sizes, the trained volume."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Bool, Float64

from labcal.cameras.calibration_record import CalibrationRecord
from labcal.cameras.camera import Camera
from labcal.cameras.record import CameraRecord
from labcal.cameras.rig import Rig
from labcal.cameras.rig_covariance import RigCovariance, wrong_parameters
from labcal.errors import InputError
from labcal.estimators.expected_error import ExpectedError
from labcal.estimators.stage_errors import StageErrors
from labcal.paths import AnyPath
from labcal.public_object import PublicObject
from labcal.wording import counted, listed

if TYPE_CHECKING:
    from labcal.estimators.estimator import PointEstimator  # imports scikit-learn


@dataclass(frozen=True)
class TrainingBox:
    """The boxes, parallel to the axes, that hold all training data.

    Attributes
    ----------
    low_mm, high_mm : float64 array, (outputs,)
        Least and largest value of each column of Y.
    low_px, high_px : float64 array, (inputs,)
        Least and largest value of each column of X.
    """

    low_mm: Float64[np.ndarray, " outputs"]
    high_mm: Float64[np.ndarray, " outputs"]
    low_px: Float64[np.ndarray, " inputs"]
    high_px: Float64[np.ndarray, " inputs"]

    @classmethod
    def of(cls, X: Float64[np.ndarray, "n inputs"], Y: Float64[np.ndarray, "n outputs"]) -> "TrainingBox":
        """Return the boxes of these training data, px and mm."""
        return cls(Y.min(axis=0), Y.max(axis=0), X.min(axis=0), X.max(axis=0))

    @property
    def planar(self) -> bool:
        """True if all training points have the same Z."""
        return bool(self.low_mm[2] == self.high_mm[2])

    def holds(self, points: Float64[np.ndarray, "n 3"]) -> Bool[np.ndarray, " n"]:
        """Return a mask of points (mm) inside or on the box; Z counts unless training was planar."""
        used = slice(2) if self.planar else slice(3)
        inside = (points[:, used] >= self.low_mm[used]) & (points[:, used] <= self.high_mm[used])
        return np.asarray(inside.all(axis=1))


@dataclass(frozen=True, eq=False, repr=False)
class Model(PublicObject):
    """A fitted estimator and its data's frame.

    Two models are equal where what their files would hold is: a model that was saved is equal to itself
    loaded, but for a method of one's own, which is fitted again.

    Attributes
    ----------
    estimator : PointEstimator
        Fitted, with outputs X, Y, Z in mm first.
    cameras : tuple of str
        Names of the cameras in the order of the columns of X.
    image_sizes : tuple of (int, int)
        Width and height of each camera's pictures, px.
    box : TrainingBox
        What it was trained on.
    resected : tuple of Camera, optional
        The cameras that the eccentricity is computed with; None where it was not corrected.
    rehearsed : ExpectedError, optional
        Error at points between the training dots, by surrogate validation; None where that was not possible.
    calibration : CalibrationRecord, optional
        How well the resected cameras agreed on the training data.
    covariance : RigCovariance, optional
        Joint covariance of the resected cameras, where they placed a target held in the hand; None where a
        stage did.
    calibrated_on : tuple of str
        Names of the views that it was fitted to, as of a rig; empty where that is not known.
    held_out : tuple of str
        Names of the held-out views, on which it is to be tested.
    warnings : tuple of str
        What was not as it should be when it was fitted, for people; not kept in the file.
    stage : StageErrors, optional
        Errors of the resected cameras by those of the stage that the target stood on; None where they are not
        stated, and so in no covariance.

    Raises
    ------
    InputError
        Cameras, sizes, box and estimator do not belong together.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> quick = pipeline.FitSettings(lens="brown5", rehearsal=False)
    >>> model = pipeline.fit(examples.TARGET, examples.detections(), "dlt", quick)
    >>> model
    Model(method=dlt, cameras=['left', 'right'], outputs=3, calibrated_on=8 views)
    >>> model.cameras, model.calibrated_on[:2]
    (('left', 'right'), ('hand-0', 'hand-1'))
    """

    estimator: "PointEstimator"
    cameras: tuple[str, ...]
    image_sizes: tuple[tuple[int, int], ...]
    box: TrainingBox
    resected: tuple[Camera, ...] | None = None
    rehearsed: ExpectedError | None = None
    calibration: CalibrationRecord | None = None
    covariance: RigCovariance | None = None
    calibrated_on: tuple[str, ...] = ()
    held_out: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    stage: StageErrors | None = None

    @property
    def misfit(self) -> bool:
        """True if surrogate validation found errors far above noise or stated covariance."""
        return self.rehearsed is not None and self.rehearsed.misfit

    @property
    def placed_by(self) -> Rig | None:
        """The rig that placed the training dots of a target held in the hand, with its covariance.

        Its errors are in all points of the method. None where a stage placed the target, or a model of an
        older version does not tell.
        """
        if self.resected is None or self.covariance is None:
            return None
        return Rig(
            cameras=dict(zip(self.cameras, map(CameraRecord.of, self.resected), strict=True)),
            calibration=self.calibration,
            covariance=self.covariance,
        )

    @property
    def field_px(self) -> tuple[float, ...] | None:
        """RMS length of the residual field over the training pixels, by camera; None of methods without one.

        It is 0 where the training data asked for no field: `hybrid` is then a lens formula alone.
        """
        lengths = getattr(self.estimator, "field_px_", None)
        return None if lengths is None else tuple(float(length) for length in lengths)

    @property
    def field_note(self) -> str | None:
        """A note on cameras whose training data asked for no residual field, for people; else None."""
        if self.field_px is None or all(self.field_px):
            return None
        if not any(self.field_px):
            return (
                f"{self.estimator.method}: no residual field was used, since the training dots ask for none: "
                "the cameras are those of a lens formula alone, as by 'bundle'"
            )
        without = [name for name, length in zip(self.cameras, self.field_px, strict=True) if not length]
        return (
            f"{self.estimator.method}: no residual field was used for {listed(without)}, where the training "
            "dots ask for none"
        )

    @classmethod
    def load(cls, path: AnyPath, method: object | None = None) -> "Model":
        """Read a fitted model, as :func:`~labcal.estimators.model_file.load_model`, which lists errors."""
        from labcal.estimators.model_file import load_model  # noqa: PLC0415 -- it imports this file

        return load_model(path, method)

    def save(self, path: AnyPath, *, force: bool = False) -> None:
        """Write the model; as :func:`~labcal.estimators.model_file.save_model`, which lists errors.

        Examples
        --------
        >>> import tempfile
        >>> import numpy as np
        >>> from labcal import Model
        >>> from labcal.estimators.affine import Affine
        >>> from labcal.estimators.model import TrainingBox
        >>> rng = np.random.default_rng(1)
        >>> X, Y = rng.uniform(0, 480, (20, 4)), rng.uniform(0, 100, (20, 3))
        >>> sizes = ((640, 480), (640, 480))
        >>> model = Model(Affine().fit(X, Y), ("left", "right"), sizes, TrainingBox.of(X, Y))
        >>> model
        Model(method=affine, cameras=['left', 'right'], outputs=3)
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     model.save(f"{folder}/model")
        ...     Model.load(f"{folder}/model") == model
        True
        """
        from labcal.estimators.model_file import save_model  # noqa: PLC0415 -- it imports this file

        save_model(path, self, force=force)

    def _summary(self) -> Mapping[str, object]:
        summary: dict[str, object] = {
            "method": self.estimator.method,
            "cameras": list(self.cameras),
            "outputs": self.estimator.n_outputs_,
        }
        if self.calibrated_on:
            summary["calibrated_on"] = counted(len(self.calibrated_on), "view")
        if self.rehearsed is not None:
            summary["expected_rmse"] = f"{self.rehearsed.rmse_mm:.3g} mm"
        if self.misfit:
            summary["misfit"] = True
        if self.field_px is not None:
            summary["field_px"] = [float(f"{length:.2g}") for length in self.field_px]
        return summary

    def _compared(self) -> object:
        estimator = self.estimator
        arrays = {one.attribute: getattr(estimator, one.attribute) for one in estimator.stored_arrays()}
        facts = {name: getattr(estimator, name) for name in estimator.fitted_facts}
        kept = (self.cameras, self.image_sizes, self.box, self.resected, self.rehearsed)
        fitted = (self.calibration, self.covariance, self.calibrated_on, self.held_out, self.stage)
        return (type(estimator), estimator.stored_parameters(), arrays, facts, kept, fitted)

    def __post_init__(self) -> None:
        """Refuse parts that do not belong together."""
        inputs, outputs = self.estimator.n_features_in_, self.estimator.n_outputs_
        if not (2 * len(self.cameras) == 2 * len(self.image_sizes) == inputs):
            raise InputError(
                f"A model of {inputs} columns needs {inputs / 2:g} cameras with a picture size each, but got "
                f"{counted(len(self.cameras), 'name')} and {counted(len(self.image_sizes), 'size')}."
            )
        if self.resected is not None and len(self.resected) != len(self.cameras):
            raise InputError(
                f"A model of {counted(len(self.cameras), 'camera')} has {len(self.resected)} resected. "
                "Fit it again."
            )
        if self.covariance is not None:
            records = dict(zip(self.cameras, map(CameraRecord.of, self.resected or ()), strict=False))
            wrong = wrong_parameters(records, self.covariance)
            if wrong is not None:
                raise InputError(
                    f"The cameras of a model and their covariance differ: {wrong}. Fit it again."
                )
        if self.stage is not None and not (self.resected and self.stage.fits(self.resected)):
            raise InputError("The cameras of a model and the errors of its stage differ. Fit it again.")
        if len(set(self.cameras)) < len(self.cameras):
            raise InputError(
                f"Every camera needs a name of its own, but the names are {', '.join(self.cameras)}."
            )
        fits = self.box.low_mm.shape == (outputs,) and self.box.low_px.shape == (inputs,)
        if outputs < 3 or not fits:  # noqa: PLR2004 - X, Y, Z
            raise InputError(
                f"A model needs outputs X, Y, Z and a training box of the same widths, but has {outputs} "
                f"outputs and boxes of {self.box.low_px.shape[0]} and {self.box.low_mm.shape[0]} columns."
            )
