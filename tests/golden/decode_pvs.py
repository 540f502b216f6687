#!/usr/bin/env python3
"""Decodes a .pvs file of version 0, written from format/SPEC.md alone: proof that the text says enough.

usage: decode_pvs.py FILE.pvs [--expect FILE.txt]
Prints the contents as text; with --expect compares them with a file instead and fails when they differ.
"""
import struct
import sys

MAGIC = bytes([0x89, 0x50, 0x56, 0x53, 0x0D, 0x0A, 0x1A, 0x0A])
DRAWS, CELLS, ROWS, DIRECTORY, CERTIFICATE, SETTINGS = 1, 2, 3, 4, 5, 6


def crc32c(data):
    crc = 0xFFFFFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc >> 1) ^ (0x82F63B78 if crc & 1 else 0)
    return crc ^ 0xFFFFFFFF


def need(condition, what):
    if not condition:
        raise ValueError(what)


class Varints:
    def __init__(self, data):
        self.data, self.at = data, 0

    def next(self):
        value, shift = 0, 0
        while True:
            need(self.at < len(self.data) and shift < 35, "varint runs out")
            byte = self.data[self.at]
            self.at += 1
            value |= (byte & 0x7F) << shift
            if byte < 0x80:
                need(byte != 0 or shift == 0, "varint is not the shortest")
                need(value < 1 << 32, "varint above 32 bits")
                return value
            shift += 7

    def runs(self, count, polygons):
        numbers, end = set(), -1
        for _ in range(count):
            first = end + 1 + self.next()
            end = first + self.next() + 1
            need(end <= polygons, "run leaves the scene")
            numbers.update(range(first, end))
        return numbers


def sections_of(data):
    count = struct.unpack_from("<I", data, 12)[0]
    need(count <= 64, "too many sections")
    table = data[96:96 + 32 * count]
    need(len(table) == 32 * count, "section table is cut")
    need(crc32c(table) == struct.unpack_from("<I", data, 88)[0], "section table checksum")
    found, place = {}, 96 + 32 * count
    for i in range(count):
        number, flags, offset, size, checksum, reserved = struct.unpack_from("<IIQQII", table, 32 * i)
        need(offset == place and flags < 2 and reserved == 0, "section record")
        place += size
        need(place <= len(data), "section leaves the file")
        need(crc32c(data[offset:place]) == checksum, "section checksum")
        if number in (DRAWS, CELLS, ROWS, DIRECTORY, CERTIFICATE, SETTINGS):
            need(number not in found and flags == (number < CERTIFICATE), "section flags")
            found[number] = data[offset:place]
        else:
            need(flags == 0, "required section of another version")
    need(place == len(data), "bytes behind the last section")
    need(all(number in found for number in (DRAWS, CELLS, ROWS, DIRECTORY)), "section missing")
    return found


def decode_cells(rows, directory, cells, polygons):
    chunks = (cells + 63) // 64
    need(len(directory) == 16 * chunks + 8 * cells, "directory size")

    def row(cell):
        offset, size, checksum = struct.unpack_from("<QII", directory, 16 * (cell // 64))
        chunk = rows[offset:offset + size]
        need(len(chunk) == size and crc32c(chunk) == checksum, "chunk checksum")
        offset, size = struct.unpack_from("<II", directory, 16 * chunks + 8 * cell)
        need(size > 0 and offset + size <= len(chunk), "row leaves its chunk")
        return chunk[offset:offset + size]

    def decode(cell, depth):
        data = Varints(row(cell))
        head = data.next()
        if head & 1 == 0:
            answer = data.runs(head >> 1, polygons)
        else:
            need(depth < 2, "references too deep")
            reference, added, removed_size = data.next(), data.next(), data.next()
            base = decode(cell // 64 * 64 + reference, depth + 1)
            end = data.at + removed_size
            removed = data.runs(head >> 1, polygons)
            need(data.at == end and removed <= base, "removed runs")
            base -= removed
            more = data.runs(added, polygons)
            need(not (more & base), "added runs")
            answer = base | more
        need(data.at == len(data.data), "bytes behind the row")
        return answer

    return [sorted(decode(cell, 0)) for cell in range(cells)]


def decode(data):
    need(data[:8] == MAGIC, "not a .pvs file")
    version, _, total = struct.unpack_from("<IIQ", data, 8)
    need(version == 0, "version")
    need(total == len(data), "size")
    need(crc32c(data[:92]) == struct.unpack_from("<I", data, 92)[0], "header checksum")
    polygons, layout, margin, error, confidence, flags, cells, draws = struct.unpack_from("<IIfffIII", data, 40)
    need(layout == 0 and flags < 2, "header")
    parts = sections_of(data)
    lines = ["version 0", "fingerprint " + data[24:40].hex(), f"polygons {polygons}", f"margin {margin:.9g}",
             f"max_pixel_error {error:.9g}", f"confidence {confidence:.9g}", f"repeatable {1 - flags}",
             "settings " + parts.get(SETTINGS, b"").decode("utf-8")]
    need(len(parts[DRAWS]) == 48 * draws and len(parts[CELLS]) == 24 * cells, "table sizes")
    for i in range(draws):
        lines.append(f"draw {i}: " + " ".join(map(str, struct.unpack_from("<10IQ", parts[DRAWS], 48 * i))))
    for i, seen in enumerate(decode_cells(parts[ROWS], parts[DIRECTORY], cells, polygons)):
        box = ["%.9g" % value for value in struct.unpack_from("<6f", parts[CELLS], 24 * i)]
        lines.append(f"cell {i}: {' '.join(box[:3])}  {' '.join(box[3:])}  sees" + "".join(f" {p}" for p in seen))
    if CERTIFICATE in parts:
        need(len(parts[CERTIFICATE]) == 40 * cells, "certificate size")
        for i in range(cells):
            rays, misses, bound, sure, seed = struct.unpack_from("<QQddQ", parts[CERTIFICATE], 40 * i)
            lines.append(f"certificate {i}: {rays} {misses} {bound:.17g} {sure:.17g} {seed}")
    return "\n".join(lines) + "\n"


def main(arguments):
    if len(arguments) not in (1, 3) or (len(arguments) == 3 and arguments[1] != "--expect"):
        print(__doc__, file=sys.stderr)
        return 2
    with open(arguments[0], "rb") as file:
        text = decode(file.read())
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
