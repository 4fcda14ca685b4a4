"""The digital twin of a shoot: the calibrated rig and boards rendered again, and compared."""
