"""The cluster of these tests leaves nothing behind, however the process ends that held it.
"""
import os
import subprocess
import sys
import time
import unittest

import slurm_cluster


def processes_with(*texts):
    """Those whose command line has a word with each of the texts, but not this one."""
    return [pid for pid, words in slurm_cluster.processes()
            if pid != os.getpid() and words[0] != sys.executable and all(any(t in w for w in words) for t in texts)]


@slurm_cluster.needs_slurm
class Cluster(unittest.TestCase):
    def test_it_ends_with_the_process_that_held_it(self):
        mark = f'31536000.{os.getpid()}'  # seconds of a sleep, and what to find it by
        holder = subprocess.Popen([sys.executable, '-c', '''
import sys, time
sys.path.insert(0, sys.argv[1])
import slurm_cluster
with slurm_cluster.Cluster(nodes=1) as cluster:
    cluster.run('sbatch', '--output=/dev/null', '--wrap', 'setsid sleep ' + sys.argv[2] + ' & sleep ' + sys.argv[2])
    print(cluster.configuration, flush=True)
    time.sleep(1000)
''', os.path.dirname(os.path.abspath(__file__)), mark], stdout=subprocess.PIPE, text=True)
        with holder.stdout:
            folder = os.path.dirname(holder.stdout.readline().strip())
        self.assertTrue(os.path.isdir(folder))

        def wait_until(count):
            end = time.monotonic() + 60
            while time.monotonic() < end:
                found = processes_with('sleep', mark)
                if len(found) == count:
                    return
                time.sleep(0.1)
            self.fail(f'{len(found)} processes of the job, not {count}')

        wait_until(2)
        holder.kill()
        holder.wait()
        wait_until(0)
        end = time.monotonic() + 60
        while (os.path.exists(folder) or processes_with(folder)) and time.monotonic() < end:
            time.sleep(0.1)
        self.assertFalse(os.path.exists(folder))
        self.assertEqual(processes_with(folder), [])
