"""The figures of bench_samplers as one HTML page: charts drawn here as SVG, pictures of the measuring program beside it."""
import html
import json
import os

from sampler_plan import TOWN
from tables import comparison_table, kinds, method, number, thesis_table
from thesis import HEMICUBES, MAIN, REAL_MAIN

COLORS = {"importance-depth": "#0b5fa5", "importance-depth-color": "#2f9fd8", "nir04": "#c1440e", "uniform": "#888888",
          "halton": "#3f8f3f", "gvs": "#7a3fa0", "gvs++": "#b07fd0", "agvs": "#c7a008"}
GROWTH_SAMPLES = 64  # on one face
STYLE = """body{font:15px/1.5 sans-serif;max-width:70em;margin:2em auto;padding:0 1em;color:#222}
table{border-collapse:collapse;margin:1em 0;font-size:13px}td,th{border:1px solid #ccc;padding:.15em .5em;text-align:right}
td:first-child,th:first-child{text-align:left}figure{margin:1em 0;display:inline-block;vertical-align:top}
figcaption{font-size:13px;max-width:34em}img{max-width:34em;border:1px solid #ccc}svg text{font:11px sans-serif}"""


def chart(series, x_label, y_label, width=720, height=300, names=None):
    """series: [(name, [(x, y), ...])], lines with dots. names: of the places along x."""
    points = [p for _, s in series for p in s]
    if not points:
        return ""
    left, bottom, top = 60, 40 if not names else 110, 10
    x0, x1 = min(p[0] for p in points), max(p[0] for p in points)
    y1 = max(p[1] for p in points) * 1.05 or 1.0

    def at(x, y):
        return (left + (x - x0) / ((x1 - x0) or 1) * (width - left - 150),
                top + (1 - y / y1) * (height - top - bottom))

    out = [f'<svg width="{width}" height="{height}" role="img">']
    for i in range(5):
        value = y1 * i / 4
        _, y = at(x0, value)
        out.append(f'<line x1="{left}" x2="{width - 150}" y1="{y:.1f}" y2="{y:.1f}" stroke="#ddd"/>'
                   f'<text x="{left - 5}" y="{y + 4:.1f}" text-anchor="end">{value:,.3g}</text>')
    for i, name in enumerate(names or []):
        x, y = at(i, 0)
        out.append(f'<text transform="translate({x:.1f},{y + 12:.1f}) rotate(-45)" text-anchor="end">'
                   f'{html.escape(name)}</text>')
    if not names:
        for i in range(5):
            value = x0 + (x1 - x0) * i / 4
            x, y = at(value, 0)
            out.append(f'<text x="{x:.1f}" y="{y + 15:.1f}" text-anchor="middle">{value:,.3g}</text>')
    for k, (name, values) in enumerate(series):
        color = COLORS.get(name, "#000")
        path = " ".join("{:.1f},{:.1f}".format(*at(*p)) for p in values)
        out.append(f'<polyline points="{path}" fill="none" stroke="{color}" stroke-width="1.5"/>')
        if len(values) <= 40:
            out += ['<circle cx="{:.1f}" cy="{:.1f}" r="2.5" fill="{}"/>'.format(*at(*p), color) for p in values]
        y = top + 12 + 15 * k
        out.append(f'<rect x="{width - 140}" y="{y - 8}" width="10" height="10" fill="{color}"/>'
                   f'<text x="{width - 125}" y="{y + 1}">{html.escape(name)}</text>')
    out.append(f'<text x="{left}" y="{height - 4}">{html.escape(x_label)}; up: {html.escape(y_label)}</text></svg>')
    return "".join(out)


def html_table(markdown):
    rows = [line.strip("| ").split(" | ") for line in markdown.strip().split("\n") if not line.startswith("|--")]
    cells = ["<tr>" + "".join(f"<{tag}>{html.escape(c)}</{tag}>" for c in row) + "</tr>"
             for row, tag in zip(rows, ["th"] + ["td"] * len(rows))]
    return "<table>" + "".join(cells) + "</table>"


def published(result):
    """One job per method: equal samples at the published setting."""
    count = MAIN.get(result["name"], REAL_MAIN)
    found = {}
    for job in result["jobs"]:
        s = job["settings"]
        own = method(job) == "guided" or s.get("resolution", 1024) == 1024 and not s.get("jitter") and not s.get("filter")
        if "samples" in kinds(job) and s.get("samples", count) == count and own:
            found.setdefault(method(job), job)
    return found


def set_sizes(result):
    """Figure 5.4: the size of every cell's set by method."""
    jobs = published(result)
    order = sorted(range(len(result["cells"])), key=lambda i: result["cells"][i]["truth_polygons"])
    series = [(name, [(x, job["cells"][i]["set"]) for x, i in enumerate(order)]) for name, job in jobs.items()]
    names = [result["cells"][i]["name"] or f"cell {i}" for i in order]
    return chart(series, "cells", "polygons in the set", names=names)


def figure(scene, name, caption):
    """A picture beside the page."""
    return f'<figure><img src="{scene}/{name}" alt=""><figcaption>{html.escape(caption)}</figcaption></figure>'


def shown(scene, pictures):
    """Figures 5.5 to 5.12: what each method gets wrong in one view, and from outside what it kept."""
    with open(pictures, encoding="utf-8") as stream:
        seen = json.load(stream)
    eye = ", ".join(f"{v:.2f}" for v in seen["eye"])
    text = (f"<h3>What is wrong in one view, in red (figures 5.5 to 5.11)</h3><p>Cell {html.escape(seen['cell'])}, from "
            f"({eye}), {seen['pixels']:,} pixels: where the first method misses most. Red pixels are drawn larger.</p>")
    text += figure(scene, seen["picture"], "everything")
    for one in seen["jobs"]:
        text += figure(scene, one["red_grown"], f"{one['label']}: {one['differing_pixels']} pixels differ, mean color "
                                                f"error {number(one['color_error'])}")
    text += "<h3>What each method kept, from outside (figure 5.12)</h3>" + figure(scene, seen["outside"], "everything")
    for one in seen["jobs"]:
        text += figure(scene, one["outside"], f"{one['label']}: {one['set']:,} polygons")
    return text


def jobs_file(result, name, labels, **changes):
    """Jobs of a scene by label, in that order, with other settings."""
    path = result["jobs_file"].replace(".jobs.json", f".{name}.json")
    with open(result["jobs_file"], encoding="utf-8") as stream:
        asked = json.load(stream)
    asked["jobs"] = sorted((j for j in asked["jobs"] if j["label"] in labels), key=lambda j: labels.index(j["label"]))
    for one in asked["jobs"]:
        one["settings"].update(changes)
    with open(path, "w", encoding="utf-8") as stream:
        json.dump(asked, stream)
    return path


def scene_pictures(bench, result, out):
    """Figures 5.5 to 5.13 of one scene. What is looked at is the worst place of the method with most error."""
    jobs = sorted(published(result).values(), key=lambda j: -j["pooled"]["pixel_error"])
    depth = published(result)["importance-depth"]
    worst = max(range(len(result["cells"])), key=lambda i: depth["cells"][i]["pixel_error"])
    cell = result["cells"][worst]["name"]
    folder = os.path.join(out, result["name"])
    os.makedirs(folder, exist_ok=True)
    where = (result["file"], result["cells_file"], result["limit"])
    bench.run("pictures", *where, jobs_file(result, "pictures", [j["label"] for j in jobs]), "--cell", cell, "--cache",
              bench.cache, "--out", folder)
    growth = os.path.join(folder, "growth.json")
    on_faces = [j["label"] for j in jobs if method(j) in HEMICUBES]
    bench.run("growth", *where, jobs_file(result, "growth", on_faces, samples=GROWTH_SAMPLES if result["name"] != TOWN else 6), "--cell", cell, "--out",
              growth)
    text = shown(result["name"], os.path.join(folder, "pictures.json"))
    with open(growth, encoding="utf-8") as stream:
        faces = json.load(stream)["faces"]
    text += "<h3>How the set grows with hemicubes on one face (figure 5.13)</h3>"
    for face in faces:
        series = [(one["settings"]["sampler"], list(enumerate(one["sizes"], 1))) for one in face["jobs"]]
        text += f"<figure>{chart(series, 'hemicubes on face ' + face['face'], 'polygons', 560, 240)}</figure>"
    return text


def write(bench, results, out, pictures):
    os.makedirs(out, exist_ok=True)
    text = f'<!doctype html><meta charset="utf-8"><title>Samplers</title><style>{STYLE}</style><h1>Samplers</h1>'
    for result in results:
        text += f"<h2>{result['name']}: {result['polygons']:,} polygons</h2>"
        if any("thesis" in job for job in result["jobs"]):
            text += "<p>The thesis's rows</p>" + html_table(thesis_table(result))
        text += "<p>Equal samples</p>" + html_table(comparison_table(result, "samples"))
        text += "<p>Equal time</p>" + html_table(comparison_table(result, "time"))
        text += f"<h3>Size of the sets by method (figure 5.4)</h3>{set_sizes(result)}"
        if pictures:
            text += scene_pictures(bench, result, out)
    path = os.path.join(out, "index.html")
    with open(path + ".part", "w", encoding="utf-8") as stream:
        stream.write(text)
    os.replace(path + ".part", path)
    print(f"figures: {path}\n")
