"""How work is spread and how results reach the disk; knows nothing of cameras."""
