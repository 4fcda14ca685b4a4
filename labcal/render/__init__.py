"""The only place with Mitsuba: sensors, textures, the scene compiler and sensor noise."""
