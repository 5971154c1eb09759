"""Values of u that mean something."""

THRESHOLD = 0.5
"""A node is activated when u rises through this."""

REST_LEVEL = 0.05
"""Tissue below this is at rest."""

BLOW_UP = 10.0
"""Beyond this the computation has broken down."""
