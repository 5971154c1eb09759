"""Finite elements on surfaces: the only importer of skfem."""
