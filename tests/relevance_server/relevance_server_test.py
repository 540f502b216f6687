"""Runs sightcell-relevance-server in a baked town and has rays look at the players that it hides."""
import json
import os
import re

from harness import InFolder, must, program, run

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
