"""Nouns to disk and back; one file per format in `formats`."""
