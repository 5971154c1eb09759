"""Shapes, surfaces and the regions on them."""
