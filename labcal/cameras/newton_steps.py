"""Number of Newton steps that the inverse of a camera's lens takes."""

import numpy as np

from labcal.cameras.camera import Camera
from labcal.cameras.mathematics import NUMPY, NumpyMathematics


def newton_steps(camera: Camera) -> int:
    """Return the Newton steps after which the inverse of the lens is found everywhere in the picture."""
    q = camera.lattice()
    with np.errstate(invalid="ignore", over="ignore"):
        there = camera.optics.trace(NUMPY, camera.parameters, *q).ok
        for steps in range(1, NUMPY.newton_steps):
            # Well short of what is asked for, since between the nodes it may be worse.
            m = NumpyMathematics(steps, settled=5e-5)
            if not np.any(there & ~camera.optics.trace(m, camera.parameters, *q).ok):
                return steps
    return NUMPY.newton_steps
