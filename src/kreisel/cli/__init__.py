"""The command line: names of files in, verbs called, one readable line for a mistake."""
