"""Shapes, surfaces and the regions on them."""

from typing import TypeAlias

from cardiosurf.geometry.atrium import Atrium
from cardiosurf.geometry.build import build_surface, check_size, points_inside
from cardiosurf.geometry.plane import Plane
from cardiosurf.geometry.sphere import Sphere
from cardiosurf.geometry.surface import Surface
from cardiosurf.geometry.t_domain import TDomain
from cardiosurf.geometry.torus import Torus
from cardiosurf.geometry.vein import Vein

AnyShape: TypeAlias = Plane | Vein | TDomain | Sphere | Torus | Atrium

SHAPES: dict[str, type[AnyShape]] = {
    "plane": Plane,
    "vein": Vein,
    "t_domain": TDomain,
    "sphere": Sphere,
    "torus": Torus,
    "atrium": Atrium,
}

__all__ = ["SHAPES", "AnyShape", "Surface", "build_surface", "check_size", "points_inside"]
