"""What bench_samplers measures: scenes, methods, settings, and the thesis's rows beside them."""
import hashlib
import os

# Samples per cell (of GVS millions of rays) -> what the thesis printed: seconds, visible %, pixel error, color error.
# GeForce GTX 260, 20 cells picked by hand; it says that its GVS was not optimised.
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
PRESETS = list(TABLE_OF)
TOWN = "small-town"  # of 20,000 polygons, for trying the benchmark itself
REAL = {"intel_castle": "city/intel_castle.glb", "candela_city": "city/candela_city.glb",
        "accident": "levels/accident.glb", "czest3ctf": "levels/czest3ctf.glb"}
CITY_SEED = 2
REAL_CELLS = 10  # those without a free place are left out

# The count that equal-sample tables compare at, the one of the thesis nearest to 264; of rays in millions.
MAIN = {"vienna800k": 264, "vienna8m": 296, "hongkong": 284, TOWN: 24}
RAYS = {TOWN: 0.05}
REAL_MAIN, OTHER_RAYS = 264, 1.0
EQUAL_SECONDS = 0.5  # of a core per cell
PUBLISHED = 1024     # pixels along a hemicube's front face
RESOLUTIONS = (256, 512, 1024)

ON_FACES = ["importance-depth", "importance-depth-color", "uniform", "halton"]
HEMICUBES = ON_FACES + ["nir04"]
RIVALS = ["nir04", "halton"]  # they get the better of the published setting and the best of RESOLUTIONS
RAY_METHODS = ["gvs", "gvs++", "agvs"]
EXPLAINED = ["vienna800k", "czest3ctf"]  # where experiments say why

# What a method's result depends on, so that a change to one method measures that one anew: files under bake/src.
BASE = "../base/include/sightcell/base/"
SHARED_CODE = ["trace", "job/cell_bake.", "cell_set/cell_set.cpp", "cell_set/cell_set.h", BASE + "random.h",
               "sampler/cell_sampler.h", BASE + "time_limit.h", "search/gap_filter."]
HEMICUBE_CODE = ["hemicube/cpu", "hemicube/hemicube_faces.cpp", "search/hemicubes.",
                 "search/boundary_face.h"]
FACE_CODE = HEMICUBE_CODE + ["sampler/face_sampl"]
DEPTH_CODE = FACE_CODE + ["sampler/importance_depth."]
RAY_CODE = ["search/aim.", "search/boundary_face.h", "sampler/border_sampling.", "sampler/guided_search.",
               "sampler/random_rays.", "sampler/ray_finds.", "sampler/reverse_sampling."]
METHOD_CODE = {
    "guided": HEMICUBE_CODE + ["search/aim.", "search/cell_search.", "search/near_polygons.h", "search/refinement.",
                               "search/vertex_neighbors.", "sampler/guided.", "search/guided_views.",
                               "search/radical_inverse.h"],
    "importance-depth": DEPTH_CODE,
    "importance-depth-color": DEPTH_CODE + ["sampler/color_weight.", "hemicube/surface_colors."],
    "uniform": FACE_CODE + ["sampler/uniform_grid."],
    "halton": FACE_CODE + ["sampler/halton.", "search/radical_inverse.h"],
    "nir04": HEMICUBE_CODE + ["sampler/nir04."],
    "gvs": RAY_CODE + ["sampler/gvs."],
    "gvs++": RAY_CODE + ["sampler/gvs_plus_plus."],
    "agvs": ["search/aim.", "sampler/agvs.", "sampler/global_rays.", "sampler/ray_feed.", "sampler/seen_pairs.",
             "sampler/segment_cells."],
}
# They decide nothing of what a method finds.
NO_CODE = ["sampler/cell_sampler.cpp", "sampler/free_memory.h", "input/sampler_options."]


def files_of(source, name):
    """Files under bake/src: of a folder, or those of a folder whose names begin so."""
    folder, start = os.path.split(os.path.join(source, name))
    found = []
    for entry in sorted(os.listdir(folder)):
        path = os.path.join(folder, entry)
        if os.path.isdir(path) and entry == start:
            found += sorted(os.path.join(at, f) for at, _, names in os.walk(path) for f in names)
        elif os.path.isfile(path) and entry.startswith(start):
            found.append(path)
    if not found:
        raise SystemExit(f"bench_samplers: {name} is not in bake/src; correct METHOD_CODE")
    return found


def check_code(root):
    """A sampler's source that no method names would change results that are taken from the cache all the same."""
    source = os.path.join(root, "bake", "src")
    known = {f for names in METHOD_CODE.values() for name in names + SHARED_CODE + NO_CODE
             for f in files_of(source, name)}
    unknown = [f for f in files_of(source, "sampler") if f not in known]
    if unknown:
        raise SystemExit(f"bench_samplers: no method names {', '.join(unknown)}; correct METHOD_CODE")


def code_of(root, method):
    """A hash of the sources that decide what a method finds."""
    source = os.path.join(root, "bake", "src")
    total = hashlib.sha256()
    for name in SHARED_CODE + METHOD_CODE[method]:
        for file in files_of(source, name):
            with open(file, "rb") as stream:
                total.update(stream.read())
    return total.hexdigest()[:16]


def hemicubes(method, samples, resolution=PUBLISHED, jitter=False, seconds=0.0):
    return {"sampler": method, "samples": samples, "resolution": resolution, "jitter": jitter,
            "seconds_per_cell": seconds}


def guided(samples, seconds=0.0):
    """Our default, with its own resolution and jitter. Where time ends it its hemicubes are as many as it likes."""
    return {"sampler": "guided", "samples": samples, "resolution": 512, "seconds_per_cell": seconds}


def rays(method, millions, seconds=0.0, **more):
    return {"sampler": method, "sampling_rays": round(1e6 * millions), "seconds_per_cell": seconds, **more}


def job(kind, settings, **more):
    """kind: thesis (a row of its tables), samples (equal numbers), time (equal time)."""
    words = [settings["sampler"]]
    if "samples" in settings and kind != "time":
        words.append(str(settings["samples"]))
    if "sampling_rays" in settings and kind != "time":
        words.append(f"{settings['sampling_rays'] / 1e6:g} M")
    if "resolution" in settings:
        words.append(f"{settings['resolution']}{'j' if settings.get('jitter') else ''}")
    if settings.get("filter"):
        words.append(f"filter {settings['filter']:g} m")
    if settings["seconds_per_cell"]:
        words.append(f"{settings['seconds_per_cell']:g} s")
    return {"label": " ".join(words), "settings": settings, "kind": kind, **more}


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
