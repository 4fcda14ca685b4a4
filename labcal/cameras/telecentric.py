"""The object-space telecentric lens: parallel chief rays, and Brown's distortion in millimetres.

Its stop lies in the rear focal plane, so that every chief ray enters parallel to the axis, and what is near
is imaged as large as what is far (Li and Zhang 2013; Chen, Liao and Zhang 2014). With (X, Y) in the camera's
frame, r^2 = X^2 + Y^2, all in mm::

    x = X (1 + k1 r^2 + k2 r^4 + k3 r^6) + 2 p1 X Y + p2 (r^2 + 2 X^2)
    y = Y (1 + k1 r^2 + k2 r^4 + k3 r^6) + p1 (r^2 + 2 Y^2) + 2 p2 X Y
    u = fx x + cx,  v = fy y + cy

`fx` and `fy` are px/mm: the magnification over the pitch of the pixels. k1 is in 1/mm^2, k2 in 1/mm^4, k3 in
1/mm^6, p1 and p2 in 1/mm: lengths in front of the lens, so that no figure depends on the size of the picture.
"""

from dataclasses import dataclass

from labcal.cameras.field import Direction, FallOff, FieldPoint, SceneRay
from labcal.cameras.mathematics import Mathematics, Number
from labcal.cameras.perspective import Perspective


@dataclass(frozen=True)
class Telecentric(Perspective):
    """Parallel rays, distorted as by the perspective lens with as many coefficients.

    Field coordinates are X and Y, mm. The camera's origin is a point of its axis: which one, no picture
    determines, so that points are imaged at any depth, and rays begin on the plane at depth 0.
    """

    central = False
    parallel = True
    opencv = None
    fall_off = FallOff.EVEN

    def undistorted_radius(self, _angle: float) -> float:
        """Return NaN: parallel rays have no angle to the axis by which they differ."""
        return float("nan")

    def field_point(
        self, _m: Mathematics, parameters: tuple[Number, ...], direction: Direction
    ) -> FieldPoint:
        """Return the field point of a point (X, Y, Z), mm; not ok beyond the fold."""
        X, Y, _ = direction
        return FieldPoint(X, Y, self.is_imaged(parameters, X, Y))

    def chief_ray(self, _m: Mathematics, _parameters: tuple[Number, ...], a: Number, b: Number) -> SceneRay:
        """Return the ray of a field point, from the plane at depth 0 along the axis."""
        zero = 0.0 * (a + b)
        return SceneRay((a, b, zero), (zero, zero, 1.0 + zero), zero == 0.0)
