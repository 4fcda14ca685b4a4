"""The figure of eccentricity.md: ``python docs/explanation/figures/eccentricity.py`` writes eccentricity.svg.

Lines are the closed formula of a pinhole; marks are labcal's integral over the outline of a dot.
"""

from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from labcal import Camera
from labcal.cameras.dot_image import dot_images
from labcal.geometry.poses import from_rotation_vector

FOCAL_PX, DISTANCE_MM = 1800.0, 1000.0


def formula(radius_mm: float, tilt: np.ndarray) -> np.ndarray:
    """Return the eccentricity in px of a dot on the camera's axis."""
    sine, cosine = np.sin(tilt), np.cos(tilt)
    return -FOCAL_PX * radius_mm**2 * sine * cosine / (DISTANCE_MM**2 - (radius_mm * sine) ** 2)


def integral(camera: Camera, radius_mm: float, tilt: float) -> float:
    """Return the same from the dot's outline, along x."""
    pose = from_rotation_vector(np.array([0.0, tilt, 0.0]), np.array([0.0, 0.0, DISTANCE_MM]))
    image = dot_images(camera, pose, np.zeros((1, 3)), np.array([radius_mm]))
    return float((image.centroid - image.centre)[0, 0])


def main() -> None:
    """Draw and write the figure, the same bytes at every run."""
    K = np.array([[FOCAL_PX, 0.0, 800.0], [0.0, FOCAL_PX, 600.0], [0.0, 0.0, 1.0]])
    camera = Camera(K, "pinhole", np.zeros(5), np.eye(4), (1600, 1200))
    mpl.rcParams["svg.hashsalt"] = "labcal"
    figure = Figure(figsize=(6.5, 3.5), layout="constrained")
    axes = figure.add_subplot()
    fine, coarse = np.radians(np.linspace(0.0, 75.0, 100)), np.radians(np.arange(0.0, 76.0, 15.0))
    for image_radius_px in (10.0, 20.0, 30.0):
        radius_mm = image_radius_px * DISTANCE_MM / FOCAL_PX
        (line,) = axes.plot(
            np.degrees(fine), np.abs(formula(radius_mm, fine)), label=f"radius {image_radius_px:g} px"
        )
        marks = [abs(integral(camera, radius_mm, tilt)) for tilt in coarse]
        axes.plot(np.degrees(coarse), marks, "o", color=line.get_color())
    axes.set(xlabel="tilt / degrees", ylabel="eccentricity / px", title="focal length 1800 px")
    axes.legend()
    figure.savefig(
        Path(__file__).with_suffix(".svg"), metadata={"Date": None, "Creator": None}, facecolor="white"
    )


if __name__ == "__main__":
    main()
