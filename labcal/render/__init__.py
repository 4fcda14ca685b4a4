"""The only place with Mitsuba: rays of cameras, textures, the scene compiler and sensor noise."""
