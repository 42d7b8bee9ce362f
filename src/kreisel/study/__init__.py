"""Scenarios in, results out: the one floor that knows truth and estimate, and closes the loop between them."""
