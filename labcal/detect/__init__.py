"""From one picture to its dots, with ids, covariances and flags: pure functions of the picture.

`detector.py` is the chain. Its stages are one file each, with a folder of their parts:

================= ============== ====================================================== ================
stage             parts          does                                                   settings
================= ============== ====================================================== ================
segmentation.py   outlines/      picture to outlines that may be dots                   segmentation
grid.py           lattice/       outlines to a lattice, and to (col, row) of each node  grid
edge_fit.py       edges/         outline to a centre of area with its covariance        edge
quality.py        checks/        flags of dots, refusals of pictures                    quality
charuco.py        corners/       the same for the corners of ChArUco boards             corner
                  marks/         coded dots (dots as above, rings read), corners of tags mark
================= ============== ====================================================== ================

`flags.py` defines each flag and each refusal, `dots.py` is the result, `settings.py` holds all
thresholds and sizes by name, and `stage_settings/` declares them.
"""
