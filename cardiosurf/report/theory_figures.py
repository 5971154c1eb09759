"""The paper's theoretical figures drawn again from the general code (``make figures``).

relpv1 and relpv2 (section 5.4, Case II), planeani2A and sphereani2A (Appendix C); and what is
drawn elsewhere: the discrete model of Appendix B, geodesics of the vein.
"""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cardiosurf.analysis.relative_acceleration import (
    diffusivity,
    front,
    gravitational,
    relative_acceleration,
)
from cardiosurf.analysis.smoothed_patches import SmoothedPatch, smoothed_factors
from cardiosurf.arrays import Floats
from cardiosurf.errors import given_words, told_on_stderr
from cardiosurf.geometry.jets import Jet, constant, log
from cardiosurf.geometry.nets import FlatNet, Net, nets_of, vein_net
from cardiosurf.geometry.sphere import Sphere
from cardiosurf.report.canvas import INK, new_figure, save
from cardiosurf.report.discrete_figure import stopping
from cardiosurf.report.geodesic_figure import geodesics

RATIOS = {0.5: "#0072b2", 1.0: INK, 2.0: "#d55e00"}
"""r/R of the curves and their colours; the paper gives numbers for 1."""
FACTOR = 4.0
SLANTS = {"pi/6": np.pi / 6, "pi/3": np.pi / 3, "pi/2": np.pi / 2}
WIDTH = 12.0
"""Width of the patch edges, in su (10 to 90 %): that of a front."""


def case_two(
    angle: float, theta: Floats, ratio: float, factors: tuple[float, float] = (FACTOR, FACTOR)
) -> Floats:
    """Return Case II's relative acceleration, (n,), with v = dv/dlambda = 1.

    Parameters
    ----------
    angle : float
        Angle A between the propagation and the theta axis, in radians, in the paper's reading.
    theta : (n,) float
        Places on the vein, in radians from the root.
    ratio : float
        r/R, tip radius over arc radius.
    factors : pair of float
        Anisotropy along theta and phi.

    Notes
    -----
    Source: Chun's paper, section 5.4.
    """
    net, count = vein_net(1.0 + ratio, ratio), len(theta)
    places = np.stack([theta, np.zeros(count)], axis=1)
    tensor = diffusivity(net, places, (constant(factors[0], count), constant(factors[1], count)))
    wave = front(net, places, angle, reading="coordinate")
    return relative_acceleration(net, places, tensor, wave).total()


def rise(angle: float, ratio: float, factors: tuple[float, float] = (FACTOR, FACTOR)) -> float:
    """Return by how much Case II at theta = 0 is above Case II at pi/4.

    Parameters
    ----------
    angle, ratio, factors
        As for ``case_two``.
    """
    root, middle = case_two(angle, np.array([0.0, 0.25 * np.pi]), ratio, factors)
    return float(root - middle)


def relpv1() -> Figure:
    """Return Case II against theta for three angles of propagation."""
    figure = new_figure(
        9.6,
        3.6,
        "relpv1: relative acceleration on the vein, both anisotropies 4",
        "section 5.4, Case II; v = dv/dlambda = 1, angle A from the theta axis",
    )
    theta = np.linspace(0.0, 0.5 * np.pi, 181)
    for axes, (name, angle) in zip(figure.subplots(1, 3, sharey=True), SLANTS.items(), strict=True):
        for ratio, colour in RATIOS.items():
            axes.plot(theta, case_two(angle, theta, ratio), color=colour, label=f"r/R = {ratio:g}")
        axes.set(title=f"A = {name}", xlabel="theta")
        _quarters(axes)
    figure.axes[0].set_ylabel("-d²n/dlambda² [1]")
    figure.axes[0].legend(fontsize=8)
    return figure


def relpv2() -> Figure:
    """Return the difference between theta = 0 and pi/4 against the angle and each anisotropy."""
    figure = new_figure(
        9.6,
        3.6,
        "relpv2: relative acceleration at theta = 0 minus that at theta = pi/4",
        "section 5.4, Case II; unless varied A = pi/4 and both anisotropies 4",
    )
    angles, factors = np.linspace(0.0, 0.5 * np.pi, 91), np.geomspace(1.0, 16.0, 61)
    slant = 0.25 * np.pi
    panels: tuple[tuple[str, Floats, Callable[[float, float], float]], ...] = (
        ("angle A", angles, rise),
        ("theta anisotropy", factors, lambda s, ratio: rise(slant, ratio, (s, FACTOR))),
        ("phi anisotropy", factors, lambda s, ratio: rise(slant, ratio, (FACTOR, s))),
    )
    for axes, (label, varied, value) in zip(figure.subplots(1, 3), panels, strict=True):
        for ratio, colour in RATIOS.items():
            found = [value(one, ratio) for one in varied.tolist()]
            axes.plot(varied, found, color=colour, label=f"r/R = {ratio:g}")
        axes.set(xlabel=label, ylim=(-0.1, 1.1))
    _quarters(figure.axes[0])
    figure.axes[0].set_ylabel("difference [1]")
    figure.axes[0].legend(fontsize=8)
    return figure


def planeani2a() -> Figure:
    """Return the anisotropy of problem 1 and the derivative of its logarithm along y."""
    figure = new_figure(
        6.4,
        3.8,
        "planeani2A: anisotropy 10 on the block, along y at x = 0",
        f"Appendix C, problem 1; edges {WIDTH:g} su wide (10 to 90 %)",
    )
    y = np.linspace(-100.0, 100.0, 801)
    places = np.stack([np.zeros_like(y), y], axis=1)
    block = SmoothedPatch((-50.0, 50.0), (-50.0, 50.0), (10.0, 1.0), WIDTH)
    factor = smoothed_factors(FlatNet(), places, [block])[0]
    axes = figure.add_subplot()
    axes.plot(y, factor.value, color=INK, label="s_xx")
    axes.set(xlabel="y [su]", ylabel="s_xx [1]", ylim=(0.0, 11.0))
    other = axes.twinx()
    other.plot(y, log(factor).first[1], color="#d55e00", linestyle="--", label="d log s_xx / dy")
    other.set_ylabel("d log s_xx / dy [1/su]", color="#d55e00")
    axes.legend(handles=[*axes.lines, *other.lines], loc="lower center", fontsize=8)
    return figure


def edge_component(theta: Floats, width: Callable[[float], float]) -> Floats:
    """Return (d log s / d phi) cot theta of eq. relaccsphere at the block's edge phi = pi/4.

    Parameters
    ----------
    theta : (n,) float
        Polar angles, off the poles.
    width : callable
        Width of the edge in su at a polar angle.
    """
    (net,) = nets_of(Sphere(radius=50.0)).values()
    found = []
    for one in theta.tolist():
        block = SmoothedPatch(None, (-0.25 * np.pi, 0.25 * np.pi), (10.0, 1.0), width(one))
        places = np.array([[one, 0.25 * np.pi]])
        factor = smoothed_factors(net, places, [block])[0]
        found.append(_without_mixed(net, places, factor))
    return np.array(found)


def _without_mixed(net: Net, places: Floats, factor: Jet) -> float:
    """Return G_theta theta less its first term, the mixed derivative."""
    mixed = factor.second[1] / factor.value
    return float((gravitational(net, places, factor, 0) - mixed)[0])


def sphereani2a() -> Figure:
    """Return the last component of eq. relaccsphere against theta."""
    figure = new_figure(
        6.4,
        3.8,
        "sphereani2A: (d log s / d phi) cot theta at the block's edge, anisotropy 10",
        "Appendix C, problem 3; R = 50 su, at phi = pi/4",
    )
    theta = np.linspace(0.05, np.pi - 0.05, 181)
    axes = figure.add_subplot()
    even = edge_component(theta, lambda one: WIDTH * float(np.sin(one)))
    axes.plot(theta, even, color=INK, label=f"edge {WIDTH / 50.0:g} rad wide (the paper's)")
    fixed = edge_component(theta, lambda _: WIDTH)
    axes.plot(theta, fixed, color="#d55e00", linestyle="--", label=f"edge {WIDTH:g} su wide")
    axes.axhline(0.0, color=INK, linewidth=0.5)
    axes.set(xlabel="theta", ylabel="[1]", ylim=(-30.0, 30.0))
    axes.set_xticks([0.0, 0.25 * np.pi, 0.5 * np.pi, 0.75 * np.pi, np.pi])
    axes.set_xticklabels(["0", "pi/4", "pi/2", "3 pi/4", "pi"])
    axes.legend(fontsize=8)
    return figure


FIGURES: dict[str, Callable[[], Figure]] = {
    "relpv1": relpv1,
    "relpv2": relpv2,
    "planeani2a": planeani2a,
    "sphereani2a": sphereani2a,
    "discrete": stopping,
    "geodesics": geodesics,
}


def draw_theory(folder: Path) -> tuple[Path, ...]:
    """Write every figure into a folder, as PNG.

    Parameters
    ----------
    folder : Path
        Where to write.

    Raises
    ------
    InputError
        The folder cannot be written to.
    """
    return tuple(
        path for name in FIGURES for path in save(FIGURES[name](), folder / name, ("png",))
    )


def _quarters(axes: Axes) -> None:
    axes.set_xticks([0.0, 0.125 * np.pi, 0.25 * np.pi, 0.375 * np.pi, 0.5 * np.pi])
    axes.set_xticklabels(["0", "pi/8", "pi/4", "3 pi/8", "pi/2"])
    axes.axhline(0.0, color=INK, linewidth=0.5)


if __name__ == "__main__":
    with told_on_stderr():
        draw_theory(Path(*given_words(1, "FOLDER")))
