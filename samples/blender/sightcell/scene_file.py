"""The exported scene: its JSON, and which Blender object each of its nodes is. Knows nothing of Blender's API."""
import json
import struct

from .problem import Problem

TRIANGLES = 4


def read_document(path):
    """The JSON of a .glb."""
    try:
        with open(path, 'rb') as file:
            magic, _, _ = struct.unpack('<4sII', file.read(12))
            size, kind = struct.unpack('<I4s', file.read(8))
            if magic == b'glTF' and kind == b'JSON':
                return json.loads(file.read(size))
    except OSError as problem:
        raise Problem(f'{path}: cannot be read ({problem.strerror}); bake first') from None
    except (struct.error, ValueError):
        pass
    raise Problem(f'{path}: not a .glb; bake again')


class Nodes:
    """The nodes of a scene by their index.

    names: of each node. owners: the name of the Blender object that shows it, or None. An object that instances (a
    collection, or on vertices and faces) owns all that is below it, except its own children. unknown: nodes whose
    visibility no set describes: marked as dynamic, or as cells. never: nodes marked so.
    """

    def __init__(self, document, objects):
        """objects: name -> (whether the object instances, name of its parent or None)."""
        self.document = document
        self.nodes = document.get('nodes', [])
        self.names = [node.get('name', '') for node in self.nodes]
        self.owners = [None] * len(self.nodes)
        self.unknown, self.never = set(), set()
        scenes = document.get('scenes', [])
        roots = scenes[document.get('scene', 0)].get('nodes', []) if scenes else []
        waiting = [(root, None, {}) for root in roots]
        while waiting:
            node, instancer, marks = waiting.pop()
            name = self.names[node]
            instances, parent = objects.get(name, (False, None))
            if instancer is not None and parent == instancer:
                instancer = None
            self.owners[node] = instancer if instancer is not None else name if name in objects else None
            own = (self.nodes[node].get('extras') or {}).get('sightcell')
            marks = {**marks, **own} if isinstance(own, dict) else marks
            if marks.get('dynamic') or marks.get('cell'):
                self.unknown.add(node)
            if marks.get('never'):
                self.never.add(node)
            marks = {key: value for key, value in marks.items() if key != 'cell'}  # which is not inherited
            below = name if instancer is None and instances else instancer
            waiting += [(child, below, marks) for child in self.nodes[node].get('children', [])]

    def label(self, node):
        """How a message names a node."""
        if node >= len(self.nodes):
            return f'nodes[{node}]'
        owner, name = self.owners[node], self.names[node]
        if owner is None or owner == name:
            return f'"{name}"' if name else f'nodes[{node}]'
        return f'"{name}" of "{owner}"'

    def has_draw(self, node, mesh, primitive, polygons):
        """Whether the node has this primitive with this number of triangles."""
        if node >= len(self.nodes) or self.nodes[node].get('mesh') != mesh:
            return False
        primitives = self.document['meshes'][mesh]['primitives']
        if primitive >= len(primitives):
            return False
        found = primitives[primitive]
        if found.get('mode', TRIANGLES) != TRIANGLES:
            return True
        accessor = found.get('indices', found['attributes']['POSITION'])
        return self.document['accessors'][accessor]['count'] // 3 == polygons
