"""Pictures that are blurred beside the others of a set."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from labcal.detect.flags import Refusal
from labcal.guide.picture_look import PictureLook

WIDER = 1.5
"""Times the usual width of edges from which on a picture counts as blurred."""
LEAST_PX = 3.0
"""Width that every sharp lens and sensor may show."""
ALWAYS_PX = 7.0
"""Width from which on a picture is blurred whatever the others are."""
_SHARP = 25.0
"""Percentile of the widths of a camera that its optics can do."""
_OTHER = 1.7
"""Times the usual width of the sharpest camera from which on pictures of any other count as blurred.

In drawn pictures edges 1.6 times as wide leave the noise of dots as it is, 1.75 times cost 20% and more.
"""
_ALIKE = 1.5
"""The same of cameras with pictures of one size, which are of one kind: their lenses can do the same."""


@dataclass(frozen=True)
class UsualEdges:
    """Widths of edges in a camera's pictures.

    Attributes
    ----------
    width_px : float
        Of its sharper pictures; of the other cameras' where it has none.
    limit_px : float
        From which on a picture counts as blurred.
    """

    width_px: float
    limit_px: float

    def is_blurred(self, look: PictureLook) -> bool:
        """Tell whether a picture is blurred; edges of burnt-out and dark ones do not tell.

        Edges that are wide in one direction alone are those of a motion, whatever the others are.
        """
        if look.refusal is Refusal.BLURRED:
            return True
        if look.burnt or look.dark:
            return False
        moved = look.motion_deg is not None and look.widest_px > LEAST_PX
        return moved or bool(look.widest_px > self.limit_px)

    def words(self, look: PictureLook) -> str:
        """Return what is wrong with a blurred picture."""
        width = f"{look.widest_px:.1f} px" if np.isfinite(look.widest_px) else "as much as dots"
        return f"blurred: edges are {width} wide, where {self.width_px:.1f} px is usual"


def usual_edges(looks: Mapping[str, Sequence[PictureLook]]) -> dict[str, UsualEdges]:
    """Return the usual widths of edges by camera.

    Parameters
    ----------
    looks : mapping of str to sequence of PictureLook
        By camera.
    """
    widths = {
        name: [one.widest_px for one in of if np.isfinite(one.widest_px) and not one.burnt]
        for name, of in looks.items()
    }
    own = {name: float(np.percentile(of, _SHARP)) for name, of in widths.items() if of}
    sharpest = min(own.values(), default=ALWAYS_PX / _OTHER)
    sizes = {name: Counter(one.size for one in of).most_common(1) for name, of in looks.items()}
    found = {}
    for name in looks:
        width = own.get(name, sharpest)
        alike = min((own[other] for other in own if sizes[other] == sizes[name]), default=sharpest)
        limit = max(LEAST_PX, min(WIDER * width, _ALIKE * alike, _OTHER * sharpest, ALWAYS_PX))
        found[name] = UsualEdges(width if width <= limit else min(alike, limit), limit)
    return found
