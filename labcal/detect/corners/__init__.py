"""Parts of the detection of ChArUco boards: corners, and the fit of one."""
