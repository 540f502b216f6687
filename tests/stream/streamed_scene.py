"""Reads the folders that `sightcell pack --stream` writes. Written from docs/streaming.md and public specifications alone:
proof that the text suffices for the author of another client.

Everything that the text lets a reader check is checked; what breaks a rule is a ValueError.
"""
import dataclasses
import hashlib
import json
import os
import struct
import zlib

import numpy as np

import gltf_reader
from gltf_reader import MESHOPT, apply, malformed_is_value_error, split_glb, whole
from meshopt_codec import need

MAGIC, VERSION = b'SIGHTFRT', 1
MOVES, EVERYWHERE, NOWHERE = 1, 2, 4  # flags of draws
EXTENSIONS = ('png', 'jpg', 'webp', 'ktx2', 'bin')
LEAST = 255  # code of a weight that is less than any other
CHUNK_LIMIT = 16 << 10
COPIES = {'gzip': '.gz', 'br': '.br'}  # by content encoding: what follows the name of a file
# By the name of an attribute before its number: type of accessor, types of components, filter.
ATTRIBUTES = {'POSITION': ('VEC3', (5126,), 'EXPONENTIAL'), 'TEXCOORD': ('VEC2', (5126,), 'EXPONENTIAL'),
              'NORMAL': ('VEC3', (5120,), 'OCTAHEDRAL'), 'TANGENT': ('VEC4', (5120,), 'OCTAHEDRAL'),
              'COLOR': ('VEC4', (5121, 5123), 'NONE')}
SECTIONS = {'materials', 'textures', 'samplers', 'images', 'extensionsUsed', 'asset'}


def hash_of(data):
    return hashlib.sha256(data).hexdigest()[:16]


class Columns:
    """Reads a payload from its begin to its end."""

    def __init__(self, payload, name):
        self.data, self.at, self.name = np.frombuffer(payload, np.uint8), 0, name

    def need(self, condition, what):
        need(condition, f'{self.name}: {what}')

    def bytes(self, count):
        self.need(count <= len(self.data) - self.at, 'the payload ends early')
        self.at += count
        return self.data[self.at - count:self.at]

    def varints(self, count, below=1 << 32, what='number'):
        """As i8. below: what the text counts them against."""
        self.need(count <= len(self.data) - self.at, 'the payload ends early')
        part = self.data[self.at:self.at + 5 * count]
        ends = np.flatnonzero(part < 128)[:count]
        begins = np.concatenate([[0], ends + 1])
        lengths = np.diff(begins)
        self.need((lengths <= 5).all(), 'a number of more than 5 bytes')
        self.need(len(ends) == count, 'the payload ends early, or in a number of more than 5 bytes')
        values = np.zeros(count, np.int64)
        for place in range(5):
            longer = lengths > place
            values[longer] |= (part[begins[:-1][longer] + place].astype(np.int64) & 127) << 7 * place
        self.need((values < 1 << 32).all(), 'a number of more than 32 bits')
        self.need((values < below).all(), f'a {what} is not below {below}')
        self.at += int(begins[-1])
        return values

    def varint(self, below=1 << 32, what='number'):
        return int(self.varints(1, below, what)[0])

    def deltas(self, count, below=1 << 32, what='number'):
        steps = self.varints(count)
        values = np.cumsum(np.where(steps & 1, -(steps + 1 >> 1), steps >> 1))
        self.need(((values >= 0) & (values < below)).all(), f'a {what} is negative or not below {below}')
        return values

    def gaps(self, counts, below, what):
        """A list of ascending numbers for each count."""
        steps = self.varints(int(sum(counts))) + 1
        ends = np.cumsum(counts, dtype=np.int64)
        lists = [np.cumsum(steps[end - size:end]) - 1 for end, size in zip(ends, counts)]
        self.need(all(not len(one) or one[-1] < below for one in lists), f'a {what} is not below {below}')
        return lists

    def floats(self, count, columns=1):
        """[count, columns]"""
        planes = self.bytes(4 * count * columns).reshape(columns, 4, count)
        values = np.ascontiguousarray(planes.transpose(2, 0, 1)).view('<f4')[:, :, 0]
        self.need(np.isfinite(values).all(), 'a float is not finite')
        return values

    def boxes(self, count):
        """[count, 2, 3]"""
        boxes = self.floats(count, 6).reshape(count, 2, 3)
        self.need((boxes[:, 0] <= boxes[:, 1]).all(), 'a box has its minimum above its maximum')
        return boxes

    def hashes(self, count):
        return [bytes(row).hex() for row in self.bytes(8 * count).reshape(count, 8)]

    def end(self):
        self.need(self.at == len(self.data), f'{len(self.data) - self.at} bytes behind the payload')


def inflated(packed, size, name):
    stream = zlib.decompressobj()
    try:
        payload = stream.decompress(packed, size + 1)
    except zlib.error as error:
        raise ValueError(f'{name}: {error}') from error
    need(stream.eof and not stream.unused_data and not stream.unconsumed_tail,
         f'{name}: the zlib stream ends early or late')
    need(len(payload) == size, f'{name}: the payload has not {size} bytes')
    return payload


def decoded(data, encoding):
    if encoding == 'gzip':
        stream = zlib.decompressobj(zlib.MAX_WBITS | 16)
        try:
            plain = stream.decompress(data)
        except zlib.error as error:
            raise ValueError(f'gzip: {error}') from error
        need(stream.eof and not stream.unused_data, 'gzip: the stream ends early or late')
        return plain
    import brotli  # only where copies of that kind are
    try:
        return brotli.decompress(data)
    except brotli.error as error:
        raise ValueError(f'brotli: {error}') from error


@dataclasses.dataclass
class ImageFile:
    width: int
    height: int
    bytes: int
    type: str
    hash: str

    def name(self):
        return f'images/{self.hash}.{self.type}'


@dataclasses.dataclass
class Front:
    fingerprint: str
    polygons: int
    cells: int
    box: np.ndarray  # [2, 3]
    document: dict  # materials and what they need
    geometry_polygons: np.ndarray
    draw_geometry: np.ndarray
    draw_material: np.ndarray  # -1: the default material
    draw_flags: np.ndarray
    draw_object: np.ndarray  # with levels of detail; -1: none
    draw_level: np.ndarray
    draw_node: np.ndarray
    draw_mesh: np.ndarray
    draw_instance: np.ndarray
    draw_primitive: np.ndarray
    draw_matrices: np.ndarray  # [D, 3, 4]
    page_bytes: np.ndarray
    page_hashes: list
    page_boxes: np.ndarray  # [P, 2, 3] in meters
    images: list  # of each image its files
    chunk_bytes: np.ndarray
    chunk_cells: np.ndarray
    chunk_hashes: list
    chunk_boxes: np.ndarray  # [C, 2, 3]
    everywhere: np.ndarray  # pages that are in every cell
    images_everywhere: np.ndarray

    def page_name(self, page):
        return f'pages/{self.page_hashes[page]}.glb'

    def chunk_name(self, chunk):
        return f'cells/{self.chunk_hashes[chunk]}.cells'


@malformed_is_value_error
def front(data):
    need(len(data) >= 16, 'front: cut')
    need(data[:8] == MAGIC, 'front: no scene.front')
    version, size = struct.unpack_from('<II', data, 8)
    need(version == VERSION, f'front: version {version}')
    read = Columns(inflated(data[16:], size, 'front'), 'front')
    fingerprint = bytes(read.bytes(16)).hex()
    polygons, geometries, draws, pages, images, files, chunks, cells, text = map(int, read.varints(9))
    box = read.floats(6).reshape(2, 3)  # one column
    read.need((box[0] <= box[1]).all(), 'the box of the scene has its minimum above its maximum')
    document = materials_of(bytes(read.bytes(text)), images)
    geometry_polygons = read.varints(geometries)
    materials = len(document.get('materials', []))
    table = {
        'draw_geometry': read.deltas(draws, geometries, 'geometry'),
        'draw_material': read.varints(draws, materials + 1, 'material') - 1,
        'draw_flags': read.varints(draws, 8, 'flag'),
        'draw_object': read.varints(draws) - 1, 'draw_level': read.varints(draws),
        'draw_node': read.deltas(draws), 'draw_mesh': read.deltas(draws), 'draw_instance': read.deltas(draws),
        'draw_primitive': read.varints(draws),
        'draw_matrices': read.floats(draws, 12).reshape(draws, 4, 3).transpose(0, 2, 1)}
    page_bytes, page_hashes = read.varints(pages), read.hashes(pages)
    steps = read.bytes(6 * pages).reshape(2, 3, pages).transpose(2, 0, 1)
    read.need((steps[:, 0] <= steps[:, 1]).all(), 'the box of a page has its minimum above its maximum')
    page_boxes = box[0] + steps / 255 * (box[1].astype('f8') - box[0])
    image_files = read_images(read, images, files)
    chunk_bytes, chunk_cells, chunk_hashes = read.varints(chunks), read.varints(chunks), read.hashes(chunks)
    chunk_boxes = read.boxes(chunks)
    everywhere = read.gaps([read.varint(pages + 1, 'count of pages')], pages, 'page')[0]
    images_everywhere = read.gaps([read.varint(images + 1, 'count of images')], images, 'image')[0]
    read.end()
    read.need(chunk_cells.sum() == cells and (chunk_cells > 0).all(), f'the chunks have not {cells} cells')
    read.need(geometry_polygons[table['draw_geometry']].sum() == polygons, f'the draws have not {polygons} polygons')
    both = table['draw_flags'] & (EVERYWHERE | NOWHERE) == EVERYWHERE | NOWHERE
    read.need(not both.any(), 'a draw is in every cell and in none')
    for what, hashes in (('page', page_hashes), ('chunk', chunk_hashes)):
        read.need(len(set(hashes)) == len(hashes), f'a {what} is there twice')
    return Front(fingerprint, polygons, cells, box, document, geometry_polygons, **table,
                 page_bytes=page_bytes, page_hashes=page_hashes, page_boxes=page_boxes, images=image_files,
                 chunk_bytes=chunk_bytes, chunk_cells=chunk_cells, chunk_hashes=chunk_hashes, chunk_boxes=chunk_boxes,
                 everywhere=everywhere, images_everywhere=images_everywhere)


def materials_of(text, images):
    document = json.loads(text.decode())
    need(isinstance(document, dict) and document['asset']['version'] == '2.0', 'front: no JSON of glTF 2.0')
    need(set(document) <= SECTIONS, f'front: JSON with {sorted(set(document) - SECTIONS)}')
    need(len(document.get('images', [])) == images, f'front: the JSON has not {images} images')
    need(not any('uri' in image or 'bufferView' in image for image in document.get('images', [])),
         'front: an image of the JSON has a place')
    return document


def read_images(read, images, files):
    counts = read.varints(images)
    read.need(counts.sum() == files, f'the images have not {files} files')
    width, height, size = read.varints(files), read.varints(files), read.varints(files)
    types = read.bytes(files)
    read.need((types < len(EXTENSIONS)).all(), 'the type of an image is not known')
    rows = [ImageFile(int(w), int(h), int(s), EXTENSIONS[t], name)
            for w, h, s, t, name in zip(width, height, size, types, read.hashes(files))]
    ends = np.cumsum(counts)
    lists = [rows[end - count:end] for end, count in zip(ends, counts)]
    for one in lists:
        known = [(file.width, file.height) for file in one if file.width and file.height]
        read.need(all(a[0] <= b[0] and a[1] <= b[1] for a, b in zip(known, known[1:])),
                  'the files of an image are not of ascending size')
    return lists


@dataclasses.dataclass
class Cell:
    number: int
    box: np.ndarray  # [2, 3]
    weight: float
    pages: np.ndarray
    page_codes: np.ndarray
    page_headings: np.ndarray  # bits of sectors of 45 degrees
    draws: np.ndarray
    images: np.ndarray
    image_codes: np.ndarray

    def page_weights(self):
        """In steradians; 0 where the text says only that it is less than any other."""
        return np.where(self.page_codes == LEAST, 0, self.weight * np.exp2(self.page_codes / -8.0))


@malformed_is_value_error
def cell_chunk(data, of):
    """The cells of a chunk. of: the front."""
    need(len(data) >= 4, 'chunk: cut')
    read = Columns(inflated(data[4:], struct.unpack_from('<I', data)[0], 'chunk'), 'chunk')
    count = read.varint(of.cells + 1, 'count of cells')
    read.need(count > 0, 'no cells')
    read.need(count == 1 or len(data) <= CHUNK_LIMIT, f'several cells in {len(data)} bytes')
    numbers, boxes = read.deltas(count, of.cells, 'cell'), read.boxes(count)
    read.need(len(set(numbers.tolist())) == count, 'a cell is there twice')
    read.need((boxes[:, 0] < boxes[:, 1]).all(), 'a cell without volume')
    weights = read.floats(count)[:, 0]
    read.need((weights >= 0).all(), 'a negative weight')
    pages, page_codes = weighted_lists(read, count, len(of.page_hashes), 'page')
    ends = np.cumsum([len(one) for one in pages])
    headings = np.split(read.bytes(int(ends[-1])), ends[:-1])
    draws = draws_of(read, count, len(of.draw_flags))
    for one in draws:
        read.need(not (of.draw_flags[one] & (EVERYWHERE | NOWHERE)).any(), 'a draw that no cell lists')
    images, image_codes = weighted_lists(read, count, len(of.images), 'image')
    read.end()
    return [Cell(int(numbers[i]), boxes[i], float(weights[i]), pages[i], page_codes[i], headings[i], draws[i], images[i],
                 image_codes[i]) for i in range(count)]


def weighted_lists(read, count, below, what):
    sizes = read.varints(count, below + 1, f'count of {what}s')
    lists = read.gaps(sizes, below, what)
    codes, ends = read.bytes(int(sizes.sum())), np.cumsum(sizes)
    return lists, [codes[end - size:end] for end, size in zip(ends, sizes)]


def draws_of(read, count, below):
    sizes = read.varints(count)
    pairs = read.varints(2 * int(sizes.sum())).reshape(-1, 2)
    lists, first = [], 0
    for size in sizes:
        runs = pairs[first:first + size]
        first += size
        ends = np.cumsum(runs.sum(axis=1) + 1)
        read.need(not size or ends[-1] <= below, f'a draw is not below {below}')
        lists.append(np.concatenate([np.arange(end - more - 1, end) for end, more in zip(ends, runs[:, 1])] or
                                    [np.zeros(0, np.int64)]))
    return lists


@dataclasses.dataclass
class Part:
    """The polygons of one geometry in a page. Vertices are those of its primitive."""
    geometry: int
    triangles: np.ndarray  # [n, 3]
    attributes: dict  # by name: floats [vertices, components]

    def corners(self):
        return self.attributes['POSITION'][self.triangles]


@malformed_is_value_error
def page(data, of):
    """The parts of a page. of: the front."""
    document, binary = split_glb(data)
    gltf = gltf_reader.Gltf(document, binary)
    signed_bytes = any(accessor['componentType'] == 5120 for accessor in document['accessors'])
    for extension in (MESHOPT, *(['KHR_mesh_quantization'] if signed_bytes else [])):
        need(extension in document['extensionsUsed'] and extension in document['extensionsRequired'],
             f'page: {extension} is not used and required')
    need(len(document['meshes']) == 1, 'page: not one mesh')
    need(not any({'matrix', 'translation', 'rotation', 'scale'} & set(node) for node in document['nodes']),
         'page: a node with a transform')
    shown = [node['mesh'] for node in document['nodes'] if 'mesh' in node]
    need(shown == [0], 'page: not one node with the mesh')
    parts = []
    for primitive in document['meshes'][0]['primitives']:
        parts += parts_of(gltf, primitive, of)
    need(parts, 'page: no polygons')
    return parts


def parts_of(gltf, primitive, of):
    need('material' not in primitive, 'page: a primitive with a material')
    need(primitive.get('mode', gltf_reader.TRIANGLES) == gltf_reader.TRIANGLES, 'page: a primitive without triangles')
    numbers = primitive['attributes']
    attributes = {name: attribute(gltf, name, number) for name, number in numbers.items()}
    need('POSITION' in attributes and len({len(values) for values in attributes.values()}) == 1,
         'page: attributes of unequal length, or no POSITION')
    view = gltf_reader.item(gltf.document, 'accessors', primitive['indices'])['bufferView']
    packed_by(gltf, view, 'TRIANGLES', 'NONE')
    corners = gltf.corners(primitive)
    pairs = primitive['extras']['sightcell']
    need(isinstance(pairs, list) and pairs and len(pairs) % 2 == 0, 'page: extras.sightcell is no list of pairs')
    parts, first, geometry = [], 0, -1
    for gap, polygons in zip(pairs[::2], pairs[1::2]):
        geometry += whole(gap, 'page: geometry') + 1
        need(geometry < len(of.geometry_polygons), f'page: there is no geometry {geometry}')
        need(whole(polygons, 'page: polygons') > 0, 'page: no polygons of a geometry')
        need(polygons <= of.geometry_polygons[geometry], f'page: more polygons than geometry {geometry} has')
        parts.append(Part(geometry, corners[first:first + polygons], attributes))
        first += polygons
    count = gltf_reader.item(gltf.document, 'accessors', primitive['indices'])['count']
    need(3 * first == count, f'page: extras.sightcell is about {3 * first} of {count} indices')
    return parts


def attribute(gltf, name, number):
    need(name.split('_')[0] in ATTRIBUTES, f'page: the attribute {name}')
    kind, components, filter_name = ATTRIBUTES[name.split('_')[0]]
    accessor = gltf_reader.item(gltf.document, 'accessors', number)
    need(accessor['type'] == kind and accessor['componentType'] in components, f'page: the type of {name}')
    need(accessor.get('normalized', False) == (accessor['componentType'] != 5126), f'page: {name} and normalized')
    packed_by(gltf, accessor['bufferView'], 'ATTRIBUTES', filter_name)
    values = gltf.floats(number)
    need(len(values), f'page: {name} is empty')
    if name == 'POSITION':  # glTF demands these
        low, high = np.array([accessor['min'], accessor['max']], 'f4')  # their text is as short as floats allow
        need((values.min(axis=0) == low).all() and (values.max(axis=0) == high).all(), 'page: min or max of POSITION is wrong')
    return values


def packed_by(gltf, view, mode, filter_name):
    packed = gltf_reader.item(gltf.document, 'bufferViews', view)['extensions'][MESHOPT]
    need(packed['mode'] == mode and packed.get('filter', 'NONE') == filter_name,
         f'page: a view is not of {mode} with the filter {filter_name}')


class Site:
    """A folder whose files are all there. Chunks and pages are decoded once."""

    def __init__(self, folder):
        self.folder = folder
        self.front = front(self.read('scene.front'))
        self.chunks, self.pages = {}, {}

    def read(self, name):
        with open(os.path.join(self.folder, *name.split('/')), 'rb') as file:
            return file.read()

    def copies(self, name):
        """The compressed copies of a file: by content encoding their bytes."""
        paths = {encoding: os.path.join(self.folder, *name.split('/')) + ending for encoding, ending in COPIES.items()}
        return {encoding: self.read(name + COPIES[encoding]) for encoding, path in paths.items() if os.path.exists(path)}

    def sent_bytes(self, name, encodings):
        """Of the body that a server with these copies sends to a client that accepts the encodings."""
        sizes = [os.path.getsize(os.path.join(self.folder, *name.split('/')))]
        return min(sizes + [len(copy) for encoding, copy in self.copies(name).items() if encoding in encodings])

    def sent_page_bytes(self, encodings):
        return np.array([self.sent_bytes(self.front.page_name(page), encodings) for page in range(len(self.front.page_bytes))])

    def files(self):
        """(name, bytes, hash) of all files that the front lists."""
        of = self.front
        yield from zip(map(of.page_name, range(len(of.page_hashes))), of.page_bytes.tolist(), of.page_hashes)
        yield from zip(map(of.chunk_name, range(len(of.chunk_hashes))), of.chunk_bytes.tolist(), of.chunk_hashes)
        for image in of.images:
            yield from ((file.name(), file.bytes, file.hash) for file in image)

    def page(self, number):
        if number not in self.pages:
            self.pages[number] = page(self.read(self.front.page_name(number)), self.front)
        return self.pages[number]

    def chunk(self, number):
        if number not in self.chunks:
            cells = cell_chunk(self.read(self.front.chunk_name(number)), self.front)
            need(len(cells) == self.front.chunk_cells[number], f'chunk {number} has not as many cells as the front has')
            boxes = np.array([cell.box for cell in cells])
            box = np.array([boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)])
            need((box == self.front.chunk_boxes[number]).all(), f'chunk {number} has another box in the front')
            self.chunks[number] = cells
        return self.chunks[number]

    def cells(self):
        """All cells, by their numbers."""
        found = {cell.number: cell for chunk in range(len(self.front.chunk_hashes)) for cell in self.chunk(chunk)}
        need(len(found) == self.front.cells, 'a cell is in two chunks')
        return found


def open_site(folder):
    site = Site(folder)
    for name, size, expected in site.files():
        path = os.path.join(folder, *name.split('/'))
        need(os.path.isfile(path), f'{name} is missing')
        need(os.path.getsize(path) == size, f'{name} has {os.path.getsize(path)} bytes instead of {size}')
        data = site.read(name)
        need(hash_of(data) == expected, f'{name} has another hash than its name')
        for encoding, copy in site.copies(name).items():
            need(decoded(copy, encoding) == data, f'{name}{COPIES[encoding]} has other contents')
    return site


def cell_at(site, point):
    """The cell of the camera, or None where it keeps the last one."""
    point = np.asarray(point, 'f4')
    boxes, found = site.front.chunk_boxes, []
    for chunk in np.flatnonzero(((boxes[:, 0] <= point) & (point < boxes[:, 1])).all(axis=1)):
        found += [cell for cell in site.chunk(int(chunk))
                  if (cell.box[0] <= point).all() and (point < cell.box[1]).all()]
    return min(found, key=lambda cell: (np.prod(np.diff(cell.box.astype('f8'), axis=0)), cell.number), default=None)


def local_polygons(site):
    """Of each geometry: the corners of all its polygons in all pages, [n, 3, 3], and the page of each."""
    corners = [[] for _ in site.front.geometry_polygons]
    pages = [[] for _ in corners]
    for number in range(len(site.front.page_hashes)):
        for part in site.page(number):
            corners[part.geometry].append(part.corners())
            pages[part.geometry].append(np.full(len(part.triangles), number))
    for geometry, most in enumerate(site.front.geometry_polygons):
        need(sum(map(len, corners[geometry])) <= most, f'pages have too many polygons of geometry {geometry}')
    return ([np.concatenate(rows or [np.zeros((0, 3, 3))]) for rows in corners],
            [np.concatenate(rows or [np.zeros(0, np.int64)]) for rows in pages])


def rebuild(site):
    """All polygons in world space: the draw of each, [n], and its corners, [n, 3, 3]."""
    of, local = site.front, local_polygons(site)[0]
    world = [apply(matrix, local[geometry]) for matrix, geometry in zip(of.draw_matrices, of.draw_geometry)]
    draws = [np.full(len(rows), draw) for draw, rows in enumerate(world)]
    return np.concatenate(draws or [np.zeros(0, np.int64)]), np.concatenate(world or [np.zeros((0, 3, 3))])
