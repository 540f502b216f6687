"""The rows that the thesis printed, and what is measured beside them."""
from sampler_plan import PUBLISHED, TOWN, guided, hemicubes, job, rays

# Samples per cell (of GVS millions of rays) -> what the thesis printed: seconds, visible %, pixel error, color error.
# GeForce GTX 260, 20 cells picked by hand; it says that its GVS was not optimized.
THESIS = {
    "vienna800k": {
        "importance-depth": {80: (6.22, 2.80, 5.5e-5, 1.5e-5), 180: (15.47, 3.05, 4.0e-6, 1.2e-6),
                             264: (22.96, 3.13, 2.0e-6, 5.6e-7), 320: (35.35, 3.17, 2.0e-6, 5.5e-7)},
        "importance-depth-color": {264: (115.33, 3.15, 2.0e-6, 5.7e-7), 320: (142.48, 3.18, 1.0e-6, 5.4e-7)},
        "nir04": {266: (18.88, 3.04, 2.2e-5, 6.0e-6), 325: (23.66, 3.08, 1.6e-5, 4.7e-6)},
        "gvs": {7.25: (175.61, 2.70, 3.1e-4, 9.9e-5)}},
    "vienna8m": {
        "importance-depth": {176: (66.22, 0.413, 1.1e-5, None), 296: (111.70, 0.433, 6.0e-6, None)},
        "nir04": {176: (48.67, 0.407, 6.3e-5, None), 301: (86.31, 0.431, 4.9e-5, None)},
        "gvs": {5.4: (369.91, 1.27, 1.4e-4, None)}},
    "hongkong": {
        "importance-depth": {284: (51.97, 1.77, 8.8e-5, None), 424: (79.39, 1.86, 4.9e-5, None)},
        "nir04": {288: (36.22, 1.68, 4.4e-4, None), 427: (54.19, 1.80, 2.4e-4, None)},
        "gvs": {14.3: (777.31, 1.80, 3.4e-3, None)}},
}
TABLE_OF = {"vienna800k": "5.1", "vienna8m": "5.2", "hongkong": "5.3"}
REAL_CELLS = 10  # those without a free place are left out

# The count that equal-sample tables compare at, the one of the thesis nearest to 264; of rays in millions.
MAIN = {"vienna800k": 264, "vienna8m": 296, "hongkong": 284, TOWN: 24}
RAYS = {TOWN: 0.05}
REAL_MAIN, OTHER_RAYS = 264, 1.0
EQUAL_SECONDS = 0.5  # of a core per cell
RESOLUTIONS = (256, 512, 1024)

ON_FACES = ["importance-depth", "importance-depth-color", "uniform", "halton"]
HEMICUBES = ON_FACES + ["nir04"]
RIVALS = ["nir04", "halton"]  # they get the better of the published setting and the best of RESOLUTIONS
RAY_METHODS = ["gvs", "gvs++", "agvs"]
EXPLAINED = ["vienna800k", "czest3ctf"]  # where experiments say why


def experiments(main):
    """What depth is without its importance, how much of the error is pixels that are too coarse, and what interior cubes
    are worth: the thesis and NIR04 look from faces alone."""
    found = [job("why", hemicubes("importance-depth", main), importance=False)]
    found[0]["label"] += " without importance"
    for pixels in (512, 2048):
        found.append(job("why", hemicubes("importance-depth", main, pixels)))
    found.append(job("why", hemicubes("importance-depth", main, PUBLISHED, True)))
    for method, share, jitter in (("importance-depth", 0.0, False), ("importance-depth", 0.8, False),
                                  ("importance-depth", 0.0, True), ("halton", 0.0, False), ("nir04", 0.0, False),
                                  ("nir04", 0.0, True)):
        one = job("why", {**hemicubes(method, main, PUBLISHED, jitter), "interior_share": share})
        one["label"] += f" interior {share:g}"
        found.append(one)
    return found


def jobs_of(scene, quick):
    """All that is measured on a scene, each setting once."""
    main, millions = MAIN.get(scene, REAL_MAIN), RAYS.get(scene, OTHER_RAYS)
    seconds = EQUAL_SECONDS / 20 if scene == TOWN else EQUAL_SECONDS
    found = []
    thesis = {} if quick else THESIS.get(scene, {})
    for method, rows in thesis.items():
        for count in rows:
            settings = rays(method, count) if method in RAY_METHODS else hemicubes(method, count)
            found.append(job("thesis", settings, thesis=rows[count]))
    for method in ON_FACES + ["nir04"]:
        found.append(job("samples", hemicubes(method, main)))
        if method in RIVALS and not quick:
            found += [job("samples", hemicubes(method, main, r, True)) for r in RESOLUTIONS]
    found.append(job("samples", guided(main)))
    found += [job("samples", rays(method, millions)) for method in RAY_METHODS]
    # Many more samples than the time is enough for.
    for method in HEMICUBES:
        found.append(job("time", hemicubes(method, 2000, PUBLISHED, False, seconds)))
        if method in RIVALS and not quick:
            found += [job("time", hemicubes(method, 4000 if r == 256 else 2000, r, True, seconds))
                      for r in RESOLUTIONS]
    found.append(job("time", guided(100_000, seconds)))
    found += [job("time", rays(method, 1000, seconds)) for method in RAY_METHODS]
    if scene in EXPLAINED and not quick:
        found += experiments(main)
    unique, seen = [], {}
    for one in found:
        key = repr((sorted(one["settings"].items()), one.get("importance", True)))
        if key in seen:
            seen[key].setdefault("also", []).append(one["kind"])
            continue
        seen[key] = one
        unique.append(one)
    return unique
