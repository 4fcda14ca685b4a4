"""Pictures of one camera that differ in size."""

from collections import Counter

from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.finding import CheckResult, Finding
from labcal.wording import counted


def check(evidence: Evidence) -> CheckResult:
    """Return a finding for each camera."""
    return tuple(found for name in evidence.cameras for found in _of_camera(evidence, name))


def _of_camera(evidence: Evidence, name: str) -> tuple[Finding, ...]:
    pictures = {
        (one.source.view, one.source.image): one.dots.size
        for one in evidence.measurements
        if one.dots is not None and one.source.camera == name
    }
    dots = evidence.detections.where(evidence.detections.camera == name)
    for view, image, (width, height) in zip(
        dots.view.tolist(), dots.image.tolist(), dots.size.tolist(), strict=True
    ):
        pictures.setdefault((view, str(image)), (width, height))
    counts = Counter(pictures.values())
    if len(counts) < 2:  # noqa: PLR2004 -- one size
        return ()
    (usual, most), *others = counts.most_common()
    odd = [key for key, size in pictures.items() if size != usual]
    sizes = ", ".join(f"{counted(count, 'picture')} of {w} x {h}" for (w, h), count in others)
    turned = all((h, w) == usual for (w, h), _ in others)
    alike = all(abs(w / h - usual[0] / usual[1]) < 0.01 * w / h for (w, h), _ in others)
    if turned:
        why = "They are turned by a quarter: switch off the camera's automatic rotation, and turn them back."
    elif alike:
        why = (
            "They have been made smaller or larger, or the camera was set to another resolution: take the "
            "originals, or take these views again."
        )
    else:
        why = "They are cropped, or taken in another mode of the camera: take these views again."
    return (
        Finding(
            CheckName.MIXED_SIZES,
            (name,),
            tuple(dict.fromkeys(view for view, _ in odd)),
            f"Pictures of camera '{name}' differ in size: {most} of {usual[0]} x {usual[1]}, but {sizes} px. "
            "A calibration holds for one size.",
            why,
            harm_mm=float("inf"),
            harm_percent=float("inf"),
            pictures=tuple(image for _, image in odd[:4]),
        ),
    )
