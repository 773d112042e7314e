"""Pictures of comparisons and runs (needs matplotlib)."""

from __future__ import annotations

import os
from pathlib import Path

from mujoco_impact.comparison import Comparison
from mujoco_impact.extras import require_matplotlib
from mujoco_impact.files import replacing
from mujoco_impact.plot.row import row_figure
from mujoco_impact.plot.scene import scene_figure


def plot_comparison(comparison: Comparison, path: str | os.PathLike[str]) -> Path:
    """Draws motions, velocities, energies, and error against run time.

    A row of pendulums shows the angles of every method over time; another scene the
    paths of its bodies in the plane in which they move.

    Args:
        comparison: What to draw.
        path: PNG (or other image) file to write.

    Returns:
        The path written.

    Raises:
        MissingExtraError: If matplotlib is not installed.
    """
    require_matplotlib()
    target = Path(path)
    figure = (row_figure if comparison.row else scene_figure)(comparison)
    with replacing(target) as part:
        figure.savefig(part, dpi=130, format=target.suffix[1:] or "png")
    return target
