"""The checks of a diagnosis, a file each."""
