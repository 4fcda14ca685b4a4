"""From dots to matched tables of pixels and points."""
