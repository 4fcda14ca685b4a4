"""How well dots are found, numbered and measured: ``labcal bench detect``."""
