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
# The target is named: labcal must know how many dots it has and how far apart they are. ``open_pictures``
# reads view and camera from the names of the files: ``_0`` is the left camera and ``_1`` the right one.
#
# ``measure`` detects the dots in every picture. A picture that cannot be used is not an error: it has a
# ``reason`` instead of dots, so that one bad picture does not stop the others.

target = labcal.load_target("paper-13x10")
pictures = pipeline.open_pictures(photos, cameras="_0=left,_1=right")
measurements = pipeline.measure_pictures(pictures, target)
for measurement in measurements:
    if not measurement.indexed:
        print(measurement.source.image, measurement.reason)
detections = pipeline.detections_of(measurements)
print(detections)

# %%
# Look at a picture before you trust its numbers. A dot has a flag: ``ok`` is a measurement; every other
# word says why it is none (:doc:`/reference/flags`). The ellipses are the stated 95% confidence ellipses,
# enlarged as the figure says.

figure = detections.plot("a", "left")

# %%
# Have the dots been everywhere?
# ------------------------------
#
# A lens is known only where dots were. The dots of all pictures together should cover the picture of each
# camera, up to its corners.

figure = detections.plot()

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
    print(f"{name}: fx = {K[0, 0]:.2f} px (sigma {fx:.2f}), cx = {K[0, 2]:.2f} px (sigma {cx:.2f})")
print(calibration)
print(f"baseline {calibration.rig.baseline_mm('left', 'right'):.2f} mm")
figure = calibration.rig.plot()

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
# pixels makes of it. The figure shows the points of the three views that were held out.

found = pipeline.reconstruct(calibration.rig, detections, target)
points = found.points
print(points)
held_out = points.where(np.isin(points.view, calibration.held_out))
figure = held_out.plot()

# %%
# Are they right?
# ---------------
#
# Nobody knows where your hand held the target. But the distance of every two dots on the print is known, so
# lengths tell: measured minus nominal length, in the three views that the calibration has not seen.

errors = pipeline.evaluate(points, target, rig=calibration.rig)
print(errors)
figure = errors.plot()

# %%
# Lengths on the target do not tell all: a print that is 0.1 % too large makes every length 0.1 % too large,
# and nothing in the pictures shows it. Measure your print with a ruler or better. A real print is also
# uneven by some micrometres: where that makes points more certain, ``calibrate`` estimates the place of every
# dot, too, and ``found.dots.why`` says so; ``HandheldSettings(dot_places="freed")`` asks for it.
#
# Keep the result. ``rig.json`` is a text file, and ``labcal convert`` writes it for OpenCV, mrcal, Kalibr,
# ROS, COLMAP and DICe (:doc:`/how-to/export-to-my-program`).

calibration.rig.save(folder / "rig.json")
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
