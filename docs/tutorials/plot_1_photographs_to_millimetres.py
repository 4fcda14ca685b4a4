"""
From photographs of a held target to points in millimetres
==========================================================

You have two cameras that look at the same place, and a printed target. You hold the target in your
hands, turn it this way and that, and take a picture with both cameras at each pose. This tutorial takes
such pictures to calibrated cameras, and then to points in space with an uncertainty.

Photographs are large, so this page makes some: it renders a set of a pair of webcams and forgets where
the pictures come from. From there on everything is as with photographs of your own: replace the folder,
the names and the target.
"""

# %%
# A folder of photographs
# -----------------------
#
# Files are named ``a_0.jpg`` (left camera) and ``a_1.jpg`` (right camera), and so on, as many programs for
# two cameras name them.

import shutil
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import labcal
from labcal import pipeline

work = tempfile.TemporaryDirectory()
folder = Path(work.name)
settings = pipeline.RenderSettings(spp=16, views=14)
rendered = pipeline.render("webcam-handheld", folder / "shoot", settings)

photos = folder / "photos"
photos.mkdir()
for letter, view in zip("abcdefghijklmn", rendered.views(), strict=True):
    for number, camera in enumerate(("left", "right")):
        shutil.copy(rendered.folder / view.images[camera], photos / f"{letter}_{number}.jpg")
print(sorted(path.name for path in photos.iterdir())[:4])

# %%
# The dots
# --------
#
# The target is named: labcal must know how many dots it has and how far apart they are. ``find_sources``
# reads view and camera from the names of the files: ``_0`` is the left camera and ``_1`` the right one.
#
# ``measure`` detects the dots in every picture. A picture that cannot be used is not an error: it has a
# ``reason`` instead of dots, so that one bad picture does not stop the others.

target = labcal.load_target("paper-13x10")
sources = pipeline.find_sources([str(photos)], {"_0": "left", "_1": "right"})
measurements = pipeline.measure(sources, target)
for measurement in measurements:
    if not measurement.indexed:
        print(measurement.source.image, measurement.reason)
detections = pipeline.detections_of(measurements)
print(f"{int(detections.ok.sum())} dots measured in {len(measurements)} pictures")

# %%
# Look at a picture before you trust its numbers. A dot has a flag: ``ok`` is a measurement; every other
# word says why it is none (:doc:`/reference/flags`). The ellipses are the stated standard deviations, 500
# times enlarged.


def ellipse(covariance: np.ndarray, scale: float) -> np.ndarray:
    """Return the outline of one standard deviation, `scale` times enlarged, shape (2, 60)."""
    angle = np.linspace(0.0, 2.0 * np.pi, 60)
    return scale * np.linalg.cholesky(covariance) @ np.stack([np.cos(angle), np.sin(angle)])


seen = measurements[0]
figure, axes = plt.subplots(figsize=(8, 6), layout="constrained")
axes.imshow(seen.source.read(), cmap="gray")
for position, covariance, flag in zip(seen.dots.position, seen.dots.covariance, seen.dots.flag, strict=True):
    if flag == "ok":
        axes.plot(*(position[:, None] + ellipse(covariance, 500.0)), color="tab:orange", linewidth=1)
axes.set(title=Path(seen.source.image).name, xlabel="x / px", ylabel="y / px")
axes.set(xlim=(-0.5, 639.5), ylim=(479.5, -0.5))

# %%
# Have the dots been everywhere?
# ------------------------------
#
# A lens is known only where dots were. The dots of all pictures together should cover the picture of each
# camera, up to its corners.

figure, axes = plt.subplots(1, 2, figsize=(9, 4.0), sharey=True, layout="constrained")
for camera, axis in zip(detections.cameras, axes, strict=True):
    dots = detections.where(detections.ok & (detections.camera == camera))
    axis.plot(*dots.position.T, ".", markersize=2)
    axis.set(title=camera, xlim=(0, 640), ylim=(480, 0), xlabel="x / px", aspect="equal")
axes[0].set_ylabel("y / px")

# %%
# The cameras
# -----------
#
# ``calibrate`` finds both lenses, the place of the right camera beside the left one, and the pose of the
# target in every view, in one bundle adjustment. It also corrects the *eccentricity*: the centroid of a
# tilted dot's image is not the image of its centre (:doc:`/explanation/eccentricity`).
#
# ``"auto"`` lets views that were held out choose the lens model. ``hold_out=3`` keeps three more views out
# of everything, to check the result with pictures that the calibration has not seen.

calibration = pipeline.calibrate(target, detections, "auto", hold_out=3)
print("lens model:", calibration.lens, "- held out:", ", ".join(calibration.held_out))
for warning in calibration.warnings:
    print("warning:", warning)
for name, fit in calibration.found.fits.items():
    fx, fy, cx, cy = fit.sigma.intrinsics
    K = calibration.rig.camera(name).K
    print(
        f"{name}: fx = {K[0, 0]:.2f} px (sigma {fx:.2f}), cx = {K[0, 2]:.2f} px (sigma {cx:.2f}), "
        f"RMS {fit.rms_in_rig_px:.3f} px"
    )
right = calibration.rig.camera("right")
print(f"baseline {np.linalg.norm(right.T_cam_world[:3, 3]):.2f} mm")

# %%
# The trials show how well each lens model predicts views that it was not fitted to. A model that is too
# simple errs here; a model that is too large gains nothing.

trials = [trial for trial in calibration.choice.trials if np.isfinite(trial.held_out_px)]
figure, axes = plt.subplots(figsize=(7, 3), layout="constrained")
axes.barh([trial.lens for trial in trials], [trial.held_out_px for trial in trials])
axes.set(xlabel="RMS in views held out / px", xscale="log")
axes.invert_yaxis()

# %%
# Points in millimetres
# ---------------------
#
# ``reconstruct`` intersects the rays of every dot that both cameras measured. The world is the frame of the
# left camera: x to the right, y down, z into the scene. The covariance of a point is what the noise of its
# pixels makes of it.

found = pipeline.reconstruct(calibration.rig, detections, target)
points = found.points
held_out = np.isin(points.view, calibration.held_out)
sigma = np.sqrt(np.trace(points.covariance, axis1=1, axis2=2))
print(f"{len(points)} points; median standard deviation {np.median(sigma):.3f} mm")

figure = plt.figure(figsize=(8, 6), layout="constrained")
axes = figure.add_subplot(projection="3d")
x, y, z = points.point[held_out].T
shown = axes.scatter(x, z, -y, c=sigma[held_out], s=6)
figure.colorbar(shown, label="standard deviation / mm", shrink=0.7)
axes.set(xlabel="x / mm", ylabel="z / mm", zlabel="-y / mm", title="Dots of the three views held out")

# %%
# Are they right?
# ---------------
#
# Nobody knows where your hand held the target. But the distance of every two dots on the print is known, so
# lengths tell: measured minus nominal length, in the three views that the calibration has not seen.

errors = pipeline.evaluate(points, target, learned=calibration.calibrated_on)
print(f"{errors.n} lengths in {', '.join(errors.views_scored)}")
print(f"RMS {errors.length_error_mm.rms:.3f} mm, largest {errors.length_error_mm.max:.3f} mm")
print(f"scale {errors.scale_ppm:+.0f} parts per million")

# %%
# Lengths on the target do not tell all: a print that is 0.1 % too large makes every length 0.1 % too large,
# and nothing in the pictures shows it. Measure your print with a ruler or better. A real print is also
# uneven by some micrometres: pass ``HandheldSettings(free_dots=True)``, and the place of every dot is
# estimated, too.
#
# Keep the result. ``rig.json`` is a text file, and ``labcal convert`` writes it for OpenCV, mrcal, Kalibr,
# ROS, COLMAP and DICe (:doc:`/how-to/export-to-my-program`).

labcal.write_rig(folder / "rig.json", calibration.rig)
print((folder / "rig.json").read_text()[:200])

# %%
# On the command line the same work is
#
# .. code-block:: sh
#
#    labcal detect photos --target paper-13x10 --cameras '_0=left,_1=right' -o dots.csv
#    labcal calibrate dots.csv --target paper-13x10 --lens auto --hold-out 3 -o rig.json
#    labcal reconstruct rig.json dots.csv --target paper-13x10 -o points.csv
#    labcal evaluate points.csv --target paper-13x10 --rig rig.json

work.cleanup()
