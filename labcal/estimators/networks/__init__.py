"""Networks, the only place with PyTorch."""
