"""Turns a writing function into a whole file or none: `replacing`, by the name the formats know it under."""

from kreisel.data.atomic import replacing as replacing
