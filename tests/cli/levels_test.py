"""Levels of detail of objects, from a glTF file to `verify --levels`: a wall across a hall, and a box behind it."""
import json

from harness import InRoom
from slivers_test import write_solids

WALL, BOX = ([8, -4, -4], [8.2, 4, 4]), ([12, -1, -1], [13, 1, 1])
HALVES = ([8, -4, -4], [8.2, 4, -0.5]), ([8, -4, 0.5], [8.2, 4, 4])  # with a slit between them
SHEET = ([8.05, -4, -4], [8.15, 4, 4])
HALL = ([-4, -4, -4], [20, 4, 4])


class Levels(InRoom):
    def bake(self, name, level, change):
        """A level of the wall that begins 5 m from it; its boxes are children of one node, which `change` makes a level."""
        def put(document):
            nodes, hall = document['nodes'], 2 + len(level)
            for node, name in ((nodes[0], 'wall'), (nodes[1], 'box'), (nodes[hall], 'hall')):
                node['name'] = name
            document['scenes'][0]['nodes'] = [0, 1, hall]
            nodes.append({'name': 'wall far', 'children': list(range(2, hall))})
            change(document)
        scene, file = self.path(f'{name}.glb'), self.path(f'{name}.pvs')
        write_solids(scene, [WALL, BOX, *level], [HALL], put)
        self.expect(0, 'bake', scene, '-o', file, '--cells-grid=-0.5,-0.5,-0.5,0.5,0.5,0.5', '--profile', 'exact',
                    '--max-pixel-error', '1e-2')
        return scene, file

    def verify(self, code, scene, file, *more):
        out, err = self.expect(code, 'verify', scene, file, '--rays', '20000', '--max-pixel-error', '1e-3', '--json', *more)
        return json.loads(out), err

    @staticmethod
    def mark(document):
        """The level is in the tree."""
        document['nodes'][-1]['extras'] = {'sightcell': {'level_of': 'wall', 'from_distance': 5}}
        document['scenes'][0]['nodes'].append(len(document['nodes']) - 1)

    @staticmethod
    def use_extension(document):
        """The level is outside the tree. It begins 7.5 m from the center of the wall, whose sphere has a radius of 5.66 m."""
        document['extensionsUsed'] = ['MSFT_lod']
        document['nodes'][0]['extensions'] = {'MSFT_lod': {'ids': [len(document['nodes']) - 1]}}
        document['nodes'][0]['extras'] = {'MSFT_screencoverage': [1.3, 0]}

    def test_a_slit_in_a_coarser_level_is_found(self):
        scene, file = self.bake('slit', HALVES, self.mark)
        self.verify(0, scene, file)
        told, err = self.verify(3, scene, file, '--levels')
        levels = told['levels']
        self.assertFalse(told['passed'])
        self.assertEqual(levels['misses_revealed'], levels['misses'])
        self.assertGreater(levels['misses'], 10)
        self.assertEqual((levels['objects'], levels['levels'], levels['levels_without_switch']), (1, 1, 0))
        self.assertEqual({(m['kind'], m['node_name'], m['before']['node_name']) for m in levels['missing']},
                         {('revealed', 'box', 'wall'), ('revealed', 'hall', 'wall')})
        self.assertRegex(err, r'polygon \d+ of node 1 "box", behind a coarser level of node 0 "wall": \d+ rays')

    def test_a_closed_level_in_its_place_is_fine(self):
        told, _ = self.verify(0, *self.bake('closed', [SHEET], self.mark), '--levels')
        self.assertEqual(told['levels']['misses'], 0)
        self.assertGreater(told['levels']['rays_at_levels'], 1000)

    def test_levels_outside_the_tree(self):
        scene, file = self.bake('outside', HALVES, self.use_extension)
        info = json.loads(self.expect(0, 'info', scene, '--json')[0])
        self.assertEqual(info['polygons'], 36)
        self.assertIn('1 level of detail is not in the scene', info['warnings'][0])
        told, _ = self.verify(3, scene, file, '--levels')
        self.assertGreater(told['levels']['misses_revealed'], 10)
        self.verify(0, scene, file, '--levels', '--levels-fov', '40')  # the wall covers more: level 0
