"""Arrays in, arrays out: the mathematics, without sensors or files."""
