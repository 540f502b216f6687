#!/usr/bin/python3
"""Runs sightcell info, and a tiny bake, on every broken scene of $SIGHTCELL_DATA/malformed and prints a table.

usage: bench_malformed.py --bin FOLDER [--data FOLDER] [--info-only] [--program PROGRAM] [--results DIR]

--bin: the folder with the program sightcell, of any build; --program: the program itself. --info-only: no bakes.
Fails (exit code 1) when a run is ended by a signal, takes more than 1 GiB or 60 s, ends with a code that is not for such
files, prints no or more than one line of error, or one that does not name file, cause and id. Exit code 77: no data.
"""
import argparse
import os
import re
import subprocess
import sys
import tempfile
import threading

sys.dont_write_bytecode = True  # nothing is written into the sources
import result_files  # noqa: E402

MEMORY_BOUND = 1 << 30  # bytes
HANG_BOUND = 60         # seconds
ERROR = re.compile(r"sightcell: (?P<subject>[^:]+): (?P<cause>.+); (?P<remedy>[^;]+) \[(?P<id>[a-z]+\.[a-z0-9-]+)\]")
DONE, BOUND_NOT_MET, BAD_INPUT = 0, 3, 4


class Run:
    """One run of a program: exit code (negative: a signal), output lines, CPU seconds, peak memory in bytes."""

    def __init__(self, command):
        with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
            child = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=out, stderr=err)
            self.hung = False

            def end():
                self.hung = True
                child.kill()
            timer = threading.Timer(HANG_BOUND, end)
            timer.start()
            _, status, usage = os.wait4(child.pid, 0)
            timer.cancel()
            child.returncode = self.code = os.waitstatus_to_exitcode(status)
            self.output, self.errors = (self.lines(stream) for stream in (out, err))
        self.cpu = usage.ru_utime + usage.ru_stime
        self.memory = usage.ru_maxrss * 1024

    @staticmethod
    def lines(stream):
        stream.seek(0)
        return stream.read().decode(errors="replace").splitlines()

    def warnings(self):
        return [line.split("warning", 1)[1].lstrip(": ") for line in self.output + self.errors
                if line.lstrip().startswith("warning")]

    def error(self):
        """The match of the one line of error, or None."""
        found = [line for line in self.errors if line.startswith("sightcell: ")]
        return ERROR.fullmatch(found[0]) if len(found) == 1 else None


def problems(run, path):
    if run.hung:
        return [f"did not end within {HANG_BOUND} s"]
    if run.code < 0:
        return [f"was ended by signal {-run.code}"]
    found = []
    if run.memory > MEMORY_BOUND:
        found.append(f"took {run.memory >> 20} MiB")
    if run.code in (DONE, BOUND_NOT_MET):
        if any(line.startswith("sightcell: ") for line in run.errors):
            found.append("prints an error and succeeds")
    elif run.code == BAD_INPUT:
        error = run.error()
        if error is None:
            found.append("does not print exactly one line of error with file, cause, remedy and id")
        elif os.path.basename(path) not in error["subject"]:
            found.append("has an error that does not name the file")
    else:
        found.append(f"ended with code {run.code}")
    return found


def outcome(info, bake):
    if info.code == BAD_INPUT:
        return "refused", info.error()
    if bake is not None and bake.code == BAD_INPUT:
        error = bake.error()
        return ("nothing to see" if error and error["id"] == "bake.nothing-to-see" else "loads, bake refused"), error
    loads = "loads with warning" if info.warnings() else "loads"
    return (loads if bake is None else "bakes with warning" if info.warnings() else "bakes"), None


def scene_files(folder):
    found = []
    for place, _, names in os.walk(folder):
        found += [os.path.join(place, name) for name in names if name.endswith((".glb", ".gltf"))]
    return sorted(found)


def message_of(info, bake):
    kind, error = outcome(info, bake)
    if error is not None:
        return kind, f"{error['cause']} [{error['id']}]"
    return kind, "; ".join(dict.fromkeys(info.warnings()))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin")
    parser.add_argument("--program")
    parser.add_argument("--data", default=os.environ.get("SIGHTCELL_DATA", ""))
    parser.add_argument("--info-only", action="store_true")
    result_files.add_option(parser)
    options = parser.parse_args()
    program = options.program or os.path.join(options.bin or ".", "sightcell")
    folder = os.path.join(options.data, "malformed")
    files = scene_files(folder)
    if not files:
        print(f"skipped: no scenes in {folder}; SIGHTCELL_DATA names the folder of real scenes")
        return 77
    rows, failures, counts = [], [], {}
    with tempfile.TemporaryDirectory() as scratch:
        for path in files:
            info = Run([program, "info", path])
            runs = [info]
            if not options.info_only:
                runs.append(Run([program, "bake", path, "-o", os.path.join(scratch, "out.pvs"), "--fresh", "--cell-limit",
                                 "2", "--max-pixel-error", "1e-2", "--progress", "none"]))
            name = os.path.relpath(path, folder)
            for verb, run in zip(("info", "bake"), runs):
                failures += [f"{name}: {verb} {problem}" for problem in problems(run, path)]
            if any(run.code < 0 for run in runs):
                kind, message = "killed", ""
            else:
                kind, message = message_of(info, runs[1] if len(runs) > 1 else None)
            counts[kind] = counts.get(kind, 0) + 1
            rows.append({"file": name, "outcome": kind, "message": message, "cpu_seconds": sum(run.cpu for run in runs),
                         "peak_mib": max(run.memory for run in runs) / (1 << 20)})
    print("| file | outcome | message | CPU s | peak MiB |\n|---|---|---|---|---|")
    for row in rows:
        message = row["message"].replace("|", "\\|")
        print(f"| {row['file']} | {row['outcome']} | {message} | {row['cpu_seconds']:.2f} | {row['peak_mib']:.0f} |")
    print(f"\n{len(files)} files: " + ", ".join(f"{count} {kind}" for kind, count in sorted(counts.items())))
    result_files.write(options.results, "malformed", "Every broken scene through sightcell info" +
                       ("." if options.info_only else " and sightcell bake --cell-limit 2 --max-pixel-error 1e-2."), rows)
    for failure in failures:
        print(f"FAILED {failure}", file=sys.stderr)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
