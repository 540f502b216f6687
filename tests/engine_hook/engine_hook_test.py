"""sightcell-engine-hook on baked scenes: all ways of drawing show what drawing everything shows, and damage shows."""
import os
import re

import harness
from colonnade_scene import write_cells, write_colonnade
from harness import must, program, run, skip_without_egl
from surfaces_scene import write_surfaces

WAYS = ['everything', 'index list', 'indirect commands', 'objects']
PACKED_WAYS = ['packed, everything', 'packed, index list', 'packed, indirect commands']
ROW = re.compile(r'(?P<way>.*\S)\s+(?P<pictures>\d+)\s+(?P<differing>\d+)\s+\S+\s+(?P<ties>\d+)\s+'
                 r'(?P<polygons>[\d.]+)\s+(?P<calls>[\d.]+)$')


class InFolder(harness.InFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.city_cells, cls.hall, cls.hall_cells = map(cls.path, ('city.json', 'hall.glb', 'hall.json'))
        cls.city = cls.make_city('city.glb', '--cells', cls.city_cells)
        write_colonnade(cls.hall)
        write_cells(cls.hall_cells)

    @classmethod
    def bake(cls, scene, cells, name, *more):
        out = cls.path(name)
        if not os.path.exists(out):
            must(program('sightcell'), 'bake', scene, '-o', out, '--cells-file', cells, '--cell-limit', 4,
                     '--quality', 'draft', '--progress', 'none', *more)
        return out

    def packed(self, scene, cells, name):
        """The options for a merged file and its mesh."""
        merged, mesh = self.bake(scene, cells, name + '_merged.pvs', '--layout', 'merged'), self.path(name + '_packed.glb')
        must(program('sightcell'), 'pack', scene, merged, '-o', mesh)
        return '--packed', mesh, '--merged', merged

    def draw(self, code, *arguments):
        """What the program says: its rows by way, and all of it."""
        answer, out, err = run(program('sightcell-engine-hook'), *arguments, '--size', 128)
        skip_without_egl(answer, err)
        self.assertEqual(answer, code, f'{arguments}\n{out}\n{err}')
        rows = {}
        for match in filter(None, map(ROW.match, out.splitlines())):
            row = match.groupdict()
            way = row.pop('way')
            rows[way] = {key: float(value) for key, value in row.items()}
        return rows, out + err


class Draws(InFolder):
    def assert_same(self, rows, ways, pictures, most=0):
        self.assertEqual(list(rows), ways)
        for way in ways:
            self.assertEqual(rows[way]['pictures'], pictures, way)
            self.assertLessEqual(rows[way]['differing'], most, way)

    def test_a_city(self):
        pvs = self.bake(self.city, self.city_cells, 'city.pvs')
        rows, said = self.draw(0, self.city, pvs, *self.packed(self.city, self.city_cells, 'city'))
        self.assert_same(rows, WAYS + PACKED_WAYS, 24, most=24 * 128 * 128 * 1e-3)
        self.assertEqual(rows['everything']['polygons'], 3000)
        self.assertEqual(rows['packed, everything']['polygons'], 3000)
        for way in ('index list', 'packed, index list'):
            self.assertLess(rows[way]['polygons'], 600, way)
        self.assertEqual(rows['indirect commands']['polygons'], rows['index list']['polygons'])
        self.assertGreater(rows['objects']['polygons'], rows['index list']['polygons'])
        self.assertEqual(rows['objects']['calls'], rows['index list']['calls'], 'a call per draw that is seen')
        self.assertLess(rows['packed, index list']['calls'], rows['index list']['calls'])
        self.assertIn('24 frames, what is drawn changed in 4\n', said)
        self.assertIn('outside all cells: DRAW_ALL, 3000 of 3000 polygons drawn, 0 pixels differ', said)

    def test_instances_of_one_mesh(self):
        pvs = self.bake(self.hall, self.hall_cells, 'hall.pvs')
        rows, said = self.draw(0, self.hall, pvs, *self.packed(self.hall, self.hall_cells, 'hall'))
        self.assertIn('1104 polygons in 20 draws of 3 primitives, 4 cells', said)
        self.assert_same(rows, WAYS + PACKED_WAYS, 24, most=24 * 128 * 128 * 1e-3)
        self.assertEqual(rows['everything']['calls'], 20)
        self.assertLess(rows['index list']['polygons'], 0.8 * rows['objects']['polygons'])
        self.assertLessEqual(rows['indirect commands']['calls'], 3, 'one for all instances of a primitive')

    def test_gaps_are_drawn_where_asked_for(self):
        pvs = self.bake(self.hall, self.hall_cells, 'exact.pvs', '--profile', 'exact')
        rows, _ = self.draw(0, self.hall, pvs, '--min-gap', 6)
        self.assert_same(rows, WAYS, 24, most=24 * 128 * 128 * 1e-3)
        self.assertGreater(rows['indirect commands']['polygons'], rows['index list']['polygons'])

    def test_a_new_bake_halfway(self):
        # Another profile and seed: other sets in another order.
        pvs = self.bake(self.hall, self.hall_cells, 'hall.pvs')
        other = self.bake(self.hall, self.hall_cells, 'other.pvs', '--profile', 'exact', '--seed', 5)
        rows, said = self.draw(0, self.hall, pvs, '--reload', other)
        self.assert_same(rows, WAYS, 24, most=24 * 128 * 128 * 1e-3)
        self.assertIn('reloaded halfway', said)

    def test_textures_masks_and_sides(self):
        surfaces, cells = self.path('surfaces.glb'), self.path('surfaces.json')
        write_surfaces(surfaces)
        with open(cells, 'w', encoding='utf-8') as out:
            out.write('{"cells":[{"name":"before","min":[-1,-1,9.5],"max":[1,1,11.5]}]}')
        pvs = self.bake(surfaces, cells, 'surfaces.pvs')
        rows, _ = self.draw(0, surfaces, pvs, *self.packed(surfaces, cells, 'surfaces'))
        self.assert_same(rows, WAYS + PACKED_WAYS, 6, most=16)
        self.assertLess(rows['index list']['polygons'], rows['everything']['polygons'])

    def test_a_missing_polygon_shows(self):
        pvs, damaged = self.bake(self.hall, self.hall_cells, 'hall.pvs'), self.path('damaged.pvs')
        must(program('sightcell-test-drop-polygon'), pvs, damaged, 1, 0)  # half of the floor, from the hall's middle
        rows, _ = self.draw(1, self.hall, damaged)
        for way in ('index list', 'indirect commands'):
            self.assertGreater(rows[way]['differing'], 1000, way)
        self.assertEqual(rows['objects']['differing'], 0, 'the walls are one draw')
        self.draw(0, self.hall, damaged, '--max-differing', 0.5)

    def test_of_a_merged_file_too(self):
        pvs = self.bake(self.hall, self.hall_cells, 'hall.pvs')
        _, mesh, _, merged = self.packed(self.hall, self.hall_cells, 'hall')
        damaged = self.path('damaged_merged.pvs')
        must(program('sightcell-test-drop-polygon'), merged, damaged, 1, 0)
        rows, _ = self.draw(1, self.hall, pvs, '--packed', mesh, '--merged', damaged)
        for way in ('packed, index list', 'packed, indirect commands'):
            self.assertGreater(rows[way]['differing'], 1000, way)
        self.assertLess(rows['index list']['differing'], 400)


class Refusals(InFolder):
    def assert_refused(self, code, identifier, *arguments):
        _, said = self.draw(code, *arguments)
        self.assertTrue(said.rstrip().endswith(f'[{identifier}]'), said)

    def test_files_that_do_not_belong_together(self):
        pvs = self.bake(self.hall, self.hall_cells, 'hall.pvs')
        _, mesh, _, merged = self.packed(self.hall, self.hall_cells, 'hall')
        self.assert_refused(4, 'hook.other-scene', self.city, pvs)
        self.assert_refused(4, 'hook.layout', self.hall, merged)
        self.assert_refused(4, 'hook.layout', self.hall, pvs, '--packed', mesh, '--merged', pvs)
        self.assert_refused(4, 'hook.other-scene', self.hall, pvs, '--packed', self.city, '--merged', merged)
        self.assert_refused(4, 'hook.runtime', self.hall, self.hall_cells)

    def test_an_order_for_each_instance(self):
        own_orders = self.bake(self.hall, self.hall_cells, 'own.pvs', '--order', 'per-instance')
        self.assert_refused(4, 'hook.per-instance', self.hall, own_orders)

    def test_wrong_use(self):
        self.draw(2, self.hall)
        self.draw(2, self.hall, self.hall, '--merged', self.hall)
