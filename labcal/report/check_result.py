"""Result of ``labcal check``: the JSON document, and the same for people."""

from dataclasses import dataclass

from labcal.calibrate.validity.change import ALL_CAMERAS
from labcal.guide.found_change import FoundChange
from labcal.guide.print_difference import PrintDifference
from labcal.guide.rig_check import LIKELY, ChangeCost, CheckVerdict, RigCheck
from labcal.paths import AnyPath


@dataclass(frozen=True)
class AmountResult:
    """A part of a change of one camera."""

    camera: str
    element: str
    """``turn`` (degrees), ``shift`` (mm), ``focus`` (% of the focal length) or ``principal point`` (px)."""
    value: list[float]
    """Along the camera's axes."""
    sigma: list[float]


@dataclass(frozen=True)
class ChangeResult:
    """One explanation by a change."""

    kind: str
    cameras: list[str]
    """Cameras of which each could be the one; of ``several`` and ``together``, all of them."""
    probability: float
    """That this is the change, given that there is one."""
    p_value: float
    amounts: list[AmountResult]


@dataclass(frozen=True)
class SmallestResult:
    """A change that would be found nine times in ten."""

    kind: str
    cameras: list[str]
    size: float
    unit: str


@dataclass(frozen=True)
class CheckResult:
    """The JSON document of ``labcal check``."""

    verdict: str
    """``valid``, ``changed`` or ``cannot-tell``."""
    p_value: float
    """Probability that noise and errors of the calibration make a difference so large."""
    camera: str | None
    """The camera that changed; null if none did, or it cannot be determined which."""
    by_camera: dict[str, float]
    """Probability by camera that it is the one, given that there is a change."""
    changes: list[ChangeResult]
    """The most likely first."""
    cost: ChangeCost | None
    """Errors of points by the change, mm; null if nothing changed."""
    budget_mm: float | None
    """RMS standard deviation of points by noise and calibration."""
    undetected_mm: float | None
    """RMS error of points by the worst change that would be missed once in ten checks."""
    smallest: list[SmallestResult]
    sigma0: float
    """Residuals over what is predicted, where every camera may have changed."""
    views: list[str]
    dots: int
    outliers: int
    mended: str | None
    """The file of the corrected rig; null if there is none."""
    mend_refused: str | None
    """Reason that there is none, where one was asked for."""
    warnings: list[str]
    print_difference: PrintDifference | None
    """Signs that the new pictures show another print than the calibration's; null where there are none."""


def check_result(found: RigCheck, mended: AnyPath | None = None, refused: str | None = None) -> CheckResult:
    """Return the JSON document.

    Parameters
    ----------
    found : RigCheck
    mended : path, optional
        Of the corrected rig.
    refused : str, optional
        Why it was not written.
    """
    return CheckResult(
        verdict=found.verdict.value,
        p_value=found.p_value,
        camera=found.camera,
        by_camera=dict(found.by_camera),
        changes=[_change(one) for one in found.changes],
        cost=found.cost,
        budget_mm=found.budget_mm,
        undetected_mm=found.undetected_mm,
        smallest=[
            SmallestResult(one.kind.value, list(one.cameras), one.size, one.unit) for one in found.smallest
        ],
        sigma0=found.sigma0,
        views=list(found.views),
        dots=found.dots,
        outliers=found.outliers,
        mended=None if mended is None else str(mended),
        mend_refused=refused,
        warnings=list(found.warnings),
        print_difference=found.print_difference,
    )


def check_words(found: RigCheck, mended: AnyPath | None = None) -> str:
    """Return the result for people."""
    lines = [verdict_words(found)]
    if found.verdict is CheckVerdict.CHANGED:
        lines += [f"- {one.words} (probability {one.probability:.2f})" for one in found.changes]
        lines += [unnamed_words(found), cost_words(found)]
    else:
        lines += [f"- found nine times in ten: {one.words}" for one in found.smallest]
    if mended is not None:
        lines.append(f"Corrected rig: {mended}.")
    return "\n".join(line for line in lines if line)


def verdict_words(found: RigCheck) -> str:
    """Return the verdict in one sentence."""
    chance = f"p = {found.p_value:.2g}" if found.p_value >= 1e-99 else "p < 1e-99"  # noqa: PLR2004 -- shown
    if found.verdict is CheckVerdict.CHANGED:
        other = found.print_difference
        instead = ""
        if other is not None and other.scale_ppm is not None:
            instead = f", or the print is another one: {other.scale_ppm:+.0f} ppm"
        return f"CHANGED ({chance}): the rig is not as it was calibrated{instead}."
    missed = "" if found.undetected_mm is None else f"up to {found.undetected_mm:.2g} mm RMS could be missed"
    budget = "" if found.budget_mm is None else f", where points have a sigma of {found.budget_mm:.2g} mm"
    if found.verdict is CheckVerdict.VALID:
        return f"VALID ({chance}): no change is found{'; ' if missed else ''}{missed}{budget}."
    return (
        f"CANNOT TELL ({chance}): no change is found, but {missed}{budget}. Take more pictures, with "
        "different tilts, all over the volume."
    )


def unnamed_words(found: RigCheck) -> str:
    """Return why no camera is named, and how likely each is; nothing where one is, or all changed."""
    if found.verdict is not CheckVerdict.CHANGED or found.camera is not None:
        return ""
    if found.changes[0].kind in ALL_CAMERAS or len(found.by_camera) == 1:
        return ""
    odds = ", ".join(f"'{name}' {share:.2f}" for name, share in found.by_camera.items())
    words = f"Which camera: {odds} (probabilities; one is named from {LIKELY:.2f} on)."
    if found.tested.made.marks:
        return words
    return f"{words} Marks that stay in place, measured before, would show it."


def cost_words(found: RigCheck) -> str:
    """Return what the change costs, for people; nothing where that is not known."""
    if found.cost is None:
        return ""
    words = f"Points are off by {found.cost.rms_mm:.2g} mm RMS, {found.cost.max_mm:.2g} mm at most"
    if found.budget_mm is not None:
        words += f", where their sigma is {found.budget_mm:.2g} mm"
    return words + "."


def _change(one: FoundChange) -> ChangeResult:
    amounts = [
        AmountResult(part.camera, part.element, list(part.value), list(part.sigma)) for part in one.amounts
    ]
    return ChangeResult(one.kind.value, list(one.cameras), one.probability, one.p_value, amounts)
