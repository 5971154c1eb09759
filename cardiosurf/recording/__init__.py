"""Observers of the march and the HDF5 file they become."""
