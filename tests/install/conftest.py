"""The tests of this folder build and install in a folder of the build tree."""
import os
import shutil

import pytest


@pytest.fixture(scope='session', autouse=True)
def work(request):
    """Empty before the tests, gone when they pass: a bundle is large."""
    from installed import ARGS  # not before the options are read
    shutil.rmtree(ARGS.work, ignore_errors=True)
    os.makedirs(ARGS.work)
    yield
    if not request.session.testsfailed:
        shutil.rmtree(ARGS.work)
