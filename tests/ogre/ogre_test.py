"""sightcell-ogre on a baked city: every way of culling shows what OGRE shows without Sightcell, and draws less."""
import json

import harness
from harness import must, program, run, write_middle_cell, write_room
from png import read_png

WIDTH, HEIGHT = 160, 120


class Ogre(harness.InFolder):
    """A city and a room, baked with the identity of their draws."""

    @classmethod
    def setUpClass(cls):
        harness.skip_without_xvfb()
        super().setUpClass()
        cls.display = harness.start_screen(cls.addClassCleanup, cls.folder)
        cls.city_cells, cls.city_pvs = cls.path('city.json'), cls.path('city.pvs')
        cls.city = cls.make_city('city.glb', '--cells', cls.city_cells)
        cls.bake(cls.city, cls.city_pvs, cls.city_cells, '--cell-limit', 3, '--names')
        cls.room, cls.room_cells, cls.room_pvs = map(cls.path, ('room.glb', 'room.json', 'room.pvs'))
        write_room(cls.room)
        write_middle_cell(cls.room_cells)
        cls.bake(cls.room, cls.room_pvs, cls.room_cells, '--names')

    @classmethod
    def bake(cls, scene, out, cells, *more):
        must(program('sightcell'), 'bake', scene, '-o', out, '--cells-file', cells, '--progress', 'none', *more)

    def draw(self, code, scene, pvs, *arguments, display=None):
        """What the program prints."""
        answer, out, err = run(program('sightcell-ogre'), scene, pvs, '--width', WIDTH, '--height', HEIGHT, *arguments,
                               display=display or self.display)
        self.assertEqual(answer, code, f'{arguments}\n{out}\n{err}')
        return out, err

    def rows(self, code, pictures, scene, pvs, *arguments):
        out, _ = self.draw(code, scene, pvs, '--json', *arguments)
        report = json.loads(out)
        self.assertEqual((report['pictures'], report['width'], report['height']), (pictures, WIDTH, HEIGHT))
        return {row.pop('mode'): row for row in report['modes']}

    def test_less_is_drawn_and_the_same_is_shown(self):
        picture = self.path('city.png')
        rows = self.rows(0, 12, self.city, self.city_pvs, '--screenshot', picture)
        self.assertEqual(list(rows), ['frustum', 'objects', 'list', 'frustum-clusters', 'clusters'])
        for mode, row in rows.items():
            self.assertLessEqual(row['wrong_pixels'], 1e-4 * 12 * WIDTH * HEIGHT, mode)
        self.assertEqual(rows['frustum']['wrong_pixels'], 0)
        self.assertEqual(rows['frustum-clusters']['wrong_pixels'], 0)
        triangles = {mode: row['triangles'] for mode, row in rows.items()}
        self.assertLess(triangles['list'], triangles['clusters'])
        self.assertLess(triangles['clusters'], triangles['objects'])
        self.assertLess(triangles['objects'], triangles['frustum'])
        self.assertLess(triangles['clusters'], triangles['frustum-clusters'])
        self.assertLess(triangles['list'], 0.2 * triangles['frustum'])
        self.assertLess(rows['objects']['draws'], 0.5 * rows['frustum']['draws'])
        self.assertEqual(rows['list']['draws'], rows['objects']['draws'], 'an index list per visible entity')
        pixels = read_png(picture)
        self.assertEqual(pixels.shape, (HEIGHT, WIDTH, 3))
        self.assertGreater(len({tuple(p) for p in pixels.reshape(-1, 3).tolist()}), 50, 'hardly anything is shown')

    def test_a_missing_polygon_shows(self):
        damaged = self.path('damaged.pvs')
        must(program('sightcell-test-drop-polygon'), self.room_pvs, damaged, 0, 0)  # half of the floor
        rows = self.rows(1, 4, self.room, damaged, '--mode', 'objects,list')
        self.assertEqual(rows['objects']['wrong_pixels'], 0, 'the room is one draw')
        self.assertGreater(rows['list']['wrong_pixels'], 0.02 * 4 * WIDTH * HEIGHT)
        self.draw(0, self.room, damaged, '--max-wrong', 0.5)

    def test_a_table_for_people(self):
        out, _ = self.draw(0, self.city, self.city_pvs, '--mode', 'objects', '--eyes', 1, '--headings', 1)
        self.assertIn('3000 triangles in 236 entities, 1 pictures', out)
        self.assertRegex(out, r'(?m)^objects +\d')

    def refused(self, identifier, scene, pvs, **more):
        out, err = self.draw(4, scene, pvs, **more)
        self.assertEqual(out, '')
        self.assertEqual(len(err.splitlines()), 1, err)
        self.assertTrue(err.rstrip().endswith(f'[{identifier}]'), err)
        return err

    def test_files_that_do_not_belong_together(self):
        said = self.refused('ogre.other-scene', self.city, self.room_pvs)
        self.assertIn('1 draws that the scene lacks (the first: room) and lacks 236 of 236', said)
        unnamed = self.path('unnamed.pvs')
        self.bake(self.room, unnamed, self.room_cells)
        self.refused('ogre.no-names', self.room, unnamed)
        self.refused('ogre.runtime', self.city, self.city_cells)
        self.refused('ogre.import', self.city_cells, self.city_pvs)

    def test_no_display(self):
        self.refused('ogre.no-display', self.city, self.city_pvs, display=':987')
