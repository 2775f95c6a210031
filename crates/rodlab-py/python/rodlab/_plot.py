"""Figures drawn with matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .frf import FrequencyResponse


def axes(ax: Sequence[Axes] | None, count: int) -> Sequence[Axes]:
    """Returns `count` axes, one above the other, with a common frequency axis; or the axes that were given."""
    import matplotlib.pyplot as plt

    if ax is None:
        _, made = plt.subplots(count, 1, sharex=True, layout="constrained", squeeze=False)
        return tuple(made[:, 0])
    if len(ax) != count:
        raise ValueError(f"found {len(ax)} axes, expected {count}")
    return ax


def band(ax: Axes, x: NDArray[Any], y: NDArray[Any], error: NDArray[Any], valid: NDArray[np.bool_], label: str) -> None:
    """Draws a curve with its band of two standard errors; invalid frequency lines are grey dots without a band."""
    ax.plot(x[~valid], y[~valid], ".", color="0.75", markersize=2, zorder=0)
    curve = np.where(valid, y, np.nan)
    (drawn,) = ax.plot(x, curve, linewidth=1)
    ax.fill_between(x, curve - 2 * error, curve + 2 * error, alpha=0.3, color=drawn.get_color(), linewidth=0)
    ax.set_ylabel(label)
    seen = y[valid]
    if seen.size:
        room = 0.2 * (np.ptp(seen) or abs(float(seen[0])) or 1.0)
        ax.set_ylim(seen.min() - room, seen.max() + room)


def frequency_response(response: FrequencyResponse, ax: Sequence[Axes] | None) -> Sequence[Axes]:
    """Draws magnitude, phase and coherence."""
    made = axes(ax, 3)
    lines = response.valid & (response.frequency_hz > 0)
    frequency, values = response.frequency_hz[lines], response.values[lines]
    made[0].loglog(frequency, np.abs(values))
    made[0].set_ylabel("|H|")
    made[1].plot(frequency, np.degrees(np.angle(values)))
    made[1].set_ylabel("phase (°)")
    if response.coherence is not None:
        made[2].plot(frequency, response.coherence[lines])
    made[2].set_ylim(0, 1.05)
    made[2].set_ylabel("coherence")
    made[2].set_xlabel("frequency (Hz)")
    return made
