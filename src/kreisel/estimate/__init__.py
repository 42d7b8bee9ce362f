"""Recordings in, attitude and motion out."""
