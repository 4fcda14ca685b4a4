"""From a pixel out of the camera and back: intrinsics, lens, and glass in front, in the camera's frame."""

from dataclasses import dataclass

from labcal.cameras import window as windows
from labcal.cameras.dual import Dual, DualMathematics, value_of
from labcal.cameras.field import Direction, FieldPoint, SceneRay
from labcal.cameras.lens import Lens
from labcal.cameras.mathematics import Mathematics, Number
from labcal.cameras.newton import solve_two_for
from labcal.cameras.window import FlatWindow, WavyWindow

INTRINSICS = 4
"""fx, fy, cx and cy come first among the parameters; the window's and the lens's follow."""


@dataclass(frozen=True)
class PixelPoint:
    """Image of a point, in the caller's kind of number, and whether there is one."""

    u: Number
    v: Number
    ok: Number


@dataclass(frozen=True)
class Optics:
    """A lens, and perhaps a window in front of it; everything but the parameters."""

    lens: Lens
    window: FlatWindow | WavyWindow | None = None

    @property
    def central(self) -> bool:
        """True if all rays pass the origin of the camera's frame."""
        return self.lens.central and not isinstance(self.window, FlatWindow)

    @property
    def closed(self) -> bool:
        """True if the lens has a closed formula for the field point of a point at any depth."""
        return (self.lens.central or self.lens.parallel) and not isinstance(self.window, FlatWindow)

    @property
    def lens_at(self) -> int:
        """Place at which the lens's parameters begin."""
        return INTRINSICS + (0 if self.window is None else len(self.window.parameters))

    def trace(self, m: Mathematics, parameters: tuple[Number, ...], u: Number, v: Number) -> SceneRay:
        """Follow the chief ray of pixel (u, v) out of the camera, in the camera's frame.

        Parameters
        ----------
        m : Mathematics
            The functions on the caller's kind of number.
        parameters : tuple of number
            ``Camera.parameters`` in that kind.
        u, v : number
            Pixel position.
        """
        return self.behind_window(
            m, parameters, self.before_window(m, parameters, *self.ideal(m, parameters, u, v))
        )

    def ideal(
        self, m: Mathematics, parameters: tuple[Number, ...], u: Number, v: Number
    ) -> tuple[Number, Number]:
        """Return the normalised image coordinates of a pixel."""
        fx, fy, cx, cy = parameters[:INTRINSICS]
        if isinstance(self.window, WavyWindow):
            u, v = windows.displaced(m, parameters[INTRINSICS : self.lens_at], u, v)
        return (u - cx) * (1.0 / fx), (v - cy) * (1.0 / fy)  # in a picture's rays, divided once for all

    def before_window(self, m: Mathematics, parameters: tuple[Number, ...], x: Number, y: Number) -> SceneRay:
        """Return the chief ray of normalised image coordinates as it leaves the lens."""
        lens = parameters[self.lens_at :]
        found = self.lens.undistort(m, lens, x, y)
        ray = self.lens.chief_ray(m, lens, found.a, found.b)
        return SceneRay(ray.origin, ray.direction, ray.ok & found.ok)

    def behind_window(self, m: Mathematics, parameters: tuple[Number, ...], ray: SceneRay) -> SceneRay:
        """Return a ray that left the lens as it goes on in the scene."""
        if not isinstance(self.window, FlatWindow):
            return ray
        return windows.bent(m, parameters[INTRINSICS : self.lens_at], ray)

    def project(self, m: Mathematics, parameters: tuple[Number, ...], p: Direction) -> PixelPoint:
        """Return where a point (X, Y, Z) of the camera's frame is imaged.

        Parameters
        ----------
        m : Mathematics
        parameters : tuple of number
            ``Camera.parameters``; with `p` all dual numbers, or none.
        p : tuple of number
            Millimetres.
        """
        fx, fy, cx, cy = parameters[:INTRINSICS]
        lens = parameters[self.lens_at :]
        found = self.lens.field_point(m, lens, p) if self.closed else self._field_of(m, parameters, p)
        x, y = self.lens.distort(m, lens, found.a, found.b)
        u, v = fx * x + cx, fy * y + cy
        if not isinstance(self.window, WavyWindow):
            return PixelPoint(u, v, found.ok)
        return self._before_waves(m, parameters, PixelPoint(u, v, found.ok))

    def _field_of(self, m: Mathematics, parameters: tuple[Number, ...], p: Direction) -> FieldPoint:
        """Return the field point whose ray passes a point, by Newton's method on the ray's distance."""
        plain = m.m if isinstance(m, DualMathematics) else m
        values = tuple(value_of(number) for number in parameters)
        glass, lens = values[INTRINSICS : self.lens_at], values[self.lens_at :]
        X, Y, Z = point = tuple(value_of(number) for number in p)
        seen = windows.unbent(plain, glass, (X, Y, Z)) if glass else (X, Y, Z)
        start = self.lens.field_point(plain, lens, seen)
        distance = plain.sqrt(X * X + Y * Y + Z * Z)
        nx, ny, nz = X / distance, Y / distance, Z / distance
        # Two directions across the line of sight (Duff et al. 2017), as constants.
        turn = 1.0 / (1.0 + plain.where(nz > 0.0, nz, 0.0))
        across_a = (1.0 - nx * nx * turn, -nx * ny * turn, -nx)
        across_b = (-nx * ny * turn, 1.0 - ny * ny * turn, -ny)

        def residual(d: DualMathematics, a: Dual, b: Dual, given: tuple[Dual, ...]) -> tuple[Dual, Dual]:
            ray = self.lens.chief_ray(d, given[self.lens_at : -3], a, b)
            if glass:
                ray = windows.bent(d, given[INTRINSICS : self.lens_at], ray)
            way = tuple(at - origin for at, origin in zip(given[-3:], ray.origin, strict=True))
            along = _dot(way, ray.direction)
            beside = tuple(w - along * v for w, v in zip(way, ray.direction, strict=True))
            return _dot(beside, across_a) / distance, _dot(beside, across_b) / distance

        found = solve_two_for(m, residual, (*parameters, *p), start.a, start.b)
        ray = self.lens.chief_ray(plain, lens, value_of(found.a), value_of(found.b))
        ok = found.ok & start.ok & ray.ok & self.lens.is_imaged(lens, value_of(found.a), value_of(found.b))
        if glass:
            ok = ok & (windows.depth_behind(glass, (X, Y, Z)) > 0.0) & windows.bent(plain, glass, ray).ok
        return FieldPoint(found.a, found.b, ok & (point[2] > ray.origin[2]))

    def _before_waves(self, m: Mathematics, parameters: tuple[Number, ...], seen: PixelPoint) -> PixelPoint:
        """Return the pixel that the waves displace to the one that a point would have without them."""

        def residual(d: DualMathematics, u: Dual, v: Dual, given: tuple[Dual, ...]) -> tuple[Dual, Dual]:
            fx, fy = given[:2]
            to_u, to_v = windows.displaced(d, given[INTRINSICS : self.lens_at], u, v)
            return (to_u - given[-2]) / fx, (to_v - given[-1]) / fy

        given = (*parameters, seen.u, seen.v)
        fx = value_of(parameters[0])
        # Unknowns in units of the focal length, as Newton's tolerance is.
        found = solve_two_for(
            m,
            lambda d, a, b, g: residual(d, a * fx, b * fx, g),
            given,
            value_of(seen.u) / fx,
            value_of(seen.v) / fx,
        )
        return PixelPoint(found.a * fx, found.b * fx, seen.ok & found.ok)


def _dot(a: tuple[Number, ...], b: tuple[Number, ...]) -> Number:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
