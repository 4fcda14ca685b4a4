"""How well dots are found, numbered and measured, and what calibrations make of that: ``labcal bench detect``."""
