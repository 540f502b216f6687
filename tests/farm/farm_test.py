"""Sixteen shards on a real Slurm, some of them struck at random moments, are the bytes of one bake.

The cluster is made here and taken down again (slurm_cluster.py). --setting seed=N strikes as an earlier run did,
--setting strikes=all three times as often.
"""
import collections
import contextlib
import os
import random
import re
import select
import shlex
import signal
import sqlite3
import subprocess
import time

import harness
import slurm_cluster
from harness import read

SAMPLE = os.path.join(harness.ROOT, 'samples', 'farm')
SHARDS = 16
# 16 blocks of 8 x 8 cells in the middle of the town.
BAKE = ['--cells-grid=-16,1,-16,16,1.5,16', '--cell-size', '1', '--samples', '6', '--resolution', '64',
        '--max-pixel-error', '3e-2', '--seed', '7']
IN_ORDER = 'signal before the time limit'
PATIENCE = 600  # seconds for one submission: a hang must end, no result depends on it


Victim = collections.namedtuple('Victim', 'pid process task node file')  # process: a file descriptor


def send(victim, number):
    """Whether it was still there."""
    try:
        signal.pidfd_send_signal(victim.process, number)
    except ProcessLookupError:
        return False
    return True


def waits(pid, number):
    """Whether a signal was sent to a stopped process."""
    with open(f'/proc/{pid}/status', encoding='utf-8') as file:
        return int(re.search(r'ShdPnd:\s*(\w+)', file.read())[1], 16) >> (number - 1) & 1


class Strikes:
    """Ends running shards in every way that a farm knows. A victim is stopped first, lest it be done meanwhile; Slurm lets
    it run again before it asks it to end."""

    def __init__(self, cluster, level, numbers):
        self.cluster, self.level, self.numbers = cluster, level, numbers
        self.kinds = {'kill -9 of the bake': self.kill_bake, 'scancel --signal=KILL': self.kill_job,
                      'scontrol requeue': self.requeue, IN_ORDER: self.limit,
                      'preemption': self.preempt}
        self.done = collections.Counter()
        self.copied = 0  # records in all copies that were found
        self.kept = collections.Counter()  # by shard under way: records in the copy that was left beside the level
        self.lost = []

    def running(self, phase):
        """Shards in work: process and the variables of its environment."""
        for pid, words in slurm_cluster.processes():
            if '--shard' in words and self.level in words and words[words.index('--phase') + 1] == phase:
                try:
                    lines = read(f'/proc/{pid}/environ').decode(errors='replace').split('\0')
                except (FileNotFoundError, ProcessLookupError):
                    continue  # it ended meanwhile
                variables = dict(v.split('=', 1) for v in lines if '=' in v)
                if 'SLURM_ARRAY_TASK_ID' in variables:
                    yield pid, variables

    def choose(self, phase):
        found = sorted(self.running(phase), key=lambda v: v[0])
        if not found:
            return None
        pid, variables = self.numbers.choice(found)
        task = variables['SLURM_ARRAY_TASK_ID']
        try:
            process = os.pidfd_open(pid)
        except ProcessLookupError:
            return None
        if pid not in (p for p, _ in self.running(phase)):  # its number may be another's by now
            os.close(process)
            return None
        return Victim(pid, process, f'{variables["SLURM_ARRAY_JOB_ID"]}_{task}', variables['SLURMD_NODENAME'],
                      f'{self.level}.shard-{task}-of-{SHARDS}.phase-{phase}')

    def log_size(self, victim):
        """Bytes of the log beside its database; None: it has none, or has ended."""
        try:
            for name in os.listdir(f'/proc/{victim.pid}/fd'):
                path = os.readlink(f'/proc/{victim.pid}/fd/{name}')
                if path.endswith('.bake-wal'):
                    return os.path.getsize(path)
        except (FileNotFoundError, ProcessLookupError):
            pass
        return None

    def until_records(self, victim):
        """Until what it has written has grown twice: the first time it may have been the empty tables."""
        end, sizes = time.monotonic() + PATIENCE, set()
        while len(sizes) < 3 and time.monotonic() < end and not select.select([victim.process], [], [], 0.01)[0]:
            if (size := self.log_size(victim)) is not None:
                sizes.add(size)

    def strike(self, kind, phase, longest):
        """Whether a shard of the phase was ended before its time."""
        victim = self.choose(phase)
        if victim is None:
            return False
        try:
            if kind == IN_ORDER and phase == '1':
                self.until_records(victim)  # there has to be something to leave
            else:
                time.sleep(self.numbers.uniform(0, longest))
            if not send(victim, signal.SIGSTOP):
                return False
            if os.path.exists(victim.file):
                send(victim, signal.SIGCONT)
                return False
            self.kinds[kind](victim)
            select.select([victim.process], [], [], PATIENCE)  # until it has ended
        finally:
            os.close(victim.process)
        ended = not os.path.exists(victim.file)  # asked to end in order, it may rather be done
        self.done[kind] += ended
        self.look_at_copy(victim.file)
        return ended

    def look_at_copy(self, shard):
        """The next one begins with what the last one had."""
        if os.path.exists(shard + '.bake'):
            with contextlib.closing(sqlite3.connect(f'file:{shard}.bake?immutable=1', uri=True)) as copy:
                (records,) = copy.execute('SELECT count(*) FROM record').fetchone()
            if records < self.kept[shard]:
                self.lost.append(f'{os.path.basename(shard)}: {self.kept[shard]} records, then {records}')
            self.kept[shard] = records
            self.copied += records

    def forget(self, shard):
        """It begins anew, and its next copy may hold less than its last."""
        self.kept.pop(shard, None)

    def kill_bake(self, victim):
        send(victim, signal.SIGKILL)

    def kill_job(self, victim):
        self.cluster.run('scancel', '--signal=KILL', '--full', victim.task)

    def requeue(self, victim):
        self.cluster.run('scontrol', 'requeue', victim.task)

    def limit(self, victim):
        """As --signal=B:USR1@120 does it."""
        self.cluster.run('scancel', '--signal=USR1', '--batch', victim.task)
        end = time.monotonic() + PATIENCE
        while not waits(victim.pid, signal.SIGTERM) and time.monotonic() < end:
            time.sleep(0.05)
        send(victim, signal.SIGCONT)

    def preempt(self, victim):
        self.cluster.run('sbatch', '--partition=urgent', f'--nodelist={victim.node}', '--output=/dev/null', '--wrap', 'true')


def guide(start):
    """The line of the sample's guide that starts so, as words."""
    lines = read(os.path.join(SAMPLE, 'README.md')).decode().splitlines()
    (line,) = [line for line in lines if line.startswith(start)]
    return shlex.split(line)


@slurm_cluster.needs_slurm
class Farm(harness.InFolder):
    @classmethod
    def setUpClass(cls):
        cls.cluster = cls.enterClassContext(slurm_cluster.Cluster(nodes=4, cpus=1))
        super().setUpClass()
        cls.level = cls.path('level.pvs')
        cls.make_city('city.glb', polygons=2000)

    @classmethod
    def execute(cls, *command, code=0):
        """What it says. It finds the programs as on a farm: sightcell and the sample's script in PATH."""
        path = ':'.join([SAMPLE, harness.BIN, os.environ['PATH']])
        done = subprocess.run(command, env={**cls.cluster.environment, 'PATH': path}, cwd=cls.folder, text=True, check=False,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=PATIENCE)
        if done.returncode != code:
            raise AssertionError(f'{command}: {done.returncode}, not {code}\n{done.stdout}')
        return done.stdout

    def until_idle(self, meanwhile=lambda: None):
        end = time.monotonic() + PATIENCE
        while self.cluster.run('squeue', '--noheader', '--partition=farm'):
            self.assertLess(time.monotonic(), end, self.cluster.run('squeue'))
            meanwhile()
            time.sleep(0.3)

    def logs(self):
        folder = self.level + '.logs'
        return {n: read(os.path.join(folder, n)).decode(errors='replace') for n in sorted(os.listdir(folder))}

    def last_words(self):
        return '\n'.join(f'{n}: {t.splitlines()[-1]}' for n, t in self.logs().items() if t)

    def bake_alone(self):
        """CPU seconds of one bake."""
        before = os.times()
        self.execute('sightcell', 'bake', 'city.glb', '-o', 'alone.pvs', '--source', 'cpu', *BAKE)
        after = os.times()
        return after.children_user - before.children_user + after.children_system - before.children_system

    def bake_two_by_hand(self):
        *words, job = guide('sbatch --array=3,7')
        self.execute(*words[:-1], '--output=by-hand-%a.txt', words[-1], job + ' ' + ' '.join(BAKE))
        self.until_idle()
        self.assertEqual({n for n in os.listdir(self.folder) if n.startswith('level')},
                         {f'level.pvs.shard-{i}-of-16.phase-1' for i in (3, 7)})
        self.assertIn('14 of 16 blocks are in no shard', self.execute('sightcell', 'merge', 'level.pvs', code=1))
        self.assertFalse(os.path.exists(self.level))

    def lose(self, numbers, strikes):
        """When all is done and not enough was struck: some shards have to be baked again."""
        if os.path.exists(self.level):
            os.remove(self.level)
            for shard in numbers.sample(range(SHARDS), 4):
                for phase in (1, 2):
                    file = f'{self.level}.shard-{shard}-of-{SHARDS}.phase-{phase}'
                    os.remove(file)
                    strikes.forget(file)

    def test_sixteen_shards_with_strikes(self):
        spent = self.bake_alone()
        self.bake_two_by_hand()
        seed = int(harness.SETTINGS.get('seed', int.from_bytes(os.urandom(3), 'little')))
        print(f'farm: seed {seed}, one bake {spent:.1f} s of CPU time', flush=True)
        numbers = random.Random(seed)
        strikes = Strikes(self.cluster, self.level, numbers)
        # Each kind once; in a long run each again, and each in phase 2. Taken from the end.
        rounds = (('1', 2), ('2', 1)) if harness.SETTINGS.get('strikes') == 'all' else (('1', 1), ('2', 0))
        plan = {phase: [k for _ in range(times) for k in numbers.sample(list(strikes.kinds), len(strikes.kinds))]
                for phase, times in rounds}
        # A shard takes a while until its first cell: an earlier end leaves no record.
        longest = {'1': spent / SHARDS, '2': 0.05}

        def strike():
            for phase, kinds in plan.items():
                if kinds and strikes.strike(kinds[-1], phase, longest[phase]):
                    kinds.pop()

        submissions = 0
        while not os.path.exists(self.level) or plan['1']:
            self.lose(numbers, strikes)
            submissions += 1
            self.execute(*guide('slurm_bake.sh 16'), *BAKE)
            if submissions == 1:
                queue = self.cluster.run('squeue', '--noheader', '--array', '--name=phase-1', '--format=%K').split()
                self.assertEqual({int(task) for task in queue} & {3, 7}, set())  # these are there
            self.until_idle(strike)
            self.assertLess(submissions, 40, self.last_words())
            # An end in order leaves what was done; where it came before the first record, another has to come.
            if not plan['1'] and not strikes.copied:
                plan['1'].append(IN_ORDER)
        print(f'farm: {submissions} submissions, {strikes.copied} records in copies of struck shards; ' +
              ', '.join(f'{k}: {n}' for k, n in strikes.done.items()), flush=True)
        self.assertGreater(strikes.copied, 0)
        self.assertEqual(strikes.lost, [])
        self.assertEqual(read(self.level), read(os.path.join(self.folder, 'alone.pvs')))
        self.assertEqual([n for n in os.listdir(self.folder) if n.endswith('.bake')], [])
