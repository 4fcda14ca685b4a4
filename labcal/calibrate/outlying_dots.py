"""Outliers of a calibration, by name."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from labcal.calibrate.adjustment.observations import Observations
from labcal.calibrate.adjustment.rounds import Adjusted
from labcal.correspond.detections import Detections
from labcal.targets.target import Target


@dataclass(frozen=True)
class OutlyingDots:
    """n dots that did not enter, those farthest off first."""

    view: np.ndarray
    """(n,) of str"""
    camera: np.ndarray
    """(n,) of str"""
    index: Int64[np.ndarray, "n 2"]
    """(col, row)"""
    off_px: Float64[np.ndarray, "n 2"]
    """Measured minus predicted."""

    def __len__(self) -> int:
        return len(self.view)

    @classmethod
    def of(
        cls,
        adjusted: Adjusted,
        observations: Observations,
        target: Target,
        names: tuple[tuple[str, ...], ...],
    ) -> "OutlyingDots":
        """Return those of an adjustment; `names` are its cameras' and its views'."""
        off = -adjusted.residual
        rows = np.flatnonzero(adjusted.outlier)
        rows = rows[np.argsort(-np.linalg.norm(off[rows], axis=1), kind="stable")]
        cameras, views = (np.array(of, dtype=np.str_) for of in names)
        row, col = np.divmod(observations.dot[rows], target.cols)
        return cls(
            views[observations.view[rows]],
            cameras[observations.camera[rows]],
            np.stack([col, row], axis=-1).astype(np.int64),
            off[rows],
        )

    def left_out(self, detections: Detections) -> Detections:
        """Return detections without these dots."""
        mine = {
            (view, camera, *index)
            for view, camera, index in zip(
                self.view.tolist(), self.camera.tolist(), self.index.tolist(), strict=True
            )
        }
        lines = zip(
            detections.view.tolist(), detections.camera.tolist(), detections.index.tolist(), strict=True
        )
        return detections.where(
            np.array([(view, camera, *index) not in mine for view, camera, index in lines], dtype=bool)
        )
