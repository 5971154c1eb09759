"""IMEX schemes as data, linear solvers and the one time loop."""
