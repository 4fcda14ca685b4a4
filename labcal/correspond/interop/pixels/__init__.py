"""Tables of named pixels of other programs, one file a format."""
