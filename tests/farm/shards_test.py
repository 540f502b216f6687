"""Shards without a farm: array variables given by hand, the manifests of samples/farm, and what merge takes and refuses.
"""
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import tempfile
import time

import harness
from harness import program, read

SAMPLE = os.path.join(harness.ROOT, 'samples', 'farm')
# Four blocks of 8 x 8 cells.
BAKE = ['--cells-grid=-8,1,-8,8,1.5,8', '--cell-size', '1', '--source', 'cpu', '--samples', '6', '--resolution', '32',
        '--max-pixel-error', '3e-2']
ARRAY_VARIABLES = re.compile('SLURM_|JOB_COMPLETION|AWS_BATCH_')


def slurm(task, first=0, last=3, step=1, count=4):
    return {'SLURM_ARRAY_TASK_ID': task, 'SLURM_ARRAY_TASK_MIN': first, 'SLURM_ARRAY_TASK_MAX': last,
            'SLURM_ARRAY_TASK_STEP': step, 'SLURM_ARRAY_TASK_COUNT': count}


def kubernetes(task, count=4):
    return {'JOB_COMPLETION_INDEX': task, 'JOB_COMPLETIONS': count}


def aws(task, count=4):
    return {'AWS_BATCH_JOB_ARRAY_INDEX': task, 'AWS_BATCH_JOB_ARRAY_SIZE': count}


class Shards(harness.InFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.scene, cls.alone = cls.make_city('city.glb', polygons=1000), cls.path('alone.pvs')
        cls.answer('bake', cls.scene, '-o', cls.alone, *BAKE)
        cls.all_there = cls.path('all_there')
        os.mkdir(cls.all_there)
        for phase in ('1', '2'):
            for shard in range(4):
                cls.bake_shard(cls.all_there, f'{shard}/4', phase)

    @staticmethod
    def run_program(*arguments, environment=()):
        """Exit code and standard error; of the array variables of this test's own surroundings the program sees none."""
        removed = {name: None for name in os.environ if ARRAY_VARIABLES.match(name)}
        code, _, err = harness.sightcell(*arguments, environment={**removed, **dict(environment)})
        return code, err

    @classmethod
    def answer(cls, *arguments, code=0, **more):
        answer, text = cls.run_program(*arguments, **more)
        if answer != code:
            raise AssertionError(f'{arguments}: {answer}, not {code}\n{text}')
        return text

    @classmethod
    def bake_shard(cls, folder, shard, phase='1', *more, scene=None, **rest):
        return cls.answer('bake', scene or cls.scene, '-o', os.path.join(folder, 'level.pvs'), *BAKE, '--shard', shard,
                          '--phase', phase, *more, **rest)

    def copy_of_all(self):
        folder = tempfile.mkdtemp(dir=self.folder)
        shutil.copytree(self.all_there, folder, dirs_exist_ok=True)
        return folder

    def assert_merges(self, folder, *files):
        level = os.path.join(folder, 'level.pvs')
        self.answer('merge', level, *files)
        self.assertEqual(read(level), read(self.alone))


class Arrays(Shards):
    def test_shard_and_count_come_from_the_array(self):
        for shard, environment, file in (
                ('array', slurm(1), '1-of-4'), ('array', kubernetes(2), '2-of-4'), ('array', aws(3), '3-of-4'),
                ('array', slurm(4, first=1, last=4), '3-of-4'), ('array', slurm(10, first=0, last=15, step=5), '2-of-4'),
                ('array/4', slurm(3, first=1, last=3, count=2), '3-of-4'), ('array/4', {'JOB_COMPLETION_INDEX': 0}, '0-of-4')):
            with self.subTest(shard=shard, environment=environment), tempfile.TemporaryDirectory(dir=self.folder) as folder:
                self.bake_shard(folder, shard, environment=environment)
                self.assertEqual(os.listdir(folder), [f'level.pvs.shard-{file}.phase-1'])

    def test_what_is_no_shard_is_refused(self):
        for shard, environment in (
                ('array', {}), ('array/4', {}), ('array', {'JOB_COMPLETION_INDEX': 1}), ('array', slurm('x')),
                ('array', aws(4)), ('array', aws(-1)), ('array/4', aws(4)), ('array/0', aws(0)), ('array', kubernetes(0, 0)),
                ('array', kubernetes('')),
                # Only some of an array, submitted again: it does not say how many there were.
                ('array', slurm(7, first=3, last=7, count=2)),
                ('4/4', {}), ('-1/4', {}), ('1', {}), ('a/b', {}), ('1/4/2', {}), ('0/0', {})):
            with self.subTest(shard=shard, environment=environment), tempfile.TemporaryDirectory(dir=self.folder) as folder:
                text = self.bake_shard(folder, shard, environment=environment, code=2)
                self.assertEqual(len([n for n in text.splitlines() if n.startswith('sightcell: ')]), 1, text)
                self.assertEqual(os.listdir(folder), [])

    def run_command(self, words, folder, scratch, **environment):
        """A container's command, here."""
        self.assertEqual(words[0], 'sightcell')
        places = {'/level/city.glb': self.scene, '/level/level.pvs': os.path.join(folder, 'level.pvs'), '/scratch': scratch}
        more = BAKE if words[1] == 'bake' else []
        self.answer(*[places.get(w, w) for w in words[1:]], *[w for w in more if w not in ('--source', 'cpu')],
                    environment=environment)

    def in_both_folders(self):
        return tempfile.mkdtemp(dir=self.folder), tempfile.mkdtemp(dir=self.folder)

    def test_kubernetes_manifests(self):
        folder, scratch = self.in_both_folders()

        def manifest(name, **values):
            text = read(os.path.join(SAMPLE, 'kubernetes', name)).decode()
            for key, value in values.items():
                self.assertIn(key, text)
                text = text.replace(key, str(value))
            self.assertNotIn('\t', text)
            return text, sum((json.loads(line) for line in re.findall(r'^ +(?:command|args): (\[.*\])$', text, re.M)), [])

        for phase in (1, 2):
            text, command = manifest('shards.yaml', PHASE=phase, SHARDS=4)
            self.assertIn('completionMode: Indexed\n  completions: 4\n', text)
            count = re.search(r'- name: (JOB_COMPLETIONS) .*\n +value: "(\d+)"', text)
            for shard in range(4):
                self.run_command(command, folder, scratch, JOB_COMPLETION_INDEX=shard, **{count[1]: count[2]})
        self.run_command(manifest('merge.yaml')[1], folder, scratch)
        self.assertEqual(read(os.path.join(folder, 'level.pvs')), read(self.alone))

    def test_aws_batch_job(self):
        folder, scratch = self.in_both_folders()
        command = json.loads(read(os.path.join(SAMPLE, 'aws_batch', 'shard.json')))['containerProperties']['command']
        for phase in ('1', '2'):
            for shard in range(4):
                self.run_command([phase if w == 'Ref::phase' else w for w in command], folder, scratch, **aws(shard))
        self.assert_merges(folder)


class Merge(Shards):
    def test_the_bytes_of_one_bake(self):
        self.assert_merges(self.copy_of_all())

    def test_missing_blocks_are_named(self):
        folder = self.copy_of_all()
        level = os.path.join(folder, 'level.pvs')
        os.remove(level + '.shard-2-of-4.phase-2')
        line = self.assert_one_error_line(self.answer('merge', level, code=1), 'shard.missing-blocks')
        self.assertIn('1 of 4 blocks lack phase 2: block ', line)
        os.remove(level + '.shard-2-of-4.phase-1')
        gone = self.assert_one_error_line(self.answer('merge', level, code=1), 'shard.missing-blocks')
        self.assertIn('1 of 4 blocks are in no shard: block ', gone)
        name = re.search(r'block [^;]*', gone)[0]
        self.assertIn(name, line)
        self.assertFalse(os.path.exists(level))
        self.assertIn(name, self.bake_shard(folder, '2/4', '2', code=1))
        self.bake_shard(folder, '2/4')
        self.bake_shard(folder, '2/4', '2')
        self.assert_merges(folder)

    def test_doubles_merge(self):
        folder, other = self.copy_of_all(), self.copy_of_all()
        self.bake_shard(other, '1/4', '2')
        names = [os.path.join(folder, n) for n in sorted(os.listdir(folder)) if n.endswith('phase-2')]
        self.assert_merges(folder, *names, os.path.join(other, 'level.pvs.shard-1-of-4.phase-2'))

    def test_arrays_of_other_sizes_mix(self):
        folder = self.copy_of_all()
        level = os.path.join(folder, 'level.pvs')
        for phase in ('1', '2'):
            for shard in (1, 3):
                os.remove(f'{level}.shard-{shard}-of-4.phase-{phase}')
        for phase in ('1', '2'):
            self.bake_shard(folder, '1/2', phase)
        self.assert_merges(folder)

    def test_more_shards_than_blocks(self):
        folder = tempfile.mkdtemp(dir=self.folder)
        for phase in ('1', '2'):
            for shard in range(6):
                self.bake_shard(folder, f'{shard}/6', phase)
        self.assert_merges(folder)

    def test_another_seed_and_another_scene_are_refused_by_name(self):
        town = os.path.join(self.folder, 'town.glb')
        self.make_city(town, polygons=1500)
        for what, scene, more in (('seed', self.scene, ['--seed', '2']), ('scene', town, [])):
            with self.subTest(what=what):
                folder, other = self.copy_of_all(), tempfile.mkdtemp(dir=self.folder)
                self.bake_shard(other, '2/4', '1', *more, scene=scene)
                shutil.copy(os.path.join(other, 'level.pvs.shard-2-of-4.phase-1'), folder)
                os.remove(os.path.join(folder, 'level.pvs.shard-3-of-4.phase-2'))
                level = os.path.join(folder, 'level.pvs')
                for text in (self.answer('merge', level, code=2), self.bake_shard(folder, '3/4', '2', code=2)):
                    line = self.assert_one_error_line(text, 'shard.other-bake')
                    self.assertIn('level.pvs.shard-2-of-4.phase-1: ', line)
                    self.assertIn(what, line)
                self.assertFalse(os.path.exists(level))


class Scratch(Shards):
    def test_a_newer_copy_is_taken_and_not_what_a_kill_left(self):
        """A task is killed on one node, goes on on another one, and comes back to the first."""
        folder, first, second = (tempfile.mkdtemp(dir=self.folder) for _ in range(3))
        level = os.path.join(folder, 'level.pvs')
        command = [program('sightcell'), 'bake', self.scene, '-o', level, *BAKE, '--shard', '0/1', '--scratch', first]
        with subprocess.Popen(command, stdin=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as killed:
            while killed.poll() is None and not any(p.stat().st_size > 40000 for p in pathlib.Path(first).glob('*-wal')):
                time.sleep(0.01)
            killed.kill()
        self.assertEqual(killed.returncode, -signal.SIGKILL)
        text = self.bake_shard(folder, '0/1', '1', '--scratch', second)
        self.assertIn('256 cells (0 were there)', text)
        os.rename(level + '.shard-0-of-1.phase-1', level + '.shard-0-of-1.phase-1.bake')
        self.assertIn('256 cells (256 were there)', self.bake_shard(folder, '0/1', '1', '--scratch', first))
