"""How good the detector is, and what calibration makes of its dots: ``labcal bench detect``."""
