"""What bench_samplers measures: scenes, methods, settings."""
import hashlib
import os

PRESETS = ["vienna800k", "vienna8m", "hongkong"]
TOWN = "small-town"  # of 20,000 polygons, for trying the benchmark itself
REAL = {"intel_castle": "city/intel_castle.glb", "candela_city": "city/candela_city.glb",
        "accident": "levels/accident.glb", "czest3ctf": "levels/czest3ctf.glb"}
CITY_SEED = 2
PUBLISHED = 1024     # pixels along a hemicube's front face, of the papers

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
