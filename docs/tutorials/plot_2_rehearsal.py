"""
A rehearsal in the rendered laboratory
======================================

You plan to measure with two webcams and a target on a lifting stage, and ask: how good will it be, and
which method should I use? The rendered laboratory answers before anything is bought: it makes the
pictures that such cameras would take, noise, distortion and JPEG included, and it knows where every dot
truly was.
"""

# %%
# The pictures
# ------------
#
# A scene is a YAML file that describes cameras, target, lamps, sensors and where the target goes.
# ``webcam-volume`` has two webcams of 640 x 480 pixels above a target at four heights; between these
# heights lie the places to test at. ``labcal scene show webcam-volume`` prints all of it: copy it and
# change what is different in your plan.
#
# ``spp`` is the number of rays for each pixel. 16 is enough to try things; the default of 64 has less noise
# of its own.

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from labcal import pipeline

work = tempfile.TemporaryDirectory()
folder = Path(work.name)
shoot = pipeline.render("webcam-volume", folder / "shoot", pipeline.RenderSettings(spp=16))
for view in shoot.views():
    print(f"{view.name:16} {view.role:6} height {view.T_world_target_nominal[2][3]:7.1f} mm")

# %%
# The pictures at a glance. The highest place is the nearest to the cameras.

figure = shoot.plot()

# %%
# Detect
# ------
#
# ``detect`` looks at the pictures alone, never at the truth. Each dot has a position and a covariance.

detections = pipeline.detect(shoot)
print(detections)
sigma = np.sqrt(np.trace(detections.covariance[detections.ok], axis1=1, axis2=2) / 2)
print(f"stated standard deviation along one axis: {np.median(sigma):.3f} px in the median")

# %%
# Methods
# -------
#
# A method is fitted to the dots at the training places: to their pixels and their known positions. Then it
# maps any pixels to points. These four differ in what they assume: ``dlt`` knows no lens distortion,
# ``quadratic`` is a polynomial, ``bundle`` adjusts two cameras with a lens model, ``hybrid`` adds a smooth
# field for the errors of the lens model (:doc:`/explanation/hybrid`).
#
# ``fit`` also predicts the error of each method at points between the training dots
# (:doc:`/explanation/uncertainty`). This needs no truth, and works with photographs, too.

methods = ("dlt", "quadratic", "bundle", "hybrid")
models = {method: pipeline.fit(shoot, detections, method) for method in methods}
for method, model in models.items():
    print(f"{method:10} expected RMS error {model.rehearsed.rmse_mm:7.2f} mm")

# %%
# Errors in millimetres
# ---------------------
#
# ``evaluate`` compares with the truth, at places that were not trained on. ``limit_mm`` is the error of two
# exactly known cameras, if the stated covariances of the dots are right. A method that is well below the
# limit shows that these covariances are too large: they are, for pictures of a Bayer mosaic in JPEG files
# (:doc:`/explanation/uncertainty`).

results = {}
for method, model in models.items():
    found = pipeline.reconstruct(model, detections, shoot.target)
    results[method] = pipeline.evaluate(found.points, shoot, detections)
limit = results["bundle"].limit_mm
print(f"{'method':10} {'RMS':>8} {'expected':>9} {'coverage':>9}   (limit {limit:.2f} mm)")
for method, errors in results.items():
    expected = models[method].rehearsed.rmse_mm
    print(f"{method:10} {errors.rmse_mm:8.2f} {expected:9.2f} {errors.coverage95:9.2f}")

# %%
# *Coverage* is the share of points that lie within the 95 % ellipsoid that the method states. Less than
# 0.95 means that the ellipsoids are too small, more that they are too large, here for the same reason: the
# covariances of the dots.

figure, axes = plt.subplots(figsize=(7, 3.5), layout="constrained")
place = np.arange(len(methods))
axes.bar(place - 0.2, [results[method].rmse_mm for method in methods], 0.4, label="true")
axes.bar(place + 0.2, [models[method].rehearsed.rmse_mm for method in methods], 0.4, label="expected by fit")
axes.axhline(limit, color="black", linestyle="--", label="limit of the pixels")
axes.set(xticks=place, xticklabels=methods, yscale="log", ylabel="RMS error / mm")
axes.legend()

# %%
# What goes wrong in practice
# ---------------------------
#
# Render the same scene with a bent board, with less light, or with a camera that moves half-way, and see how
# sensitive the plan is. On the command line a key of the scene is changed with ``--set``:
#
# .. code-block:: sh
#
#    labcal render webcam-volume -o bent --set board.bend.along_x_mm=1.5
#    labcal render webcam-volume -o dark --set photometry.exposure_stops=-3
#    labcal render webcam-volume -o knocked --set mistake=camera-knocked
#
# :doc:`/reference/scenes` lists the keys. ``labcal bench render`` measures
# whether the laboratory itself is exact enough for your question.

work.cleanup()
