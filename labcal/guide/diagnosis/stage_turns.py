"""Views in which a target does not lie on the stage as its reading says."""

import numpy as np

from labcal.guide.diagnosis.evidence import Evidence

_FEWEST = 3
"""Views with readings: of two both would be right or wrong alike."""
_TURNED_DEG = 45.0
"""Turn from which on a board lies another way round; poses of a camera that is badly known err by less."""


def turned_on_stage(evidence: Evidence) -> dict[str, float]:
    """Return the views in which the board lies turned, beside most others, with the turn in degrees.

    The rotation from the stage to a camera is the same in all views; of each view it is the target's rotation
    in the camera times the inverse of the one that the stage reads.
    """
    nominal = evidence.nominal_poses
    if evidence.alone is None or len(nominal) < _FEWEST:
        return {}
    names = evidence.alone.dots.entering.views
    found: dict[str, float] = {}
    for camera in evidence.alone.alone:
        seen = [
            (names[at], np.asarray(T[:3, :3] @ nominal[names[at]][:3, :3].T))
            for at, T in zip(camera.single.views.tolist(), camera.single.T_cam_target, strict=True)
            if names[at] in nominal
        ]
        if len(seen) < _FEWEST:
            continue
        turns = np.array([R for _, R in seen])
        cosine = 0.5 * (np.einsum("aij,bij->ab", turns, turns) - 1.0)
        apart = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
        usual = int(np.argmax((apart < _TURNED_DEG).sum(axis=1)))
        for (view, _), angle in zip(seen, apart[usual].tolist(), strict=True):
            if angle >= _TURNED_DEG:
                found[view] = angle
    return found
