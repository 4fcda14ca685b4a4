"""Tests of exchanged pictures, which bear each other's camera's name.

One decision (:mod:`.decision`) for three kinds of evidence: poses of a hand-held target in cameras that are
calibrated alone (:mod:`.by_poses`), rays of known cameras (:mod:`.by_rays`), and a target at known places
(:mod:`.by_places`).
"""
