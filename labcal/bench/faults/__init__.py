"""Faults of boards and of shooting that methods do not know of, as they act on exact pixels."""
