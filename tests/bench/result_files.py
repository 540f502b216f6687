"""Measured rows as CSV files, one per table: what tests/bench/results holds and BENCHMARKS.md is generated from.

A file begins with lines "# key: value" (what, command, commit, machine, any number of note), then a header and its rows.
A benchmark script takes --results DIR (add_option) and calls write once per table.
"""
import csv
import io
import os
import shlex
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
FOLDER = os.path.join(ROOT, "tests", "bench", "results")


def add_option(parser):
    parser.add_argument("--results", metavar="DIR",
                        help="also write each table to DIR as a CSV file (tests/bench/results holds the published ones)")


def commit():
    """The commit that is checked out, with "+" where tracked files differ from it; "unknown" outside a clone."""
    try:
        asked = ["git", "-C", ROOT, "describe", "--always", "--abbrev=7", "--dirty=+", "--exclude=*"]
        return subprocess.run(asked, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return "unknown"


def machine():
    """The processor's name and how many cores this process may use."""
    name = "unknown processor"
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as stream:
            name = next(line.split(":", 1)[1].strip() for line in stream if line.startswith("model name"))
    except (OSError, StopIteration):
        pass
    return f"{name}, {len(os.sched_getaffinity(0))} cores"


def command():
    """The command line of this script, without --results and without folders that say nothing elsewhere."""
    words, own = [os.path.relpath(os.path.abspath(sys.argv[0]), ROOT)], list(sys.argv[1:])
    while own:
        word = own.pop(0)
        if word == "--results":
            own.pop(0)
        elif not word.startswith("--results="):
            words.append(short(word))
    return shlex.join(words)


def short(word):
    if not os.path.isabs(word):
        return word
    return os.path.relpath(word, ROOT) if word.startswith(ROOT + os.sep) else os.path.basename(word)


def text_of(value):
    if value is None:
        return ""
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def write(folder, name, what, rows, notes=(), **facts):
    """Writes DIR/name.csv; does nothing where folder is None. rows: dicts with the same keys. facts: replace those of
    this run (command, commit, machine)."""
    if folder is None:
        return
    lines = {"what": what, "command": command(), "commit": commit(), "machine": machine(), **facts}
    out = io.StringIO()
    for key, value in [*lines.items(), *(("note", note) for note in notes)]:
        out.write(f"# {key}: {value}\n")
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(rows[0])
    for row in rows:
        if list(row) != list(rows[0]):
            raise ValueError(f"{name}.csv: a row has other columns than the first")
        writer.writerow([text_of(value) for value in row.values()])
    os.makedirs(folder, exist_ok=True)
    path = os.path.join(folder, name + ".csv")
    with open(path + ".part", "w", encoding="utf-8") as stream:
        stream.write(out.getvalue())
    os.replace(path + ".part", path)


def read(path):
    """Facts and rows of a file: a dict (note: a list), and dicts of text."""
    facts, lines = {"note": []}, []
    with open(path, encoding="utf-8") as stream:
        for line in stream:
            if lines or not line.startswith("# "):
                lines.append(line)
                continue
            key, value = line[2:].rstrip("\n").split(": ", 1)
            if key == "note":
                facts["note"].append(value)
            else:
                facts[key] = value
    return facts, list(csv.DictReader(lines))
