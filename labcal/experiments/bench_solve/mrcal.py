"""Against mrcal, by its own programs: the same dots, held-out views, and its reading of our cameras.

Both calibrate one camera from the training views: labcal with ``rational8``, mrcal with OPENCV8, which is the
same formula, and a flat board. Then both lenses are held, and labcal's pose fitter, the same for both, lays
the target into the views that neither has seen.
"""
