"""The tables and rows of version 0, written from the last chapter of format/SPEC.md alone."""
import struct

from pvs_parts import crc32c, need, unpack

DRAWS, CELLS, ROWS, DIRECTORY, CERTIFICATE = 1, 2, 3, 4, 5
REQUIRED = (DRAWS, CELLS, ROWS, DIRECTORY)
FLAGGED = REQUIRED
OPTIONAL = (CERTIFICATE, 6)  # 6: settings


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


def runs_of(numbers):
    runs = []
    for number in sorted(numbers):
        if runs and runs[-1][1] == number:
            runs[-1][1] += 1
        else:
            runs.append([number, number + 1])
    return runs


def most_runs(rows_size):
    return rows_size // 2


def row_records(directory, chunks, cells):
    records = [struct.unpack_from("<II", directory, 16 * chunks + 8 * cell) for cell in range(cells)]
    return [records[64 * chunk:64 * chunk + 64] for chunk in range(chunks)]


def check_filled(records, size):
    """Rows lie in the order of the first cell that uses them, and fill the chunk."""
    place, known = 0, set()
    for record in records:
        need(record[1] > 0 and sum(record) <= size, "row leaves its chunk")
        if record[0] == place:
            place += record[1]
        else:
            need(record in known, "rows do not follow each other")
        known.add(record)
    need(place == size, "bytes behind the last row")


def decode_chunk(chunk, records, polygons):
    check_filled(records, len(chunk))

    def decode(cell, depth):
        need(cell < len(records), "reference leaves the chunk")
        offset, size = records[cell]
        data = Varints(chunk[offset:offset + size])
        head = data.next()
        if head & 1 == 0:
            answer = data.runs(head >> 1, polygons)
        else:
            need(depth < 2, "references too deep")
            reference, added, removed_size = data.next(), data.next(), data.next()
            base = decode(reference, depth + 1)
            end = data.at + removed_size
            removed = data.runs(head >> 1, polygons)
            need(data.at == end and removed <= base, "removed runs")
            base -= removed
            more = data.runs(added, polygons)
            need(not (more & base), "added runs")
            answer = base | more
        need(data.at == len(data.data), "bytes behind the row")
        return answer

    return [runs_of(decode(cell, 0)) for cell in range(len(records))]


def draws_of(header, section):
    need(len(section) == 48 * header.draws, "size of the draw table")
    draws, place = [], 0
    for i in range(header.draws):
        draw = struct.unpack_from("<10IQ", section, 48 * i)
        need(draw[5] == 0 and draw[6] == draw[8] == place, "draw")
        place += draw[7]
        draws.append(draw)
    need(place == header.polygons, "draws do not have all polygons")
    return draws


def decode_tables(header, parts, contents):
    contents.draws = draws_of(header, parts[DRAWS])
    contents.borders = [draw[8] for draw in contents.draws]
    contents.source_of_stored = range(header.polygons)
    need(len(parts[CELLS]) == 24 * header.cells, "size of the cells")
    contents.boxes = [struct.unpack_from("<6f", parts[CELLS], 24 * i) for i in range(header.cells)]
    if CERTIFICATE in parts:
        need(len(parts[CERTIFICATE]) == 40 * header.cells, "size of the certificate")
        contents.certificate = [struct.unpack_from("<QQddQ", parts[CERTIFICATE], 40 * i) for i in range(header.cells)]


def row_decoder(header, parts, chunks):
    need(len(parts[DIRECTORY]) == 16 * chunks + 8 * header.cells, "size of the row directory")
    records = row_records(parts[DIRECTORY], chunks, header.cells)
    return lambda number, chunk, cells: decode_chunk(chunk, records[number], header.polygons)
