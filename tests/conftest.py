"""Options and fixtures of all tests in Python. Classes of tests use harness.py directly."""
import os
import sys

sys.dont_write_bytecode = True  # nothing is written into the sources
import harness  # noqa: E402
import pytest  # noqa: E402

ALL_SKIPPED = 77  # ctest shows an entry that ends so as skipped


def pytest_addoption(parser):
    parser.addoption('--bin', metavar='FOLDER', default=os.path.join(harness.ROOT, 'build', 'dev', 'bin'),
                     help='the built programs (default: build/dev/bin)')
    parser.addoption('--setting', metavar='NAME=VALUE', action='append', default=[],
                     help='what only CMake knows, for tests that ask for it')


def pytest_configure(config):
    harness.BIN = os.path.abspath(config.getoption('--bin'))
    harness.SETTINGS.update(setting.split('=', 1) for setting in config.getoption('--setting'))


def pytest_sessionfinish(session):
    counts = session.config.pluginmanager.get_plugin('terminalreporter').stats
    if counts.get('skipped') and not any(counts.get(kind) for kind in ('passed', 'failed', 'error')):
        session.exitstatus = ALL_SKIPPED


@pytest.fixture
def folder(request):
    """A temporary folder, removed after the test."""
    return harness.new_folder(lambda *call: request.addfinalizer(lambda: call[0](*call[1:])))
