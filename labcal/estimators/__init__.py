"""Methods that recover points in space from pixel positions, one file a method."""
