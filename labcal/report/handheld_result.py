"""Result of ``labcal fit`` for a hand-held target: its poses and the cameras that gave them."""

from dataclasses import dataclass

from labcal.calibrate.dot_treatment import DotDecision
from labcal.estimators.training import Training
from labcal.report.inconsistent_result import InconsistentResult, inconsistent_result
from labcal.wording import counted


@dataclass(frozen=True)
class HandheldResult:
    """Poses of a hand-held target by bundle adjustment."""

    lens: str
    views: int
    """That entered."""
    left_out: tuple[str, ...]
    """Pictures that did not, each with its reason, for people."""
    rms_px: float
    outlier_count: int
    free_dots: bool
    """True if the places of the dots on the print were estimated."""
    dot_places: DotDecision
    """The treatment of the dots, and the reason."""
    inconsistent: InconsistentResult | None
    """Causes of contradictions between the cameras' poses of the target; null if there are none."""

    @property
    def doubtful(self) -> bool:
        """True if pictures were left out, or cameras contradict each other."""
        return bool(self.left_out) or self.inconsistent is not None

    def words(self) -> str:
        """Return it for people."""
        views, left_out = counted(self.views, "view"), counted(len(self.left_out), "picture")
        return (
            f"hand-held target: bundle adjustment of {views} ({left_out} left out), lens {self.lens}, "
            f"RMS {self.rms_px:.4f} px, {counted(self.outlier_count, 'outlier')}; the first camera is the "
            f"world; dots {self.dot_places.why}"
        )


def handheld_result(training: Training) -> HandheldResult | None:
    """Return the result for a hand-held target; None if a stage gave the poses."""
    held = training.held
    if held is None:
        return None
    return HandheldResult(
        lens=held.lens,
        views=len(held.found.views),
        left_out=held.found.skipped,
        rms_px=held.found.rms_px,
        outlier_count=len(held.found.outliers),
        free_dots=held.found.freed is not None,
        dot_places=held.found.dot_decision,
        inconsistent=inconsistent_result(held.found),
    )
