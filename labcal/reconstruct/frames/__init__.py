"""Frames that a user names: by three points, by a board lying in it, by known points."""
