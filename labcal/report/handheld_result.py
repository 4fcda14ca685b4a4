"""What ``labcal fit`` tells of a target that was held in the hand."""

from dataclasses import dataclass

from labcal.estimators.fitting import Training
from labcal.report.inconsistent_result import InconsistentResult, inconsistent_result
from labcal.wording import counted


@dataclass(frozen=True)
class HandheldResult:
    """How a bundle adjustment placed a target that was held."""

    lens: str
    views: int
    """That entered."""
    left_out: tuple[str, ...]
    """Pictures that did not, each with its reason, for people."""
    rms_px: float
    outlier_count: int
    free_dots: bool
    """Whether the places of the dots on the print were estimated."""
    inconsistent: InconsistentResult | None
    """Why the cameras do not agree on where the target was; null where they do."""

    def words(self) -> str:
        """Return it for people."""
        freed = "with" if self.free_dots else "without"
        views, left_out = counted(self.views, "view"), counted(len(self.left_out), "picture")
        return (
            f"the target was held: a bundle adjustment of {views} ({left_out} left out), lens {self.lens}, "
            f"{freed} free dots, left an RMS of {self.rms_px:.4f} px and "
            f"{counted(self.outlier_count, 'outlier')}; the first camera is the world"
        )


def handheld_result(training: Training) -> HandheldResult | None:
    """Return how a target was placed that was held; None where a stage told."""
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
        inconsistent=inconsistent_result(held.found),
    )
