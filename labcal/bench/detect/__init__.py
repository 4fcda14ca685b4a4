"""How well dots are found, measured and calibrated with: ``labcal bench detect``."""
