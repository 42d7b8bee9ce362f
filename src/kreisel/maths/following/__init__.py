"""Paths in, attitudes of bodies that follow them out.

Exact paths, given by functions: `exact` (nose along the tangent) and `transport` (without twist), built on `tangent`
(closed form), `heading` (rest and the vertical), `joints` (where something steps) and `rolling`.
Paths known from samples, whose small derivatives are noise: `course` and `carried`.
"""
