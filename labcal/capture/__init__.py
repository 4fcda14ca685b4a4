"""Pictures from cameras: real ones, replayed ones and simulated ones behind one small interface."""
