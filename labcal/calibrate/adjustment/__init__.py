"""Bundle adjustment: cameras, target poses and, where asked, the dots' places, all at once."""
