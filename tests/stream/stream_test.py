"""What `sightcell pack --stream` writes, by a reader that was written from docs/streaming.md alone. Every polygon of the
scene and of every cell set has to be there."""
import io
import json
import os

import numpy as np
from PIL import Image

import harness
from colonnade_scene import write_cells, write_colonnade
from decode_pvs import Contents
from gltf_reader import apply, read_draws, read_gltf
from harness import QUICK_BAKE, InFolder, new_folder, read, write_middle_cell, write_room
from matching import partners
from painted_images import CUTOFF, PIXELS, colors, leaves, light_of, means, normals, numbers_of
from painted_scene import image_files, write_painted
from pair_sets import candidates, corner_distance
from streamed_scene import COPIES, EVERYWHERE, MOVES, NOWHERE, cell_at, decoded, local_polygons, open_site, rebuild
from tiled_site import Z_UP, attribute_rows, page_polygons, read_tileset, tile_polygons

GRID = 0.002  # meters
PAGE_SIZE = 4096  # bytes. Small, so that scenes of a few thousand polygons have a dozen pages
OPTIONS = ['--grid', GRID, '--page-size', PAGE_SIZE, '--tileset', '--compress', 'brotli']
SMALLER = 64  # pixels of the smaller versions of images
STEP = 2 ** (1 / 16)  # a weight is rounded to an eighth of a power of two
SMALLEST = 11  # classes of importance below this one have a range of solid angles


def largest_of_class(number):
    return 2 * np.pi / 4.0 ** np.minimum(number, SMALLEST)


def modified(folder):
    """By path: when each file was written, and its number."""
    return {os.path.join(place, name): (os.stat(os.path.join(place, name)).st_mtime_ns, os.stat(os.path.join(place, name)).st_ino)
            for place, _, names in os.walk(folder) for name in names}


def contents(folder):
    return {os.path.relpath(path, folder): read(path) for path in modified(folder)}


class Streamed(InFolder):
    """Of a scene: the file, its sets and what was packed. Subclasses name the scene."""
    __test__ = False

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.scene, cls.pvs, cls.site_folder = cls.path('scene.glb'), cls.path('scene.pvs'), cls.path('site')
        options = cls.write_scene()
        cls.must('bake', cls.scene, '-o', cls.pvs, '--importance', '--progress', 'none', *QUICK_BAKE, *options)
        cls.must('pack', '--stream', cls.scene, cls.pvs, '-o', cls.site_folder, *OPTIONS)
        cls.draws = read_draws(cls.scene)
        cls.sets = Contents(read(cls.pvs))
        cls.site = open_site(cls.site_folder)
        cls.cells = cls.site.cells()
        cls.match_polygons()

    @classmethod
    def must(cls, *arguments):
        code, out, err = harness.sightcell(*arguments)
        if code != 0:
            raise RuntimeError(f'{arguments}: {code}\n{out}\n{err}')
        return out

    @classmethod
    def match_polygons(cls):
        """By source id: the page that has the polygon, -1 where none has; all pages with a polygon in its place; whether
        it has an extent on the grid. By geometry and polygon in pages: the draws that have found it."""
        front, (corners, pages) = cls.site.front, local_polygons(cls.site)
        cls.page_of = np.full(front.polygons, -1)
        cls.pages_near = [set() for _ in range(front.polygons)]
        cls.flat = np.zeros(front.polygons, bool)
        cls.found_by = [np.zeros(len(rows), np.int64) for rows in corners]
        for draw, geometry, matrix in zip(cls.draws, front.draw_geometry, front.draw_matrices):
            ids = slice(draw.first, draw.first + len(draw.local))
            ours, packed = draw.world(), apply(matrix, corners[geometry])
            partner = partners(ours, packed, GRID * 1.001)
            found = partner >= 0
            cls.page_of[ids][found] = pages[geometry][partner[found]]
            cls.found_by[geometry][partner[found]] += 1
            cls.flat[ids] = np.linalg.norm(ours - np.roll(ours, 1, axis=1), axis=2).min(axis=1) <= 2 * GRID
            if not len(ours) or not len(packed):
                continue
            for i, j in candidates(ours, packed, GRID * 1.001):
                near = corner_distance(ours[i], packed[j]) <= GRID * 1.001
                for polygon, page in zip(i[near], pages[geometry][j[near]]):
                    cls.pages_near[draw.first + polygon].add(int(page))

    def draw_of(self, polygons):
        return np.searchsorted([draw.first + len(draw.local) for draw in self.draws], polygons, side='right')

    def test_draws_are_those_of_the_scene(self):
        front = self.site.front
        self.assertEqual(front.fingerprint, self.sets.header.fingerprint)
        self.assertEqual(front.polygons, self.sets.header.polygons)
        self.assertEqual(list(zip(front.draw_node, front.draw_mesh, front.draw_primitive, front.draw_instance,
                                  front.draw_material, front.geometry_polygons[front.draw_geometry])),
                         [(d.node, d.mesh, d.primitive, d.instance, d.material, len(d.local)) for d in self.draws])
        for matrix, draw in zip(front.draw_matrices, self.draws):
            np.testing.assert_allclose(matrix, draw.matrix[:3], rtol=1e-5, atol=1e-5)

    def test_every_polygon_is_in_one_page(self):
        missing = (self.page_of < 0) & ~self.flat
        self.assertFalse(missing.any(), f'{missing.sum()} of {len(missing)} polygons are in no page')
        self.assertTrue((self.page_of >= 0).any())
        # Each polygon in a page is one of each of its draws.
        front = self.site.front
        for geometry, found in enumerate(self.found_by):
            self.assertTrue((found == (front.draw_geometry == geometry).sum()).all(), f'geometry {geometry}')

    def test_rebuilt_polygons_are_those_of_the_draws(self):
        draws, world = rebuild(self.site)
        for number, draw in enumerate(self.draws):
            rebuilt, own = world[draws == number], draw.world()
            self.assertLessEqual(len(rebuilt), len(own))
            if len(rebuilt):
                self.assertTrue((rebuilt.min(axis=(0, 1)) > own.min(axis=(0, 1)) - GRID).all())
                self.assertTrue((rebuilt.max(axis=(0, 1)) < own.max(axis=(0, 1)) + GRID).all())
            own = own[~self.flat[draw.first:draw.first + len(own)]]
            if len(own):
                self.assertTrue((rebuilt.min(axis=(0, 1)) < own.min(axis=(0, 1)) + GRID).all())
                self.assertTrue((rebuilt.max(axis=(0, 1)) > own.max(axis=(0, 1)) - GRID).all())

    def test_boxes_contain_polygons(self):
        front, (corners, pages) = self.site.front, local_polygons(self.site)
        for matrix, geometry in zip(front.draw_matrices, front.draw_geometry):
            world, boxes = apply(matrix, corners[geometry]), front.page_boxes[pages[geometry]]
            if len(world):
                slack = 2 * GRID
                self.assertTrue((world >= boxes[:, None, 0] - slack).all() and (world <= boxes[:, None, 1] + slack).all())
        own = np.concatenate([draw.world().reshape(-1, 3) for draw in self.draws])
        self.assertTrue((front.box[0] <= own.min(axis=0) + GRID).all() and (front.box[1] >= own.max(axis=0) - GRID).all())
        self.assertTrue((np.diff(front.box, axis=0)[0] < 2 * np.ptp(own, axis=0) + 2 * GRID).all())

    def test_positions_are_on_one_grid(self):
        """Of a power of two for each geometry, the largest one that keeps the distance."""
        front, (corners, _) = self.site.front, local_polygons(self.site)
        for geometry, rows in enumerate(corners):
            if not len(rows):
                continue
            scale = max(np.linalg.norm(front.draw_matrices[d][:, :3], 2)
                        for d in np.flatnonzero(front.draw_geometry == geometry))
            steps = rows.reshape(-1) * 2.0 ** 20
            step = 2.0 ** min((int(n) & -int(n)).bit_length() - 1 for n in steps if n) / 2.0 ** 20
            self.assertTrue((steps == np.rint(steps)).all())
            # That it is not too large is seen where polygons are matched.
            self.assertGreater(2 * step * scale, GRID)

    def test_cells_have_what_is_in_their_sets(self):
        front = self.site.front
        self.assertEqual(sorted(self.cells), list(range(len(self.sets.boxes))))
        for number, cell in self.cells.items():
            np.testing.assert_array_equal(cell.box.reshape(6), np.array(self.sets.boxes[number], 'f4'))
            here = {*cell.pages.tolist(), *front.everywhere.tolist()}
            shown = {*cell.draws.tolist(), *np.flatnonzero(front.draw_flags & EVERYWHERE).tolist()}
            seen = np.array(self.sets.seen(number), np.int64)
            seen_draws = self.draw_of(seen)
            for polygon, draw in zip(seen, seen_draws):
                if front.draw_flags[draw] & NOWHERE or self.flat[polygon]:
                    continue
                self.assertIn(draw, shown, f'cell {number}')
                self.assertTrue(self.pages_near[polygon] & here, f'cell {number}: polygon {polygon} is in no page of it')
            # And no more than that.
            self.assertLessEqual(set(cell.draws.tolist()), set(seen_draws.tolist()))
            needed = {self.page_of[polygon] for polygon in seen} | {p for polygon in seen for p in self.pages_near[polygon]}
            self.assertLessEqual(set(cell.pages.tolist()), needed)

    def test_weights_are_those_of_the_importance(self):
        for number, cell in self.cells.items():
            classes = np.array(self.sets.classes(number))
            pages = self.page_of[self.sets.seen(number)]
            weights = dict(zip(cell.pages.tolist(), cell.page_weights()))
            for page, weight in weights.items():
                most = largest_of_class(classes[pages == page])
                least = np.where(classes[pages == page] < SMALLEST, most / 4, 0).sum()
                self.assertLessEqual(weight, STEP * most.sum() * 1.001, f'cell {number}, page {page}')
                self.assertGreaterEqual(weight * STEP * 1.001, least, f'cell {number}, page {page}')
            self.assertGreater(cell.weight, 0)
            if not len(self.site.front.everywhere):
                self.assertLessEqual(sum(weights.values()), cell.weight * STEP)
                self.assertGreaterEqual(sum(weights.values()), cell.weight / STEP)

    def test_polygons_are_in_the_headings_of_their_pages(self):
        """In the mean over the cell, next to nothing of a page is in sectors without their bit."""
        random = np.random.default_rng(2)
        world = np.concatenate([draw.world() for draw in self.draws])
        for number, cell in self.cells.items():
            seen = np.array(self.sets.seen(number), np.int64)
            angles = 0.25 ** np.minimum(np.array(self.sets.classes(number)), 11.0)
            everywhere = self.site.front.draw_flags[self.draw_of(seen)] & EVERYWHERE != 0
            seen, angles = seen[~everywhere], angles[~everywhere]
            by_sector = np.zeros((len(cell.pages), 8))
            at = np.searchsorted(cell.pages, self.page_of[seen])
            for _ in range(64):
                eye = random.uniform(*cell.box)
                ahead = (random.dirichlet([1, 1, 1], len(seen))[:, :, None] * world[seen]).sum(axis=1) - eye
                sectors = np.floor(np.arctan2(ahead[:, 2], ahead[:, 0]) / np.pi * 4).astype(int) % 8
                np.add.at(by_sector, (at, sectors), angles)
            by_sector /= by_sector.sum(axis=1, keepdims=True)
            has = cell.page_headings[:, None] >> np.arange(8) & 1 > 0
            self.assertLess(np.where(has, 0, by_sector).max(), 3 / 16, f'cell {number}')

    def test_pages_are_small(self):
        self.assertLess(self.site.front.page_bytes.max(), 1.5 * PAGE_SIZE)

    def test_the_cell_of_a_point(self):
        draw = np.random.default_rng(1)
        boxes = np.array([self.cells[i].box for i in range(len(self.cells))], 'f8')
        low, high = boxes[:, 0].min(axis=0) - 1, boxes[:, 1].max(axis=0) + 1
        points = [*boxes.mean(axis=1), *boxes[:, 0], *boxes[:, 1], *draw.uniform(low, high, (200, 3))]
        for point in np.array(points, 'f4'):
            inside = [i for i, (first, last) in enumerate(boxes) if (first <= point).all() and (point < last).all()]
            cell = cell_at(self.site, point)
            volumes = [np.prod(boxes[i][1] - boxes[i][0]) for i in inside]
            self.assertEqual(cell and cell.number, inside[int(np.argmin(volumes))] if inside else None)
        self.assertIsNone(cell_at(self.site, high + 1))

    def test_tiles_show_the_polygons_of_pages(self):
        """Of all draws here, since none is left out."""
        leaves = list(read_tileset(self.site_folder).leaves())
        self.assertEqual(sorted(tile.page for _, tile in leaves), list(range(len(self.site.front.page_hashes))))
        total = 0
        for _, tile in leaves:
            ours, expected = tile_polygons(self.site_folder, tile), page_polygons(self.site, tile.page)
            self.assertEqual(set(ours), set(expected))
            for material, corners in expected.items():
                self.assertEqual(len(ours[material]), len(corners))
                self.assertTrue((partners(ours[material], corners, 1e-5) >= 0).all(), f'page {tile.page}, {material}')
                total += len(corners)
            everything = np.concatenate(list(ours.values())) @ Z_UP.T
            self.assertTrue((tile.box[0] <= everything.min(axis=(0, 1))).all(), f'page {tile.page}')
            self.assertTrue((tile.box[1] >= everything.max(axis=(0, 1))).all(), f'page {tile.page}')
            self.assertTrue((np.diff(tile.box, axis=0)[0] < np.ptp(everything, axis=(0, 1)) + 1e-3).all())
        self.assertEqual(total, len(rebuild(self.site)[0]))

    def test_errors_of_tiles(self):
        """The largest error of the pages below, which is at most twice that of any in the same tile."""
        def check(tile):
            below = [self.error_of(leaf.page) for _, leaf in tile.leaves()]
            self.assertAlmostEqual(tile.error, max(below), delta=1e-4 * tile.error)
            for child in tile.children:
                if child.content is None:
                    check(child)
                else:
                    self.assertLessEqual(tile.error, 2 * self.error_of(child.page))

        check(read_tileset(self.site_folder))

    def error_of(self, page):
        """The side of a square as large as the surface of the page."""
        area = 0
        for part in self.site.page(page):
            draws = self.site.front.draw_matrices[self.site.front.draw_geometry == part.geometry]
            world = [apply(matrix, part.corners()) for matrix in draws]
            area += max(np.linalg.norm(np.cross(rows[:, 1] - rows[:, 0], rows[:, 2] - rows[:, 0]), axis=1).sum() / 2
                        for rows in world)
        return area ** 0.5

    def test_tiles_have_the_attributes_of_pages(self):
        for _, tile in read_tileset(self.site_folder).leaves():
            wrapper = read_gltf(os.path.join(self.site_folder, *tile.content.split('/')))
            page = read_gltf(os.path.join(self.site_folder, *self.site.front.page_name(tile.page).split('/')))
            rows = [set().union(*(attribute_rows(gltf, primitive, gltf.corners(primitive))
                                  for mesh in gltf.document['meshes'] for primitive in mesh['primitives']))
                    for gltf in (wrapper, page)]
            self.assertEqual(*rows)
            self.assertEqual(os.path.relpath(os.path.join('tiles', wrapper.document['buffers'][0]['uri'])),
                             os.path.relpath(self.site.front.page_name(tile.page)))

    def test_a_second_run_writes_the_same(self):
        again = new_folder(self.addCleanup)
        first, before = contents(self.site_folder), modified(self.site_folder)
        self.must('pack', '--stream', self.scene, self.pvs, '-o', again, *OPTIONS)
        self.assertEqual(contents(again), first)
        self.must('pack', '--stream', self.scene, self.pvs, '-o', self.site_folder, *OPTIONS)
        after = modified(self.site_folder)
        self.assertEqual(contents(self.site_folder), first)
        front = os.path.join(self.site_folder, 'scene.front')
        self.assertEqual({path: time for path, time in after.items() if path != front},
                         {path: time for path, time in before.items() if path != front})

    def test_files_of_an_older_front_stay(self):
        folder = new_folder(self.addCleanup)
        self.must('pack', '--stream', self.scene, self.pvs, '-o', folder, '--grid', 16 * GRID, *OPTIONS[2:])
        coarse = set(contents(folder))
        self.must('pack', '--stream', self.scene, self.pvs, '-o', folder, *OPTIONS)
        both = contents(folder)
        self.assertLess(coarse, set(both))
        self.assertEqual(both, {**both, **contents(self.site_folder)})

    def test_pages_and_tiles_have_smaller_copies(self):
        files = contents(self.site_folder)
        plain = {name: data for name, data in files.items() if not name.endswith(tuple(COPIES.values()))}
        compressed = [name for name in plain if name.endswith(('.glb', '.gltf', '.json'))]
        for encoding, ending in COPIES.items():
            self.assertEqual({name + ending for name in compressed}, {name for name in files if name.endswith(ending)})
            for name in compressed:
                copy = files[name + ending]
                self.assertEqual(decoded(copy, encoding), plain[name], name + ending)
                self.assertLess(len(copy), len(plain[name]) * 15 / 16)
        self.assertTrue(all(files[name + '.gz'][:10] == b'\x1f\x8b\x08\0\0\0\0\0\x02\xff' for name in compressed))

    def test_copies_that_are_printed(self):
        folder = new_folder(self.addCleanup)
        printed = json.loads(self.must('pack', '--stream', self.scene, self.pvs, '-o', folder, *OPTIONS, '--json'))
        self.assertEqual(printed['page_gzip_bytes'], self.site.sent_page_bytes({'gzip'}).sum())
        self.assertEqual(printed['page_brotli_bytes'], self.site.sent_page_bytes({'gzip', 'br'}).sum())
        tiles = [name for name in contents(folder) if name.endswith('.gltf')]
        self.assertEqual(printed['tile_gzip_bytes'], sum(self.site.sent_bytes(name, {'gzip'}) for name in tiles))
        self.assertEqual(printed['tile_brotli_bytes'], sum(self.site.sent_bytes(name, {'gzip', 'br'}) for name in tiles))
        sent = self.site.sent_page_bytes({'gzip'})
        self.assertAlmostEqual(printed['mean_cell_gzip_bytes'], np.mean([sent[cell.pages].sum() for cell in self.cells.values()]))

    def test_without_copies(self):
        """Those of older versions of files that change must go: a server would send them."""
        folder = new_folder(self.addCleanup)
        self.must('pack', '--stream', self.scene, self.pvs, '-o', folder, '--grid', 16 * GRID, *OPTIONS[2:])
        with open(os.path.join(folder, 'scene.front.gz'), 'wb') as other:
            other.write(b'of another program')
        before = contents(folder)
        self.must('pack', '--stream', self.scene, self.pvs, '-o', folder, *OPTIONS[:-1], 'none')
        self.assertEqual({name for name in before if name not in contents(folder)},
                         {'tileset.json.gz', 'tileset.json.br', 'scene.front.gz'})
        again = new_folder(self.addCleanup)
        self.must('pack', '--stream', self.scene, self.pvs, '-o', again, *OPTIONS[:-2])
        self.assertEqual({name.split('.')[-1] for name in contents(again)} & {'gz', 'br'}, {'gz'})
        self.must('pack', '--stream', self.scene, self.pvs, '-o', again, *OPTIONS)
        self.assertEqual(contents(again), contents(self.site_folder))

    def test_damaged_files_are_rejected(self):
        folder = new_folder(self.addCleanup)
        self.must('pack', '--stream', self.scene, self.pvs, '-o', folder, *OPTIONS)
        front = open_site(folder).front
        for name in ('scene.front', front.chunk_name(0), front.page_name(0), front.page_name(0) + '.gz', front.page_name(0) + '.br'):
            path = os.path.join(folder, *name.split('/'))
            data = read(path)
            # In a zlib stream, a flipped bit may mean the same bytes. Not so in the header, the first bytes and the checksum.
            places = [*range(18), *range(len(data) - 4, len(data))] if name == 'scene.front' else range(0, len(data), 61)
            for damaged in (data[:-1], data + b'\0', *(data[:at] + bytes([data[at] ^ 16]) + data[at + 1:] for at in places)):
                with open(path, 'wb') as file:
                    file.write(damaged)
                with self.assertRaises(ValueError):
                    open_site(folder)
            with open(path, 'wb') as file:
                file.write(data)
        open_site(folder)


class City(Streamed):
    __test__ = True

    @classmethod
    def write_scene(cls):
        cls.make_city('scene.glb')
        return ['--cell-limit', 6]

    def test_equal_geometry_is_there_once(self):
        shapes = {(draw.mesh, draw.primitive) for draw in self.draws}
        self.assertLessEqual(len(self.site.front.geometry_polygons), len(shapes))
        self.assertLess(len(shapes), len(self.draws))

    def test_cells_need_a_part_of_the_pages(self):
        needed = [len(cell.pages) for cell in self.cells.values()]
        self.assertLess(2 * max(needed), len(self.site.front.page_bytes))

    def test_pages_are_in_some_directions(self):
        headings = np.concatenate([cell.page_headings for cell in self.cells.values()])
        self.assertGreater((headings != 255).mean(), 0.25)
        self.assertTrue((headings != 0).all())


class Colonnade(Streamed):
    """All pillars are one geometry: by nodes, mirrored, and by EXT_mesh_gpu_instancing."""
    __test__ = True

    @classmethod
    def write_scene(cls):
        cells = cls.path('cells.json')
        write_cells(cells)
        write_colonnade(cls.scene)
        return ['--cells-file', cells]

    def test_equal_geometry_is_there_once(self):
        self.assertEqual(len(self.site.front.geometry_polygons), 3)
        self.assertEqual(sorted(self.site.front.geometry_polygons.tolist()), [2, 12, 64])


class Lit(InFolder):
    """Sections that a streamed scene does not have are named."""

    def test_what_is_left_out_is_named(self):
        scene, cells, pvs = self.path('lit.glb'), self.path('cells.json'), self.path('lit.pvs')
        write_middle_cell(cells)
        write_room(scene, scenes=[[0, 1]], nodes=[
            {'mesh': 0}, {'translation': [4, 3, 4], 'extensions': {'KHR_lights_punctual': {'light': 0}}}],
            extensionsUsed=['KHR_lights_punctual'], extensions={'KHR_lights_punctual': {'lights': [{'type': 'point'}]}})
        for options, left_out in ([], []), (['--lights'], ['lights']), (['--sun', '150,40', '--lights'], ['shadow casters', 'lights']):
            Streamed.must('bake', scene, '-o', pvs, '--cells-file', cells, '--importance', '--progress', 'none',
                          '--max-pixel-error', '1e-2', *options)
            code, _, err = harness.sightcell('pack', '--stream', scene, pvs, '-o', self.path('site'))
            self.assertEqual(code, 0, err)
            self.assertEqual([line for line in err.splitlines() if line.startswith('warning:')], [
                f'warning: the streamed scene has no {what}: those of {pvs} are left out' for what in left_out])


class FarAway(InFolder):
    """A draw so far away that no float has its place is in no cell, and its numbers are finite."""

    def test_numbers_are_finite(self):
        scene, pvs, site_folder = self.path('far.glb'), self.path('far.pvs'), self.path('site')
        write_room(scene, scenes=[[0, 1, 2]], nodes=[
            {'mesh': 0}, {'mesh': 0, 'translation': [1e300, 0, 0]}, {'mesh': 0, 'scale': [1e60, 1e60, 1e60]}])
        Streamed.must('bake', scene, '-o', pvs, '--importance', '--progress', 'none', *QUICK_BAKE)
        Streamed.must('pack', '--stream', scene, pvs, '-o', site_folder)
        site = open_site(site_folder)
        self.assertLess(np.ptp(site.front.box, axis=0).max(), 100)
        for cell in site.cells().values():
            self.assertEqual(cell.draws.tolist(), [0])


class Painted(Streamed):
    """Attributes and an image, and a box that the host moves."""
    __test__ = True

    @classmethod
    def write_scene(cls):
        cls.cells_file = cls.path('cells.json')
        write_middle_cell(cls.cells_file)
        write_painted(cls.scene)
        return ['--cells-file', cls.cells_file]

    def test_attributes(self):
        """Without those that no texture needs: only the room has a texture of normals, and none has the second coordinates."""
        self.assert_attributes(self.site, {0: {'TEXCOORD_1'}, 1: {'TEXCOORD_1', 'TANGENT'}})

    def test_all_attributes(self):
        folder = new_folder(self.addCleanup)
        self.must('pack', '--stream', self.scene, self.pvs, '-o', folder, *OPTIONS, '--all-attributes')
        self.assert_attributes(open_site(folder), {0: set(), 1: set()})

    def assert_attributes(self, site, left_out):
        """left_out: by mesh."""
        gltf = read_gltf(self.scene)
        limits = {'NORMAL': 0.03, 'TANGENT': 0.03, 'TEXCOORD_0': 1 / 32 / PIXELS, 'TEXCOORD_1': 1 / 32 / PIXELS, 'COLOR_0': 0.5 / 255}
        for page in range(len(site.front.page_bytes)):
            for part in site.page(page):
                draw = int(np.flatnonzero(site.front.draw_geometry == part.geometry)[0])
                mesh = int(site.front.draw_mesh[draw])
                primitive = gltf.document['meshes'][mesh]['primitives'][0]
                self.assertEqual(set(part.attributes), set(primitive['attributes']) - left_out[mesh])
                source = {name: gltf.floats(number) for name, number in primitive['attributes'].items()}
                for vertex in np.unique(part.triangles):
                    near = np.linalg.norm(source['POSITION'] - part.attributes['POSITION'][vertex], axis=1) <= GRID
                    for name, limit in limits.items():
                        if name in left_out[mesh]:
                            continue
                        near &= np.abs(source[name] - part.attributes[name][vertex]).max(axis=1) <= limit * 1.001
                    self.assertTrue(near.any(), f'page {page}, vertex {vertex}')

    def test_images(self):
        front = self.site.front
        for files, data in zip(front.images, image_files()):
            self.assertEqual((files[-1].width, files[-1].height, files[-1].type), (PIXELS, PIXELS, 'png'))
            self.assertEqual(self.site.read(files[-1].name()), data)
        self.assertEqual(front.document['materials'][0]['pbrMetallicRoughness']['baseColorTexture'], {'index': 0})
        self.assertEqual([cell.images.tolist() for cell in self.cells.values()], [[0, 2, 3]])

    def smaller(self, image):
        """The pixels of the only smaller version."""
        file, whole = self.site.front.images[image]
        self.assertEqual((file.width, file.height, file.type), (SMALLER, SMALLER, 'webp'))
        self.assertLess(2 * file.bytes, whole.bytes)
        with Image.open(io.BytesIO(self.site.read(file.name()))) as decoded:
            self.assertEqual((decoded.format, decoded.size), ('WEBP', (SMALLER, SMALLER)))
            self.assertEqual(decoded.mode, 'RGBA' if image == 1 else 'RGB')
            return np.array(decoded, 'f8')

    def test_smaller_colors_are_means_of_light(self):
        expected = numbers_of(means(light_of(colors()), SMALLER))
        self.assertGreater(np.abs(means(colors().astype('f8'), SMALLER) - expected).mean(), 20)
        self.assertLess(np.abs(self.smaller(0) - expected).mean(), 3)

    def test_smaller_leaves_cover_as_much(self):
        found, source = self.smaller(1), leaves()
        coverage = (source[:, :, 3] >= 255 * CUTOFF).mean()
        self.assertLess((means(source[:, :, 3] / 255, SMALLER) >= CUTOFF).mean(), coverage - 0.1)
        self.assertAlmostEqual((found[:, :, 3] >= 255 * CUTOFF).mean(), coverage, delta=0.05)
        # Transparent pixels do not color those beside them.
        self.assertLess(np.abs(found[:, :, :3] - source[source[:, :, 3] > 0][0][:3]).mean(), 3)

    def test_smaller_normals_have_length_1(self):
        expected = means(normals() / 127.5 - 1, SMALLER)
        length = np.linalg.norm(expected, axis=2, keepdims=True)
        self.assertLess(length.max(), 0.8)
        self.assertLess(np.abs(self.smaller(2) / 127.5 - 1 - expected / length).mean(), 0.02)

    def test_a_damaged_image_has_one_file(self):
        self.assertEqual(len(self.site.front.images[3]), 1)
        folder = new_folder(self.addCleanup)
        code, _, err = harness.sightcell('pack', '--stream', self.scene, self.pvs, '-o', folder, *OPTIONS)
        self.assertEqual(code, 0)
        self.assertEqual([line for line in err.splitlines() if 'smaller' in line],
                         ['warning: images/3 has no smaller versions: it is damaged, or too large to decode'])

    def test_without_images(self):
        folder = new_folder(self.addCleanup)
        self.must('pack', '--stream', self.scene, self.pvs, '-o', folder, *OPTIONS, '--no-textures')
        self.assertFalse([name for name in contents(folder) if name.startswith('images')])
        open_site(folder).cells()

    def test_the_host_moves_the_box(self):
        """So it can be visible from any cell."""
        front = self.site.front
        self.assertEqual(front.draw_flags.tolist(), [0, MOVES | EVERYWHERE])
        cell, = self.cells.values()
        self.assertEqual(cell.draws.tolist(), [0])
        pages = {page for page in range(len(front.page_bytes)) for part in self.site.page(page)
                 if part.geometry == front.draw_geometry[1]}
        self.assertEqual(set(front.everywhere.tolist()), pages)
        self.assertEqual(front.images_everywhere.tolist(), [1])
