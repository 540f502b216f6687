"""Whatever happens to a bake, nothing finished is lost and no wrong file appears: signals, streams that nobody reads,
places that take no file, names in any writing, the order in which things reach the disk.

Kills at random moments, full disks and damaged checkpoints are tests/bench/bench_kills.py.
"""
import ctypes
import json
import os
import re
import signal
import socket
import subprocess
import sys

from harness import QUICK_BAKE, TIMEOUT, InRoom, Stopped, program, read, sightcell, write_city, write_room


class Quick(InRoom):
    """A bake that takes no time, of the room."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.whole = cls.path('undisturbed.pvs')
        code, _, err = sightcell(*cls.command(cls.whole))
        if code != 0:
            raise RuntimeError(err)

    @classmethod
    def command(cls, output, *more):
        return ['bake', cls.room, '-o', output, '--cells-file', cls.cells, '--source', 'cpu', *QUICK_BAKE, *more]

    def beside(self, output):
        folder, name = os.path.split(output)
        return [n for n in os.listdir(folder or '.') if n != name and n.startswith(name)]

    def assert_baked(self, output):
        self.assertEqual(read(output), read(self.whole))
        self.assertEqual(self.beside(output), [])


# --- what reaches the disk, and when

class Order(Quick):
    CALLS = 'open,openat,creat,write,pwrite64,writev,fsync,fdatasync,rename,renameat,renameat2,unlink,unlinkat,close'

    def trace(self, command):
        """Calls that went well: (name, arguments, files of the numbers among them)."""
        log = self.path('calls.txt')
        try:
            done = subprocess.run(['strace', '-f', '-y', '-qqq', '-s', '0', '-e', f'trace={self.CALLS}', '-o', log,
                                   program('sightcell'), *command], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                                  timeout=TIMEOUT)
        except FileNotFoundError:
            self.skipTest('there is no strace')
        if done.returncode != 0 and 'sightcell' not in done.stderr:
            self.skipTest('strace may not trace here: ' + done.stderr)
        self.assertEqual(done.returncode, 0, done.stderr)
        calls, open_lines = [], {}
        for line in read(log).decode(errors='surrogateescape').splitlines():
            thread, text = line.split(None, 1)
            if text.endswith('<unfinished ...>'):
                open_lines[thread] = text[:-len('<unfinished ...>')].rstrip()
                continue
            resumed = re.match(r'<\.\.\. \w+ resumed>(.*)', text)
            if resumed:
                text = open_lines.pop(thread) + resumed.group(1)
            call = re.match(r'(\w+)\((.*)\)\s+= (-?\d+)', text)
            if call and not call.group(3).startswith('-'):
                calls.append((call.group(1), call.group(2)))
        return calls

    def test_the_file_is_on_the_disk_before_its_name_and_the_checkpoint_goes_last(self):
        output = self.path('ordered.pvs')
        calls = self.trace(self.command(output))
        self.assertEqual(read(output), read(self.whole))
        folder = os.path.dirname(output)

        def first(what, after=-1):
            for i, (name, arguments) in enumerate(calls):
                if i > after and what(name, arguments):
                    return i
            self.fail(f'not found after call {after} of {calls}')

        def name_is(path):
            return lambda name, arguments: name.startswith('open') and f'"{path}"' in arguments

        renamed = first(lambda name, arguments: name.startswith('rename') and f'"{output}"' in arguments)
        temporary = re.match(r'(?:AT_FDCWD[^,]*, )?"([^"]+)"', calls[renamed][1]).group(1)
        self.assertEqual(os.path.dirname(temporary), folder, 'rename works inside one folder')
        self.assertFalse(any(name_is(output)(*call) for call in calls), 'nobody writes under the final name')
        opened = first(name_is(temporary))
        of_file = [i for i, (name, arguments) in enumerate(calls)
                   if f'<{temporary}>' in arguments and not name.startswith('open')]
        written = [i for i in of_file if 'write' in calls[i][0]]
        self.assertTrue(written)
        flushed = [i for i in of_file if calls[i][0] in ('fsync', 'fdatasync')]
        self.assertTrue(opened < written[0] and written[-1] < flushed[-1] < renamed, [calls[i] for i in of_file])
        folder_flushed = first(lambda name, arguments: name == 'fsync' and f'<{folder}>' in arguments, renamed)
        gone = first(lambda name, arguments: name.startswith('unlink') and f'"{output}.bake"' in arguments)
        self.assertLess(folder_flushed, gone, 'the finished file is safe before what it was made from goes')


# --- signals

class Signals(Stopped):
    def test_a_terminal_that_closes_is_an_orderly_end(self):
        output = self.path('hung-up.pvs')
        self.assertEqual(self.stop(output, signal.SIGHUP), 130)
        self.assert_resumes(output)

    def test_an_ignored_hangup_stays_ignored(self):
        """As under nohup."""
        running = self.start(self.path('nohup.pvs'), before=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
        running.send_signal(signal.SIGHUP)
        self.assertEqual(running.communicate(timeout=TIMEOUT) and running.returncode, 0)
        self.assertEqual(read(self.path('nohup.pvs')), self.whole())

    def test_the_second_signal_of_any_kind_ends_at_once(self):
        for first, second in ((signal.SIGINT, signal.SIGINT), (signal.SIGINT, signal.SIGTERM),
                              (signal.SIGHUP, signal.SIGTERM)):
            output = self.path(f'twice-{first}-{second}.pvs')
            running = self.start(output)
            running.send_signal(signal.SIGSTOP)  # both wait for it: it is in a cell when they come
            running.send_signal(first)
            running.send_signal(signal.SIGCONT)
            said = ''
            while 'stopping' not in said:
                line = running.stderr.readline()
                self.assertTrue(line, said)
                said += line
            running.send_signal(second)
            running.communicate(timeout=TIMEOUT)
            self.assertEqual(running.returncode, -second)
            self.assertFalse(os.path.exists(output))
        self.assert_resumes(output)

    def test_the_first_bake_ends_well_when_a_second_one_was_refused(self):
        output = self.path('in-use.pvs')
        running = self.start(output)
        running.send_signal(signal.SIGSTOP)
        try:
            line = self.assert_one_error_line(self.expect(1, *self.command(output))[1], 'checkpoint.in-use')
            self.assertIn(output + '.bake', line)
        finally:
            running.send_signal(signal.SIGCONT)
        running.communicate(timeout=TIMEOUT)
        self.assertEqual(running.returncode, 0)
        self.assertEqual(read(output), self.whole())
        self.assertEqual([n for n in os.listdir(self.folder) if n.startswith('in-use.pvs.')], [])

    def test_a_checkpoint_of_other_settings_or_another_scene_names_what_differs(self):
        output = self.path('other.pvs')
        self.stop(output, signal.SIGKILL)
        for option, value, name in (('--seed', '2', 'seed'), ('--sampler', 'halton', 'sampler'),
                                    ('--margin', '0.5', 'margin'), ('--smallest-gap', '0', 'smallest_gap'),
                                    ('--all-double-sided', None, 'all_double_sided')):
            changed = [option] + [value] * (value is not None)
            _, err = self.expect(2, *self.command(output, *changed))
            line = self.assert_one_error_line(err, 'checkpoint.other-bake')
            self.assertIn(f'differs in {name};', line)
        other = self.path('other-city.glb')
        write_city(other, polygons=2500)
        command = [other if argument == self.city else argument for argument in self.command(output)]
        _, err = self.expect(2, *command)
        self.assertIn('differs in the scene or its cells', self.assert_one_error_line(err, 'checkpoint.other-bake'))
        self.assertFalse(os.path.exists(output))
        self.assert_resumes(output)


# --- streams

class Streams(Stopped):
    SAMPLES, RESOLUTION = 12, 64

    def bake(self, output, *more, **streams):
        return subprocess.Popen([program('sightcell'), *self.command(output, *more)], stdin=subprocess.DEVNULL, **streams)

    def assert_baked(self, output):
        self.assertEqual(read(output), self.whole())
        self.assertEqual([n for n in os.listdir(self.folder) if n.startswith(os.path.basename(output) + '.')], [])

    def test_a_reader_of_the_progress_that_goes_away_does_not_end_the_bake(self):
        output = self.path('unread.pvs')
        running = self.bake(output, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        running.stdout.readline()
        running.stdout.close()
        self.assertEqual(running.wait(timeout=TIMEOUT), 0)
        self.assert_baked(output)

    def test_a_log_on_a_full_disk_does_not_end_the_bake(self):
        output = self.path('full-log.pvs')
        with open('/dev/full', 'w') as full:
            self.assertEqual(self.bake(output, stdout=subprocess.DEVNULL, stderr=full).wait(timeout=TIMEOUT), 0)
        self.assert_baked(output)

    def test_an_error_that_nobody_reads_still_has_its_exit_code(self):
        with open('/dev/full', 'w') as full:
            done = subprocess.run([program('sightcell'), 'info', self.path('missing.glb')], stderr=full, timeout=TIMEOUT)
        self.assertEqual(done.returncode, 4)

    def test_the_summary_for_a_reader_that_went_away_is_an_error_after_the_file_is_written(self):
        output = self.path('no-summary.pvs')
        running = self.bake(output, '--json', stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        running.stdout.close()
        err = running.stderr.read()
        running.stderr.close()
        self.assertEqual(running.wait(timeout=TIMEOUT), 1)
        self.assert_one_error_line(err, 'cli.not-writable')
        self.assert_baked(output)

    def test_closed_streams_are_not_mistaken_for_files(self):
        """Without them the next files opened are numbers 0, 1 and 2, and messages would be written into those."""
        for closed in ((1,), (2,), (0, 1, 2)):
            output = self.path(f'closed-{"".join(map(str, closed))}.pvs')
            shell = ' '.join(f'{number}>&-' for number in closed)
            command = [program('sightcell'), *self.command(output)]
            done = subprocess.run(['sh', '-c', f'exec "$@" {shell}', 'sh', *command], capture_output=True, timeout=TIMEOUT)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assert_baked(output)
        done = subprocess.run(['sh', '-c', 'exec "$@" >&-', 'sh', program('sightcell'), 'info', self.city],
                              capture_output=True, text=True, timeout=TIMEOUT)
        self.assertEqual(done.returncode, 1)
        self.assert_one_error_line(done.stderr, 'cli.not-writable')

    def test_a_limit_on_the_size_of_files_is_an_error_like_a_full_disk(self):
        output = self.path('limited.pvs')
        command = [program('sightcell'), *self.command(output)]
        done = subprocess.run(['sh', '-c', 'ulimit -f 8; exec "$@"', 'sh', *command], capture_output=True, text=True,
                              timeout=TIMEOUT)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertEqual(len([line for line in done.stderr.splitlines() if line.startswith('sightcell: ')]), 1)
        self.assertFalse(os.path.exists(output))
        self.expect(0, *command[1:])
        self.assert_baked(output)


# --- places

class Places(Quick):
    def assert_refused(self, code, identifier, output, *more, command=None):
        """At once: no cell is baked for nothing."""
        _, err = self.expect(code, *(command or self.command(output)), *more)
        self.assertNotIn('estimate', err)
        return self.assert_one_error_line(err, identifier)

    def test_an_output_that_is_no_file(self):
        folder, pipe = self.path('folder.pvs'), self.path('pipe.pvs')
        os.mkdir(folder)
        os.mkfifo(pipe)
        with socket.socket(socket.AF_UNIX) as listening:
            listening.bind(self.path('socket.pvs'))
        for output in (folder, folder + '/', pipe, self.path('socket.pvs'), '/dev/null'):
            before = os.lstat(output)
            self.assertIn(output, self.assert_refused(1, 'output.io', output))
            self.assertEqual(os.lstat(output), before)

    def test_a_checkpoint_that_is_a_folder(self):
        output = self.path('blocked.pvs')
        os.mkdir(output + '.bake')
        for more in ([], ['--fresh']):
            self.assertIn(output + '.bake', self.assert_refused(1, 'checkpoint.not-writable', output, *more))
        self.assertEqual(os.listdir(output + '.bake'), [])

    def test_a_folder_that_does_not_exist(self):
        self.assert_refused(1, 'checkpoint.not-writable', self.path('not/there/x.pvs'))

    def test_a_summary_that_cannot_be_written_is_refused_before_the_bake(self):
        output = self.path('summary.pvs')
        os.mkdir(self.path('summaries'))
        for name in ('not/there.json', 'summaries'):
            self.assertIn(name, self.assert_refused(1, 'cli.not-writable', output, '--json-file', self.path(name)))
        self.assertFalse(os.path.exists(output))

    def test_no_input_and_no_other_output_is_overwritten(self):
        before = [read(self.room), read(self.cells)]
        for output, summary in ((self.room, 's.json'), (self.cells, 's.json'), ('o.pvs', self.room), ('o.pvs', self.cells),
                                ('o.pvs', 'o.pvs'), ('o.pvs', 'nowhere/../o.pvs')):
            output, summary = self.path(output), self.path(summary)
            self.assert_refused(2, 'cli.output-is-input', output, '--json-file', summary)
        self.assertEqual([read(self.room), read(self.cells)], before)
        self.assertFalse(os.path.exists(self.path('o.pvs')))

    def test_a_name_that_sqlite_would_read_as_an_address(self):
        for name in ('file:x.pvs?mode=memory&x=', 'file:a%20b.pvs'):
            command = [program('sightcell'), *self.command(name)]
            done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, timeout=TIMEOUT)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assert_baked(self.path(name))
        checkpoint = self.path('file:c.pvs.bake')
        os.mkdir(checkpoint)  # it really is beside the output that the checkpoint goes
        done = subprocess.run([program('sightcell'), *self.command('file:c.pvs')], cwd=self.folder, capture_output=True,
                              text=True, timeout=TIMEOUT)
        self.assert_one_error_line(done.stderr, 'checkpoint.not-writable')

    def test_what_a_killed_writer_left_goes_and_nothing_else(self):
        output = self.path('cleaned.pvs')
        left = [output + '.tmp-1234-0', output + '.tmp-99-17']
        kept = [output + '.tmp-', output + '.tmp-1-x', output + '.tmp-1-2-3', output + 'x.tmp-1-2', output + '.old']
        for name in left + kept:
            with open(name, 'w', encoding='utf-8') as out:
                out.write('something')
        self.expect(0, *self.command(output))
        self.assertEqual([name for name in left if os.path.exists(name)], [])
        self.assertEqual([name for name in kept if not os.path.exists(name)], [])


class Mounts(Quick):
    """Folders that nobody may write, root neither."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        # Mounts of this process alone: they go when it ends.
        new_mount_namespace = 0x00020000
        cls.may_mount = os.geteuid() == 0 and ctypes.CDLL(None).unshare(new_mount_namespace) == 0 and \
            subprocess.run(['mount', '--make-rprivate', '/'], capture_output=True).returncode == 0

    def setUp(self):
        if not self.may_mount:
            self.skipTest('only root may mount')
        self.disk = self.path(self.id().rsplit('.', 1)[1])
        os.mkdir(self.disk)
        self.mount('-t', 'tmpfs', '-o', 'size=1m', 'none')
        self.addCleanup(subprocess.run, ['umount', '-l', self.disk], check=True)

    def mount(self, *how):
        subprocess.run(['mount', *how, self.disk], check=True)

    def test_a_read_only_disk(self):
        output = os.path.join(self.disk, 'x.pvs')
        self.mount('-o', 'remount,ro')
        line = self.assert_one_error_line(self.expect(1, *self.command(output))[1], 'checkpoint.not-writable')
        self.assertIn('Read-only file system', line)
        _, err = self.expect(1, *self.command(self.path('y.pvs'), '--json-file', os.path.join(self.disk, 'y.json')))
        self.assert_one_error_line(err, 'cli.not-writable')
        self.assertEqual(os.listdir(self.disk), [])

    def test_a_finished_file_on_a_read_only_disk_is_read(self):
        output = os.path.join(self.disk, 'x.pvs')
        self.expect(0, *self.command(output))
        self.mount('-o', 'remount,ro')
        self.expect(0, 'info', output)
        _, err = self.expect(1, 'patch', output, '--add', '0:1')
        self.assert_one_error_line(err, 'patch.not-written')
        self.assertEqual(read(output), read(self.whole))

    def test_a_disk_without_room(self):
        output = os.path.join(self.disk, 'x.pvs')
        with open(os.path.join(self.disk, 'ballast'), 'wb') as out:
            out.write(bytes(1 << 20))
        self.assert_one_error_line(self.expect(1, *self.command(output))[1], 'checkpoint.disk-full')
        os.remove(os.path.join(self.disk, 'ballast'))
        self.expect(0, *self.command(output))
        self.assert_baked(output)

    def test_a_user_who_may_not_write_there(self):
        output = os.path.join(self.disk, 'x.pvs')
        os.chmod(self.disk, 0o755)
        os.chmod(self.folder, 0o755)
        as_nobody = ['setpriv', '--reuid=65534', '--clear-groups', program('sightcell')]
        if subprocess.run([*as_nobody, '--version'], capture_output=True).returncode != 0:
            self.skipTest('nobody cannot run the program here')
        done = subprocess.run([*as_nobody, *self.command(output)], capture_output=True, text=True, timeout=TIMEOUT)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assert_one_error_line(done.stderr, 'checkpoint.not-writable')


# --- names

NAMES = ['Stra\u00dfe \u00fc\u00f6\u00e4', '\u57ce\u5e02', 'with  spaces ', '"quoted" \'twice\'', 'two\nlines', 'tab\tbell\a', '[1,2]',
         '-dash', 'percent %20 %s {}', '\U0001f3d9', os.fsdecode(b'not UTF-8: \xff\xfe\xe9')]


class Names(Quick):
    def test_files_and_folders_of_any_name(self):
        for name in NAMES:
            with self.subTest(name=name):
                folder = self.path(name)
                os.mkdir(folder)
                scene, cells = os.path.join(folder, name + '.glb'), os.path.join(folder, name + '.json')
                output, summary = os.path.join(folder, name + '.pvs'), os.path.join(folder, name + ' summary')
                write_room(scene)
                with open(cells, 'wb') as out:
                    out.write(read(self.cells))
                out, err = self.expect(0, 'bake', scene, '-o', output, '--cells-file', cells, '--source', 'cpu', *QUICK_BAKE,
                                       '--json', '--json-file', summary, '--progress', 'json')
                self.assert_baked(output)
                self.assertEqual(read(summary), out.encode())
                shown = output.encode(errors='surrogateescape').decode(errors='replace')
                self.assertEqual(self.shortened(json.loads(out)['output']), self.shortened(shown))
                for line in err.splitlines():
                    if line.startswith('{'):
                        json.loads(line)
                json.loads(self.expect(0, 'info', scene, '--json')[0])
                json.loads(self.expect(0, 'info', output, '--json')[0])
                json.loads(self.expect(0, 'verify', scene, output, '--rays', '20000', '--json')[0])
                json.loads(self.expect(0, 'patch', output, '--add', '0:1', '--json')[0])
                _, err = self.expect(4, 'info', scene + '.missing')
                self.assert_one_error_line(err, 'scene.not-found')

    @staticmethod
    def shortened(text):
        """Decoders put different numbers of replacement characters in the place of what is no UTF-8."""
        return re.sub('\ufffd+', '\ufffd', text)

    def test_an_error_is_one_line_whatever_the_name(self):
        for name in NAMES:
            for path in (self.path(name + '.missing.glb'), self.path(name + '.missing.pvs')):
                _, err = self.expect(4, 'info', path)
                self.assertEqual(err.count('\n'), 1, err)
                self.assertFalse(re.search('[\x00-\x09\x0b-\x1f\x7f]', err), repr(err))

    def test_nodes_of_any_name(self):
        for number, name in enumerate([*NAMES[:-1], 'long ' * 100]):
            with self.subTest(name=name):
                scene, cells = self.path(f'nodes-{number}.glb'), self.path(f'nodes-{number}.json')
                output = self.path(f'nodes-{number}.pvs')
                write_room(scene, nodes=[{'mesh': 0, 'name': name}, {'mesh': 0, 'name': 'again'}], scenes=[[0, 1]],
                           animations=[{'channels': [{'sampler': 0, 'target': {'node': 0, 'path': 'scale'}}], 'samplers': []}])
                with open(cells, 'w', encoding='utf-8') as out:
                    json.dump({'cells': [{'name': name, 'min': [3, 1, 3], 'max': [5, 2, 5]}], 'never': {'nodes': [name]}}, out,
                              ensure_ascii=number % 2 == 0)
                json.loads(self.expect(0, 'info', scene, '--json')[0])
                out, err = self.expect(0, 'bake', scene, '-o', output, '--cells-file', cells, '--source', 'cpu', *QUICK_BAKE,
                                       '--animated', 'rest', '--json')
                self.assertEqual(json.loads(out)['visible_set_percent'], 50.0)
                info = json.loads(self.expect(0, 'info', output, '--json')[0])
                self.assertEqual(info['settings']['overrides']['never'], [[0, 11]])
                with open(cells, 'w', encoding='utf-8') as out:
                    json.dump({'cells': [{'min': [3, 1, 3], 'max': [5, 2, 5]}], 'never': {'nodes': [name + '?']}}, out)
                _, err = self.expect(4, 'bake', scene, '-o', output, '--cells-file', cells, '--source', 'cpu', *QUICK_BAKE)
                self.assert_one_error_line(err, 'cells.no-such-node')

    def test_json_that_is_no_utf8_is_refused(self):
        scene, cells = self.path('latin.glb'), self.path('latin.json')
        write_room(scene, nodes=[{'mesh': 0, 'name': 'XXXX'}])
        content = read(scene)
        with open(scene, 'wb') as out:
            out.write(content.replace(b'XXXX', b'Stra\xdfe'[:4]).replace(b'Stra', b'\xdf\xff\xe4b'))
        self.assert_one_error_line(self.expect(4, 'info', scene)[1], 'scene.bad-json')
        with open(cells, 'wb') as out:
            out.write(b'{"cells":[{"name":"Stra\xdfe","min":[3,1,3],"max":[5,2,5]}]}')
        _, err = self.expect(4, 'bake', self.room, '-o', self.path('latin.pvs'), '--cells-file', cells, '--source', 'cpu')
        self.assert_one_error_line(err, 'cells.not-json')
