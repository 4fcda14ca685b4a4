"""Linear models of the dots of a shoot, by which explanations of its residuals are compared."""
