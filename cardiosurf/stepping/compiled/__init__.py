"""The march as machine code: numba compiles it once, and keeps it (docs/numerics.md).

Only ``engine`` is asked for from outside, and only when something is marched: importing numba
takes a third of a second.
"""
