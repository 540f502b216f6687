#!/usr/bin/env python3
"""The Python decoder refuses every damaged file with the status that is listed for it, and reads those that have none.

usage: golden_errors_test.py FOLDER [--say]: with statuses.txt. --say: prints what each is refused for.
"""
import os
import sys

sys.dont_write_bytecode = True  # nothing is written into the source tree
from decode_pvs import Contents  # noqa: E402
from pvs_parts import Refused  # noqa: E402


def outcome(path):
    with open(path, "rb") as file:
        data = file.read()
    try:
        Contents(data)
    except Refused as refusal:
        return refusal.status, str(refusal)
    return "ok", "ok"


def main(folder, say=None):
    with open(os.path.join(folder, "statuses.txt"), encoding="utf-8") as file:
        listed = [line.split() for line in file]
    wrong = 0
    for name, expected in listed:
        status, why = outcome(os.path.join(folder, name))
        if say is not None:
            print(f"{name}: {why}")
        if status != expected:
            print(f"{name}: {expected} was expected, not: {why}", file=sys.stderr)
            wrong += 1
    return 0 if listed and wrong == 0 else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
