#!/usr/bin/python3
"""What a client of a streamed scene (docs/streaming.md) loads until its first picture is nearly complete.

usage: bench_streaming.py --bin FOLDER [--poses N] [--seed N] [--page-size N] [--encoding NAME] [--worst N] [--quick]
                          [--results DIR] [SCENE.glb[=FILE.pvs] ...]

--bin: the folder with sightcell and stream_truth. Scenes: files, or paths under SIGHTCELL_DATA, where missing ones are said
so. Without FILE.pvs (which needs importance), the scene is baked. --quick: a small town, a few cells and poses. Files are
kept under $SIGHTCELL_CACHE (default build/cache); a rerun does what changed. --worst: prints the N views in which ours needs most
bytes over the oracle.

A client has nothing and begins at a random pose (stream_truth.cpp says which) with one of four views of 60 degrees. It loads
the front, the cell chunks whose box contains the eye, and then the pages of its cell, one order after the other:
  ours            weight / bytes, times the part of the page's headings that is in the view, 1/64 at least and where
                  its box is not in the frustum
  distance        nearest box first; with or without those in the frustum before all others
  projected area  of the box / bytes: of the rectangle around it on the screen, or of its sphere
  hierarchical Z  projected area of boxes that pass a test against the depths of the whole scene in this view, which no
                  client has
  oracle          true solid angle in this view / bytes
All orders are over the same pages, the ones that our cell lists, so rivals have our visibility as well. Distance,
projected area and hierarchical Z also have a variant with the boxes of single draws in a page, which no client of ours has.
Of the variants of an order, the table has the one with the fewest bytes until 99 %.

A level is a share of the solid angle of polygons that are visible in the view and arrive with the cell's pages. Waste is the
bytes of pages without any of them. The ceiling is the share of the visible solid angle that the cell lists at all. Texture
images are left out. Times: 10 Mbit/s, 40 ms from a request to its answer, 6 requests at a time.

Bytes are those that a server sends: of the compressed copies that --encoding names (gzip; `brotli`: to a client that accepts
both; `as they are`: none). Weights per byte are over the sizes in the front, those without encoding; the oracle knows what is
sent. A table has the bytes of ours for all encodings, and what they would be if ours knew what is sent.
"""
import argparse
import dataclasses
import hashlib
import os
import subprocess
import sys

sys.dont_write_bytecode = True  # nothing is written into the sources
import numpy as np  # noqa: E402
import result_files  # noqa: E402
import stream_network  # noqa: E402
import stream_orders as orders  # noqa: E402
import stream_poses  # noqa: E402
from stream_poses import streamed_scene  # noqa: E402

LEVELS = {"95": 0.95, "99": 0.99, "99_9": 0.999, "100": 1.0}
ROUNDING = 1e-9
ENCODINGS = {"as they are": (), "gzip": ("gzip",), "brotli": ("gzip", "br")}
LEAST_WEIGHT = 1e-3  # sr. Views that show less are left out
CURVE = [round(8192 * 2 ** (step / 2)) for step in range(19)]  # bytes of pages
QUICK_PAGES = 2048  # bytes: the small town has several
QUICK_BAKE = ["--cell-limit", "6", "--max-pixel-error", "1e-3", "--seed", "1"]


def fail(text):
    sys.exit(f"bench_streaming: {text}")


class Kept:
    """Files that are made once, by the contents of what they are made of."""

    def __init__(self, programs):
        self.programs, self.hashes = programs, {}
        self.folder = os.path.abspath(os.path.join(os.environ.get("SIGHTCELL_CACHE", "build/cache"), "bench_streaming"))

    def hash_of(self, path):
        if path not in self.hashes:
            with open(path, "rb") as stream:
                self.hashes[path] = hashlib.file_digest(stream, "sha256").hexdigest()
        return self.hashes[path]

    def make(self, name, program, inputs, settings, arguments):
        """The path of what the program makes. arguments: of the path that it shall write."""
        program = os.path.join(self.programs, program)
        if not os.path.exists(program):
            fail(f"{program} is not there; build it: cmake --build --preset release")
        parts = [*map(self.hash_of, [program, *inputs]), *settings, name]
        place = os.path.join(self.folder, hashlib.sha256("\0".join(parts).encode()).hexdigest()[:24])
        done = os.path.join(place, name)
        if not os.path.exists(done):
            part = os.path.join(place, "part", name)
            os.makedirs(os.path.dirname(part), exist_ok=True)
            ended = subprocess.run([program, *arguments(part), *settings], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                   text=True, check=False)
            if ended.returncode not in (0, 3):
                fail(f"{os.path.basename(program)} ended with {ended.returncode}: {ended.stderr.strip().splitlines()[-1:]}")
            os.replace(part, done)
        return done

    def scene(self, options, named):
        """The .glb and its .pvs."""
        scene, _, pvs = named.partition("=")
        if not os.path.exists(scene):
            scene = os.path.join(os.environ.get("SIGHTCELL_DATA", ""), scene)
        if not os.path.exists(scene):
            return None
        more = QUICK_BAKE if options.quick else []
        return scene, pvs or self.make("scene.pvs", "sightcell", [scene], ["--importance", "--progress", "none", *more],
                                       lambda part: ["bake", scene, "-o", part])

    def site(self, options, scene, pvs):
        size = ["--page-size", str(options.page_size)] if options.page_size else []
        return self.make("site", "sightcell", [scene, pvs], ["--no-textures", "--compress", "brotli", *size],
                         lambda part: ["pack", "--stream", scene, pvs, "-o", part])

    def poses(self, options, scene, pvs):
        return self.make("poses", "stream_truth", [scene, pvs], ["--poses", str(options.poses), "--seed", str(options.seed)],
                         lambda part: [scene, pvs, part])


@dataclasses.dataclass
class Loading:
    """One order in one view."""
    bytes: dict  # of pages until each level
    waste: float  # share of the bytes until 99 %
    seconds: dict
    curve: np.ndarray  # share of the solid angle within each of CURVE


def until_levels(gains, costs, total):
    """What is spent when each level is reached, and after how many."""
    spent, gained = np.cumsum(costs), np.cumsum(gains)
    at = {name: int(np.searchsorted(gained, level * total * (1 - ROUNDING))) for name, level in LEVELS.items()}
    return {name: spent[min(number, len(spent) - 1)] for name, number in at.items()}, at


def loading(view, pages, startup, timed):
    gains, sizes = view.true[pages], view.scene.sent[pages].astype("f8")
    total = gains.sum()
    spent, at = until_levels(gains, sizes, total)
    first = slice(0, at["99"] + 1)
    seconds = {}
    if timed:
        there = np.array(stream_network.arrivals(sizes.tolist(), startup))
        order = np.argsort(there, kind="stable")
        times = np.cumsum(gains[order])
        for name in ("99", "99_9"):
            seconds[name] = there[order][np.searchsorted(times, LEVELS[name] * total * (1 - ROUNDING))]
    curve = np.append(0, np.cumsum(gains))[np.searchsorted(np.cumsum(sizes), CURVE, side="right")] / total
    return Loading(spent, sizes[first][gains[first] == 0].sum() / sizes[first].sum(), seconds, curve)


def single_polygons(view):
    """Bytes until each level if polygons could be loaded one by one, each at its share of the bytes of its page."""
    where = view.scene.pages
    same, first, at = np.unique(where.same[view.ids], return_index=True, return_inverse=True)
    gains, page = orders.sums(at, view.angles, len(same)), view.of_page[first]
    costs = view.scene.sent[page] / where.page_polygons[page]
    order = np.argsort(-gains / costs, kind="stable")
    return until_levels(gains[order], costs[order], gains.sum())[0]


class Measured:
    """One scene."""

    def __init__(self, name):
        self.name, self.poses, self.empty, self.views = name, 0, 0, []
        self.sent = {}  # by encoding: bytes of each page

    def measure(self, scene, site, poses, encoding):
        self.sent = {name: site.sent_page_bytes(accepted) for name, accepted in ENCODINGS.items()}
        of = orders.Scene(site.front, stream_poses.pages_of_scene(scene, site), self.sent[encoding])
        front_bytes = os.path.getsize(os.path.join(site.folder, "scene.front"))
        everywhere = of.sent[site.front.everywhere].tolist()
        for number, pose in enumerate(poses):
            boxes = site.front.chunk_boxes
            chunks = np.flatnonzero(((boxes[:, 0] <= pose.eye) & (pose.eye < boxes[:, 1])).all(axis=1))
            sizes = [*site.front.chunk_bytes[chunks].tolist(), *everywhere]
            begin = stream_network.arrivals([front_bytes])[0]
            ready = max(stream_network.arrivals(sizes, begin))
            cell = streamed_scene.cell_at(site, pose.eye)
            for turn in (*range(stream_poses.VIEWS), None):
                view = orders.View(of, pose, cell, turn)
                if view.weight < LEAST_WEIGHT or not len(view.numbers):
                    self.empty += turn is not None
                    continue
                self.views.append(self.row(view, number, turn, ready, front_bytes + sum(sizes), len(chunks)))
                self.views[-1]["encodings"] = self.encodings_of(view, front_bytes + site.front.chunk_bytes[chunks].sum())
        self.poses = len(poses)

    @staticmethod
    def row(view, number, turn, ready, startup, chunks):
        asked = [one for variants in orders.ORDERS.values() for one in variants] + (orders.TRIED if turn is not None else [])
        published = {one for variants in orders.ORDERS.values() for one in variants}
        return {"pose": number, "view": turn, "eye": view.pose.eye, "cell": view.cell.number, "startup": startup, "chunks": chunks,
                "ceiling": view.ceiling, "page_ceiling": view.page_ceiling, "listed": view.bytes.sum(),
                "carry": (view.true[view.numbers] > 0).mean(), "in_frustum": view.in_view(view.boxes).mean(),
                "polygons": single_polygons(view),
                "orders": {one.__name__: loading(view, one(view), ready, turn is not None and one in published) for one in asked}}

    def encodings_of(self, view, before_pages):
        """Bytes until each level by encoding, of ours, and of ours by the weight per byte that is sent."""
        out = {}
        for name, sent in self.sent.items():
            begin = before_pages + sent[view.scene.front.everywhere].sum()
            for order, pages in (("ours", orders.ours(view)), ("ours, of sent bytes", orders.ours_of(view, sent[view.numbers]))):
                gains = view.true[pages]
                spent, _ = until_levels(gains, sent[pages].astype("f8"), gains.sum())
                out[name, order] = {level: begin + size for level, size in spent.items()}
        return out

    def encodings(self):
        views = self.of_views()
        for name, order in views[0]["encodings"]:
            yield {"scene": self.name, "pages": name, "order": order, "all_page_bytes": int(self.sent[name].sum()),
                   **{f"bytes_{level}": np.mean([row["encodings"][name, order][level] for row in views]) for level in LEVELS}}

    def of_views(self, all_directions=False):
        return [row for row in self.views if (row["view"] is None) == all_directions]

    def mean(self, order, level, all_directions=False):
        return np.mean([row["orders"][order].bytes[level] for row in self.of_views(all_directions)])

    def best(self, variants, all_directions=False):
        return min((one.__name__ for one in variants), key=lambda name: self.mean(name, "99", all_directions))

    def chosen(self, all_directions=False):
        return {name: self.best(variants, all_directions) for name, variants in orders.ORDERS.items()}

    def summary(self):
        views, chosen = self.of_views(), self.chosen()
        startup = np.mean([row["startup"] for row in views])
        for order, variant in chosen.items():
            runs = [row["orders"][variant] for row in views]
            pages = {level: self.mean(variant, level) for level in LEVELS}
            ratios = [row["orders"][variant].bytes["99"] / row["orders"]["oracle"].bytes["99"] for row in views]
            yield {"scene": self.name, "views": len(views), "order": order, "variant": variant, "startup_bytes": startup,
                   **{f"bytes_{level}": startup + pages[level] for level in LEVELS},
                   **{f"page_bytes_{level}": pages[level] for level in LEVELS},
                   **{f"over_oracle_{level}": pages[level] / self.mean("oracle", level) for level in LEVELS},
                   "over_oracle_99_90_percent": float(np.quantile(ratios, 0.9)), "over_oracle_99_largest": max(ratios),
                   "over_area_99": pages["99"] / self.mean(chosen["projected area"], "99"),
                   "waste_99_percent": 100 * np.mean([run.waste for run in runs]),
                   "seconds_99": np.mean([run.seconds["99"] for run in runs]),
                   "seconds_99_9": np.mean([run.seconds["99_9"] for run in runs]),
                   "ceiling_percent": 100 * np.mean([row["ceiling"] for row in views]),
                   "least_ceiling_percent": 100 * min(row["ceiling"] for row in views),
                   "page_ceiling_percent": 100 * np.mean([row["page_ceiling"] for row in views])}

    def tried(self):
        views = self.of_views()
        for name in views[0]["orders"]:
            yield {"scene": self.name, "order": name, **{f"page_bytes_{level}": self.mean(name, level) for level in LEVELS},
                   "waste_99_percent": 100 * np.mean([row["orders"][name].waste for row in views])}
        yield {"scene": self.name, "order": "single polygons",
               **{f"page_bytes_{level}": np.mean([row["polygons"][level] for row in views]) for level in LEVELS}, "waste_99_percent": 0.0}

    def curves(self):
        for order, variant in self.chosen().items():
            mean = np.mean([row["orders"][variant].curve for row in self.of_views()], axis=0)
            yield from ({"scene": self.name, "order": order, "page_bytes": size, "share": float(share)}
                        for size, share in zip(CURVE, mean))


def kb(number):
    return f"{number / 1000:.1f}"


def print_summary(rows):
    print("| scene | order | KB until 95 % | 99 % | 99.9 % | 100 % | of these startup | pages over oracle, 99 % | 99.9 % | pages over "
          "projected area, 99 % | waste, % | s until 99 % | 99.9 % | ceiling, % | least |\n" + "|---" * 15 + "|")
    for row in rows:
        print(f"| {row['scene']} | {row['order']} | " + " | ".join(kb(row[f'bytes_{level}']) for level in LEVELS) +
              f" | {kb(row['startup_bytes'])} | {row['over_oracle_99']:.2f} | {row['over_oracle_99_9']:.2f} | "
              f"{row['over_area_99']:.2f} | {row['waste_99_percent']:.1f} | {row['seconds_99']:.2f} | {row['seconds_99_9']:.2f} | {row['ceiling_percent']:.3f} | "
              f"{row['least_ceiling_percent']:.3f} |")


def print_tried(rows):
    print("\n| scene | order | KB of pages until 95 % | 99 % | 99.9 % | 100 % | waste, % |\n" + "|---" * 7 + "|")
    for row in rows:
        print(f"| {row['scene']} | {row['order']} | " + " | ".join(kb(row[f'page_bytes_{level}']) for level in LEVELS) +
              f" | {row['waste_99_percent']:.1f} |")


def print_encodings(rows):
    print("\n| scene | pages | order | KB of all pages | KB until 95 % | 99 % | 99.9 % | 100 % |\n" + "|---" * 8 + "|")
    for row in rows:
        print(f"| {row['scene']} | {row['pages']} | {row['order']} | {kb(row['all_page_bytes'])} | " +
              " | ".join(kb(row[f'bytes_{level}']) for level in LEVELS) + " |")


def print_more(one, worst):
    views = one.of_views()
    print(f"\n{one.name}: {one.poses} poses, {len(views)} views, {one.empty} more that show nothing. Means: a cell lists "
          f"{kb(np.mean([row['listed'] for row in views]))} KB of pages, {100 * np.mean([row['in_frustum'] for row in views]):.0f} % of "
          f"them with their box in the frustum, {100 * np.mean([row['carry'] for row in views]):.0f} % with something visible; "
          f"{np.mean([row['chunks'] for row in views]):.2f} chunks. All directions, KB of pages until 99 %: " +
          ", ".join(f"{order} {kb(one.mean(name, '99', True))}" for order, name in one.chosen(True).items()))
    names = ["ours", "ours_view_first", "ours_boxes_of_draws", "weight_at_pose", "truth_in_view", "oracle"]
    for row in sorted(views, key=lambda row: -row["orders"]["ours"].bytes["99"] / row["orders"]["oracle"].bytes["99"])[:worst]:
        print(f"  pose {row['pose']} view {row['view']} cell {row['cell']} eye {' '.join(f'{x:.1f}' for x in row['eye'])}: KB until 99 %: " +
              ", ".join(f"{name} {kb(row['orders'][name].bytes['99'])}" for name in names) +
              f", single polygons {kb(row['polygons']['99'])}; pages with something {100 * row['carry']:.0f} %")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True)
    parser.add_argument("--poses", type=int)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--page-size", type=int)
    parser.add_argument("--encoding", choices=ENCODINGS, default="gzip")
    parser.add_argument("--worst", type=int, default=0)
    parser.add_argument("--quick", action="store_true")
    result_files.add_option(parser)
    parser.add_argument("scenes", nargs="*")
    options = parser.parse_args()
    options.poses = options.poses or (8 if options.quick else 200)
    options.page_size = options.page_size or (QUICK_PAGES if options.quick else None)
    kept, all_of_them = Kept(options.bin), []
    if not options.scenes:
        options.scenes = [kept.make("town.glb", "sightcell-city", [], ["--polygons", "20000", "--seed", "1"],
                                    lambda part: ["--out", part])]
    for named in options.scenes:
        files = kept.scene(options, named)
        if files is None:
            print(f"bench_streaming: {named} is not there", file=sys.stderr)
            continue
        one = Measured(os.path.splitext(os.path.basename(files[0]))[0])
        one.measure(files[0], streamed_scene.open_site(kept.site(options, *files)),
                    stream_poses.read_poses(kept.poses(options, *files)), options.encoding)
        all_of_them.append(one)
    if not all_of_them:
        print("skipped: no scenes; SIGHTCELL_DATA names the folder of real scenes")
        return 77
    tables = {name: [row for one in all_of_them for row in getattr(one, name)()] for name in ("summary", "tried", "curves", "encodings")}
    print_summary(tables["summary"])
    print_tried(tables["tried"])
    print_encodings(tables["encodings"])
    for one in all_of_them:
        print_more(one, options.worst)
    notes = [f"{options.poses} random poses in each scene, four views of 60 degrees from each. --no-textures."]
    encoded = [f"Bytes as sent, pages: {options.encoding}."]
    for name, key, what in (("streaming", "summary", "Bytes and seconds until shares of a view have arrived, by order of pages."),
                            ("streaming_tried", "tried", "Bytes of pages until shares of a view have arrived, all orders that were tried."),
                            ("streaming_curves", "curves", "The share of a view that the first bytes of pages carry, in the mean.")):
        result_files.write(options.results, name, what, tables[key], notes + encoded)
    result_files.write(options.results, "streaming_encodings", "Bytes until shares of a view have arrived, by encoding of pages.",
                       tables["encodings"], notes)
    return 0


if __name__ == "__main__":
    sys.exit(main())
