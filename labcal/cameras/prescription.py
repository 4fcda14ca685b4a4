"""A lens prescription: surfaces as an optical designer lists them, and their paraxial optics."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from labcal.bounds import LEAST_MM, Length, Margin, Millimetres
from labcal.cameras.spherical import SURFACE
from labcal.run.descriptions import description_names, read_description
from labcal.run.names import Name

FOLDER = "scenes/lenses"


class Surface(BaseModel):
    """One surface, met by light from the scene in the order of the list."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    radius_mm: Millimetres | None
    """Radius of curvature, positive with its centre behind the surface; null for a plane and for the stop."""
    gap_mm: Margin
    """Distance along the axis to the next surface; of the last one without meaning."""
    index: Annotated[float, Field(ge=1, le=4)]
    """Refractive index behind the surface."""
    diameter_mm: Length
    """Clear diameter."""

    @model_validator(mode="after")
    def _is_curved(self) -> "Surface":
        if self.radius_mm is not None and abs(self.radius_mm) < LEAST_MM:
            raise ValueError("a plane has radius_mm null, not 0")
        return self

    @property
    def curvature(self) -> float:
        """One over the radius, 1/mm."""
        return 0.0 if self.radius_mm is None else 1.0 / self.radius_mm


class Prescription(BaseModel):
    """A lens of spherical surfaces with a stop (Kolb, Mitchell and Hanrahan 1995)."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: Name
    description: str = ""
    surfaces: Annotated[tuple[Surface, ...], Field(min_length=2, max_length=40)]
    stop: Annotated[int, Field(ge=0)]
    """Number (from 0) of the surface that is the stop: a plane with the same medium on both sides."""
    focus_mm: Length | None = None
    """Distance in front of the entrance pupil that the film is set to; null: infinity."""

    @model_validator(mode="after")
    def _has_a_stop(self) -> "Prescription":
        if self.stop >= len(self.surfaces):
            raise ValueError(f"stop is surface {self.stop}, but there are only {len(self.surfaces)}")
        if self.surfaces[self.stop].radius_mm is not None or not np.isclose(
            self.index_before(self.stop), self.surfaces[self.stop].index
        ):
            raise ValueError("the stop must be a plane with the same index on both sides")
        if self.surfaces[-1].index != 1.0:
            raise ValueError("the last surface must have air (index 1) behind it")
        if not paraxial(self).focal_mm > 0.0:
            raise ValueError("the lens does not collect light: its focal length is not positive")
        if not paraxial(self).film_mm > 0.0:
            raise ValueError("focus_mm lies within the focal length, where the film has no place")
        return self

    def index_before(self, number: int) -> float:
        """Return the refractive index in front of a surface."""
        return 1.0 if number == 0 else self.surfaces[number - 1].index

    def towards_film(self, first: int, stop: int) -> tuple[float, ...]:
        """Return the parameters of surfaces for a ray that travels to the film (see ``spherical``)."""
        parameters: list[float] = []
        for i in range(first, stop):
            surface = self.surfaces[i]
            gap = 0.0 if i == 0 else self.surfaces[i - 1].gap_mm
            ratio = self.index_before(i) / surface.index
            parameters += [gap, surface.curvature, ratio, 0.25 * surface.diameter_mm**2]
        return tuple(parameters)

    def towards_scene(self, first: int) -> tuple[float, ...]:
        """Return the parameters of the surfaces from `first` to the front, for a ray travelling outwards."""
        parameters: list[float] = []
        for i in range(first, -1, -1):
            surface = self.surfaces[i]
            ratio = surface.index / self.index_before(i)
            parameters += [surface.gap_mm, -surface.curvature, ratio, 0.25 * surface.diameter_mm**2]
        return tuple(parameters)


@dataclass(frozen=True)
class Paraxial:
    """A lens near its axis; lengths in mm."""

    focal_mm: float
    entrance_pupil_mm: float
    """Its place behind the front vertex."""
    pupil_slope: float
    """Slope outside the lens over slope at the stop, of a ray through the middle of the stop."""
    film_mm: float
    """The film's place behind the last vertex, where what lies at the focus distance is sharp."""


def paraxial(lens: Prescription) -> Paraxial:
    """Return the paraxial quantities of a lens (Welford 1986, chapter 3)."""
    whole = lens.towards_film(0, len(lens.surfaces))
    height, slope = paraxial_ray(whole, 1.0, 0.0)
    focal = -1.0 / slope if slope < 0.0 else -1.0
    out_height, out_slope = paraxial_ray(lens.towards_scene(lens.stop - 1), 0.0, 1.0)
    entrance = out_height / out_slope
    if lens.focus_mm is not None:
        height, slope = paraxial_ray(whole, lens.focus_mm - entrance, 1.0)
    film = -height / slope if slope < 0.0 else -1.0
    return Paraxial(focal, entrance, out_slope, film)


def paraxial_ray(surfaces: tuple[float, ...], height: float, slope: float) -> tuple[float, float]:
    """Return height and slope of a paraxial ray behind surfaces."""
    for first in range(0, len(surfaces), SURFACE):
        gap, curvature, ratio, _ = surfaces[first : first + SURFACE]
        height += slope * gap
        slope = ratio * slope + (ratio - 1.0) * curvature * height
    return height, slope


def prescription_names() -> list[str]:
    """Return the names of the lenses that labcal ships, sorted."""
    return description_names(FOLDER)


def load_prescription(name: str) -> Prescription:
    """Return a lens by name, or from a YAML file of one's own.

    Raises
    ------
    UnknownNameError
        No shipped lens has that name; the nearest one is offered.
    InputError
        The description cannot be read, or a value in it is not allowed.
    """
    return read_description(Prescription, "lens", FOLDER, name)
