"""Runs sightcell-relevance-server in a baked town and has rays look at the players that it hides."""
import json
import os
import re

from harness import InFolder, must, program, run, write_boxes

PLAYERS, FRAMES = 16, 60
PAIRS = PLAYERS * (PLAYERS - 1)  # of a frame
WRONG = 1e-3  # of all pairs: the bound of the bakes here


class Town(InFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.town, cls.pvs = cls.make_city('town.glb'), cls.path('town.pvs')
        must(program('sightcell'), 'bake', cls.town, '-o', cls.pvs, '--cells-grid', -24, 0, -24, 24, 4, 24,
                 '--cell-size', 8, '--volumes', 2, '--quality', 'draft', '--progress', 'none')

    def serve(self, name, *more, frames=FRAMES):
        """Share of the pairs that are hidden, percent; what is printed; the record's file."""
        record = self.path(name)
        code, out, err = run(program('sightcell-relevance-server'), self.pvs, '--players', PLAYERS, '--frames', frames,
                             '--record', record, *more)
        self.assertEqual(code, 0, err)
        return float(re.search(r'([\d.]+) % hidden', out)[1]), out, record

    def look_at(self, record, frames=FRAMES):
        code, out, err = run(program('sightcell-test-hidden-pairs'), self.town, record)
        self.assertEqual(code, 0, err)
        found = json.loads(out)
        self.assertEqual(found['pairs'], PAIRS * frames)
        self.assertGreater(found['checked'], PAIRS * frames / 2, 'hardly an eye at a free place')
        return found

    def test_who_is_hidden_cannot_be_seen(self):
        hidden, out, record = self.serve('record.csv')
        found = self.look_at(record)
        self.assertGreater(hidden, 20)
        self.assertGreater(found['hidden'], found['checked'] / 5)
        self.assertLessEqual(found['wrong'], WRONG * found['checked'])
        self.assertIn('240 pairs per frame', out)
        self.assertIn(' 0.00 % outside all cells', out)
        self.assertGreater(float(re.search(r'([\d.]+) % of moves into', out)[1]), 0)

    def test_same_seed_same_game(self):
        _, _, first = self.serve('first.csv')
        _, _, again = self.serve('again.csv')
        _, _, other = self.serve('other.csv', '--seed', 2)
        texts = []
        for name in (first, again, other):
            with open(name, encoding='utf-8') as file:
                texts.append(file.read())
        self.assertEqual(texts[0], texts[1])
        self.assertNotEqual(texts[0], texts[2])

    def test_a_server_that_lags_hides_fewer(self):
        hidden, _, record = self.serve('now.csv')
        lagging, _, later = self.serve('lag.csv', '--lag', 0.25)
        self.assertLess(lagging, hidden)
        with open(record, encoding='utf-8') as now, open(later, encoding='utf-8') as lag:
            for line, line_later in zip(now, lag):
                self.assertLessEqual(line[-2], line_later[-2], 'who is visible stays so: ' + line)

    def test_a_server_that_lags_hides_nobody_who_has_walked_on(self):
        # Its answer of one frame with where the players are seven frames later: 0.23 of 0.25 seconds.
        frames = 240
        _, _, now = self.serve('now.csv', frames=frames)
        _, _, lag = self.serve('lag.csv', '--lag', 0.25, frames=frames)
        with open(now, encoding='utf-8') as file:
            header, *places = file.readlines()
        wrong = []
        for name, record in (('late_now.csv', now), ('late_lag.csv', lag)):
            with open(record, encoding='utf-8') as file:
                answers = file.readlines()[1:]
            late = self.path(name)
            with open(late, 'w', encoding='utf-8') as out:
                out.write(header)
                out.writelines(place[:-2] + answer[-2:] for place, answer in zip(places[7 * PAIRS:], answers))
            found = self.look_at(late, frames - 7)
            wrong.append(found['wrong'])
        self.assertEqual(wrong[1], 0)
        self.assertGreater(wrong[0], 0, 'who does not think of the lag is wrong')

    def test_rays_notice_who_is_hidden_wrongly(self):
        _, _, record = self.serve('record.csv')
        doctored = self.path('doctored.csv')
        with open(record, encoding='utf-8') as file, open(doctored, 'w', encoding='utf-8') as out:
            out.writelines(re.sub(r',1$', ',0', line) for line in file)
        found = self.look_at(doctored)
        self.assertEqual(found['hidden'], found['checked'])
        self.assertEqual(found['wrong'], found['checked'] - found['unseen_by_rays'])
        self.assertGreater(found['wrong'], 100)

    def test_a_file_without_volumes_is_refused(self):
        plain = self.path('plain.pvs')
        must(program('sightcell'), 'bake', self.town, '-o', plain, '--cells-grid', 0, 0, 0, 8, 4, 8, '--cell-size', 8,
                  '--progress', 'none')
        code, _, err = run(program('sightcell-relevance-server'), plain)
        self.assertEqual(code, 4)
        self.assertTrue(err.rstrip().endswith('[relevance.no-volumes]'), err)


# Three rooms in a row, 6 x 3 x 6 m each, with a doorway of 2 x 2.2 m between two of them and a door in each.
def write_rooms(path):
    walls = [((-0.2, -0.2, -0.2), (18.2, 0, 6.2)), ((-0.2, 3, -0.2), (18.2, 3.2, 6.2)), ((-0.2, 0, -0.2), (18.2, 3, 0)),
             ((-0.2, 0, 6), (18.2, 3, 6.2)), ((-0.2, 0, 0), (0, 3, 6)), ((18, 0, 0), (18.2, 3, 6))]
    for x in (6, 12):
        walls += [((x - 0.1, 0, 0), (x + 0.1, 3, 2)), ((x - 0.1, 0, 4), (x + 0.1, 3, 6)), ((x - 0.1, 2.2, 2), (x + 0.1, 3, 4))]
    doors = [[((x - 0.05, 0, 2), (x + 0.05, 2.2, 4))] for x in (6, 12)]
    write_boxes(path, [(walls, {}), (doors[0], {'group': 'west'}), (doors[1], {'group': 'east'})])


class Doors(InFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.scene = cls.path('rooms.glb')
        write_rooms(cls.scene)
        for name, closed in (('open', ()), ('west', ('west',)), ('east', ('east',)), ('both', ('west', 'east'))):
            must(program('sightcell'), 'bake', cls.scene, '-o', cls.path(name + '.pvs'), '--cells-grid', 0, 0, 0, 18, 3, 6,
                 '--cell-size', 3, '--volumes', 1, '--quality', 'draft', '--progress', 'none',
                 *(word for door in closed for word in ('--closed', door)))

    def closed(self, *files):
        return [word for doors, file in files for word in ('--closed', f'{doors}={self.path(file + ".pvs")}')]

    def serve(self, record, *more):
        """Share of the pairs that are hidden, percent, and what rays find."""
        code, out, err = run(program('sightcell-relevance-server'), self.path('open.pvs'), '--players', PLAYERS, '--frames',
                             FRAMES, '--door-period', 0.5, '--record', self.path(record), *more)
        self.assertEqual(code, 0, err)
        code, found, err = run(program('sightcell-test-hidden-pairs'), self.scene, self.path(record), 'west', 'east')
        self.assertEqual(code, 0, err)
        return float(re.search(r'([\d.]+) % hidden', out)[1]), json.loads(found)

    def test_closed_doors_hide_and_open_doors_do_not(self):
        every = (('west', 'west'), ('east', 'east'), ('west,east', 'both'))
        none, _ = self.serve('none.csv')
        one, one_found = self.serve('one.csv', *self.closed(every[0]))
        all_three, found = self.serve('all.csv', *self.closed(*every))
        self.assertLess(none, one)
        self.assertLess(one, all_three)
        for rays in (one_found, found):
            self.assertGreater(rays['checked'], PAIRS * FRAMES / 2)
            self.assertLessEqual(rays['wrong'], WRONG * rays['checked'])

    def test_rays_notice_a_door_that_is_open(self):
        self.serve('all.csv', *self.closed(('west', 'west'), ('east', 'east'), ('west,east', 'both')))
        with open(self.path('all.csv'), encoding='utf-8') as file, open(self.path('wrong.csv'), 'w', encoding='utf-8') as out:
            out.writelines(re.sub(r',3,([01])$', r',0,\1', line) for line in file)  # said to be open where both are closed
        _, found, _ = run(program('sightcell-test-hidden-pairs'), self.scene, self.path('wrong.csv'), 'west', 'east')
        self.assertGreater(json.loads(found)['wrong'], 20)

    def test_files_that_do_not_fit_are_refused(self):
        for given, code, identifier in (('west', 2, 'relevance.closed'), (f'west={self.path("east.pvs")}', 4, 'relevance.not-closed'),
                                        (f'north={self.path("west.pvs")}', 4, 'relevance.not-closed')):
            answer, _, err = run(program('sightcell-relevance-server'), self.path('open.pvs'), '--closed', given)
            self.assertEqual(answer, code, err)
            self.assertTrue(err.rstrip().endswith(f'[{identifier}]'), err)
