"""Distribution of work over processes, and results on disk; independent of cameras."""
