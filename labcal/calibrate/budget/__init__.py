"""The joint covariance of a calibration: noise of pixels, views that disagree, and the print."""
