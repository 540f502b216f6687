"""The tables of bench_samplers as Markdown and as rows, from what the measuring program wrote."""
import statistics

from sampler_plan import PUBLISHED
from thesis import RAY_METHODS, RIVALS, TABLE_OF


def number(value, digits=3):
    """1.2e-05 as 1.2e-5; plain where that is shorter."""
    if value is None:
        return ""
    if value == 0:
        return "0"
    if abs(value) >= 1e-3:
        return f"{value:.{digits}g}" if abs(value) < 1000 else f"{value:,.0f}"
    mantissa, exponent = f"{value:.1e}".split("e")
    return f"{mantissa}e{int(exponent)}"


def kinds(job):
    return [job["kind"]] + job.get("also", [])


def method(job):
    return job["settings"]["sampler"]


def count_text(job):
    """Mean samples or rays that a cell took."""
    pooled = job["pooled"]
    if method(job) in RAY_METHODS:
        return f"{pooled['rays'] / 1e6:.3g} M rays"
    return f"{pooled['samples']:.0f}"


def variant_text(job):
    s = job["settings"]
    if "resolution" in s:
        return f"{s['resolution']}{' jittered' if s.get('jitter') else ''}"
    return f"filter {s['filter']:g} m" if s.get("filter") else ""


def error_text(pooled):
    return f"{number(pooled['pixel_error'])} ({number(pooled['low'])} to {number(pooled['high'])})"


def mean_of(result, job, inside):
    """Mean pixel error of the cells with geometry inside, or of those without."""
    errors = [c["pixel_error"] for cell, c in zip(result["cells"], job["cells"]) if cell["geometry_inside"] == inside]
    return statistics.fmean(errors) if errors else None


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def thesis_table(result):
    rows = []
    for job in result["jobs"]:
        if "thesis" not in job:
            continue
        seconds, visible, error, color = job["thesis"]
        p = job["pooled"]
        rows.append([method(job), count_text(job), number(p["cpu_seconds"]), number(p["visible_percent"]),
                     error_text(p), number(p["color_error"]), number(seconds), number(visible), number(error),
                     number(color)])
    return table(["method", "samples or rays", "CPU s per cell", "visible %", "pixel error (95 %)", "color error",
                  "thesis: s", "visible %", "pixel error", "color error"], rows)


def best_of(jobs):
    """Of the variants of each method the one with the lowest pixel error, published settings kept beside it."""
    chosen = {}
    for job in jobs:
        key = (method(job), job["settings"].get("filter", 0))
        if key not in chosen or job["pooled"]["pixel_error"] < chosen[key]["pooled"]["pixel_error"]:
            chosen[key] = job
    return list(chosen.values())


def compared(result, kind):
    """Published settings of all, then of rivals their best where it is another."""
    jobs = [job for job in result["jobs"] if kind in kinds(job)]
    count = jobs and max(j["settings"].get("samples", 0) for j in jobs if method(j) == "importance-depth")
    if kind == "samples":  # rows of the thesis have other numbers too
        jobs = [j for j in jobs if j["settings"].get("samples", count) == count]
    published = [j for j in jobs if method(j) == "guided"  # it has one setting, its own
                 or j["settings"].get("resolution", PUBLISHED) == PUBLISHED and not j["settings"].get("jitter")]
    best = [j for j in best_of(jobs) if j not in published]
    return published, best


def comparison_table(result, kind):
    published, best = compared(result, kind)
    depth = next((j for j in published if method(j) == "importance-depth"), None)
    rows = []
    for job in published + best:
        p = job["pooled"]
        ratio = p["pixel_error"] / depth["pooled"]["pixel_error"] if depth and depth["pooled"]["pixel_error"] else None
        errors = sorted(c["pixel_error"] for c in job["cells"])
        rows.append([method(job) + (" (best)" if job in best else ""), variant_text(job), count_text(job),
                     number(p["cpu_seconds"]), number(p["visible_percent"]), error_text(p), number(p["color_error"]),
                     "" if ratio is None else f"{ratio:.0f}" if ratio >= 100 else f"{ratio:.2g}",
                     number(mean_of(result, job, False)), number(mean_of(result, job, True)),
                     f"{number(errors[0])}, {number(statistics.median(errors))}, {number(errors[-1])}"])
    return table(["method", "setting", "samples or rays", "CPU s per cell", "visible %", "pixel error (95 %)",
                  "color error", "x depth", "in empty cells", "in others", "cells: least, median, most"], rows)


def why_table(result):
    """The experiments, and what they are held against."""
    rows = []
    for job in result["jobs"]:
        if "why" not in kinds(job) and job not in compared(result, "samples")[0]:
            continue
        p = job["pooled"]
        rows.append([job["label"], count_text(job), number(p["cpu_seconds"]), number(p["visible_percent"]),
                     error_text(p), number(mean_of(result, job, False)), number(mean_of(result, job, True))])
    return table(["experiment", "samples or rays", "CPU s per cell", "visible %", "pixel error (95 %)",
                  "in empty cells", "in others"], rows)


def markdown(results):
    text = ""
    for result in results:
        name = result["name"]
        cells = result["cells"]
        inside = sum(1 for c in cells if c["geometry_inside"])
        text += (f"### {name}: {result['polygons']:,} polygons, {len(cells)} cells ({inside} with geometry inside), "
                 f"{sum(c['truth_rays'] for c in cells) / 1e6:,.0f} M rays of truth\n\n")
        if any("thesis" in job for job in result["jobs"]):
            text += f"Table {TABLE_OF[name]} of the thesis, and its rows:\n\n{thesis_table(result)}\n"
        text += f"Equal samples:\n\n{comparison_table(result, 'samples')}\n"
        text += f"Equal time:\n\n{comparison_table(result, 'time')}\n"
        if any("why" in kinds(job) for job in result["jobs"]):
            text += f"Experiments at equal samples:\n\n{why_table(result)}\n"
    return text


def rival_ratios(results):
    """Pixel error of each rival, the better of published and best, over that of importance-depth."""
    rows = []
    for result in results:
        row = [result["name"]]
        for kind in ("samples", "time"):
            published, best = compared(result, kind)
            depth = next(j for j in published if method(j) == "importance-depth")["pooled"]["pixel_error"]
            for name in RIVALS:
                errors = [j["pooled"]["pixel_error"] for j in published + best if method(j) == name]
                row.append(f"{min(errors) / depth:.2g}" if errors and depth else "")
        rows.append(row)
    head = ["scene"] + [f"{name}, equal {kind}" for kind in ("samples", "time") for name in RIVALS]
    return table(head, rows)


def front_of(result, job):
    s = job["settings"]
    return {"scene": result["name"], "kind": "+".join(sorted(set(kinds(job)))), "method": s["sampler"],
            "resolution": s.get("resolution", ""), "jitter": int(s.get("jitter", False)), "filter": s.get("filter", "")}


def cell_rows(results):
    """A row for every cell of every setting."""
    return [{**front_of(result, job), "cell": cell["name"], "samples": c["samples"], "rays": c["rays"],
             "cpu_seconds": f"{c['cpu_seconds']:.4g}", "polygons": c["set"],
             "visible_percent": f"{100 * c['set'] / result['polygons']:.5g}", "pixel_error": f"{c['pixel_error']:.4g}",
             "low": f"{c['low']:.4g}", "high": f"{c['high']:.4g}", "misses": f"{c['misses']:.4g}",
             "color_error": f"{c['color_error']:.4g}"}
            for result in results for job in result["jobs"] for cell, c in zip(result["cells"], job["cells"])]


def pooled_row(result, job, kind, setting, best):
    p, thesis = job["pooled"], job.get("thesis", ("",) * 4) if kind == "thesis" else ("",) * 4
    rays = method(job) in RAY_METHODS
    return {"scene": result["name"], "kind": kind, "method": method(job), "setting": setting, "best": int(best),
            "hemicubes": "" if rays else f"{p['samples']:.0f}", "million_rays": f"{p['rays'] / 1e6:.3g}" if rays else "",
            "cpu_seconds": number(p["cpu_seconds"]), "visible_percent": number(p["visible_percent"]),
            "pixel_error": number(p["pixel_error"]), "low": number(p["low"]), "high": number(p["high"]),
            "color_error": number(p["color_error"]), "in_empty_cells": number(mean_of(result, job, False)),
            "in_others": number(mean_of(result, job, True)),
            **{"thesis_" + key: value if value == "" else number(value)
               for key, value in zip(("seconds", "visible_percent", "pixel_error", "color_error"), thesis)}}


def pooled_rows(results):
    """A row for every setting, in the order of the printed tables."""
    rows = []
    for result in results:
        rows += [pooled_row(result, job, "thesis", variant_text(job), False) for job in result["jobs"] if "thesis" in job]
        for kind in ("samples", "time"):
            published, best = compared(result, kind)
            rows += [pooled_row(result, job, kind, variant_text(job), job in best) for job in published + best]
        rows += [pooled_row(result, job, "why", " ".join(job["label"].split()[1:]), False) for job in result["jobs"]
                 if "why" in kinds(job)]
    return rows
