"""From one picture to its dots, with ids, covariances and flags: pure functions of the picture."""
