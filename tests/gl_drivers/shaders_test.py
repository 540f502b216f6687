"""All shaders, as the programs assemble them, through the reference compiler of Khronos (glslangValidator). Drivers
accept more than the core profile of OpenGL 4.5, and each of them something else."""
import os
import re
import shutil
import subprocess

import harness
import pytest

# Generated texts by the name of their setting, the folders that make OpenGL programs of them, and the least number.
SETS = [('shaders', ('bake/src', 'bake/picture/src'), 15), ('sample_shaders', ('samples/gpu_driven',), 9)]
STAGES = {'GL_VERTEX_SHADER': 'vert', 'GL_FRAGMENT_SHADER': 'frag', 'GL_COMPUTE_SHADER': 'comp'}


def embedded_texts(setting):
    """Name and text of the shaders in the generated file that is compiled into the programs."""
    path = os.path.join(harness.SETTINGS[setting], 'sources.cpp')
    if setting != 'shaders' and not os.path.exists(path):
        pytest.skip(f'{path} is not built')
    with open(path, encoding='utf-8') as file:
        found = re.findall(r'const char\* const (\w+) = R"glsl\((.*?)\)glsl";', file.read(), re.DOTALL)
    return dict(found)


def linked_programs(folders):
    """The stages of each OpenGL program: a list of (stage, name of the shader)."""
    programs = set()
    for folder in folders:
        for path, _, names in os.walk(os.path.join(harness.ROOT, folder)):
            for name in names:
                if not name.endswith('.cpp'):
                    continue
                with open(os.path.join(path, name), encoding='utf-8') as file:
                    text = file.read()
                stage = r'\{(GL_\w+_SHADER), shaders::(\w+)\}'
                for program in re.findall(rf'\{{({stage}(?:,\s*{stage})*)\}}', text):
                    programs.add(tuple(re.findall(stage, program[0])))
    return sorted(programs)


def compile_and_link(folder, stages, texts):
    """The exit code and the output of the compiler."""
    validator = shutil.which('glslangValidator')
    if validator is None:
        pytest.skip('no glslangValidator (glslang-tools)')
    paths = []
    for stage, name in stages:
        paths.append(os.path.join(folder, f'{name}.{STAGES[stage]}'))
        with open(paths[-1], 'w', encoding='utf-8') as file:
            file.write(texts[name])
    done = subprocess.run([validator, '-l', *paths], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


@pytest.mark.parametrize('setting, folders, least', SETS)
def test_each_program_is_valid_in_the_core_profile(folder, setting, folders, least):
    texts = embedded_texts(setting)
    failed = []
    for stages in linked_programs(folders):
        code, out = compile_and_link(folder, stages, texts)
        if code != 0 or 'WARNING' in out:
            failed.append(out)
    assert not failed, '\n'.join(failed)


@pytest.mark.parametrize('setting, folders, least', SETS)
def test_each_shader_is_in_a_program_and_names_the_core_profile(setting, folders, least):
    texts = embedded_texts(setting)
    assert len(texts) >= least
    used = {name for stages in linked_programs(folders) for _, name in stages}
    assert used == set(texts)
    assert not [name for name, text in texts.items() if not text.startswith('#version 450 core\n')]


@pytest.mark.parametrize('bad', ['void main() { gl_FragColor = vec4(1); }',  # compatibility profile
                                 'void main() { nonsense; }',
                                 'in vec3 from_no_stage; out vec4 color; void main() { color = absent(); }'])
def test_the_compiler_finds_mistakes(folder, bad):
    code, out = compile_and_link(folder, [('GL_FRAGMENT_SHADER', 'bad')], {'bad': '#version 450 core\n' + bad})
    assert code != 0, out
