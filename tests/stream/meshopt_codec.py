"""Decoders of EXT_meshopt_compression, written from the text of the extension alone.

`decode` takes the bytes of a compressed buffer view and returns those of the view. What the text forbids is a ValueError.
The filter QUATERNION is not supported: nothing here uses it.
"""
import numpy as np

GROUP = 16  # elements whose deltas are stored together
SMALLEST_TAIL = 32  # bytes
ALL_ONES = {1: 3, 2: 15}  # by the mode of a group: the delta that says that a whole byte follows
# By the mode of a group: its bytes without those that follow.
PACKED = (0, 4, 8, 16)
# By mode and byte: how many of the deltas in the byte have all bits set.
SENTINELS = {1: bytes(sum(value >> shift & 3 == 3 for shift in (0, 2, 4, 6)) for value in range(256)),
             2: bytes((value & 15 == 15) + (value >> 4 == 15) for value in range(256))}


def need(condition, what):
    if not condition:
        raise ValueError(what)


def decode(data, count, stride, mode, filter_name='NONE'):
    """The bytes of a buffer view of count elements with stride bytes each."""
    need(isinstance(count, int) and isinstance(stride, int) and count >= 0 and stride > 0, 'count or stride of meshopt')
    if mode == 'ATTRIBUTES':
        need(stride % 4 == 0 and stride <= 256, f'a stride of {stride} bytes for ATTRIBUTES')
        return filtered(decode_attributes(data, count, stride), filter_name)
    need(mode in ('TRIANGLES', 'INDICES'), f'meshopt has no mode {mode}')
    need(stride in (2, 4), f'a stride of {stride} bytes for {mode}')
    need(filter_name == 'NONE', f'the filter {filter_name} for {mode}')
    indices = decode_triangles(data, count) if mode == 'TRIANGLES' else decode_indices(data, count)
    need(stride == 4 or not len(indices) or indices.max() < 65536, 'an index of meshopt needs more than 16 bits')
    return indices.astype('<u2' if stride == 2 else '<u4').tobytes()


# Mode ATTRIBUTES.

def decode_attributes(data, count, stride):
    """An array of bytes [count, stride]."""
    tail = max(stride, SMALLEST_TAIL)
    need(len(data) >= 1 + tail, 'ATTRIBUTES are cut')
    need(data[0] == 0xA0, f'ATTRIBUTES have the header {data[0]:#04x} instead of 0xa0')
    need(count == 0 or len(data) - 1 - tail >= stride * -(-count // (4 * GROUP)), 'ATTRIBUTES are cut')
    body = bytes(data[:len(data) - tail])
    largest = min(8192 // stride & ~15, 256)
    blocks = [min(largest, count - first) for first in range(0, count, largest)]
    modes, places, end = find_groups(body, blocks, stride)
    need(end == len(body), 'ATTRIBUTES do not end at their tail')
    deltas = read_groups(np.frombuffer(data, np.uint8), np.array(modes, np.uint8), np.array(places, np.int64))
    # Blocks have stride rows of whole groups each.
    columns, first = [], 0
    for elements in blocks:
        groups = -(-elements // GROUP)
        rows = deltas[first:first + stride * groups].reshape(stride, groups * GROUP)
        columns.append(rows[:, :elements])
        first += stride * groups
    if not columns:
        return np.zeros((0, stride), np.uint8)
    zigzag = np.concatenate(columns, axis=1)
    steps = np.where(zigzag & 1, ~(zigzag >> 1), zigzag >> 1)
    # The text has the element before the padding to 32 bytes or behind it; files have it at the very end.
    baseline = np.frombuffer(data, np.uint8)[len(data) - stride:]
    return np.ascontiguousarray((np.cumsum(steps, axis=1, dtype=np.uint8) + baseline[:, None]).T)


def find_groups(body, blocks, stride):
    """Of each group, in the order of the stream: its mode, and where its bytes begin. Then where the last one ends."""
    modes, places, at = [], [], 1
    for elements in blocks:
        groups = -(-elements // GROUP)
        header = -(-groups // 4)
        for _ in range(stride):
            bits = int.from_bytes(body[at:at + header], 'little')
            at += header
            for _ in range(groups):
                mode = bits & 3
                bits >>= 2
                modes.append(mode)
                places.append(at)
                if mode == 1 or mode == 2:
                    at += PACKED[mode] + sum(body[at:at + PACKED[mode]].translate(SENTINELS[mode]))
                elif mode == 3:
                    at += GROUP
    return modes, places, at


def read_groups(data, modes, places):
    """The deltas as they are stored, [groups, 16]."""
    deltas = np.zeros((len(modes), GROUP), np.uint8)
    whole = modes == 3
    deltas[whole] = data[places[whole, None] + np.arange(GROUP)]
    for mode, shifts in ((1, (6, 4, 2, 0)), (2, (4, 0))):
        chosen = modes == mode
        at = places[chosen]
        packed = data[at[:, None] + np.arange(PACKED[mode])]
        values = (packed[:, :, None] >> np.array(shifts, np.uint8) & ALL_ONES[mode]).reshape(-1, GROUP)
        follows = values == ALL_ONES[mode]
        rank = np.cumsum(follows, axis=1) - 1
        values[follows] = data[(at[:, None] + PACKED[mode] + rank)[follows]]
        deltas[chosen] = values
    return deltas


# Modes TRIANGLES and INDICES.

class Varints:
    """Numbers of 7 bits per byte, from one place up to another."""

    def __init__(self, data, at, end, what):
        self.data, self.at, self.end, self.what = data, at, end, what

    def byte(self):
        need(self.at < self.end, f'{self.what} are cut')
        self.at += 1
        return self.data[self.at - 1]

    def number(self):
        value, shift = 0, 0
        while True:
            byte = self.byte()
            value |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                break
            need(shift < 35, f'{self.what} have a number of more than 5 bytes')
        need(value < 1 << 32, f'{self.what} have a number of more than 32 bits')
        return value


class Triangles:
    """The state of a decoder of TRIANGLES. FIFOs are lists whose end is the most recent entry."""

    def __init__(self, data, count):
        need(len(data) >= 1 + count // 3 + 16, 'TRIANGLES are cut')
        need(data[0] == 0xE1, f'TRIANGLES have the header {data[0]:#04x} instead of 0xe1')
        self.codes = bytes(data[1:1 + count // 3])
        self.table = bytes(data[len(data) - 16:])
        need(self.table[14:] == b'\0\0' and all(value & 15 != 15 and value >> 4 != 15 for value in self.table),
             'the table of TRIANGLES has a value that it must not have')
        self.extra = Varints(bytes(data), 1 + count // 3, len(data) - 16, 'TRIANGLES')
        self.next, self.last = 0, 0
        # Contents are undefined at first; what reads them is rejected.
        self.edges, self.vertices = [], []

    def explicit(self):
        value = self.extra.number()
        self.last = self.last + (~(value >> 1) if value & 1 else value >> 1) & 0xFFFFFFFF
        return self.last

    def unused(self):
        self.next += 1
        return self.next - 1

    def recent(self, age):
        need(age < len(self.vertices), 'TRIANGLES name a vertex that was not there')
        return self.vertices[-1 - age]

    def third(self, low):
        """The corner behind a known edge. Is it a new entry of the FIFO?"""
        if low == 0:
            return self.unused(), True
        if low < 13:
            return self.recent(low), False
        if low == 15:
            return self.explicit(), True
        self.last = self.last + (-1 if low == 13 else 1) & 0xFFFFFFFF
        return self.last, True

    def corner(self, nibble):
        """One of the corners of a triangle without a known edge."""
        if nibble == 0:
            return self.unused(), True
        if nibble < 15:
            return self.recent(nibble - 1), False
        return self.explicit(), True

    def without_edge(self, low):
        first_is_next = low < 15
        pair = self.table[low]
        if low >= 14:
            pair = self.extra.byte()
            if pair == 0:
                self.next = 0
        a = self.unused() if first_is_next else self.explicit()
        b, new_b = self.corner(pair >> 4)
        c, new_c = self.corner(pair & 15)
        self.edges += ((b, a), (c, b), (a, c))
        self.vertices += [a] + [b] * new_b + [c] * new_c
        return a, b, c

    def decode(self):
        corners = []
        for code in self.codes:
            if code >= 0xF0:
                corners += self.without_edge(code & 15)
            else:
                need(code >> 4 < len(self.edges), 'TRIANGLES name an edge that was not there')
                a, b = self.edges[-1 - (code >> 4)]
                c, new = self.third(code & 15)
                self.edges += ((c, b), (a, c))
                if new:
                    self.vertices.append(c)
                corners += (a, b, c)
            del self.edges[:-16], self.vertices[:-16]
        need(self.extra.at == self.extra.end, 'TRIANGLES do not end at their tail')
        return np.array(corners, np.uint32)


def decode_triangles(data, count):
    need(count % 3 == 0, 'TRIANGLES with a count that 3 does not divide')
    return Triangles(data, count).decode()


def decode_indices(data, count):
    need(len(data) >= 1 + count + 4, 'INDICES are cut')
    need(data[0] == 0xD1, f'INDICES have the header {data[0]:#04x} instead of 0xd1')
    need(bytes(data[-4:]) == bytes(4), 'the tail of INDICES is not zero')
    numbers = Varints(bytes(data), 1, len(data) - 4, 'INDICES')
    last, indices = [0, 0], []
    for _ in range(count):
        value = numbers.number()
        delta = ~(value >> 2) if value & 2 else value >> 2
        last[value & 1] = last[value & 1] + delta & 0xFFFFFFFF
        indices.append(last[value & 1])
    need(numbers.at == numbers.end, 'INDICES do not end at their tail')
    return np.array(indices, np.uint32)


# Filters.

def filtered(elements, name):
    if name == 'NONE':
        return elements.tobytes()
    if name == 'EXPONENTIAL':
        return exponential(elements).tobytes()
    need(name == 'OCTAHEDRAL', f'the filter {name} is not supported')
    need(elements.shape[1] in (4, 8), f'the filter OCTAHEDRAL with a stride of {elements.shape[1]} bytes')
    return octahedral(elements.view('i1' if elements.shape[1] == 4 else '<i2')).tobytes()


def exponential(elements):
    """Floats of a mantissa in the low 24 bits and an exponent above."""
    words = elements.view('<i4')
    exponents = words >> 24
    need(not words.size or np.abs(exponents).max() <= 100, 'the filter EXPONENTIAL has an exponent beyond 100')
    return np.ldexp(((words << 8) >> 8).astype('f8'), exponents).astype('<f4')


def octahedral(values):
    """Unit vectors in three components of the same width; the fourth component passes."""
    largest = np.iinfo(values.dtype).max
    one = values[:, 2].astype('i4')
    # 1.0 in 4 bits or more: 7, 15, 31 ...
    need(not len(one) or ((one >= 7).all() and not (one & (one + 1)).any()), 'the filter OCTAHEDRAL has a wrong one')
    need((np.abs(values[:, :2].astype('i4')) <= one[:, None]).all(), 'the filter OCTAHEDRAL has a number above its one')
    plane = values[:, :2].astype('f4') / one[:, None].astype('f4')
    z = 1 - np.abs(plane).sum(axis=1)
    plane -= np.copysign(np.minimum(z, 0)[:, None], plane)
    vectors = np.concatenate([plane, z[:, None]], axis=1)
    vectors /= np.linalg.norm(vectors, axis=1, keepdims=True)
    # Halves are rounded away from zero, as round() of C does.
    rounded = np.trunc(vectors * largest + np.copysign(np.float32(0.5), vectors))
    return np.concatenate([rounded.astype(values.dtype), values[:, 3:]], axis=1)
