"""The curves as a small SVG."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from support.convergence import Point

COLOURS = ("#c0392b", "#2471a3", "#7f8c8d")


def plot_curves(
    curves: Mapping[str, Sequence[Point]], targets: Sequence[float], title: str, path: Path
) -> None:
    """Error over time, both logarithmic; a bar spans the repeats' fastest and slowest."""
    import matplotlib as mpl

    mpl.use("svg")
    # Text stays text, and the same curves give the same file.
    mpl.rcParams.update({"svg.hashsalt": "irradia", "svg.fonttype": "none"})
    from matplotlib import pyplot as plt
    from matplotlib.ticker import FormatStrFormatter, LogLocator, NullFormatter

    figure, axes = plt.subplots(figsize=(6.4, 4.0))
    for (name, curve), colour in zip(curves.items(), COLOURS, strict=False):
        times = [point.time_s for point in curve]
        spread = [
            [point.time_s - min(point.seconds) for point in curve],
            [max(point.seconds) - point.time_s for point in curve],
        ]
        errors = [100.0 * point.error for point in curve]
        axes.errorbar(times, errors, xerr=spread, marker="o", markersize=3, color=colour, label=name)
    for target in targets:
        axes.axhline(100.0 * target, color="#bbbbbb", linewidth=0.8, zorder=0)
    axes.set(xscale="log", yscale="log", xlabel="seconds, warm-up included", ylabel="relative RMSE in %")
    axes.set_title(title, fontsize=10)
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter(FormatStrFormatter("%g"))
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.xaxis.set_major_formatter(FormatStrFormatter("%g"))
    axes.legend(frameon=False)
    figure.tight_layout()
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)
