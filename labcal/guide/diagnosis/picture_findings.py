"""Findings of single pictures: one for each camera, of the pictures that show a fault."""

from collections.abc import Sequence

import numpy as np

from labcal.guide.diagnosis.check_name import CheckName
from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.finding import Finding
from labcal.guide.picture_look import PictureLook

Looked = tuple[str, str, PictureLook]
"""View, path and look of a picture."""
_SHOWN = 4


def looks_of(evidence: Evidence, camera: str) -> list[Looked]:
    """Return the looks of a camera's pictures, of those that could be read."""
    return [
        (one.source.view, one.source.image, look)
        for one, look in zip(evidence.measurements, evidence.looks, strict=True)
        if look is not None and one.source.camera == camera
    ]


def picture_cameras(evidence: Evidence) -> tuple[str, ...]:
    """Return the cameras with pictures, in their order."""
    return tuple(dict.fromkeys(one.source.camera for one in evidence.measurements))


def noise_increase(faulty: Sequence[PictureLook], sound: Sequence[PictureLook], least: float) -> float:
    """Return the relative increase of the dots' standard deviation in faulty pictures beside sound ones.

    Infinite where no faulty picture is measured; `least` where nothing sound is left to compare with.
    """
    of = [one.sigma_px for one in faulty if np.isfinite(one.sigma_px)]
    other = [one.sigma_px for one in sound if np.isfinite(one.sigma_px)]
    if not of:
        return float("inf")
    return max(least, float(np.median(of) / np.median(other)) - 1.0) if other else least


def picture_finding(
    evidence: Evidence,
    check: CheckName,
    of: tuple[str, Sequence[Looked]],
    words: tuple[str, str],
    harm: float,
) -> Finding:
    """Return the finding for a camera.

    Parameters
    ----------
    evidence : Evidence
    check : CheckName
    of : (str, sequence of Looked)
        The camera, and its faulty pictures, the worst first.
    words : (str, str)
        What is wrong, and how to mend it.
    harm : float
        Relative increase of the noise of points that are measured in such pictures.
    """
    camera, faulty = of
    bad = {view for view, _, _ in faulty}
    views = tuple(dict.fromkeys(m.source.view for m in evidence.measurements if m.source.view in bad))
    expected = evidence.expected_mm
    harm_mm = None if expected is None else expected * float(np.sqrt((1.0 + harm) ** 2 - 1.0))
    if np.isinf(harm):
        harm_mm = harm
    pictures = tuple(image for _, image, _ in faulty[:_SHOWN])
    return Finding(
        check, (camera,), views, *words, harm_mm=harm_mm, harm_percent=100.0 * harm, pictures=pictures
    )
