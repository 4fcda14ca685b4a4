"""Glass in front of a camera: a flat window with air or water behind it, or a wavy one.

The glass bends the camera's own rays, so that truth and picture follow the same path. What lies behind a flat
window fills all of the scene.
"""

from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from labcal.bounds import LONGEST_SIDE_PX, Finite, Length, Margin
from labcal.cameras.field import Direction, SceneRay
from labcal.cameras.mathematics import NUMPY, Mathematics, Number

Index = Annotated[float, Field(ge=1.0, le=4.0)]
Displacement = Annotated[float, Field(ge=-LONGEST_SIDE_PX, le=LONGEST_SIDE_PX)]
WATER = 1.333
GLASS = 1.5168
"""Schott N-BK7 at 588 nm."""
_AHEAD = 1e-3
"""Least cosine between a ray and the window's normal."""


class FlatWindow(BaseModel):
    """A plane-parallel window, with air on the camera's side."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    kind: Literal["flat", "interface"] = "flat"
    """With known refractive indices; or before an unknown medium, whose index a calibration finds."""
    distance_mm: Length
    """From the camera's origin to the near face, along the window's normal."""
    tilt_x_deg: Annotated[float, Field(gt=-80, lt=80)] = 0.0
    """Turn of the normal about the camera's x axis, away from its z axis."""
    tilt_y_deg: Annotated[float, Field(gt=-80, lt=80)] = 0.0
    """Then about its y axis."""
    thickness_mm: Margin = 10.0
    glass_index: Index = GLASS
    behind_index: Index = 1.0
    """Refractive index of what fills the scene: 1 for air, 1.333 for water."""

    @property
    def parameters(self) -> tuple[float, ...]:
        """The normal (away from the camera), distance, thickness, and both indices."""
        return tuple(float(number) for number in self.formula(NUMPY, self.free))

    @property
    def free(self) -> tuple[float, ...]:
        """Free parameters: both tilts (rad), the distance (mm), and of an interface its refractive index."""
        place = (float(np.radians(self.tilt_x_deg)), float(np.radians(self.tilt_y_deg)), self.distance_mm)
        return place if self.kind == "flat" else (*place, self.behind_index)

    def moved(self, free: tuple[float, ...]) -> "FlatWindow":
        """Return the same window with other :attr:`free` parameters.

        Raises
        ------
        ValueError
            There is no such window (pydantic's).
        """
        a, b, distance, *behind = map(float, free)
        return FlatWindow(
            kind=self.kind,
            distance_mm=distance,
            tilt_x_deg=float(np.degrees(a)),
            tilt_y_deg=float(np.degrees(b)),
            thickness_mm=self.thickness_mm,
            glass_index=self.glass_index,
            behind_index=behind[0] if behind else self.behind_index,
        )

    def formula(self, m: Mathematics, free: tuple[Number, ...]) -> tuple[Number, ...]:
        """Return :attr:`parameters` of the same window with other :attr:`free` parameters."""
        a, b, distance, *behind = free
        normal = (m.sin(b) * m.cos(a), -m.sin(a), m.cos(b) * m.cos(a))
        thickness, glass, index = (
            0.0 * distance + number for number in (self.thickness_mm, self.glass_index, self.behind_index)
        )
        return (*normal, distance, thickness, glass, behind[0] if behind else index)


class Wave(BaseModel):
    """One sinusoid of a wavy window."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    amplitude_px: tuple[Displacement, Displacement]
    """Largest displacement of the picture along x and along y."""
    period_px: Annotated[float, Field(ge=1e-3, le=1e9)]
    direction_deg: Finite = 0.0
    """Along which the wave runs, from the picture's x axis towards its y axis."""
    phase_deg: Finite = 0.0
    """At the pixel (0, 0)."""


class WavyWindow(BaseModel):
    """A window whose waves displace the picture: pixel q sees what q + d(q) would see without it.

    d(q) is the sum over the waves of ``amplitude sin(2 pi (q . direction) / period + phase)``. A thin one
    close to the lens does this; rays still pass one point.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    kind: Literal["wavy"] = "wavy"
    waves: Annotated[tuple[Wave, ...], Field(min_length=1, max_length=16)]

    @property
    def parameters(self) -> tuple[float, ...]:
        """For each wave: wave vector (rad/px), phase (rad), amplitudes (px)."""
        parameters: list[float] = []
        for wave in self.waves:
            angle, k = np.radians(wave.direction_deg), 2.0 * np.pi / wave.period_px
            parameters += [
                float(k * np.cos(angle)),
                float(k * np.sin(angle)),
                float(np.radians(wave.phase_deg)),
            ]
            parameters += wave.amplitude_px
        return tuple(parameters)

    @property
    def largest_px(self) -> float:
        """An upper bound of the displacement."""
        return float(sum(np.hypot(*wave.amplitude_px) for wave in self.waves))


Window = Annotated[FlatWindow | WavyWindow, Field(discriminator="kind")]
_PER_WAVE = 5


def displaced(m: Mathematics, parameters: tuple[Number, ...], u: Number, v: Number) -> tuple[Number, Number]:
    """Return the pixel that would see, without the wavy window, what (u, v) sees through it."""
    to_u, to_v = u, v
    for first in range(0, len(parameters), _PER_WAVE):
        k_u, k_v, phase, amplitude_u, amplitude_v = parameters[first : first + _PER_WAVE]
        height = m.sin(k_u * u + k_v * v + phase)
        to_u, to_v = to_u + amplitude_u * height, to_v + amplitude_v * height
    return to_u, to_v


def bent(m: Mathematics, parameters: tuple[Number, ...], ray: SceneRay) -> SceneRay:
    """Return a ray behind a flat window; not ok for rays that do not meet it.

    Snell's law in vector form: behind a face with normal n, ``v' = (v + (sqrt(i^2 - 1 + c^2) - c) n) / i``
    with i the ratio of the indices behind and before and c the cosine of v and n.
    """
    nx, ny, nz, distance, thickness, glass, behind = parameters
    (ox, oy, oz), (dx, dy, dz) = ray.origin, ray.direction
    before = nx * dx + ny * dy + nz * dz
    ahead = before > _AHEAD
    cosine = m.where(ahead, before, 1.0)
    in_glass = m.sqrt(glass * glass - 1.0 + cosine * cosine)  # glass times the cosine there
    in_scene = m.sqrt(behind * behind - 1.0 + cosine * cosine)
    near = (distance - (nx * ox + ny * oy + nz * oz)) / cosine
    # In the glass the ray runs along v + (in_glass - cosine) n, whose part along n is in_glass.
    far = thickness / in_glass
    along, push = near + far, far * (in_glass - cosine)
    origin = (ox + along * dx + push * nx, oy + along * dy + push * ny, oz + along * dz + push * nz)
    push = in_scene - cosine
    direction = ((dx + push * nx) / behind, (dy + push * ny) / behind, (dz + push * nz) / behind)
    return SceneRay(origin, direction, ray.ok & ahead & (near > 0.0))


def unbent(m: Mathematics, parameters: tuple[Number, ...], direction: Direction) -> Direction:
    """Return the direction, before the window, of light that comes from far away behind it (any length)."""
    nx, ny, nz, _, _, _, behind = parameters
    X, Y, Z = direction
    length = m.sqrt(X * X + Y * Y + Z * Z)
    X, Y, Z = behind * X / length, behind * Y / length, behind * Z / length
    cosine = nx * X + ny * Y + nz * Z  # behind times the cosine there
    squared = cosine * cosine + 1.0 - behind * behind
    # Steeper light is totally reflected; from near by it may still come, so start at a grazing ray.
    push = m.sqrt(m.where(squared > _AHEAD, squared, _AHEAD)) - cosine
    return X + push * nx, Y + push * ny, Z + push * nz


def depth_behind(parameters: tuple[Number, ...], direction: Direction) -> Number:
    """Return how far a point (X, Y, Z) lies behind the far face, mm."""
    nx, ny, nz, distance, thickness, _, _ = parameters
    X, Y, Z = direction
    return nx * X + ny * Y + nz * Z - distance - thickness
