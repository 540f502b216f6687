"""The 3D Tiles of `sightcell pack --stream --tileset`: draws that tiles leave out, materials, instances, and what is wrong
use. stream_test.py compares the tiles of whole scenes with their pages."""
import json
import os

import numpy as np

import harness
from gltf_reader import read_draws, read_gltf
from harness import QUICK_BAKE, InFolder, new_folder, read, write_room
from painted_scene import write_painted
from streamed_scene import NOWHERE, open_site
from tiled_site import Z_UP, page_polygons, read_tileset, tile_polygons

HALF = 0.5 ** 0.5


def packed(test, scene, *options):
    """The folder of the site and what the command printed."""
    pvs, folder = test.path('scene.pvs'), new_folder(test.addCleanup)
    for command in (('bake', scene, '-o', pvs, '--importance', '--progress', 'none', *QUICK_BAKE),
                    ('pack', '--stream', scene, pvs, '-o', folder, '--tileset', '--json', *options)):
        code, out, err = harness.sightcell(*command)
        if code != 0:
            raise RuntimeError(f'{command}: {code}\n{err}')
    return folder, json.loads(out)


def wrappers(folder):
    return [read_gltf(os.path.join(folder, *tile.content.split('/'))).document for _, tile in read_tileset(folder).leaves()]


class Tiled(InFolder):
    __test__ = False

    def check_same_polygons(self, folder):
        """Each page has one tile, or nothing that is shown."""
        site, tiles = open_site(folder), [tile for _, tile in read_tileset(folder).leaves()]
        expected = {page: page_polygons(site, page) for page in range(len(site.front.page_hashes))}
        self.assertEqual(sorted(tile.page for tile in tiles), [page for page, some in expected.items() if some])
        for tile in tiles:
            ours = tile_polygons(folder, tile)
            self.assertEqual(set(ours), set(expected[tile.page]))
            for material, corners in expected[tile.page].items():
                self.assertEqual(len(ours[material]), len(corners))
                order = [np.lexsort(np.rint(rows.reshape(-1, 9) * 1e3).T) for rows in (ours[material], corners)]
                np.testing.assert_allclose(ours[material][order[0]], corners[order[1]], atol=2e-5)
        return site


class Marked(Tiled):
    """A room with a small one in it in different ways."""
    __test__ = True

    def room_with(self, *nodes, **more):
        nodes = [{'mesh': 0}, *nodes]
        write_room(self.path('scene.glb'), scenes=[list(range(len(nodes)))], nodes=nodes, **more)
        return packed(self, self.path('scene.glb'))

    def small(self, x, **more):
        return {'mesh': 0, 'translation': [x, 1, 1], 'scale': [0.1, 0.1, 0.1], **more}

    def marked(self, x, **marks):
        return self.small(x, extras={'sightcell': marks})

    def test_draws_of_no_cell_are_left_out(self):
        folder, _ = self.room_with(self.marked(1, never=True), self.marked(2, dynamic=True), self.marked(3, always=True))
        site = self.check_same_polygons(folder)
        self.assertEqual(int((site.front.draw_flags & NOWHERE != 0).sum()), 1)
        polygons = np.concatenate([rows for _, tile in read_tileset(folder).leaves()
                                   for rows in tile_polygons(folder, tile).values()])
        self.assertEqual(sorted(set(polygons[:, :, 0].min(axis=1).round(1)) - {0, 8}), [2, 2.8, 3, 3.8])

    def test_the_finest_level_is_shown(self):
        coarse = {'mesh': 0, 'translation': [1, 2, 1], 'scale': [0.2, 0.1, 0.2]}
        fine = self.small(1, extensions={'MSFT_lod': {'ids': [2]}})
        write_room(self.path('scene.glb'), scenes=[[0, 1, 2]], nodes=[{'mesh': 0}, fine, coarse], extensionsUsed=['MSFT_lod'])
        folder, _ = packed(self, self.path('scene.glb'))
        site = self.check_same_polygons(folder)
        self.assertEqual(site.front.draw_level.tolist(), [0, 0, 1])
        self.assertEqual(sum(len(rows) for _, tile in read_tileset(folder).leaves()
                             for rows in tile_polygons(folder, tile).values()), 24)

    def test_draws_that_are_too_far_away(self):
        """No float has their places."""
        write_room(self.path('scene.glb'), scenes=[[0, 1]],
                   nodes=[{'mesh': 0}, {'mesh': 0, 'translation': [1e300, 0, 0]}])
        folder, told = packed(self, self.path('scene.glb'))
        self.assertEqual(told['tiles'], 1)
        far = tile_polygons(folder, next(iter(read_tileset(folder).leaves()))[1])
        self.assertEqual([len(rows) for rows in far.values()], [12])

    def test_instances(self):
        """Four or more places are instances. Mirrored and sheared ones are not: viewers would draw them wrong."""
        turned = [self.small(x, rotation=[0, HALF * np.sin(x), HALF * np.cos(x), HALF]) for x in (1, 2, 3, 4, 5)]
        sheared = {'scale': [1, 2, 1], 'children': [8]}
        mirrored = self.small(6, scale=[-0.1, 0.1, 0.1])
        nodes = [{'mesh': 0}, *turned, mirrored, sheared, {'mesh': 0, 'translation': [7, 1, 2], 'scale': [0.1, 0.1, 0.1],
                                                           'rotation': [0, 0, np.sin(0.3), np.cos(0.3)]}]
        write_room(self.path('scene.glb'), scenes=[list(range(8))], nodes=nodes)
        folder, _ = packed(self, self.path('scene.glb'))
        self.check_same_polygons(folder)
        for document in wrappers(folder):
            instanced = [node for node in document['nodes'] if 'extensions' in node]
            counts = [document['accessors'][number]['count'] for node in instanced
                      for number in node['extensions']['EXT_mesh_gpu_instancing']['attributes'].values()]
            self.assertEqual(set(counts), {6})  # with the room itself
            self.assertIn('EXT_mesh_gpu_instancing', document['extensionsRequired'])
            self.assertEqual(len(document['nodes']), 3)

    def test_boxes_contain_what_floats_make_of_polygons(self):
        """Ten kilometers away, where floats have steps of a millimeter."""
        turned = [{'mesh': 1, 'translation': [10000.1 + 0.1 * i, -9000.3, 12000.7], 'rotation': [0, np.sin(i), 0, np.cos(i)],
                   'scale': [0.1] * 3, 'extras': {'sightcell': {'dynamic': True}}} for i in range(9)]
        primitive = {'attributes': {'POSITION': 0}}
        folder, _ = self.room_with(*turned, meshes=[{'primitives': [{**primitive, 'indices': 1}]}, {'primitives': [primitive]}])
        self.check_same_polygons(folder)
        for _, tile in read_tileset(folder).leaves():
            for draw in read_draws(os.path.join(folder, *tile.content.split('/'))):
                matrix = draw.matrix.astype('f4')
                points = (draw.local.astype('f4') @ matrix[:3, :3].T + matrix[:3, 3]).astype('f4') @ Z_UP.T
                self.assertTrue((tile.box[0] <= points).all() and (points <= tile.box[1]).all(), f'page {tile.page}')

    def test_three_places_are_nodes(self):
        folder, _ = self.room_with(self.small(1), self.small(2))
        self.check_same_polygons(folder)
        for document in wrappers(folder):
            self.assertEqual([node.get('extensions') for node in document['nodes']], [None] * 3)
            self.assertEqual(len(document['buffers']), 2)

    def test_counts(self):
        folder, told = self.room_with(self.small(1))
        sizes = [os.path.getsize(os.path.join(folder, 'tiles', name)) for name in os.listdir(os.path.join(folder, 'tiles'))
                 if name.endswith('.gltf')]
        self.assertEqual((told['tiles'], told['tile_bytes']), (len(sizes), sum(sizes)))
        self.assertEqual(told['tileset_bytes'], os.path.getsize(os.path.join(folder, 'tileset.json')))
        code, out, _ = harness.sightcell('pack', '--stream', self.path('scene.glb'), self.path('scene.pvs'), '-o', folder,
                                         '--tileset')
        self.assertEqual(code, 0)
        self.assertIn(f'{len(sizes)} tiles', out)

    def test_without_the_option(self):
        folder, _ = self.room_with()
        code, out, _ = harness.sightcell('pack', '--stream', self.path('scene.glb'), self.path('scene.pvs'), '-o',
                                         self.path('other'), '--json')
        self.assertEqual((code, json.loads(out)['tiles']), (0, 0))
        self.assertEqual(set(os.listdir(folder)) - set(os.listdir(self.path('other'))), {'tiles', 'tileset.json', 'tileset.json.gz'})

    def test_it_needs_stream(self):
        code, _, err = harness.sightcell('pack', 'scene.glb', 'scene.pvs', '-o', 'out.glb', '--tileset')
        self.assertEqual(code, 2)
        self.assertIn('cli.wrong-use', err)


class Materials(Tiled):
    """Those of the painted room with one image, changed."""
    __test__ = True

    def changed(self, change, *options):
        path = self.path('painted.gltf')
        write_painted(path)
        document = json.loads(read(path))
        document.update(images=document['images'][:1], textures=[{'source': 0, 'sampler': 0}],
                        materials=[{'pbrMetallicRoughness': {'baseColorTexture': {'index': 0}}}])
        for mesh in document['meshes']:
            mesh['primitives'][0]['material'] = 0
        change(document)
        with open(path, 'w', encoding='utf-8') as file:
            json.dump(document, file)
        folder, _ = packed(self, path, *options)
        self.check_same_polygons(folder)
        return wrappers(folder)

    def test_each_tile_has_the_materials_that_it_uses(self):
        def change(document):
            image, = document['images']
            document['images'] = [{**image, 'name': 'a'}, {**image, 'name': 'b', 'uri': image['uri'].replace('=', '')}]
            document['textures'] = [{'source': 0}, {'source': 0, 'sampler': 0}]
            document['materials'] = [{'name': 'unused', 'normalTexture': {'index': 0}}, {'name': 'walls'},
                                     {'name': 'box', 'emissiveTexture': {'index': 1, 'extensions': {
                                         'KHR_texture_transform': {'scale': [2, 2]}}}}]
            document['extensionsUsed'] = ['KHR_texture_transform', 'KHR_lights_punctual']
            for mesh, material in zip(document['meshes'], (1, 2)):
                mesh['primitives'][0]['material'] = material
        box, walls = sorted(self.changed(change), key=lambda document: document['materials'][0]['name'])
        self.assertEqual([material['name'] for material in box['materials']], ['box'])
        self.assertEqual(box['materials'][0]['emissiveTexture']['index'], 0)
        self.assertEqual((box['textures'], len(box['images']), len(box['samplers'])), ([{'source': 0, 'sampler': 0}], 1, 1))
        self.assertIn('KHR_texture_transform', box['extensionsUsed'])
        self.assertNotIn('KHR_lights_punctual', box['extensionsUsed'])
        self.assertNotIn('KHR_texture_transform', walls['extensionsUsed'])
        self.assertEqual([key for key in ('textures', 'samplers', 'images') if key in walls], [])

    def test_textures_without_a_file(self):
        def change(document):
            document['images'].append({'uri': 'nowhere.png'})
            document['textures'] += [{'source': 1}, {'source': 1, 'extensions': {'EXT_texture_webp': {'source': 0}}}]
            document['extensionsUsed'] = ['EXT_texture_webp']
            document['materials'][0].update(normalTexture={'index': 1}, emissiveTexture={'index': 2})
        for document in self.changed(change):
            material, = document['materials']
            self.assertNotIn('normalTexture', material)
            self.assertEqual(len(document['images']), 1)
            alone = document['textures'][material['emissiveTexture']['index']]
            self.assertEqual(alone, {'extensions': {'EXT_texture_webp': {'source': 0}}})
        for document in self.changed(change, '--no-textures'):
            self.assertEqual(document['materials'], [{'pbrMetallicRoughness': {}}])
            self.assertNotIn('images', document)
