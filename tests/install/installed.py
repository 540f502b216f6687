"""What the tests of this folder share: the arguments, installing, building and running a consumer."""
import argparse
import os
import re
import subprocess

import harness

# What CMake says, and the sources.
ARGS = argparse.Namespace(source=harness.ROOT, **harness.SETTINGS)
GOLDEN_ANSWER = 'cell 0: 4\ncell 1: 1\n'  # tests/golden/v1_tiny.txt: what its two cells see


def golden():
    return os.path.join(ARGS.source, 'tests/golden/v1_tiny.pvs')


def run(*command, code=0, **more):
    """Standard output and error together; the exit code must be the expected one.

    pkg-config puts a backslash before each byte of a letter outside ASCII, so the bytes need not be UTF-8.
    """
    environment = {k: v for k, v in os.environ.items()
                   if k not in ('LD_LIBRARY_PATH', 'PKG_CONFIG_PATH', 'CMAKE_PREFIX_PATH', 'DESTDIR')}
    environment.update(more.pop('env', {}))
    done = subprocess.run([str(c) for c in command], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, errors='surrogateescape', env=environment,
                          timeout=300, **more)
    if (done.returncode == 0) != (code == 0):
        raise AssertionError(f'exit code {done.returncode} of: {" ".join(map(str, command))}\n{done.stdout}')
    return done.stdout


def install(prefix, *components):
    """What CMake said."""
    text = ''
    for component in components or [None]:
        text += run(ARGS.cmake, '--install', ARGS.build, '--config', ARGS.config, '--prefix', prefix,
            *(['--component', component] if component else []))
    return text


def configure(source, prefix, *arguments, code=0):
    """The folder and what CMake said."""
    folder = os.path.join(ARGS.work, f'build{len(os.listdir(ARGS.work))}')
    text = run(ARGS.cmake, '-S', source, '-B', folder, '-G', ARGS.generator, '-DCMAKE_BUILD_TYPE=Release',
               f'-DCMAKE_C_COMPILER={ARGS.cc}', f'-DCMAKE_CXX_COMPILER={ARGS.cxx}', f'-DCMAKE_PREFIX_PATH={prefix}',
               *arguments, code=code)
    return folder, re.sub(r'\s+', ' ', text)


def build(name, prefix):
    """Configures and builds the consumer in the folder of that name; its build folder."""
    folder, text = configure(os.path.join(ARGS.source, 'tests/install', name), prefix)
    return folder, text + run(ARGS.cmake, '--build', folder)


def needed(path):
    """The shared libraries that an ELF file names, and its own RUNPATH."""
    text = run('readelf', '-d', '-W', path, env={'LC_ALL': 'C'})
    return re.findall(r'\(NEEDED\).*\[(.*)\]', text), re.findall(r'\(R(?:UN)?PATH\).*\[(.*)\]', text)
