"""Bakes that were stopped in all the ways there are."""
import json
import os
import signal
import subprocess
import time

from harness import QUICK_BAKE, TIMEOUT, Stopped, program, read


class Resume(Stopped):
    """Stopped in all the ways there are."""

    def test_kill_and_resume_gives_the_same_bytes(self):
        output = self.path('killed.pvs')
        self.assertEqual(self.stop(output, signal.SIGKILL), -signal.SIGKILL)
        self.assert_resumes(output)

    def test_two_kills(self):
        output = self.path('twice.pvs')
        self.stop(output, signal.SIGKILL)
        self.assertEqual(self.stop(output, signal.SIGKILL), -signal.SIGKILL)
        self.assert_resumes(output, after=2)

    def test_interrupt_answers_130_and_resumes(self):
        output = self.path('stopped.pvs')
        for number in (signal.SIGINT, signal.SIGTERM):
            self.assertEqual(self.stop(output, number), 130)
        self.assert_resumes(output, after=2)

    def test_an_interrupt_while_cells_are_found(self):
        big, output = self.make_city('big.glb', polygons=300000), self.path('early.pvs')
        for wait in (0, 0.05, 0.1, 0.2, 0.4):  # on a busy machine the signal may come before the bake begins, or later
            running = subprocess.Popen([program('sightcell'), 'bake', big, '-o', output, '--threads', '1', '--progress', 'json'],
                                       stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            self.addCleanup(running.stderr.close)
            for line in running.stderr:
                if '300,000 polygons' in line:  # it is loaded
                    break
            time.sleep(wait)
            running.send_signal(signal.SIGINT)
            _, said = running.communicate(timeout=TIMEOUT)
            if running.returncode == -signal.SIGINT:
                continue
            self.assertEqual(running.returncode, 130)
            if 'stopped before the first cell' in said:
                self.assertNotIn('merging', said)
                self.assertEqual([n for n in os.listdir(self.folder) if n.startswith('early.pvs')], [])
                return
        self.fail('no signal came while cells were found')

    def test_interrupted_in_its_time_budget_it_leaves_a_file_and_goes_on(self):
        output = self.path('in-time.pvs')
        running = self.start(output, '--time-budget', '1000')
        running.send_signal(signal.SIGINT)
        _, said = running.communicate(timeout=TIMEOUT)
        self.assertEqual(running.returncode, 130)
        self.assertIn(f'{output} holds them', said)
        before = json.loads(self.expect(0, 'info', output, '--json')[0])
        self.assertGreaterEqual(before['cells'], 1)
        self.assertFalse(before['repeatable'])
        out, err = self.expect(0, *self.command(output, '--time-budget', '2000', '--json'))
        self.assertGreaterEqual(json.loads(out)['cells_resumed'], before['cells'])
        self.assertIn('resuming', err)
        after = json.loads(self.expect(0, 'info', output, '--json')[0])
        self.assertGreaterEqual(after['cells'], before['cells'])
        self.assertLessEqual(after['max_pixel_error'], 1e-3)
        self.assertFalse(os.path.exists(output + '.bake'))

    def test_other_settings_are_refused_until_fresh(self):
        output = self.path('other.pvs')
        self.stop(output, signal.SIGKILL)
        _, err = self.expect(2, *self.command(output, '--metric', 'color'))
        self.assertIn('metric', self.assert_one_error_line(err, 'checkpoint.other-bake'))
        _, err = self.expect(2, *self.command(output, '--player-radius', '0.1'))
        line = self.assert_one_error_line(err, 'checkpoint.other-bake')
        self.assertIn(output + '.bake', line)
        self.assertIn('player_radius', line)
        self.assertIn('--fresh', line)
        out, _ = self.expect(0, 'bake', self.city, '-o', output, '--cell-limit', '8', *QUICK_BAKE, '--fresh', '--json')
        self.assertEqual(json.loads(out)['cells_resumed'], 0)
        self.assertNotEqual(read(output), self.whole())

    def test_a_second_bake_of_the_same_output_is_refused(self):
        output = self.path('shared.pvs')
        running = self.start(output)
        running.send_signal(signal.SIGSTOP)  # it must not be done before the others come
        try:
            for more in ([], ['--fresh']):
                _, err = self.expect(1, *self.command(output, *more))
                self.assert_one_error_line(err, 'checkpoint.in-use')
        finally:
            running.kill()
            running.communicate(timeout=TIMEOUT)

    def test_another_source_is_refused_until_fresh(self):
        output = self.path('source.pvs')
        running = self.start(output, '--source', 'cpu')
        running.send_signal(signal.SIGINT)
        running.communicate(timeout=TIMEOUT)
        self.assertEqual(running.returncode, 130)
        _, err = self.expect(2, *self.command(output, '--source', 'rays'))
        self.assertIn('differs in device, source', self.assert_one_error_line(err, 'checkpoint.other-bake'))
        out, _ = self.expect(0, *self.command(output, '--source', 'cpu', '--json'))
        self.assertGreaterEqual(json.loads(out)['cells_resumed'], 1)

    def test_damaged_checkpoint_is_refused_until_fresh(self):
        output, whole = self.path('damaged.pvs'), self.path('undamaged.pvs')
        room = [self.room, '--cells-file', self.cells, *QUICK_BAKE]
        with open(output + '.bake', 'wb') as out:
            out.write(b'no database' * 1000)
        _, err = self.expect(4, 'bake', '-o', output, *room)
        self.assert_one_error_line(err, 'checkpoint.damaged')
        self.expect(0, 'bake', '-o', output, *room, '--fresh')
        self.expect(0, 'bake', '-o', whole, *room)
        self.assertEqual(read(output), read(whole))
