"""Sizes of mistakes by what they do to the very shoot that they are made in."""

import numpy as np

from labcal.bench.diagnose.harm import LENS
from labcal.bench.diagnose.held_shoot import HeldShoot, measured_points
from labcal.bench.diagnose.mistakes import MISTAKES
from labcal.bench.diagnose.simulated_dots import simulated_dots
from labcal.bench.diagnose.sizes import size_of
from labcal.calibrate.dot_treatment import DotTreatment
from labcal.calibrate.handheld import calibrate_handheld
from labcal.calibrate.single_calibration import HandheldSettings
from labcal.cameras.rig import Rig
from labcal.cameras.triangulation import triangulate
from labcal.errors import InputError
from labcal.geometry.poses import rigid_alignment, transform
from labcal.guide.diagnosis.check_name import CheckName

HARM = 0.25
"""Relative increase of the RMS 3-D error by the smallest mistake."""
_POINTS = 200
_SETS = 2
"""Sets of noise, of which the error of a good calibration is the root mean square."""
_TRIED = 4
"""Sizes at which the difference is measured, at most."""
_LINEAR = 3.0
"""Factor between two sizes up to which the difference of rigs is taken as linear."""
_FEWEST = 0.5
"""Share of the points that both rigs must reconstruct."""
_DECLARED = HandheldSettings(dot_places=DotTreatment.DECLARED)


def harmful_size(check: CheckName, shoot: HeldShoot, pattern: int) -> float:
    """Return the size of a mistake that makes points measured with a shoot's rig worse by a quarter.

    Of the same kind of shoot one suffers several times as much as another by the same mistake, so that a size
    for all shoots leaves mistakes among them that harm nothing. With the RMS error e of points by the good
    calibration, and the RMS difference D of points between it and the one with the mistake under the same
    noise, the error with the mistake is ``sqrt(e^2 + D^2)`` on average, and D is proportional to the size.
    Dots are taken as declared: a calibration that frees them would not suffer by the shape of the board.

    Parameters
    ----------
    check : CheckName
        One of :data:`~labcal.bench.diagnose.mistakes.MISTAKES`.
    shoot : HeldShoot
        Without a mistake.
    pattern : int
        Seed of directions and views of the mistake.
    """
    points = _Points.of(shoot, pattern)
    good = [_rig(shoot, pattern + number) for number in range(_SETS)]
    known = [rig for rig in good if rig is not None]
    size = size_of(check, shoot.kind, 0)
    if not known or good[0] is None:
        return size
    error = float(np.sqrt(np.mean([points.error(rig) ** 2 for rig in known])))
    wanted = error * float(np.sqrt((1.0 + HARM) ** 2 - 1.0))
    for _ in range(_TRIED):
        bad = _rig(MISTAKES[check](shoot, size, np.random.default_rng(pattern)), pattern)
        differs = np.inf if bad is None else points.difference(bad, good[0])
        before, size = size, size * float(np.clip(wanted / differs, 0.1, 10.0))
        if 1.0 / _LINEAR < size / before < _LINEAR:
            break
    return size


class _Points:
    """Points over the volume of a pair, and their pixels by the true cameras with noise."""

    def __init__(self, true: np.ndarray, q: np.ndarray, covariance: np.ndarray) -> None:
        self._true, self._q, self._covariance = true, q, covariance

    @classmethod
    def of(cls, shoot: HeldShoot, seed: int) -> "_Points":
        random, cameras = np.random.default_rng(seed), shoot.pair.cameras()
        p = measured_points(shoot.pair, _POINTS, random)
        q = np.stack([camera.project(p).q for camera in cameras], axis=1)
        q += shoot.noise_px * random.standard_normal(q.shape)
        return cls(p, q, np.tile(shoot.noise_px**2 * np.eye(2), (len(p), len(cameras), 1, 1)))

    def error(self, rig: Rig) -> float:
        """Return the RMS error of the points by a rig after a rigid alignment, mm."""
        return _apart(self._measured(rig), self._true)

    def difference(self, one: Rig, other: Rig) -> float:
        """Return the RMS difference of the points by two rigs after a rigid alignment, mm."""
        return _apart(self._measured(one), self._measured(other))

    def _measured(self, rig: Rig) -> np.ndarray:
        return triangulate([rig.camera(name) for name in rig.cameras], self._q, self._covariance).point


def _apart(found: np.ndarray, true: np.ndarray) -> float:
    good = np.isfinite(found).all(axis=1) & np.isfinite(true).all(axis=1)
    if good.mean() < _FEWEST:
        return float("inf")
    moved = transform(rigid_alignment(true[good], found[good]), found[good])
    return float(np.sqrt(((moved - true[good]) ** 2).sum(axis=1).mean()))


def _rig(shoot: HeldShoot, seed: int) -> Rig | None:
    try:
        dots = simulated_dots(shoot, np.random.default_rng(seed))
        return calibrate_handheld(dots, shoot.described, LENS, _DECLARED).rig
    except InputError:
        return None
