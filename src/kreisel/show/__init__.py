"""Draws what was computed and computes nothing."""
