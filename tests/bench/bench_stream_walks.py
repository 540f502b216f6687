#!/usr/bin/python3
"""What sightcell-stream-client measures on walks over a slow connection (slow_link.py) to nginx.

usage: bench_stream_walks.py --bin FOLDER [--walks N] [--seconds S] [--speeds M/S ...] [--seed N] [--rate MBIT]
                             [--round-trip MS] [--parallel N] [--no-pictures] [--keep FOLDER] [--results DIR]
                             --site NAME=FOLDER ...

A walk goes from view cell to adjacent view cell, on the shortest way to one random cell after the other. The site does not
state where walls are, so walks may go through them. Each walk has a client without any file and a slow connection of its
own. Measured is from the moment when a cell is complete for the first time to the end of the walk:

  B/s         received bytes, with headers, per second
  B per cell  received bytes over the cells that were entered for the first time; p95: of the bytes between two such entries
  pending     share of the time in which the cell was not complete, or not yet known
  missing     share of the time in which more than 0.1 % of the weight of the cell was missing, or the cell was not yet known
  wrong       share of the pictures (160x90, two per second) of which more than 0.1 % of the pixels are wrong

A pixel is wrong if it differs by more than 8 of 255 levels from the pictures of both of two clients that wait for all files of
the cell, the largest images too. One of them loads nothing ahead, the other one all that its camera can reach: from inside a wall, a
camera sees polygons that no valid viewpoint of its cell sees, and they are there by chance.

--keep: the paths, frames and requests of each walk, as bench_stream_server.py takes them.
"""
import argparse
import concurrent.futures
import csv
import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

sys.dont_write_bytecode = True  # nothing is written into the sources
HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(os.path.dirname(HERE), folder) for folder in ("stream", "viewer")]
import nginx_server  # noqa: E402
import numpy as np  # noqa: E402
import result_files  # noqa: E402
from png import read_png  # noqa: E402
from stream_walks import Cells  # noqa: E402
from streamed_scene import open_site  # noqa: E402

SIZE = "160x90"
PICTURES = 2  # per second
LEVELS = 8  # of 255
SHARE = 1e-3  # of weight and of pixels
FASTEST = 50  # meters per second of a camera that waits for each picture
REFERENCES = (0, 60)  # seconds of movement to load ahead
EXTRA = 240  # seconds that a client may take beyond its walk


def run_client(arguments, url, path, speed, distance, folder, more):
    """Returns the printed JSON. Writes pictures, frames.csv and requests.csv into the folder."""
    command = [os.path.join(arguments.bin, "sightcell-stream-client"), url, "--json", "--walk", path, f"--speed={speed:g}",
               "--log-frames", os.path.join(folder, "frames.csv"), "--log-requests", os.path.join(folder, "requests.csv"), *more]
    if arguments.no_pictures:
        command.append("--no-draw")
    else:
        command += ["--pictures", os.path.join(folder, "pictures"), f"--picture-distance={distance:.9g}", "--size", SIZE]
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True, timeout=arguments.seconds * 3 + EXTRA)
    return json.loads(done.stdout)


def slow_client(arguments, server, name, walk):
    """The walk over a slow connection of its own."""
    port = nginx_server.free_port()
    link = subprocess.Popen([sys.executable, os.path.join(HERE, "slow_link.py"), str(port), str(server.port), "--rate",
                             arguments.rate, "--round-trip", arguments.round_trip])
    try:
        while not nginx_server.answers(port):
            time.sleep(0.02)
        return run_client(arguments, f"http://127.0.0.1:{port}/{name}/", walk.path, walk.speed, walk.distance, walk.folder, [])
    finally:
        link.terminate()
        link.wait()


class Walk:
    def __init__(self, folder, path, speed):
        self.folder, self.path, self.speed, self.distance = folder, path, speed, speed / PICTURES
        os.makedirs(folder, exist_ok=True)

    def measure(self, seconds):
        """Of frames between the first complete cell and the end of the walk."""
        frames = [f for f in rows_of(os.path.join(self.folder, "frames.csv")) if f["walked_seconds"] < seconds - 1e-4]
        begin = next((i for i, f in enumerate(frames) if not f["pending"] and not f["unknown_cell"]), None)
        if begin is None:
            raise RuntimeError(f"{self.folder}: no cell was complete")
        frames = frames[begin:]
        times = [b["seconds"] - a["seconds"] for a, b in zip(frames, frames[1:])]
        entered, at = [], {int(frames[0]["cell"])}
        for frame in frames:
            if not frame["unknown_cell"] and int(frame["cell"]) not in at:
                at.add(int(frame["cell"]))
                entered.append(frame["bytes"])
        received = frames[-1]["bytes"] - frames[0]["bytes"]
        out = {"seconds": sum(times), "bytes": received, "entered": len(entered), "first_bytes": frames[0]["bytes"],
               "first_seconds": frames[0]["seconds"], "between": np.diff([frames[0]["bytes"], *entered]).tolist(),
               "pending": sum(t for t, f in zip(times, frames) if f["pending"] or f["unknown_cell"]),
               "missing": sum(t for t, f in zip(times, frames) if lacks(f)), "pictures": 0, "wrong": 0, "wrong_pixels": 0.0}
        # Not the last place, which rounding may leave out.
        out["places"] = range(int(np.ceil(frames[0]["walked_seconds"] * PICTURES)), int(np.ceil(seconds * PICTURES)))
        return out

    def compare(self, measured, references):
        """Pictures of this walk against those of clients that wait. references: their folders."""
        folder = os.path.join(self.folder, "pictures")
        for place in measured["places"]:
            ours, *others = (read_png(os.path.join(at, f"{place:05}.png")).astype(int) for at in (folder, *references))
            wrong = np.all([np.abs(ours - other).max(axis=2) > LEVELS for other in others], axis=0).mean()
            measured["pictures"] += 1
            measured["wrong"] += wrong > SHARE
            measured["wrong_pixels"] += wrong


def lacks(frame):
    return frame["unknown_cell"] or frame["weight"] - frame["weight_present"] > SHARE * frame["weight"]


def rows_of(path):
    with open(path, encoding="utf-8") as stream:
        return [{key: float(value or -1) for key, value in row.items()} for row in csv.DictReader(stream)]


def walks_of(arguments, name, cells, folder):
    """All walks of a site, with their paths written. The walks of one number begin alike at each speed."""
    walks = []
    for speed in arguments.speeds:
        for number in range(arguments.walks):
            at = os.path.join(folder, f"{name}-{speed:g}-{number}")
            walks.append(Walk(at, os.path.join(at, "path.json"), speed))
            with open(walks[-1].path, "w", encoding="utf-8") as out:
                json.dump({"path": cells.walk(speed * arguments.seconds, arguments.seed + number)}, out)
    return walks


def measured_walk(arguments, server, name, walk):
    result = slow_client(arguments, server, name, walk)
    if result["failed"] or not result["complete"]:
        raise RuntimeError(f"{walk.folder}: {result}")
    return walk.measure(arguments.seconds)


def compare(arguments, server, name, walk, measured):
    """Pictures of the same places, when all files of the cell are there."""
    # A power of two faster: positions are the same to the bit, and so is the order of coplanar polygons.
    speed = walk.speed * 2 ** max(0, int(np.log2(FASTEST / walk.speed)))
    with tempfile.TemporaryDirectory() as folder:
        folders = [os.path.join(folder, str(ahead)) for ahead in REFERENCES]
        for at, ahead in zip(folders, REFERENCES):
            os.mkdir(at)
            run_client(arguments, server.url(name), walk.path, speed, walk.distance, at,
                       ["--wait", f"--lookahead={ahead}"])
        walk.compare(measured, [os.path.join(at, "pictures") for at in folders])
    shutil.rmtree(os.path.join(walk.folder, "pictures"))


def row_of(name, speed, measured):
    def total(key):
        return sum(one[key] for one in measured)
    between = [size for one in measured for size in one["between"]]
    seconds, pictures = total("seconds"), total("pictures")
    return {"scene": name, "meters_per_second": speed, "walks": len(measured), "seconds": seconds,
            "first_cell_seconds": statistics.mean(one["first_seconds"] for one in measured),
            "first_cell_bytes": statistics.mean(one["first_bytes"] for one in measured),
            "bytes_per_second": total("bytes") / seconds, "cells_entered": total("entered"),
            "bytes_per_cell": total("bytes") / max(1, total("entered")),
            "bytes_per_cell_95": float(np.percentile(between, 95)) if between else 0.0,
            "pending_percent": 100 * total("pending") / seconds, "missing_percent": 100 * total("missing") / seconds,
            "pictures": pictures, "wrong_pictures_percent": 100 * total("wrong") / pictures if pictures else None,
            "wrong_pixels_percent": 100 * total("wrong_pixels") / pictures if pictures else None}


def text_of(row):
    wrong = "" if row["wrong_pictures_percent"] is None else f"{row['wrong_pictures_percent']:.2f} %"
    return (f"{row['scene']} | {row['meters_per_second']:g} m/s | {row['first_cell_seconds']:.2f} s | "
            f"{row['bytes_per_second'] / 1000:.1f} KB/s | {row['cells_entered']} | {row['bytes_per_cell'] / 1000:.1f} KB | "
            f"{row['bytes_per_cell_95'] / 1000:.1f} KB | {row['pending_percent']:.2f} % | {row['missing_percent']:.2f} % | {wrong}")


def parsed():
    parser = argparse.ArgumentParser()
    parser.add_argument("--bin", required=True)
    parser.add_argument("--walks", type=int, default=3)
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--speeds", type=float, nargs="+", default=[1.5, 6])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--rate", default="10")
    parser.add_argument("--round-trip", default="40")
    parser.add_argument("--parallel", type=int, default=1, help="walks at a time, each with its own slow connection")
    parser.add_argument("--no-pictures", action="store_true")
    parser.add_argument("--keep", metavar="FOLDER")
    parser.add_argument("--site", action="append", required=True, dest="sites", metavar="NAME=FOLDER")
    result_files.add_option(parser)
    return parser.parse_args()


def main():
    arguments = parsed()
    if nginx_server.PROGRAM is None:
        print("nginx is not installed (scripts/bootstrap --tests)", file=sys.stderr)
        return 77
    sites = dict(site.split("=", 1) for site in arguments.sites)
    rows = []
    print("scene | speed | first cell | B/s | new cells | B per cell | p95 | pending | missing | wrong")
    with tempfile.TemporaryDirectory() as temporary, nginx_server.Nginx(sites) as server, \
            concurrent.futures.ThreadPoolExecutor(arguments.parallel) as pool:
        for name, site in sites.items():
            walks = walks_of(arguments, name, Cells(open_site(site)), arguments.keep or temporary)
            measured = list(pool.map(lambda walk: measured_walk(arguments, server, name, walk), walks))
            if not arguments.no_pictures:
                list(pool.map(lambda pair: compare(arguments, server, name, *pair), zip(walks, measured)))
            for speed in arguments.speeds:
                rows.append(row_of(name, speed, [of for walk, of in zip(walks, measured) if walk.speed == speed]))
                print(text_of(rows[-1]), flush=True)
    result_files.write(arguments.results, "stream_walks", "The stream client on walks from cell to cell over a slow connection.",
                       rows, [f"{arguments.rate} Mbit/s and a round trip of {arguments.round_trip} ms for each walk, "
                              f"{arguments.parallel} walks at a time.",
                              "Walks go from cell to adjacent cell, through walls too. From the first complete cell on."])
    return 0


if __name__ == "__main__":
    sys.exit(main())
