"""What a bake shows while it runs: a line on a terminal, lines in a log, JSON for tools."""
import fcntl
import json
import os
import pty
import re
import struct
import subprocess
import termios

from harness import TIMEOUT, Stopped, program

PHASES = ['merging_cells', 'estimating', 'baking_cells', 'checking_neighbors', 'writing_file']
REDRAW = '\r\x1b[K'


class Progress(Stopped):
    SAMPLES, RESOLUTION = 12, 64

    def command_of(self, output, mode):
        command = [program('sightcell'), *self.command(output, '--fresh'), '--source', 'cpu']
        return [mode if argument == 'json' else argument for argument in command]

    def on_terminal(self, columns):
        """All that a bake writes to a terminal of this width."""
        ours, its = pty.openpty()
        fcntl.ioctl(its, termios.TIOCSWINSZ, struct.pack('HHHH', 24, columns, 0, 0))
        running = subprocess.Popen(self.command_of(self.path('terminal.pvs'), 'auto'), stdin=subprocess.DEVNULL,
                                   stdout=subprocess.DEVNULL, stderr=its)
        os.close(its)
        written = b''
        try:
            while some := os.read(ours, 65536):
                written += some
        except OSError:
            pass  # the other end is closed
        os.close(ours)
        self.assertEqual(running.wait(timeout=TIMEOUT), 0, written)
        return written.decode().replace('\r\n', '\n')

    def test_a_terminal_has_a_line_that_never_wraps(self):
        for columns in (24, 40, 80, 120):
            written = self.on_terminal(columns)
            # What is drawn last before the line is cleared or a message follows.
            drawn = [part.split('\n')[-1] for part in written.split(REDRAW)]
            self.assertEqual([text for text in drawn if len(text) >= columns], [], columns)
            for start in ('loading city.glb', 'finding cells', 'baking cells: 0 of 8', 'writing the file'):
                self.assertTrue([text for text in drawn if text.startswith(start)], (start, drawn))

    def test_a_terminal_keeps_messages_and_the_last_line_only(self):
        screen = ['']
        for part in re.split(f'({re.escape(REDRAW)}|\n)', self.on_terminal(120)):
            if part == '\n':
                screen.append('')
            elif part == REDRAW:
                screen[-1] = ''
            else:
                screen[-1] += part
        self.assertEqual(screen[-1], '', 'nothing is left behind the last message')
        self.assertEqual(len([line for line in screen if line.startswith('baked 8 cells in ')]), 1, screen)
        for transient in ('loading', 'finding cells', 'estimating', 'baking cells', 'writing the file'):
            self.assertEqual([line for line in screen if line.startswith(transient)], [])

    def test_a_log_has_few_lines_and_no_control_characters(self):
        log = self.path('log.txt')
        with open(log, 'wb') as stream:
            done = subprocess.run(self.command_of(self.path('log.pvs'), 'auto'), stdin=subprocess.DEVNULL,
                                  stdout=subprocess.DEVNULL, stderr=stream, timeout=TIMEOUT, check=False)
        self.assertEqual(done.returncode, 0)
        with open(log, encoding='utf-8') as stream:
            text = stream.read()
        self.assertRegex(text, r'^[ -~\n]*$')
        self.assertEqual(len(re.findall(r'^baked 8 cells in ', text, re.MULTILINE)), 1, text)

    def test_json_has_the_phase_and_the_time_left_from_the_first_line_on(self):
        done = subprocess.run(self.command_of(self.path('json.pvs'), 'json'), stdin=subprocess.DEVNULL,
                              capture_output=True, text=True, timeout=TIMEOUT, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        lines = [json.loads(line) for line in done.stderr.splitlines() if line.startswith('{')]
        self.assertEqual(list(dict.fromkeys(line['phase'] for line in lines)), PHASES)
        bounded = [cell for line in lines for cell in line['bounded_cells']]
        self.assertEqual(sorted(cell['cell'] for cell in bounded), list(range(8)), 'each once')
        for cell in bounded:
            self.assertTrue(all(low < high for low, high in zip(cell['min'], cell['max'])), cell)
            self.assertGreater(cell['polygons'], 0)
            self.assertTrue(0 < cell['upper_bound'] <= 1e-3, cell)
            self.assertGreater(cell['seconds'], 0)
        lines = [line for line in lines if line['phase'] not in ('merging_cells', 'estimating')]
        self.assertEqual({line['cells_total'] for line in lines}, {8})
        self.assertEqual(lines[0]['cells_per_second'], 0)
        self.assertGreater(lines[0]['seconds_left'], 0, 'from the estimate')
        self.assertEqual(lines[-1]['cells'], 8)
