"""Guided capture: what the views so far lack, the error reached, and the next pose that lowers it most."""
