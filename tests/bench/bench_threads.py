#!/usr/bin/python3
"""Bakes scenes with one thread and with two in turn: what the second thread costs, and how much of a bake is parallel.

usage: bench_threads.py --bin FOLDER [--source NAME] [--rounds N] [--cell-limit N] [--quick] [--results DIR] [--json-file OUT.json]
                        [SCENE.glb[=CELLS.json] ...] [-- OPTION ...]

--bin: the folder with sightcell and sightcell-city. Without a scene: the city's preset vienna800k with its twenty cells,
made under $SIGHTCELL_CACHE (default build/cache). After -- options of `sightcell bake`. --quick: a small town, a few
cells, one round. Medians of --rounds pairs (3), the two bakes of a pair one right after the other.

  CPU 2/1     CPU seconds (user and system) of the bake with two threads through those of the bake with one
  wall 1/2    how much sooner it ends; says something only where two cores have nothing else to do
  busy        wall through CPU seconds of the bake with one thread: 1 on an idle machine
  parallel    Amdahl's share of the CPU seconds of the bake with two threads that was in parallel sections. Serial is what
              the calling thread computes more than the worker before and after the cells; and of the cells the share of
              the time in which one of the two had nothing to do, where a thread that waits for a core has something to do.
              By /proc (schedstat), so that others who use the machine change nothing but the noise
  cells       the same of the cells alone, without loading, building trees and writing the file; what the last cells leave
              to one thread counts as serial
"""
import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import threading
import time

sys.dont_write_bytecode = True  # nothing is written into the sources
import result_files  # noqa: E402


def fail(text):
    sys.exit(f"bench_threads: {text}")


def thread_seconds(process):
    """For each thread of a process the seconds so far that it ran, and that it ran or waited for a core."""
    out = {}
    folder = f"/proc/{process}/task"
    try:
        for thread in os.listdir(folder):
            with open(f"{folder}/{thread}/schedstat", encoding="ascii") as stream:
                ran, waited = (int(word) * 1e-9 for word in stream.read().split()[:2])
            out[int(thread)] = (ran, ran + waited)
    except OSError:  # it has just ended
        pass
    return out


class Watch(threading.Thread):
    """Follows the threads of a bake with two: the calling one and TBB's worker, then one more that drives the cells in the
    calling one's place, for as long as there are cells."""

    def __init__(self, process):
        super().__init__(daemon=True)
        self.process, self.ended = process, False
        self.last, self.driver, self.before, self.after, self.wall = {}, None, None, None, 0.0

    def run(self):
        began = 0.0
        while not self.ended:
            now, at = thread_seconds(self.process), time.monotonic()
            new = set(now) - set(self.last)
            if len(self.last) == 2 and len(new) == 1:
                self.driver, = new
                self.before, began = dict(self.last), at - now[self.driver][1]
            if self.driver in now:
                self.after, self.wall = now, at - began
            self.last.update(now)
            time.sleep(0.01)

    def shares(self):
        """Parallel share of everything and of the cells; nothing where the threads are not those of lanes."""
        if self.driver is None or len(self.last) != 3:
            return None
        worker, = (t for t in self.before if t != self.process)

        def during_cells(kind):
            return self.after[self.driver][kind] + self.after[worker][kind] - self.before[worker][kind]

        idle = max(2.0 * self.wall - during_cells(1), 0.0) / during_cells(1)
        total = sum(ran for ran, _ in self.last.values())
        around = self.last[self.process][0] - (self.last[worker][0] - during_cells(0) + self.after[self.driver][0])
        return 1.0 - (max(around, 0.0) + idle * during_cells(0)) / total, 1.0 - idle


def bake(options, scene, cells, threads, folder):
    output = os.path.join(folder, f"{threads}.pvs")
    command = [os.path.join(options.bin, "sightcell"), "bake", scene, "-o", output, "--fresh", "--threads", str(threads),
               "--source", options.source, "--progress", "none"]
    command += ["--cells-file", cells] if cells else []
    command += ["--cell-limit", str(options.cell_limit)] if options.cell_limit else []
    command += options.more
    start = time.monotonic()
    try:
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    except FileNotFoundError:
        fail(f"{command[0]} is not there; build it: cmake --build --preset release")
    watch = Watch(process.pid)
    watch.start()
    said = process.stderr.read()
    watch.ended = True
    _, status, usage = os.wait4(process.pid, 0)
    wall = time.monotonic() - start
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode not in (0, 3):
        fail(f"{' '.join(command)} ended with {process.returncode}: {said.strip().splitlines()[-1:]}")
    watch.join()
    with open(output, "rb") as stream:
        content = stream.read()
    return {"cpu": usage.ru_utime + usage.ru_stime, "wall": wall, "memory": usage.ru_maxrss * 1024,
            "shares": watch.shares() if threads == 2 else None, "bytes": content}


def measure(options, scene, cells):
    rounds = []
    with tempfile.TemporaryDirectory(prefix="sightcell-threads-") as folder:
        for number in range(options.rounds):
            # Who goes first changes, so that a machine that gets busier favors nobody.
            order = (1, 2) if number % 2 == 0 else (2, 1)
            pair = {threads: bake(options, scene, cells, threads, folder) for threads in order}
            if pair[1]["bytes"] != pair[2]["bytes"]:
                fail(f"{scene}: one and two threads gave other bytes")
            one, two = pair[1], pair[2]
            rounds.append({"cpu_1": one["cpu"], "cpu_2": two["cpu"], "wall_1": one["wall"], "wall_2": two["wall"],
                           "memory_1": one["memory"], "memory_2": two["memory"], "ratio": two["cpu"] / one["cpu"],
                           "speedup": one["wall"] / two["wall"], "busy": one["wall"] / one["cpu"],
                           "parallel": two["shares"][0] if two["shares"] else None,
                           "cells": two["shares"][1] if two["shares"] else None})
            print(f"bench_threads: {os.path.basename(scene)}, round {number + 1}: CPU {one['cpu']:.1f} and "
                  f"{two['cpu']:.1f} s, wall {one['wall']:.1f} and {two['wall']:.1f} s", file=sys.stderr, flush=True)
    row = {"scene": os.path.basename(scene), "rounds": rounds}
    for key in rounds[0]:
        values = [r[key] for r in rounds if r[key] is not None]
        row[key] = statistics.median(values) if values else None
    return row


def town(options):
    """The scene to bake where none is named: (scene, cells)."""
    folder = os.path.join(os.environ.get("SIGHTCELL_CACHE", "build/cache"), "bench_threads")
    os.makedirs(folder, exist_ok=True)
    name = "town" if options.quick else "vienna800k"
    scene, cells = os.path.join(folder, name + ".glb"), os.path.join(folder, name + ".cells.json")
    if not (os.path.exists(scene) and (options.quick or os.path.exists(cells))):
        command = [os.path.join(options.bin, "sightcell-city"), "--seed", "1", "--out", scene]
        command += ["--polygons", "20000"] if options.quick else ["--preset", "vienna800k", "--cells", cells]
        if subprocess.run(command, stdout=subprocess.DEVNULL, check=False).returncode != 0:
            fail("the city could not be made")
    return scene, None if options.quick else cells


def published(row, options):
    return {"scene": os.path.splitext(row["scene"])[0], "cells": options.cell_limit or "all", "options": " ".join(options.more),
            "cpu_seconds_1": row["cpu_1"], "cpu_seconds_2": row["cpu_2"], "ratio": row["ratio"],
            "parallel_percent": row["parallel"] and 100.0 * row["parallel"],
            "parallel_percent_of_cells": row["cells"] and 100.0 * row["cells"],
            "peak_mib_1": row["memory_1"] / 2**20, "peak_mib_2": row["memory_2"] / 2**20}


def percent(value):
    return "-" if value is None else f"{100.0 * value:.1f} %"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True)
    parser.add_argument("--source", default="cpu")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--cell-limit", type=int, default=0)
    parser.add_argument("--quick", action="store_true")
    result_files.add_option(parser)
    parser.add_argument("--json-file")
    parser.add_argument("scenes", nargs="*")
    own, more = sys.argv[1:], []
    if "--" in own:
        at = own.index("--")
        own, more = own[:at], own[at + 1:]
    options = parser.parse_args(own)
    options.more = more
    if options.quick:
        options.rounds, options.cell_limit = 1, 6
    scenes = [tuple((name.split("=", 1) + [None])[:2]) for name in options.scenes] or [town(options)]
    rows = [measure(options, scene, cells) for scene, cells in scenes]
    print(f"source {options.source}, {options.rounds} rounds, options: {' '.join(more) or 'none'}\n")
    print("| scene | CPU s, 1 thread | 2 threads | CPU 2/1 | wall 1/2 | busy | parallel | cells | peak memory, 1 thread |"
          " 2 threads |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for r in rows:
        print(f"| {r['scene']} | {r['cpu_1']:.1f} | {r['cpu_2']:.1f} | {r['ratio']:.2f} | {r['speedup']:.2f} |"
              f" {r['busy']:.2f} | {percent(r['parallel'])} | {percent(r['cells'])} |"
              f" {r['memory_1'] / 2**20:.0f} MiB | {r['memory_2'] / 2**20:.0f} MiB |")
    result_files.write(options.results, "threads", "A bake with one thread and with two, in turns; the bytes of the files are equal.",
                       [published(r, options) for r in rows], [f"--source {options.source}, medians of {options.rounds} pairs."])
    if options.json_file:
        with open(options.json_file, "w", encoding="utf-8") as stream:
            json.dump(rows, stream, indent=1)


if __name__ == "__main__":
    main()
