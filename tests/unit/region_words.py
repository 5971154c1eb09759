"""Regions in few words, for tests of geometry."""

from cardiosurf.geometry.regions import (
    Ball,
    BallLimits,
    Box,
    BoxLimits,
    HalfSpace,
    HalfSpaceLimits,
    Polar,
    PolarLimits,
)


def box(**limits: tuple[float, float]) -> Box:
    return Box(BoxLimits(**limits))


def ball(centre: tuple[float, float, float], radius: float) -> Ball:
    return Ball(BallLimits(centre, radius))


def half_space(normal: tuple[float, float, float], offset: float) -> HalfSpace:
    return HalfSpace(HalfSpaceLimits(normal, offset))


def polar(**limits: tuple[float, float]) -> Polar:
    return Polar(PolarLimits(**limits))
