"""HDR-FLIP over bytes, a panel for each scene."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from support.field_rows import Row

CURVES = {  # how a row's name begins: label, colour, marker
    "hash-": ("hash grid", "#c0392b", "o"),
    "triplane-": ("tri-planes", "#2471a3", "s"),
    "frequency-": ("frequencies", "#7d3c98", "^"),
    "sh2 beside": ("SH L2 grid", "#7f8c8d", "x"),
    "sh1 beside": ("SH L1 grid", "#bdc3c7", "+"),
    "lightmap beside": ("lightmap", "#1e8449", "d"),
}


def plot_flip_over_bytes(rows: Sequence[Row], path: Path) -> None:
    """Writes an SVG; nothing where there are no rows."""
    import matplotlib as mpl

    mpl.use("svg")
    mpl.rcParams.update({"svg.hashsalt": "irradia", "svg.fonttype": "none"})
    from matplotlib import pyplot as plt

    scenes = list(dict.fromkeys(row["scene"] for row in rows if row.get("flip") and row["scene"] != "rooms"))
    if not scenes:
        return
    figure, panels = plt.subplots(1, len(scenes), figsize=(3.6 * len(scenes), 3.4), squeeze=False)
    for axes, scene in zip(panels[0], scenes, strict=True):
        here = [row for row in rows if row["scene"] == scene and row.get("flip")]
        for start, (label, colour, marker) in CURVES.items():
            curve = sorted((r["n_bytes"] / 1000, r["flip"]) for r in here if r["name"].startswith(start))
            if curve:
                kb, flip = zip(*curve, strict=True)
                axes.plot(kb, flip, marker=marker, markersize=4, color=colour, label=label, linewidth=1.2)
        axes.set(xscale="log", xlabel="kB as shipped", title=scene)
        axes.set_ylim(bottom=0.0)
        axes.set_xticks([50, 200, 1000], ["50", "200", "1000"])
        axes.minorticks_off()
        axes.grid(color="#eeeeee")
    panels[0][0].set_ylabel("HDR-FLIP")
    named = {
        name: line for axes in panels[0] for line, name in zip(*axes.get_legend_handles_labels(), strict=True)
    }
    figure.tight_layout(rect=(0.0, 0.08, 1.0, 1.0))
    figure.legend(
        named.values(), named.keys(), loc="lower center", ncols=len(named), frameon=False, fontsize=8
    )
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)
