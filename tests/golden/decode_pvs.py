#!/usr/bin/env python3
"""Decodes a .pvs file of version 1 or 0, written from format/SPEC.md alone: proof that the text says enough.

usage: decode_pvs.py FILE.pvs [--expect FILE.txt]
Prints the contents as text; with --expect compares them with a file instead and fails when they differ. A file that
breaks a rule is refused in one line, with the status that SPEC.md says.
"""
import bisect
import math
import struct
import sys

sys.dont_write_bytecode = True  # nothing is written into the source tree
import decode_v0  # noqa: E402
import decode_v1  # noqa: E402
from pvs_parts import Refused, crc32c, need  # noqa: E402

MAGIC = bytes([0x89, 0x50, 0x56, 0x53, 0x0D, 0x0A, 0x1A, 0x0A])
ROWS, DIRECTORY, SETTINGS, IMPORTANCE, NAMED_GROUPS, VIEWPOINTS, EYES, IDENTITY, CASTERS = 3, 4, 6, 9, 11, 12, 13, 15, 17
RESIDENCY, LIGHTS = 18, 19
VERSIONS = {0: decode_v0, 1: decode_v1}


class Header:
    def __init__(self, data):
        need(len(data) >= 8, "no whole header", "truncated" if MAGIC.startswith(data) else "not_ours")
        need(data[:8] == MAGIC, "not a .pvs file", "not_ours")
        need(len(data) >= 12, "no whole header", "truncated")
        self.version = struct.unpack_from("<I", data, 8)[0]
        need(self.version in VERSIONS, f"version {self.version}", "version")
        need(len(data) >= 96, "no whole header", "truncated")
        need(crc32c(data[:92]) == struct.unpack_from("<I", data, 92)[0], "header", "checksum")
        self.sections, total = struct.unpack_from("<IQ", data, 12)
        need(len(data) >= total, "bytes are missing", "truncated")
        need(len(data) <= total, "bytes behind the end")
        self.fingerprint = data[24:40].hex()
        (self.polygons, layout, self.margin, self.error, self.confidence, self.flags, self.cells, self.draws,
         self.run_bound, self.range_bound, self.list_bound, self.slack,
         self.table_checksum) = struct.unpack_from("<IIfffIIIIIIfI", data, 40)
        self.merged = layout == 1
        self.volumes = 0
        self.begins = None  # of clusters, in stored polygons
        need(layout < 2 and self.flags < 2, "host layout or flags")
        need(0 <= self.margin < math.inf, "margin")
        need(0 <= self.error <= 1 and 0 <= self.confidence <= 1 and 0 <= self.slack <= 1, "share")
        if self.version == 0:
            need(not self.merged and not any(data[80:88]), "layout or reserved bytes of the header")
        need(self.sections <= 64 and self.polygons <= 4294967294 and self.cells <= 16777216 and
             self.draws <= 67108864 and self.margin <= 1000000, "header", "limit")
        self.cells_of_chunks = [min(64, self.cells - first) for first in range(0, self.cells, 64)]

    def check_bounds(self, most_runs):
        need(self.run_bound <= min(self.items(), most_runs) and self.list_bound <= most_runs, "run or list bound")
        draws = self.draws + (self.volumes > 0)
        need(self.run_bound <= self.range_bound <= (self.run_bound + draws if self.run_bound else 0), "range bound")

    def items(self):
        """Polygons, or clusters, and volumes behind them: what sets are of."""
        return (self.polygons if self.begins is None else len(self.begins)) + self.volumes


def sections_of(data, header, version):
    required = version.REQUIRED
    table = data[96:96 + 32 * header.sections]
    need(len(table) == 32 * header.sections, "section table is cut")
    need(crc32c(table) == header.table_checksum, "section table", "checksum")
    found, place = {}, 96 + len(table)
    for i in range(header.sections):
        number, flags, offset, size, checksum, reserved = struct.unpack_from("<IIQQII", table, 32 * i)
        need(offset == place and flags < 2 and reserved == 0, "section record")
        place += size
        need(place <= len(data), "section leaves the file")
        never_required = number in (IMPORTANCE, NAMED_GROUPS, VIEWPOINTS, EYES, IDENTITY, CASTERS, RESIDENCY,
                                    LIGHTS)
        need(not never_required or flags == 0, f"required section {number}", "version")
        if number in required or number in version.OPTIONAL:
            need(number not in found, "section is there twice")
            need(flags == (number in version.FLAGGED), "section flags")
        else:
            need(flags == 0, f"required section {number}", "version")
        need(crc32c(data[offset:place]) == checksum, f"section {number}", "checksum")
        found[number] = data[offset:place]
    need(place == len(data), "bytes behind the last section")
    need(all(number in found for number in required), "section missing")
    need(len(found.get(SETTINGS, b"")) <= 16777216, "settings", "limit")
    return found


class Contents:
    """What a file holds. Members that only one of the versions sets begin as if there were none."""

    def __init__(self, data):
        self.header = header = Header(data)
        version = VERSIONS[header.version]
        parts = sections_of(data, header, version)
        self.orders, self.lattice, self.certificate, self.volume_shape, self.volumes = [], None, [], None, []
        self.named_groups, self.named_group_of_draw = [], []
        self.player_radius, self.viewpoints, self.eyes = 0, [], []
        self.identity, self.clusters = [], []
        self.settings = parts.get(SETTINGS, b"").decode("utf-8", "backslashreplace")
        version.decode_tables(header, parts, self)
        header.check_bounds(version.most_runs(len(parts[ROWS])))
        self.check_records()
        self.sets = list(self.decode_sets(parts, version))
        self.importance = []
        if IMPORTANCE in version.OPTIONAL and IMPORTANCE in parts:
            sizes = [len(self.polygons_in(cell)) for cell in range(header.cells)]
            self.importance = version.decode_importance(parts[IMPORTANCE], sizes, header.cells_of_chunks)
        self.suns, self.caster_proofs, self.casters = [], [], []
        if CASTERS in version.OPTIONAL and CASTERS in parts:
            self.suns, self.caster_proofs, self.casters = version.decode_casters(header, parts[CASTERS])
        self.residency = None
        if RESIDENCY in version.OPTIONAL and RESIDENCY in parts:
            self.residency = version.decode_residency(header, parts[RESIDENCY])
        self.lights, self.lights_of_cells = [], []
        if LIGHTS in version.OPTIONAL and LIGHTS in parts:
            self.lights, self.lights_of_cells = version.decode_lights(header, parts[LIGHTS])

    def check_records(self):
        for box in self.boxes:
            need(all(map(math.isfinite, box)) and all(box[axis] < box[axis + 3] for axis in range(3)), "cell")
        for rays, misses, bound, sure, _ in self.certificate:
            need(misses <= rays and 0 <= bound <= 1 and 0 <= sure <= 1, "certificate")

    def decode_sets(self, parts, version):
        """The set of every cell as runs of stored numbers. Checks the bounds over all of them."""
        directory, rows = parts[DIRECTORY], parts[ROWS]
        chunks = self.header.cells_of_chunks
        decode_chunk = version.row_decoder(self.header, parts, len(chunks))
        place, most_runs, most_ranges = 0, 0, 0
        borders = sorted(set(self.borders + [self.header.polygons] * (self.header.volumes > 0)))
        for number, cells in enumerate(chunks):
            offset, size, checksum = struct.unpack_from("<QII", directory, 16 * number)
            need(offset == place and offset + size <= len(rows), "chunk of rows")
            place += size
            need(crc32c(rows[offset:place]) == checksum, f"chunk {number}", "checksum")
            for runs in decode_chunk(number, rows[offset:place], cells):
                ranges = sum(bisect.bisect_left(borders, end) - bisect.bisect_right(borders, first) + 1
                             for first, end in runs)
                most_runs, most_ranges = max(most_runs, len(runs)), max(most_ranges, ranges)
                yield runs
        need(place == len(rows), "bytes behind the last chunk")
        need(most_runs == self.header.run_bound, "run bound")
        need(most_ranges == self.header.range_bound, "range bound")

    def polygons_in(self, cell):
        """Stored numbers."""
        polygons = self.header.polygons
        return [number for first, end in self.sets[cell] for number in range(first, min(end, polygons))]

    def volumes_in(self, cell):
        polygons = self.header.polygons
        return [number - polygons for first, end in self.sets[cell] for number in range(max(first, polygons), end)]

    def seen(self, cell):
        """Ascending source ids."""
        return sorted(self.source_of_stored[number] for number in self.polygons_in(cell))

    def classes(self, cell):
        """By ascending source ids."""
        stored = self.polygons_in(cell)
        pairs = sorted(zip((self.source_of_stored[number] for number in stored), self.importance[cell]))
        return [one for _, one in pairs]

    def text(self):
        header = self.header
        yield f"version {header.version}"
        yield f"fingerprint {header.fingerprint}"
        yield f"polygons {header.polygons}"
        yield f"margin {header.margin:.9g}"
        yield f"max_pixel_error {header.error:.9g}"
        yield f"confidence {header.confidence:.9g}"
        if header.version > 0:
            yield f"slack {header.slack:.9g}"
        if header.merged:
            yield "layout merged"
        yield f"repeatable {1 - header.flags}"
        yield f"settings {self.settings}"
        for i, draw in enumerate(self.draws):
            yield f"draw {i}: " + " ".join(map(str, draw))
        for i, name in enumerate(self.named_groups):
            yield f"named group {i}: " + name.decode("utf-8", "backslashreplace")
        for i, group in enumerate(self.named_group_of_draw):
            if group > 0:
                yield f"named group of draw {i}: {group - 1}"
        for i, order in enumerate(self.orders):
            yield f"order {i}:" + "".join(f" {polygon}" for polygon in order)
        for i, sizes in enumerate(self.clusters):
            yield f"clusters of order {i}:" + "".join(f" {size}" for size in sizes)
        if self.lattice is not None:
            yield "%s %.17g %.17g" % self.lattice
        for i, box in enumerate(self.boxes):
            seen = "".join(f" {polygon}" for polygon in self.seen(i))
            yield f"cell {i}: {box_text(box)}  sees{seen}"
        if self.volumes:
            yield "volumes %.17g %.17g" % self.volume_shape
            for i, place in enumerate(self.volumes):
                yield f"volume {i}: %d %d %d" % place
            for i in range(header.cells):
                yield f"volumes of {i}:" + "".join(f" {volume}" for volume in self.volumes_in(i))
        for i, (rays, misses, bound, sure, seed) in enumerate(self.certificate):
            yield f"certificate {i}: {rays} {misses} {bound:.17g} {sure:.17g} {seed}"
        if self.viewpoints:
            yield f"player_radius {self.player_radius:.9g}"
        for i, (valid, outside, _) in enumerate(self.viewpoints):
            yield f"viewpoints {i}: {valid:.9g} {outside:.9g}"
        for i, (_, _, parts) in enumerate(self.viewpoints):
            for box, inside in parts:
                yield f"{'inside' if inside else 'outside'} of {i}: {box_text(box)}"
        for i, eyes in enumerate(self.eyes):
            for eye in eyes:
                yield f"eye of {i}: " + " ".join(f"{value:.9g}" for value in eye)
        for i, (geometry, node, mesh) in enumerate(self.identity):
            if geometry is not None:
                yield f"geometry hash of draw {i}: {geometry:016x}"
            if node is not None:
                yield f"node of draw {i}: {node}"
            if mesh is not None:
                yield f"mesh of draw {i}: {mesh}"
        for i in range(len(self.importance)):
            yield f"importance {i}:" + "".join(f" {one}" for one in self.classes(i))
        for i, sun in enumerate(self.suns):
            yield f"sun {i}: " + " ".join(f"{value:.9g}" for value in sun)
        for i, (runs, (rays, misses, bound, sure, seed)) in enumerate(zip(self.casters, self.caster_proofs)):
            of = f"{i // len(self.suns)} {i % len(self.suns)}"
            ids = sorted(self.source_of_stored[number] for first, end in runs for number in range(first, end))
            yield f"casters {of}:" + "".join(f" {polygon}" for polygon in ids)
            yield f"certificate of casters {of}: {rays} {misses} {bound:.17g} {sure:.17g} {seed}"
        if self.residency:
            yield from self.residency_lines()
        for i, (record, proof, runs) in enumerate(self.lights):
            node, *numbers = record
            at, along, (reach, cone) = ([f"{v:.9g}" for v in part] for part in (numbers[:3], numbers[3:6], numbers[6:]))
            yield f"light {i}: node {node} at {' '.join(at)} along {' '.join(along)}, range {reach}, cone {cone}"
            ids = sorted(self.source_of_stored[number] for first, end in runs for number in range(first, end))
            yield f"polygons of light {i}:" + "".join(f" {polygon}" for polygon in ids)
            rays, misses, bound, sure, seed = proof
            yield f"certificate of light {i}: {rays} {misses} {bound:.17g} {sure:.17g} {seed}"
        for i, lights in enumerate(self.lights_of_cells):
            yield f"lights of cell {i}:" + "".join(f" {light}" for light in lights)

    def residency_lines(self):
        pixels, anisotropy, textures, levels = self.residency
        yield f"residency: {pixels:.9g} pixels per radian, anisotropy {anisotropy:.9g}"
        for i, (image, width, height) in enumerate(textures):
            yield f"texture {i}: image {image}, {width} x {height}"
        for i, own in enumerate(levels):
            yield f"levels {i}:" + "".join(f" {level}" for level in own)


def box_text(box):
    numbers = ["%.9g" % value for value in box]
    return f"{' '.join(numbers[:3])}  {' '.join(numbers[3:])}"


def decode(data):
    return "".join(line + "\n" for line in Contents(data).text())


def main(arguments):
    if len(arguments) not in (1, 3) or (len(arguments) == 3 and arguments[1] != "--expect"):
        print(__doc__, file=sys.stderr)
        return 2
    with open(arguments[0], "rb") as file:
        data = file.read()
    try:
        text = decode(data)
    except Refused as refusal:
        print(f"{arguments[0]}: {refusal}", file=sys.stderr)
        return 1
    if len(arguments) == 1:
        print(text, end="")
        return 0
    with open(arguments[2], encoding="utf-8") as file:
        same = file.read() == text
    if not same:
        print(f"{arguments[0]}: the contents differ from {arguments[2]}", file=sys.stderr)
    return 0 if same else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
