"""Faults of boards and of shooting that methods are not told of, as they act on exact pixels."""
