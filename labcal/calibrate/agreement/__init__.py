"""Whether the cameras of a rig agree on where a target was that was held in the hand."""
