"""Appendix B's discrete model: units that can excite a limited number of neighbours."""
