"""A prediction in readable lines."""

from collections.abc import Iterator

import numpy as np

from cardiosurf.analysis.prediction import COARSE, PatchPrediction, Prediction


def prediction_lines(prediction: Prediction) -> list[str]:
    """Return a prediction as lines of text.

    Parameters
    ----------
    prediction : Prediction
        What ``predict`` returned.
    """
    front = prediction.front
    jump = f"passes jumps of d up to {front.critical_jump:.2f}"
    without = (
        f"{prediction.last_undisturbed:.0f} tu without patches "
        f"(with curvature {_value(prediction.curvature_delay, '.0f')} tu later, median)"
    )
    lines = [
        f"{prediction.name}: predicted without a march, edges of {prediction.edge_length:g} su",
        f"  front         c0 {front.speed:.4f} su/tu, g {front.curvature_factor:.3f}, {jump}",
        f"  last arrival  {prediction.last_arrival:.0f} tu if nothing blocks, {without}",
    ]
    for one in prediction.targets:
        when = "no wave comes" if one.first is None else f"{one.first:.0f} to {one.last:.0f} tu"
        lines.append(f"  target {one.name}: {when}")
    for patch in prediction.patches:
        lines += _patch(patch, prediction)
    if prediction.patches and prediction.edge_length > COARSE:
        lines.append(
            f"  note: edges above {COARSE:g} su put the relative acceleration too low"
            " (by 9 to 21 % at 3 to 5), and its limit was found at 1.5"
        )
    return lines


def _patch(patch: PatchPrediction, prediction: Prediction) -> Iterator[str]:
    if patch.first_arrival is None:
        yield f"  patch {patch.name}: no wave enters it from outside"
        return
    yield (
        f"  patch {patch.name}: entrance {patch.entrance:.0f} su, reached at "
        f"{patch.first_arrival:.0f} tu; angle {patch.angle:.0f} degrees "
        f"({patch.least_angle:.0f} to {patch.greatest_angle:.0f}), "
        f"curvature {_value(patch.curvature, '.4f')} /su"
    )
    width = f"{prediction.width:g} su"
    limit = float(np.sqrt(prediction.front.critical_jump))
    rows = (
        (
            "relative acceleration",
            patch.acceleration,
            prediction.acceleration_limit,
            ".4f",
            patch.by_acceleration,
            f", over {width}",
        ),
        (
            "source and sink",
            patch.source_sink,
            limit,
            ".2f",
            patch.by_source_sink,
            f", {100.0 * (patch.blocked_share or 0.0):.0f} % of the entrance beyond it",
        ),
        ("curvature", patch.curvature_number, 1.0, ".2f", patch.by_curvature, ""),
    )
    for name, value, critical, form, expected, more in rows:
        yield (
            f"    {name:<22} {expected or 'not known':<11} "
            f"{_value(value, form)}, critical {_value(critical, form)}{more}"
        )


def _value(value: float | None, form: str) -> str:
    if value is None:
        return "not known"
    text = f"{value:{form}}"
    # a minus before nothing but zeros says nothing
    return text.lstrip("-") if float(text) == 0.0 else text
