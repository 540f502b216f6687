#!/usr/bin/env python3
"""A real Slurm on this machine alone: its own munge key, ports and folders; no systemd, accounting or cgroups.

usage: slurm_cluster.py [--nodes N] [--cpus N]    runs one until standard input ends; prints what to put into SLURM_CONF

Tests use `Cluster`, which runs this program and holds its standard input: when the test ends, however it ends, so does
the cluster. All processes that come of it, also those that the jobs left behind, are its descendants (it is their
subreaper) and are killed by number before it exits.
"""
import argparse
import ctypes
import os
import pwd
import secrets
import select
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAMS = ('munged', 'slurmctld', 'slurmd', 'sbatch', 'squeue', 'scancel', 'scontrol', 'sinfo')
START = 60  # seconds until all nodes must be idle
PR_SET_PDEATHSIG, PR_SET_CHILD_SUBREAPER = 1, 36
LIBC = ctypes.CDLL(None, use_errno=True)

# KillWait: between a job's SIGTERM and SIGKILL. cred_expire: how long a requeued job waits; below 5, two minutes.
# What a task prolog prints goes into the job's environment. The nodes are one machine; their local disks are not.
TASK_PROLOG = '''#!/bin/sh
mkdir -p "{folder}/disk-$SLURMD_NODENAME"
echo "export TMPDIR={folder}/disk-$SLURMD_NODENAME"
'''

CONFIGURATION = '''
ClusterName=sightcell
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={ports[0]}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket,cred_expire=5
CredType=cred/munge
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool-%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd-%n.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd-%n.log
SlurmdParameters=config_overrides
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MailProg=/bin/true
TaskProlog={folder}/task_prolog
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerType=sched/backfill
SchedulerParameters=bf_interval=2,sched_interval=2,batch_sched_delay=1
PreemptType=preempt/partition_prio
PreemptMode=REQUEUE
ReturnToService=2
KillWait=5
MessageTimeout=60
SlurmdTimeout=300
{nodes}
PartitionName=farm Nodes=ALL Default=YES MaxTime=INFINITE State=UP PriorityTier=1 PreemptMode=REQUEUE
PartitionName=urgent Nodes=ALL MaxTime=INFINITE State=UP PriorityTier=2 PreemptMode=OFF
'''


def missing_programs():
    path = os.environ.get('PATH', '') + ':/usr/sbin:/sbin'
    return [p for p in PROGRAMS if not shutil.which(p, path=path)]


def needs_slurm(tests):
    """A class of tests that is skipped where there is no Slurm."""
    missing = missing_programs()
    return unittest.skipIf(missing, f'no {", ".join(missing)} here: scripts/bootstrap --farm installs Slurm')(tests)


def processes():
    """Number and command line of each on this machine."""
    for name in os.listdir('/proc'):
        if name.isdigit():
            try:
                with open(f'/proc/{name}/cmdline', encoding='utf-8', errors='replace') as file:
                    words = file.read().split('\0')
            except (FileNotFoundError, ProcessLookupError):
                continue  # it ended meanwhile
            yield int(name), words


class Cluster:
    """`with Cluster(nodes=4, cpus=1) as cluster:`"""

    def __init__(self, nodes=4, cpus=1):
        self.supervisor = subprocess.Popen([sys.executable, os.path.abspath(__file__), '--nodes', str(nodes), '--cpus',
                                            str(cpus)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.configuration = self.supervisor.stdout.readline().strip()
        if not self.configuration:
            self.supervisor.wait()
            raise RuntimeError('the cluster did not start; what it wrote stands above')
        self.environment = {**os.environ, 'SLURM_CONF': self.configuration}

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.supervisor.stdin.close()
        self.supervisor.wait()
        self.supervisor.stdout.close()

    def run(self, *command, **more):
        """Standard output of one of Slurm's commands."""
        done = subprocess.run([str(c) for c in command], env=self.environment, stdin=subprocess.DEVNULL, text=True,
                              capture_output=True, timeout=120, check=False, **more)
        if done.returncode != 0:
            raise RuntimeError(f'{command}: {done.stdout}{done.stderr}')
        return done.stdout


def free_ports(count):
    """They stay free only as long as nobody takes them: the cluster tries again with others."""
    sockets = [socket.socket() for _ in range(count)]
    for s in sockets:
        s.bind(('127.0.0.1', 0))
    ports = [s.getsockname()[1] for s in sockets]
    for s in sockets:
        s.close()
    return ports


def write_configuration(folder, nodes, cpus):
    host = socket.gethostname().split('.')[0]
    ports = free_ports(1 + nodes)
    lines = '\n'.join(f'NodeName=node-{i} NodeHostname={host} NodeAddr=127.0.0.1 Port={ports[1 + i]} CPUs={cpus} State=UNKNOWN'
                      for i in range(nodes))
    path = os.path.join(folder, 'slurm.conf')
    with open(path, 'w', encoding='utf-8') as out:
        out.write(CONFIGURATION.format(host=host, ports=ports, user=pwd.getpwuid(os.geteuid()).pw_name, folder=folder,
                                       nodes=lines))
    with open(os.path.join(folder, 'cgroup.conf'), 'w', encoding='utf-8') as out:
        out.write('CgroupPlugin=cgroup/v1\n')  # the one that never asks dbus; nothing uses it
    with open(os.path.join(folder, 'task_prolog'), 'w', encoding='utf-8', opener=lambda p, f: os.open(p, f, 0o755)) as out:
        out.write(TASK_PROLOG.format(folder=folder))
    for name in ['state', *(f'spool-node-{i}' for i in range(nodes))]:
        os.mkdir(os.path.join(folder, name), 0o755)
    with open(os.path.join(folder, 'munge.key'), 'wb', opener=lambda p, f: os.open(p, f, 0o600)) as out:
        out.write(secrets.token_bytes(128))
    return path


def die_with_parent():
    LIBC.prctl(PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)


def descendants():
    """Of this process, by number: children that are not waited for yet count."""
    parents = {}
    for name in os.listdir('/proc'):
        if name.isdigit():
            try:
                with open(f'/proc/{name}/stat', encoding='utf-8', errors='replace') as file:
                    parents[int(name)] = int(file.read().rsplit(')', 1)[1].split()[1])
            except (OSError, IndexError):
                continue  # it ended meanwhile
    found, again = {os.getpid()}, True
    while again:
        more = {p for p, parent in parents.items() if parent in found} - found
        found |= more
        again = bool(more)
    return found - {os.getpid()}


def reap():
    try:
        while os.waitpid(-1, os.WNOHANG)[0] != 0:
            pass
    except ChildProcessError:
        pass


def kill_descendants(first=()):
    """`first`: those that would start others."""
    for process in first:
        process.kill()
    while True:
        reap()
        left = descendants()
        if not left:
            return
        for pid in left:
            try:
                os.kill(pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
        time.sleep(0.05)


class Daemons:
    def __init__(self, folder, nodes, cpus):
        self.folder = folder
        self.nodes = nodes
        self.configuration = write_configuration(folder, nodes, cpus)
        self.environment = {**os.environ, 'SLURM_CONF': self.configuration,
                            'PATH': os.environ.get('PATH', '') + ':/usr/sbin:/sbin'}
        self.running = []

    def start(self, name, *command):
        with open(os.path.join(self.folder, name + '.out'), 'wb') as out:
            process = subprocess.Popen(command, env=self.environment, stdin=subprocess.DEVNULL, stdout=out,
                                       stderr=subprocess.STDOUT, preexec_fn=die_with_parent)
        self.running.append(process)

    def start_all(self):
        """Whether all nodes became idle."""
        at = self.folder
        self.start('munged', 'munged', '--foreground', f'--key-file={at}/munge.key', f'--socket={at}/munge.socket',
                   f'--pid-file={at}/munge.pid', f'--log-file={at}/munge.log', f'--seed-file={at}/munge.seed')
        end = time.monotonic() + START
        while not os.path.exists(at + '/munge.socket') and self.all_run() and time.monotonic() < end:
            time.sleep(0.05)
        self.start('slurmctld', 'slurmctld', '-D', '-f', self.configuration)
        for i in range(self.nodes):
            self.start(f'slurmd-{i}', 'slurmd', '-D', '-f', self.configuration, '-N', f'node-{i}')
        while self.all_run() and time.monotonic() < end:
            said = subprocess.run(['sinfo', '--noheader', '--Node', '--partition=farm', '--format=%T'], check=False,
                                  env=self.environment, capture_output=True, text=True).stdout.split()
            if said == ['idle'] * self.nodes:
                return True
            time.sleep(0.2)
        return False

    def all_run(self):
        return all(p.poll() is None for p in self.running)

    def last_words(self):
        for name in sorted(os.listdir(self.folder)):
            path = os.path.join(self.folder, name)
            if name.endswith(('.out', '.log')) and os.path.getsize(path):
                with open(path, encoding='utf-8', errors='replace') as file:
                    yield f'{name}: ' + '  '.join(file.read().splitlines()[-4:])


def serve(nodes, cpus):
    LIBC.prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    words = []
    for _ in range(3):
        folder = tempfile.mkdtemp(prefix='slurm-')  # short: it holds a socket
        os.chmod(folder, 0o755)
        daemons = Daemons(folder, nodes, cpus)
        try:
            if daemons.start_all():
                print(daemons.configuration, flush=True)
                while not select.select([sys.stdin], [], [], 0.5)[0]:
                    reap()
                return 0
            words = list(daemons.last_words())
        finally:
            kill_descendants(daemons.running)
            shutil.rmtree(folder, ignore_errors=True)
    print('slurm_cluster: no node became idle\n  ' + '\n  '.join(words), file=sys.stderr)
    return 1


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('--nodes', type=int, default=4)
    parser.add_argument('--cpus', type=int, default=1)
    args = parser.parse_args()
    if missing_programs():
        print(f'slurm_cluster: no {", ".join(missing_programs())} here', file=sys.stderr)
        return 77
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):  # may come to a whole group: the end of input counts
        signal.signal(number, lambda *_: None)  # not ignored: daemons and jobs would inherit that
    return serve(args.nodes, args.cpus)


if __name__ == '__main__':
    sys.exit(main())
