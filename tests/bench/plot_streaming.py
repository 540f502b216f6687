#!/usr/bin/python3
"""Draws the curves of bench_streaming.py: what is missing of a view after so many KB of pages, by order of pages.

usage: plot_streaming.py CURVES.csv OUT.png

CURVES.csv: streaming_curves.csv, as bench_streaming.py --results writes it. Needs the Debian package python3-matplotlib.
"""
import csv
import sys

LEAST = 1e-4  # share that is missing
COLORS = {"ours": "#d62728", "distance": "#7f7f7f", "projected area": "#1f77b4", "hierarchical Z": "#17becf", "oracle": "#000000"}


def curves_of(path):
    """By scene and order: KB of pages, and the share of the view that is missing."""
    found = {}
    with open(path, encoding="utf-8", newline="") as stream:
        for row in csv.DictReader(line for line in stream if not line.startswith("#")):
            curve = found.setdefault(row["scene"], {}).setdefault(row["order"], ([], []))
            curve[0].append(float(row["page_bytes"]) / 1000)
            curve[1].append(max(1 - float(row["share"]), LEAST / 10))
    return found


def draw(curves, path):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    figure, axes = pyplot.subplots(1, len(curves), figsize=(3 * len(curves), 3.2), sharey=True, squeeze=False)
    for axis, (scene, orders) in zip(axes[0], curves.items()):
        for order, (kilobytes, missing) in orders.items():
            axis.plot(kilobytes, missing, label=order, color=COLORS[order], linestyle="--" if order == "oracle" else "-",
                      linewidth=2 if order == "ours" else 1.2)
        most = max(next((x for x, y in zip(*curve) if y <= LEAST), curve[0][-1]) for curve in orders.values())
        axis.set(title=scene, xscale="log", yscale="log", ylim=(LEAST, 1), xlim=(8, most), xlabel="KB of pages")
        axis.grid(alpha=0.3)
        ticks = [kilobytes for kilobytes in (10, 30, 100, 300, 1000, 3000) if kilobytes <= most]
        axis.set_xticks(ticks, [f"{kilobytes:,}" for kilobytes in ticks])
        axis.minorticks_off()
    axes[0][0].set_yticks([1, 0.1, 0.01, 0.001, 0.0001], ["100 %", "10 %", "1 %", "0.1 %", "0.01 %"])
    axes[0][0].set_ylabel("missing of the view")
    axes[0][0].legend(loc="lower left", fontsize=8)
    figure.tight_layout()
    figure.savefig(path, dpi=100, metadata={"Software": None})


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    try:
        draw(curves_of(sys.argv[1]), sys.argv[2])
    except ImportError as missing:
        sys.exit(f"plot_streaming: {missing}; install the Debian package python3-matplotlib")


if __name__ == "__main__":
    main()
