"""Result documents and how they look; computes nothing."""
