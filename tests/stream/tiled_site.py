"""Reads the 3D Tiles of a streamed scene, written from docs/streaming.md and the specifications of 3D Tiles 1.1 and glTF
2.0 alone. What breaks a rule is a ValueError.
"""
import dataclasses
import json
import os

import numpy as np

from gltf_reader import apply, malformed_is_value_error, read_draws, read_gltf
from meshopt_codec import need
from streamed_scene import NOWHERE, hash_of

Z_UP = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]], 'f8')  # what a viewer does to the glTF of a tile


@dataclasses.dataclass
class Tile:
    box: np.ndarray  # [2, 3], with Z up
    error: float
    content: str  # a path from the folder of the site; None: no content
    page: int
    children: list

    def leaves(self):
        """Tiles with content below this one, each with the one above it."""
        for child in self.children:
            if child.content is not None:
                yield self, child
            yield from child.leaves()


@malformed_is_value_error
def read_tileset(folder):
    with open(os.path.join(folder, 'tileset.json'), encoding='utf-8') as file:
        document = json.load(file)
    need(document['asset'] == {'version': '1.1'}, 'no 3D Tiles 1.1')
    need(document['root'].get('refine') == 'ADD' and 'transform' not in document['root'], 'the root is not as the text has it')
    root = read_tile(document['root'])
    need(document['geometricError'] >= root.error, 'the tileset has less error than its root')
    return root


def read_tile(entry):
    numbers = np.array(entry['boundingVolume']['box'], 'f8')
    need(numbers.shape == (12,) and np.isfinite(numbers).all(), 'a box has not 12 numbers')
    half = numbers[3:].reshape(3, 3)
    need((half == np.diag(np.diag(half))).all() and (np.diag(half) >= 0).all(), 'a box is not along the axes')
    children = [read_tile(child) for child in entry.get('children', [])]
    need(children or 'children' not in entry, 'an empty list of children')
    content = entry['content']['uri'] if 'content' in entry else None
    tile = Tile(np.array([numbers[:3] - np.diag(half), numbers[:3] + np.diag(half)]), entry['geometricError'], content,
                entry['extras']['sightcell']['page'] if content is not None else -1, children)
    need(content is None or not children and tile.error == 0, 'a tile with content and children, or with an error')
    for child in children:
        need((tile.box[0] <= child.box[0]).all() and (child.box[1] <= tile.box[1]).all(), 'a child leaves the box of its tile')
        need(child.error <= tile.error, 'a child has a larger error than its tile')
    return tile


def described_material(document, number, image_name):
    """Text that is equal for equal materials, whatever the numbers of their textures. image_name: of an image's number."""
    def described(value):
        if isinstance(value, list):
            return [described(one) for one in value]
        if not isinstance(value, dict):
            return value
        out = {}
        for key, child in value.items():
            if key.endswith('Texture'):
                child = {**child, 'index': texture(document['textures'][child['index']])}
                if child['index'] is None:
                    continue
            out[key] = described(child)
        return out

    def texture(entry):
        images = [entry, *entry.get('extensions', {}).values()]
        names = [image_name(one['source']) if 'source' in one else None for one in images]
        sampler = document['samplers'][entry['sampler']] if 'sampler' in entry else None
        return [names, sampler] if any(names) else None

    return 'default' if number < 0 else json.dumps(described(document['materials'][number]), sort_keys=True)


def tile_polygons(folder, tile):
    """By material: the corners of the polygons of a tile in the world of the scene, [n, 3, 3]."""
    path = os.path.join(folder, *tile.content.split('/'))
    with open(path, 'rb') as file:
        need(f'tiles/{hash_of(file.read())}.gltf' == tile.content, 'a tile has another hash than its name')
    gltf, out = read_gltf(path), {}

    def image_name(number):
        uri = gltf.document['images'][number]['uri']
        need(uri.startswith('../images/') and os.path.isfile(os.path.join(folder, uri[3:])), f'{uri} is missing')
        return uri[3:]

    for draw in read_draws(path):
        out.setdefault(described_material(gltf.document, draw.material, image_name), []).append(draw.world())
    return {material: np.concatenate(some) for material, some in out.items()}


def page_polygons(site, page):
    """What tile_polygons of the page must be, from the front."""
    front, out = site.front, {}

    def image_name(number):
        return front.images[number][-1].name() if front.images[number] else None

    for part in site.page(page):
        for draw in np.flatnonzero((front.draw_geometry == part.geometry) & (front.draw_flags & NOWHERE == 0) &
                                   ((front.draw_object < 0) | (front.draw_level == 0))):
            material = described_material(front.document, int(front.draw_material[draw]), image_name)
            out.setdefault(material, []).append(apply(front.draw_matrices[draw], part.corners()))
    return {material: np.concatenate(some) for material, some in out.items()}


def attribute_rows(gltf, primitive, corners):
    """All attributes of the corners of polygons, a row of bytes for each polygon."""
    columns = [gltf.accessor(primitive['attributes'][name]) for name in sorted(primitive['attributes'])]
    rows = np.concatenate([np.ascontiguousarray(column[corners]).view(np.uint8).reshape(len(corners), -1)
                           for column in columns], axis=1)
    return {row.tobytes() for row in rows}
