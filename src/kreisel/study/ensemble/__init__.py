"""Turns a scenario into many runs of it, each with draws of its own, and their errors into statistics."""
