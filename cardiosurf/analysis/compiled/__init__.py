"""Loops over triangles as machine code, compiled and kept as the march is.

They need numba's decorators only, which ``stepping.compiled.keep`` has; importing this package
takes as long as importing numba.
"""
