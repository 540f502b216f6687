#!/usr/bin/python3
"""Kills a bake again and again, fills its disk and damages its checkpoint: what is lost, and is any file wrong?

usage: bench_kills.py --bin FOLDER [--kills N] [--damaged N] [--seed N] [--quick] [--results DIR] [--json-file OUT.json]
                      [-- OPTION ...]

--bin: the folder with sightcell and sightcell-city. After -- options of the bake that is killed. --quick: smaller bakes
and fewer of everything. The seed decides moments and damages; where a kill by the clock lands is up to the machine.

  kills    SIGKILL at random moments, at random calls that bring the checkpoint to the disk, and while the .pvs file is
           written; each is followed by the same command, which may be killed again. Lost: cells that were reported as
           finished and not taken up again. The calls are hit by strace; without it all but the clock's kills and those
           of a poll for the temporary file are left out, which is said
  disk     a disk of a few pages fills up at every point of a bake; then room is made, and the same command goes on
  damaged  bits flipped in the checkpoint, the file cut off, its journal removed: refused by name or right in the end

wrong: an output file that is not the undisturbed bake's, a file left over at the end, a command that does not end well.
Exit code 1 when anything was lost or wrong.
"""
import argparse
import collections
import contextlib
import json
import os
import random
import re
import shutil
import sqlite3
import subprocess
import sys
import tempfile
import time

sys.dont_write_bytecode = True  # nothing is written into the sources
import result_files  # noqa: E402
from kills.victim import SmallDisk, Victim, own_mounts  # noqa: E402

PAGE = 4096
STATES = 4  # unfinished bakes that are damaged in turn
# Of a hundred kills so many are aimed at commits and so many at the writing of the file.
AT_COMMITS, AT_WRITING = 25, 20
COMMIT_CALLS = ("fdatasync", "pwrite64")
# One call each of the way from all cells to a finished bake: file flushed, renamed, folder flushed, checkpoint removed.
WRITING_CALLS = (("fsync", 1), ("rename", 1), ("fsync", 2), ("unlink", 1), ("exit_group", 1))


def strace(call, number):
    return ["strace", "-f", "-qqq", "-o", "/dev/null", "-e", f"trace={call}", "-e",
            f"inject={call}:signal=KILL:when={number}"]


def has_strace():
    try:
        return subprocess.run(["strace", "-f", "-o", "/dev/null", "true"], capture_output=True).returncode == 0
    except FileNotFoundError:
        return False


def commit_counts(victim):
    """How often the thread that commits makes each of these calls in an undisturbed bake."""
    with tempfile.NamedTemporaryFile("r") as log:
        victim.run(before=["strace", "-f", "-qqq", "-o", log.name, "-e", "trace=" + ",".join(COMMIT_CALLS)])
        victim.clear()
        threads = collections.Counter()
        for line in log:
            thread, call = line.split("(")[0].split()[:2]
            threads[call, thread] += 1
    return {call: max((n for (name, _), n in threads.items() if name == call), default=1) for call in COMMIT_CALLS}


class Tally:
    """What happened to one sort of disturbance."""

    def __init__(self):
        self.times = self.cells = self.lost = self.wrong = 0

    def row(self):
        return {"times": self.times, "cells_reported": self.cells, "cells_lost": self.lost, "wrong": self.wrong}


class Bench:
    def __init__(self, seed):
        self.random = random.Random(seed)
        self.tallies, self.notes = {}, []

    def tally(self, sort):
        return self.tallies.setdefault(sort, Tally())

    def wrong(self, sort, what):
        self.tally(sort).wrong += 1
        self.notes.append(f"{sort}: {what}")

    def must_finish(self, victim, sort, reported, *more):
        """The same command, undisturbed: takes up what was reported, gives the bytes of an undisturbed bake."""
        self.must_have_finished(victim, sort, reported, victim.run(*more))

    def must_have_finished(self, victim, sort, reported, ended):
        if ended.code != 0:
            self.wrong(sort, f"ended with {ended.code}: {ended.error_lines}")
        elif victim.content() != victim.whole:
            self.wrong(sort, "other bytes in the end")
        elif victim.left():
            self.wrong(sort, f"left {victim.left()}")
        else:
            self.lose(sort, reported, ended.resumed)
        victim.clear()

    def lose(self, sort, reported, resumed):
        if reported > resumed:
            self.tally(sort).lost += reported - resumed
            self.notes.append(f"{sort}: {reported} cells were reported, {resumed} resumed")


# --- kills

class Kills(Bench):
    def __init__(self, seed, victim, kills):
        super().__init__(seed)
        self.victim, self.wanted, self.done = victim, kills, 0
        self.traced = has_strace()
        began = time.monotonic()
        victim.whole = reference(victim)
        self.seconds = time.monotonic() - began
        self.commits = commit_counts(victim) if self.traced else {}

    def plan(self):
        aimed = self.wanted * AT_COMMITS // 100 if self.traced else 0
        writing = self.wanted * AT_WRITING // 100
        sorts = ["commit"] * aimed + ["writing"] * writing + ["clock"] * (self.wanted - aimed - writing)
        self.random.shuffle(sorts)
        return sorts

    def kill(self, sort):
        if sort == "clock":
            return self.victim.run(kill_after=self.random.uniform(0.0, 1.05 * self.seconds))
        if sort == "commit":
            call = self.random.choice(COMMIT_CALLS)
            return self.victim.run(before=strace(call, self.random.randint(1, self.commits[call])))
        # Half of them by a poll: between the calls, and all of them where there is no strace.
        if not self.traced or self.random.random() < 0.5:
            return self.victim.run(kill_when=self.victim.is_writing)
        return self.victim.run(before=strace(*self.random.choice(WRITING_CALLS)))

    def landed(self, sort, ended):
        """Where a kill hit."""
        if sort == "commit":
            return "in a commit"
        if self.victim.is_writing() or (self.victim.content() is not None and os.path.exists(self.victim.checkpoint)):
            return "while writing"
        if self.victim.content() is not None:
            return "at the end"
        return "in cells" if ended.reported > 0 else "before cells"

    def run(self):
        plan = self.plan()
        while plan:
            self.chain(plan)

    def chain(self, plan):
        """One bake from its first start to its end, killed once or several times in between."""
        reported, last, ended = 0, None, None
        while plan and (last is None or self.random.random() < 0.75):
            ended = self.kill(plan[-1])
            if ended.code == 0:  # it was quicker: the kill is still to come, in another bake
                break
            last = self.landed(plan.pop(), ended)
            tally = self.tally(last)
            tally.times += 1
            if ended.code != -9:
                self.wrong(last, f"ended with {ended.code} on its own: {ended.error_lines}")
            if ended.resumed is not None:
                self.lose(last, reported, ended.resumed)
            reported = max(reported, ended.reported)
            if self.victim.is_wrong():
                self.wrong(last, "an output with other bytes")
            if self.victim.content() is not None and not os.path.exists(self.victim.checkpoint):
                reported = 0  # it was done
                break
            tally.cells += ended.reported
        if ended.code == 0:
            self.must_have_finished(self.victim, last or "none", reported, ended)
        else:
            self.must_finish(self.victim, last, reported)


def reference(victim):
    ended = victim.run()
    if ended.code != 0:
        sys.exit(f"bench_kills: the undisturbed bake ends with {ended.code}:\n" + "\n".join(ended.lines))
    whole = victim.content()
    victim.clear()
    return whole


# --- disk

class Disk(Bench):
    """The disk fills up after so many pages, for every number of pages that is too small."""

    def __init__(self, seed, victim, step):
        super().__init__(seed)
        self.victim, self.step = victim, step
        victim.whole = reference(victim)

    def run(self):
        with SmallDisk(self.victim.folder, 64 << 20) as disk:
            free = PAGE
            while self.fill(disk, free):
                free += self.step * PAGE

    def fill(self, disk, free):
        """Did the bake meet the end of the disk?"""
        disk.leave(free)
        ended = self.victim.run()
        if ended.code == 0:
            if self.victim.content() != self.victim.whole:
                self.wrong("full disk", f"other bytes with {free} bytes free")
            return False
        sort = "full disk: " + (ended.error() or "no line of error")
        tally = self.tally(sort)
        tally.times += 1
        tally.cells += ended.reported
        if ended.code != 1 or ended.error() not in ("bake.disk-space", "checkpoint.disk-full", "checkpoint.not-writable",
                                                      "output.io"):
            self.wrong(sort, f"{free} bytes free: ends with {ended.code}: {ended.error_lines}")
        if self.victim.is_wrong() or self.victim.is_writing():
            self.wrong(sort, f"{free} bytes free: leaves {self.victim.left()}")
        disk.make_room()
        self.must_finish(self.victim, sort, ended.reported)
        return True


# --- damage

class Damage(Bench):
    def __init__(self, seed, victim, variants):
        super().__init__(seed)
        self.victim, self.variants = victim, variants
        victim.whole = reference(victim)

    def half_done(self):
        """Files of bakes that were killed in the middle: after some cells, and in a commit where strace can."""
        states, aimed = [], has_strace()
        commits = commit_counts(self.victim)["fdatasync"] if aimed else 0
        for i in range(4 * STATES):
            if aimed and i % 2 == 1:
                ended = self.victim.run(before=strace("fdatasync", self.random.randint(commits // 3, commits - 1)))
            else:
                ended = self.victim.run(kill_at_cell=self.random.randint(2, 12))
            files = {name: self.read(name) for name in self.victim.left()}
            self.victim.clear()
            if ended.code != 0 and os.path.basename(self.victim.checkpoint) in files:
                states.append(files)
            if len(states) == STATES:
                return states
        sys.exit("bench_kills: the small bake is over too soon to be killed")

    def read(self, name):
        with open(os.path.join(self.victim.folder, name), "rb") as file:
            return file.read()

    def run(self):
        states = self.half_done()
        for i in range(self.variants):
            files = dict(self.random.choice(states))
            sort = self.damage(files, i)
            for name, content in files.items():
                with open(os.path.join(self.victim.folder, name), "wb") as out:
                    out.write(content)
            self.try_it(sort)

    def damage(self, files, number):
        """Changes the files; says how."""
        name = os.path.basename(self.victim.checkpoint)
        beside = [other for other in files if other != name]
        sort = ("flipped", "cut off", "zeroed", "beside gone", "beside flipped", "flipped", "renumbered")[number % 7]
        if sort.startswith("beside") and not beside:
            sort = "flipped"
        if sort == "renumbered":
            self.renumber(files)
            return sort
        if sort == "beside gone":
            for other in beside:
                del files[other]
            return sort
        if sort == "beside flipped":
            name = self.random.choice(beside)
        content = bytearray(files[name])
        if content and sort.endswith("flipped"):
            for _ in range(self.random.choice((1, 1, 1, 4, 64))):
                content[self.random.randrange(len(content))] ^= 1 << self.random.randrange(8)
        elif sort == "zeroed":
            at = self.random.randrange(len(content) // 512) * 512
            content[at:at + 512] = bytes(512)
        else:
            del content[self.random.randrange(len(content)):]
        files[name] = bytes(content)
        return sort

    def renumber(self, files):
        """One record says that it is another's: a flipped bit of its number, which a checksum of its bytes does not see."""
        path = os.path.join(self.victim.folder, "renumbered")
        for name, content in files.items():
            with open(path + name.removeprefix(os.path.basename(self.victim.checkpoint)), "wb") as out:
                out.write(content)
        with contextlib.closing(sqlite3.connect(path, isolation_level=None)) as database:
            for table, sql in database.execute("SELECT name, sql FROM sqlite_schema WHERE type='table'").fetchall():
                key = re.search(r"(\w+) INTEGER PRIMARY KEY", sql)
                numbers = database.execute(f"SELECT {key.group(1)} FROM {table}").fetchall() if key else []
                if numbers:
                    one = self.random.choice(numbers)[0]
                    database.execute(f"UPDATE OR REPLACE {table} SET {key.group(1)}=? WHERE {key.group(1)}=?",
                                     (one ^ 1 << self.random.randrange(5), one))
            database.execute("PRAGMA journal_mode=DELETE")
        files.clear()
        with open(path, "rb") as file:
            files[os.path.basename(self.victim.checkpoint)] = file.read()
        self.victim.clear()

    @staticmethod
    def is_refused(ended):
        """By name. A damaged version cannot be told from another version."""
        of_version = ended.code == 2 and "differs in scene, settings or version;" in ended.error_lines[0]
        return (ended.code == 4 or of_version) and (ended.error() or "").startswith("checkpoint.")

    def try_it(self, sort):
        tally = self.tally(sort)
        tally.times += 1
        ended = self.victim.run()
        if ended.code == 0:
            if self.victim.content() != self.victim.whole or self.victim.left():
                self.wrong(sort, f"other bytes in the end, or something left: {self.victim.left()}")
            self.victim.clear()
        elif self.is_refused(ended) and self.victim.content() is None:
            self.tally("refused, then --fresh").times += 1
            self.must_finish(self.victim, "refused, then --fresh", 0, "--fresh")
        else:
            self.wrong(sort, f"ends with {ended.code}: {ended.error_lines}")
            self.victim.clear()


# --- all of it

def print_table(title, bench):
    print(f"\n{title}")
    print(f"{'':<34}{'times':>7}{'cells reported':>16}{'cells lost':>12}{'wrong':>7}")
    for sort, tally in sorted(bench.tallies.items()):
        print(f"{sort:<34}{tally.times:>7}{tally.cells:>16}{tally.lost:>12}{tally.wrong:>7}")
    for note in bench.notes:
        print(f"  {note}")
    sys.stdout.flush()


def make_city(folder, binaries, polygons):
    city = os.path.join(folder, f"city-{polygons}.glb")
    subprocess.run([os.path.join(binaries, "sightcell-city"), "--polygons", str(polygons), "--seed", "1", "--out", city],
                   check=True, capture_output=True)
    return city


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True)
    parser.add_argument("--kills", type=int)
    parser.add_argument("--damaged", type=int)
    parser.add_argument("--seed", type=int)
    parser.add_argument("--quick", action="store_true")
    result_files.add_option(parser)
    parser.add_argument("--json-file")
    parser.add_argument("options", nargs="*", metavar="-- OPTION")
    options = parser.parse_args()
    quick = options.quick
    seed = options.seed if options.seed is not None else 1 if quick else random.SystemRandom().randrange(1 << 32)
    kills = options.kills if options.kills is not None else 10 if quick else 100
    damaged = options.damaged if options.damaged is not None else 14 if quick else 200
    print(f"seed {seed}" + ("" if has_strace() else "; no strace here: no kills are aimed at single calls"))

    mounts = own_mounts()
    folder = tempfile.mkdtemp(prefix="sightcell-kills-")
    try:
        small = ["--cell-limit", "24", "--samples", "6", "--resolution", "32", "--max-pixel-error", "5e-2"]
        large = options.options or (small if quick else ["--cell-limit", "64", "--samples", "16", "--resolution", "128",
                                                         "--max-pixel-error", "2e-3"])
        program = os.path.join(options.bin, "sightcell")
        town = make_city(folder, options.bin, 500)
        scene = town if quick else make_city(folder, options.bin, 2000)

        benches = {}
        bench = benches["kills"] = Kills(seed, Victim(program, scene, os.path.join(folder, "kills"), large), kills)
        bench.run()
        print_table(f"kills of a bake of {bench.seconds:.1f} s", bench)
        if mounts:
            bench = benches["disk"] = Disk(seed, Victim(program, town, os.path.join(folder, "disk"), small),
                                           12 if quick else 1)
            bench.run()
            print_table("full disks", bench)
        else:
            print("\nfull disks: left out, only root can mount a small one")
        bench = benches["damaged"] = Damage(seed, Victim(program, town, os.path.join(folder, "damaged"), small), damaged)
        bench.run()
        print_table("damaged checkpoints", bench)
    finally:
        shutil.rmtree(folder, ignore_errors=True)

    rows = {name: {sort: tally.row() for sort, tally in bench.tallies.items()} for name, bench in benches.items()}
    result_files.write(options.results, "kills", "Bakes that are killed, run out of disk or find a damaged checkpoint: lost cells and "
                       "wrong files.", [{"event": f"{name}: {sort}", **tally.row()} for name, bench in benches.items() for sort, tally in sorted(bench.tallies.items())])
    if options.json_file:
        with open(options.json_file, "w", encoding="utf-8") as out:
            json.dump({"seed": seed, "seconds": benches["kills"].seconds, **rows}, out, indent=2)
    bad = [note for bench in benches.values() for note in bench.notes]
    print(f"\n{len(bad)} lost or wrong" if bad else "\nnothing lost, nothing wrong")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
