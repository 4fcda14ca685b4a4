"""Rehearsal of a rig: the errors to expect of it before anything is bought or printed."""
