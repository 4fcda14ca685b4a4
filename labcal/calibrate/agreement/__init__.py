"""Agreement of the cameras of a rig on the poses of a hand-held target."""
