"""The tables and rows of version 1, written from format/SPEC.md alone."""
import math
import struct

from pvs_parts import MASK32, PADDING, Bits, code_table, crc32c, need, packed_columns, unpack, with_raw_bits

DRAWS, CELLS, ROWS, DIRECTORY, CERTIFICATE, SETTINGS, ORDERS, CODES, IMPORTANCE = 1, 2, 3, 4, 5, 6, 7, 8, 9
VOLUMES, NAMED_GROUPS, VIEWPOINTS, EYES, BORDERS, IDENTITY, CLUSTERS, CASTERS = 10, 11, 12, 13, 14, 15, 16, 17
RESIDENCY, LIGHTS = 18, 19
REQUIRED = (DRAWS, CELLS, ROWS, DIRECTORY, ORDERS, CODES)
OPTIONAL = (CERTIFICATE, SETTINGS, IMPORTANCE, VOLUMES, NAMED_GROUPS, VIEWPOINTS, EYES, BORDERS, IDENTITY, CLUSTERS,
            CASTERS, RESIDENCY, LIGHTS)
FLAGGED = REQUIRED + (VOLUMES, BORDERS, CLUSTERS)
CLASSES = 16
FURTHEST = 1 << 27  # chunk of a lattice, in x and z
FURTHEST_LAYER = 1 << 30
FURTHEST_VOLUME = 1 << 30
MOST_VOLUMES = 16777216
MOST_NAMES = 16777216  # bytes
MOST_REGION = 65536  # bytes
DEEPEST = 18  # leaf of a region
LARGEST_CLUSTER = 256  # polygons
LONGEST_RUN = 64  # of an order in a file with clusters
MOST_TEXTURES = 65536
MOST_LIGHTS = 65536
MOST_TEXELS = 65536  # along a side of a texture
MOST_ITEMS = 4294967294  # polygons and volumes


def most_runs(rows_size):
    return 4 * rows_size


def whole_columns(section, columns, rows, what, at=0):
    values, end = packed_columns(section, at, columns, rows)
    need(end == len(section), f"bytes behind {what}")
    return values


def decode_orders(section, in_runs):
    count = unpack("<I", section, 0, "orders")[0]
    (polygons, firsts), at = packed_columns(section, 4, 2, count + 1)
    for column in (polygons, firsts):
        need(column[0] == 0 and all(a <= b for a, b in zip(column, column[1:])), "orders do not follow each other")
    code, at = code_table(section, at)
    lengths = None
    if in_runs:
        lengths, at = code_table(section, at)
    need(at + firsts[-1] + PADDING == len(section), "size of the orders")
    orders = []
    for i in range(count):
        end = at + firsts[i + 1]
        bits = Bits(section, 8 * (at + firsts[i]), 8 * end)
        order, expected = [], 0
        while len(order) < polygons[i + 1] - polygons[i]:
            number = code.number(bits)
            step = -(number + 1) // 2 if number & 1 else number // 2
            first = (expected + step) & MASK32
            more = lengths.number(bits) if in_runs else 0
            need(more < LONGEST_RUN, "run of an order is too long")
            order.extend(range(first, first + more + 1))
            expected = order[-1] + 1
        need((bits.at + 7) // 8 == end, "a permutation does not end where the next begins")
        need(sorted(order) == list(range(len(order))), "an order is no permutation")
        orders.append(order)
    return orders


def decode_clusters(header, section, orders, draws):
    """Per order the polygons of its clusters. Sets the columns of the header: where each cluster begins in stored
    polygons."""
    (firsts,), at = packed_columns(section, 0, 1, len(orders) + 1)
    need(firsts[0] == 0 and all(a <= b for a, b in zip(firsts, firsts[1:])), "clusters do not follow each other")
    need(firsts[-1] <= sum(map(len, orders)), "more clusters than polygons")
    sizes = whole_columns(section, 1, firsts[-1], "the clusters", at)[0]
    need(all(1 <= size <= LARGEST_CLUSTER for size in sizes), "polygons of a cluster")
    of_order = [sizes[a:b] for a, b in zip(firsts, firsts[1:])]
    need(all(sum(own) == len(order) for own, order in zip(of_order, orders)), "clusters have not the polygons of an order")
    header.begins, stored = [], 0
    for number in range(len(orders)) if header.merged else [draw[-1] for draw in draws]:
        for size in of_order[number]:
            header.begins.append(stored)
            stored += size
    return of_order


def decode_draws(header, section, orders):
    """The draws as version 0 has them, with flags and the number of the order behind; the source id of every polygon; and
    where ranges begin."""
    need(header.draws <= 8 * len(section), "more draws than bits")
    columns = whole_columns(section, 13, header.draws, "the draw table")
    firsts = columns[8] + [header.polygons]
    need(firsts[0] == 0 and all(a <= b for a, b in zip(firsts, firsts[1:])), "draws do not follow each other")
    draws, named = [], 0
    for row, end in zip(zip(*columns), firsts[1:]):
        node, mesh, primitive, instance, material, group, order, source, stored, base, tag_low, tag_high, flags = row
        need(order <= named and flags < 2, "draw")
        named = max(named, order + 1)
        need(source + end - stored <= header.polygons, "draw leaves the scene")
        draws.append((node, mesh, primitive, instance, material, group, source, end - stored, stored, base,
                      tag_high << 32 | tag_low, flags, order))
    need(named == len(orders), "orders that no draw names")
    sources, borders = [], []
    for unit in draw_groups(draws) if header.merged else single_draws(draws):
        unpermuted = [source + i for draw in unit for source in [draw[6]] for i in range(draw[7])]
        order = orders[unit[0][-1]]
        need(len(order) == len(unpermuted), "an order has not as many polygons as its draws")
        borders.append(len(sources))
        sources.extend(unpermuted[polygon] for polygon in order)
    need(sorted(sources) == list(range(header.polygons)), "a source id is not there once")
    return draws, sources, borders


def single_draws(draws):
    need(all(draw[5] == 0 for draw in draws), "draw group")
    return [[draw] for draw in draws]


def draw_groups(draws):
    groups = []
    for draw in draws:
        group, source, order = draw[5], draw[6], draw[-1]
        need(order == group, "order of a draw group")
        if group == len(groups):
            groups.append([draw])
            continue
        need(group == len(groups) - 1, "draw groups do not ascend")
        before = groups[-1][-1]
        need(draw[4] == before[4] and not draw[11] and not before[11], "draws of a group")
        need(source >= before[6] + before[7], "draws of a group are not in the order of the source")
        groups[-1].append(draw)
    return groups


def to_float(value):
    try:
        return struct.unpack("<f", struct.pack("<f", value))[0]
    except OverflowError:
        return math.inf


def box_of_steps(width, height, first, last):
    return tuple(to_float(corner[axis] * size)
                 for corner in (first, last) for axis, size in enumerate((width, height, width)))


def chunk_boxes(width, height, chunk):
    x, y, z, level, mask = chunk
    width, height = math.ldexp(width, -level), math.ldexp(height, -level)
    for bit in range(64):
        if mask >> bit & 1:
            place = (8 * x + bit % 8, y, 8 * z + bit // 8)
            yield box_of_steps(width, height, place, [at + 1 for at in place])


def decode_lattice(header, section):
    """The lattice as (word for its kind, width, height), and the boxes of the cells."""
    width, height, count = unpack("<ddI", section, 4, "lattice")
    need(0 < width < math.inf and 0 < height < math.inf, "shape of the lattice")
    boxes, last = [], ()
    for x, y, z, level, first, low, high in zip(*whole_columns(section, 7, count, "the lattice", 24)):
        x, y, z = x - (1 << 31), y - (1 << 31), z - (1 << 31)
        need(-FURTHEST <= x < FURTHEST and -FURTHEST <= z < FURTHEST, "chunk of the lattice is too far away")
        need(-FURTHEST_LAYER <= y < FURTHEST_LAYER and level <= 31, "layer or level of the lattice")
        need(first == len(boxes) and (low or high), "cells of a lattice's chunk")
        need(last < (level, z, x, y), "chunks of the lattice do not ascend")
        last = (level, z, x, y)
        boxes.extend(chunk_boxes(width, height, (x, y, z, level, high << 32 | low)))
    need(len(boxes) == header.cells, "the lattice does not have all cells")
    return ("lattice", width, height), boxes


def decode_grid(header, section):
    """As decode_lattice."""
    width, height = unpack("<dd", section, 4, "grid")
    need(0 < width < math.inf and 0 < height < math.inf, "step of the grid")
    boxes = []
    for row in zip(*whole_columns(section, 6, header.cells, "the grid", 20)):
        first, steps = [number - (1 << 31) for number in row[:3]], row[3:]
        need(min(steps) >= 1, "cell of the grid without a step")
        boxes.append(box_of_steps(width, height, first, [at + more for at, more in zip(first, steps)]))
    return ("grid", width, height), boxes


def decode_cells(header, section):
    kind = unpack("<I", section, 0, "cells")[0]
    need(kind in (0, 1, 2), "kind of cells")
    if kind > 0:
        return (decode_lattice if kind == 1 else decode_grid)(header, section)
    need(len(section) == 4 + 24 * header.cells, "size of the cells")
    return None, [struct.unpack_from("<6f", section, 4 + 24 * i) for i in range(header.cells)]


def as_float(bits):
    return struct.unpack("<f", struct.pack("<I", bits))[0]


def proofs_of(columns):
    return [(rays_high << 32 | rays, misses_high << 32 | misses, as_float(bound), as_float(sure), seed_high << 32 | seed)
            for rays, rays_high, misses, misses_high, bound, sure, seed, seed_high in zip(*columns)]


def decode_certificate(header, section):
    return proofs_of(whole_columns(section, 8, header.cells, "the certificate"))


def decode_volumes(header, section):
    """The lattice, and the place of every volume."""
    width, height, count = unpack("<ddI", section, 0, "volumes")
    need(count <= MOST_VOLUMES and header.polygons + count <= MOST_ITEMS, "volumes", "limit")
    need(0 < width < math.inf and 0 < height < math.inf, "shape of the volumes")
    need(0 < count <= 8 * len(section), "number of volumes")
    places = []
    for place in zip(*whole_columns(section, 3, count, "the volumes", 20)):
        place = tuple(value - (1 << 31) for value in place)
        need(all(-FURTHEST_VOLUME <= value < FURTHEST_VOLUME for value in place), "volume is too far away")
        low, high = ([to_float((value + more) * size) for value, size in zip(place, (width, height, width))]
                     for more in (0, 1))
        need(all(math.isfinite(a) and math.isfinite(b) and a < b for a, b in zip(low, high)), "box of a volume")
        places.append(place)
    need(len(set(places)) == len(places), "two volumes at one place")
    return (width, height), places


def decode_named_groups(header, section, draws):
    """The names, as bytes; of each draw 0, or one more than the number of its group."""
    count, size = unpack("<II", section, 0, "named groups")
    need(size <= MOST_NAMES, "names", "limit")
    need(0 < count <= size and 8 + size <= len(section), "names")
    (ends,), at = packed_columns(section, 8 + size, 1, count)
    begins = [0] + ends
    need(all(a < b for a, b in zip(begins, ends)) and ends[-1] == size, "names do not follow each other")
    groups = whole_columns(section, 1, header.draws, "the named groups", at)[0]
    need(max(groups, default=0) <= count, "a named group that there is not")
    if header.merged:
        of_draw_group = {draw[5]: group for draw, group in zip(draws, groups)}
        need(all(of_draw_group[draw[5]] == group for draw, group in zip(draws, groups)), "draws of a group")
    return [section[8 + a:8 + b] for a, b in zip(begins, ends)], groups


def decode_region(region, grown):
    """The parts of the grown box as (box, whether it is inside), box as min x, y, z, max x, y, z."""
    if not region:
        return [(grown, True)]
    bits, parts = Bits(region, 0, 8 * len(region)), []

    def node(box, depth):
        kind = bits.take(2)
        need(kind < 3, "node of a region")
        if kind < 2:
            need(depth > 0, "the root of a region is no split")
            parts.append((box, kind == 1))
            return
        need(depth < DEEPEST, "leaf of a region is too deep")
        sides = [to_float(box[axis + 3] - box[axis]) for axis in range(3)]
        axis = sides.index(max(sides))
        middle = to_float(0.5 * to_float(box[axis] + box[axis + 3]))
        need(box[axis] < middle < box[axis + 3], "a side has no middle")
        node(box[:axis + 3] + (middle,) + box[axis + 4:], depth + 1)
        node(box[:axis] + (middle,) + box[axis + 1:], depth + 1)

    node(grown, 0)
    need((bits.at + 7) // 8 == len(region), "bytes behind a region")
    need(bits.take(8 * len(region) - bits.at) == 0, "bits behind a region")
    need(any(inside for _, inside in parts), "nothing is inside a region")
    return parts


def decode_viewpoints(header, section, boxes):
    """The player radius; of each cell the share that is valid, the share that is outside, and the parts of its box."""
    radius = unpack("<f", section, 0, "viewpoints")[0]
    need(0 < radius < math.inf, "player radius")
    columns, at = packed_columns(section, 4, 3, header.cells)
    records, begin = [], 0
    for valid, outside, end in zip(*columns):
        need(begin <= end, "regions do not ascend")
        need(end - begin <= MOST_REGION, "region", "limit")
        valid, outside = as_float(valid), as_float(outside)
        need(0 < valid <= 1 and 0 <= outside <= 1 and (end > begin or outside == 0), "shares of viewpoints")
        records.append((valid, outside, section[at + begin:at + end]))
        begin = end
    need(at + begin == len(section), "regions do not end with the section")
    margin = header.margin
    grown = [tuple(to_float(value - margin) for value in box[:3]) + tuple(to_float(value + margin) for value in box[3:])
             for box in boxes]
    return radius, [(valid, outside, decode_region(region, box)) for (valid, outside, region), box in zip(records, grown)]


def decode_borders(cells, section):
    """The number of cells of every chunk."""
    sizes = []
    for block, (first, low, high) in enumerate(zip(*whole_columns(section, 3, (cells + 63) // 64, "the borders"))):
        begins = [place for place in range(64) if (high << 32 | low) >> place & 1]
        end = min(64, cells - 64 * block)
        need(first == len(sizes) and begins[:1] == [0] and begins[-1] < end, "chunk borders")
        sizes.extend(b - a for a, b in zip(begins, begins[1:] + [end]))
    return sizes


def below(value):
    """The largest f32 below an f32."""
    if value == 0:
        return -2.0 ** -149
    bits = struct.unpack("<I", struct.pack("<f", value))[0]
    return as_float(bits - 1 if value > 0 else bits + 1)


def decode_eyes(header, section, boxes):
    """The positions of each cell."""
    (ends,), at = packed_columns(section, 0, 1, header.cells)
    begins = [0] + ends[:-1]
    need(all(0 <= end - begin <= 8 for begin, end in zip(begins, ends)), "eyes of a cell")
    columns, at = packed_columns(section, at, 3, ends[-1] if ends else 0)
    need(at == len(section), "bytes behind the eyes")
    need(all(q < 4096 for column in columns for q in column), "eye outside its box")
    positions = []
    for begin, end, box in zip(begins, ends, boxes):
        positions.append([])
        for eye in list(zip(*columns))[begin:end]:
            place = [to_float(low + (high - low) * ((q + 0.5) / 4096)) for q, low, high in zip(eye, box[:3], box[3:])]
            positions[-1].append([below(high) if at >= high else at for at, high in zip(place, box[3:])])
    return positions


def decode_names(columns, text):
    """Names that begin with bytes of the one before."""
    names, before, at = [], b"", 0
    for shared, further in zip(*columns):
        need(shared <= len(before) and 1 <= further <= 255 - shared, "name of a draw")
        before = before[:shared] + text[at:at + further]
        at += further
        need(at <= len(text) and 0 not in before, "text of a name")
        names.append(before.decode("utf-8", "backslashreplace"))
    need(at == len(text), "bytes behind the names")
    return names


def decode_identity(section, draws):
    """Per draw: its hash, or None without polygons; the names of its node and its mesh, or None."""
    need(len(section) >= 16, "identity is cut")
    hashes, names, nodes, meshes = struct.unpack_from("<IIII", section)
    drawn = sorted((draw[6], i) for i, draw in enumerate(draws) if draw[7] > 0)
    need(hashes <= len(drawn) and max(names, nodes, meshes) <= 8 * len(section), "sizes of the identity")
    (of_draw,), at = packed_columns(section, 16, 1, len(drawn))
    (low, high), at = packed_columns(section, at, 2, hashes)
    (of_node,), at = packed_columns(section, at, 1, nodes)
    (of_mesh,), at = packed_columns(section, at, 1, meshes)
    columns, at = packed_columns(section, at, 2, names)
    need(all(number < hashes for number in of_draw), "hash of a draw")
    need(all(number <= names for number in of_node + of_mesh), "name of a node or mesh")
    texts = [None] + decode_names(columns, section[at:])
    of_place = {i: low[number] | high[number] << 32 for number, (_, i) in zip(of_draw, drawn)}
    return [(of_place.get(i), texts[of_node[node]] if node < nodes else None,
             texts[of_mesh[mesh]] if mesh < meshes else None) for i, (node, mesh, *_) in enumerate(draws)]


def decode_tables(header, parts, contents):
    if BORDERS in parts:
        header.cells_of_chunks = decode_borders(header.cells, parts[BORDERS])
    contents.orders = decode_orders(parts[ORDERS], CLUSTERS in parts)
    contents.draws, contents.source_of_stored, contents.borders = decode_draws(header, parts[DRAWS], contents.orders)
    if CLUSTERS in parts:
        contents.clusters = decode_clusters(header, parts[CLUSTERS], contents.orders, contents.draws)
    contents.lattice, contents.boxes = decode_cells(header, parts[CELLS])
    if CERTIFICATE in parts:
        contents.certificate = decode_certificate(header, parts[CERTIFICATE])
    if VOLUMES in parts:
        contents.volume_shape, contents.volumes = decode_volumes(header, parts[VOLUMES])
        header.volumes = len(contents.volumes)
    if NAMED_GROUPS in parts:
        contents.named_groups, contents.named_group_of_draw = decode_named_groups(header, parts[NAMED_GROUPS],
                                                                                  contents.draws)
    if VIEWPOINTS in parts:
        contents.player_radius, contents.viewpoints = decode_viewpoints(header, parts[VIEWPOINTS], contents.boxes)
    if EYES in parts:
        contents.eyes = decode_eyes(header, parts[EYES], contents.boxes)
    if IDENTITY in parts:
        contents.identity = decode_identity(parts[IDENTITY], contents.draws)


class RunCode:
    def __init__(self, gaps, lengths):
        self.gaps, self.lengths = gaps, lengths

    def runs(self, bits, count, limit):
        """So many runs as (first, end), none beyond limit."""
        runs, end = [], -1
        for _ in range(count):
            gap, length = self.gaps.symbol(bits), self.lengths.symbol(bits)
            first = end + 1 + with_raw_bits(gap, bits)
            end = first + with_raw_bits(length, bits) + 1
            need(end <= limit, "run leaves the scene")
            runs.append((first, end))
        return runs


def count_of(bits):
    width = bits.take(5)
    return 1 << (width - 1) | bits.take(width - 1) if width else 0


def numbers_at(ranks, runs):
    """Runs of the numbers that have these ranks among the numbers in runs."""
    found, at, before = [], 0, 0
    for rank, end in ranks:
        while rank < end:
            need(at < len(runs), "rank beyond the last one")
            first, size = runs[at][0], runs[at][1] - runs[at][0]
            if rank >= before + size:
                before += size
                at += 1
                continue
            stop = min(end, before + size)
            found.append((first + rank - before, first + stop - before))
            rank = stop
    return found


def between(runs, limit):
    """Runs of the numbers below limit that are not in runs."""
    borders = [0] + [border for run in runs for border in run] + [limit]
    return [(first, end) for first, end in zip(borders[::2], borders[1::2]) if first < end]


def in_odd_number(*lists):
    """Runs of the numbers that are in one or three of the lists: borders that are there twice cancel out."""
    borders = set()
    for runs in lists:
        for run in runs:
            borders ^= {run[0]}
            borders ^= {run[1]}
    borders = sorted(borders)
    return list(zip(borders[::2], borders[1::2]))


class RowDecoder:
    def __init__(self, header, codes):
        self.header = header
        tables, at = [], 0
        for _ in range(6):
            table, at = code_table(codes, at)
            tables.append(table)
        need(at == len(codes), "bytes behind the code tables")
        self.own, self.removed, self.added = (RunCode(*tables[i:i + 2]) for i in (0, 2, 4))

    def decode_chunk(self, chunk, cells):
        """The sets of its cells, as runs."""
        table = Bits(chunk, 0, 8 * len(chunk))
        width = table.take(8)
        need(width <= 32, "width of the places of rows")
        begins = [table.take(width) for _ in range(cells)]
        rows = chunk[(table.at + 7) // 8:]
        need(len(rows) >= PADDING, "chunk is cut")
        made, ends = {}, {}
        sets = [self.decode_row(rows, begins, cell, made, ends, 0)[0] for cell in range(cells)]
        place = 0
        for cell, begin in enumerate(begins):
            if begin == place:
                place = ends[begin]
            else:
                need(begin in begins[:cell], "rows do not follow each other")
        need(place == len(rows) - PADDING, "bytes behind the last row")
        return [[(self.polygon_at(first), self.polygon_at(end)) for first, end in runs] for runs in sets]

    def polygon_at(self, number):
        """Where a number of a row is in stored polygons and volumes."""
        begins, polygons = self.header.begins, self.header.polygons
        if begins is None:
            return number
        return begins[number] if number < len(begins) else polygons + number - len(begins)

    def decode_row(self, rows, begins, cell, made, ends, followed):
        """The set, and how many references it stands on. made: rows decoded before, by their begin."""
        need(followed <= 2, "references too deep")
        need(cell < len(begins), "reference leaves the chunk")
        begin = begins[cell]
        if begin not in made:
            bits = Bits(rows, 8 * begin, 8 * (len(rows) - PADDING))
            if bits.take(1) == 0:
                count = count_of(bits)
                need(count <= self.header.run_bound, "more runs than the run bound")
                made[begin] = self.own.runs(bits, count, self.header.items()), 0
            else:
                made[begin] = self.decode_difference(bits, rows, begins, made, ends, followed)
            ends[begin] = (bits.at + 7) // 8
        need(followed + made[begin][1] <= 2, "references too deep")
        return made[begin]

    def decode_difference(self, bits, rows, begins, made, ends, followed):
        items = self.header.items()
        reference, removed, added = bits.take(6), count_of(bits), count_of(bits)
        need(max(removed, added) <= self.header.list_bound, "a list above the list bound")
        base, depth = self.decode_row(rows, begins, reference, made, ends, followed + 1)
        gone = numbers_at(self.removed.runs(bits, removed, items), base)
        come = numbers_at(self.added.runs(bits, added, items), between(base, items))
        runs = in_odd_number(base, gone, come)
        need(len(runs) <= self.header.run_bound, "more runs than the run bound")
        return runs, depth + 1


def row_decoder(header, parts, chunks):
    need(len(parts[DIRECTORY]) == 16 * chunks, "size of the chunk directory")
    rows = RowDecoder(header, parts[CODES])
    return lambda number, chunk, cells: rows.decode_chunk(chunk, cells)


class SectionBounds:
    """What RowDecoder needs of a header."""

    begins = None  # also in a file of clusters, the sets of casters and lights are of polygons

    def __init__(self, header, run_bound, list_bound):
        self.polygons, self.run_bound, self.list_bound = header.polygons, run_bound, list_bound

    def items(self):
        return self.polygons


def decode_casters(header, section):
    """The suns as six numbers each; the certificate and the runs of every caster set, by its number."""
    count, run_bound, list_bound = unpack("<III", section, 0, "casters")
    need(count > 0, "no sun")
    need(count <= 64 and header.cells * count <= 16777216, "suns", "limit")
    suns = [unpack("<6f", section, 12 + 24 * i, "a sun") for i in range(count)]
    for sun in suns:
        need(all(0.99 < sum(v * v for v in part) < 1.01 for part in (sun[:3], sun[3:])), "direction to a sun")
        need(sum(a * b for a, b in zip(sun, sun[3:])) > -0.01, "way of a sun")
    sets = header.cells * count
    proofs, made = decode_section_sets(header, section, 12 + 24 * count, sets, run_bound, list_bound)
    return suns, proofs, made


def decode_section_sets(header, section, at, sets, run_bound, list_bound):
    """The certificates and the runs of the sets at the end of a section of casters or lights."""
    columns, at = packed_columns(section, at, 8, sets)
    proofs = proofs_of(columns)
    need(all(p[1] <= p[0] and 0 <= p[2] <= 1 and 0 <= p[3] <= 1 for p in proofs), "certificate of a section")
    (ends,), at = packed_columns(section, at, 1, (sets + 63) // 64)
    codes = at
    for _ in range(6):
        _, at = code_table(section, at)
    rows = section[at:]
    need(run_bound <= min(4 * len(rows), header.polygons) and list_bound <= 4 * len(rows), "bounds of a section")
    decoder = RowDecoder(SectionBounds(header, run_bound, list_bound), section[codes:at])
    made, begin = [], 0
    for end in ends:
        need(begin <= end <= len(rows), "chunk of a section")
        made += decoder.decode_chunk(rows[begin:end], min(64, sets - len(made)))
        begin = end
    need(begin == len(rows), "bytes behind the last chunk of a section")
    need(max(map(len, made), default=0) == run_bound, "run bound of a section")
    return proofs, made


def decode_lights(header, section):
    """Of each light its record, its certificate and the runs of its set; of each cell the lights that touch it."""
    count, run_bound, list_bound = unpack("<III", section, 0, "lights")
    need(count > 0, "no light")
    need(count <= MOST_LIGHTS, "lights", "limit")
    records = [unpack("<I8f", section, 12 + 36 * i, "a light") for i in range(count)]
    for _, *numbers in records:
        need(all(map(math.isfinite, numbers[:3])), "place of a light")
        need(0.99 < sum(v * v for v in numbers[3:6]) < 1.01, "direction of a light")
        need(numbers[6] > 0 and 0 <= numbers[7] <= 1.5708001, "range or cone of a light")
    at, size = 12 + 36 * count, (count + 7) // 8
    touching = []
    for _ in range(header.cells):
        bits = int.from_bytes(section[at:at + size], "little")
        need(bits < 1 << count, "bits behind the last light")
        touching.append([light for light in range(count) if bits >> light & 1])
        at += size
    proofs, made = decode_section_sets(header, section, at, count, run_bound, list_bound)
    return list(zip(records, proofs, made)), touching


def decode_residency(header, section):
    """Pixels per radian; anisotropy; image, width and height of each texture; the levels of each cell, in quarters from
    -4.25 on, 0 for a texture that is not needed."""
    count, pixels, anisotropy = unpack("<Iff", section, 0, "residency")
    need(count <= MOST_TEXTURES, "textures", "limit")
    need(0 < pixels <= 1048576 and 1 <= anisotropy <= 16, "what the levels are for")
    columns, at = packed_columns(section, 12, 3, count)
    textures = list(zip(*columns))
    need(all(a < b for a, b in zip(columns[0], columns[0][1:])), "images do not ascend")
    need(all(1 <= side <= MOST_TEXELS for texture in textures for side in texture[1:]), "size of a texture")
    (ends,), at = packed_columns(section, at, 1, (header.cells + 15) // 16)
    runs, at = code_table(section, at)
    changes, at = code_table(section, at)
    made, begin = [], 0
    for end in ends:
        need(begin <= end and at + end + PADDING <= len(section), "chunk of levels")
        bits = Bits(section, 8 * (at + begin), 8 * (at + end))
        last, needed = [17] * count, [False] * count
        for _ in range(min(16, header.cells - len(made))):
            decode_levels(runs, changes, bits, textures, last, needed)
            made.append([level if there else 0 for level, there in zip(last, needed)])
        need((bits.at + 7) // 8 == at + end, "bytes behind the levels of a chunk")
        begin = end
    need(at + begin + PADDING == len(section), "bytes behind the last chunk of levels")
    return pixels, anisotropy, textures, made


def decode_levels(runs, changes, bits, textures, last, needed):
    """Changes the levels of the cell before into those of the next one."""
    texture = 0
    while texture < len(textures):
        texture += runs.number(bits)
        need(texture <= len(textures), "run of unchanged textures")
        if texture == len(textures):
            break
        change = changes.number(bits)
        last[texture] += (change + 1) // 2 if change % 2 else -(change // 2)
        needed[texture] = change > 0 or not needed[texture]
        need(1 <= last[texture] <= 17 + 4 * (max(textures[texture][1:]).bit_length() - 1), "level of a texture")
        texture += 1


def decode_importance(section, sizes, cells_of_chunks):
    """Of each cell the classes of its polygons in stored order. sizes: how many these are."""
    chunks = len(cells_of_chunks)
    at = 4 + 16 * chunks
    need(at <= len(section), "the directory of the importance is cut")
    codes = []
    for _ in range(CLASSES):
        code, at = code_table(section, at, CLASSES, 8)
        codes.append(code)
    runs, at = code_table(section, at, 64, 8)
    need(crc32c(section[4:at]) == unpack("<I", section, 0, "importance")[0], "front of the importance", "checksum")
    place, classes = 0, []
    for number, cells in enumerate(cells_of_chunks):
        offset, size, checksum = struct.unpack_from("<QII", section, 4 + 16 * number)
        need(offset == place and at + offset + size <= len(section), "chunk of classes")
        place += size
        chunk = section[at + offset:at + place]
        need(crc32c(chunk) == checksum, f"chunk {number} of classes", "checksum")
        classes.extend(decode_classes(chunk, sizes[len(classes):len(classes) + cells], codes, runs))
    need(at + place == len(section), "bytes behind the last chunk of classes")
    return classes


def decode_classes(chunk, sizes, codes, runs):
    width = unpack("<B", chunk, 0, "chunk of classes")[0]
    begin = 1 + (width * len(sizes) + 7) // 8
    need(width <= 32 and begin + PADDING <= len(chunk), "places of classes")
    table = Bits(chunk, 8, 8 * begin)
    begins = [table.take(width) for _ in sizes] + [len(chunk) - PADDING - begin]
    need(begins[0] == 0 and all(a <= b for a, b in zip(begins, begins[1:])), "classes do not follow each other")
    for cell, size in enumerate(sizes):
        end = begin + begins[cell + 1]
        bits, before, classes = Bits(chunk, 8 * (begin + begins[cell]), 8 * end), CLASSES - 1, []
        while len(classes) < size:
            one, count = codes[before].symbol(bits), 1
            if one == CLASSES - 1:
                need(before != one or not classes, "a run of the last class behind another")
                count += runs.number(bits)
            classes.extend([one] * min(count, size + 1))
            before = one
        need(len(classes) == size, "a run of the last class leaves the set")
        need((bits.at + 7) // 8 == end, "classes of a cell do not end where those of the next begin")
        yield classes
