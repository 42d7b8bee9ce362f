"""Motion in, sensor readings out."""
