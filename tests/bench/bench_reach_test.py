"""bench_reach.py on a room as a level, and its person in rooms with obstacles."""
import csv
import json
import os
import sys

import numpy as np
import pytest
from harness import BIN, ROOT, program, run, write_room

sys.path[:0] = [os.path.join(ROOT, "tests", "bench")]
import bench_reach as reach  # noqa: E402

BODY, EYE = 0.25, 1.6  # m
MIDDLE_OF_ONE_SIDE = [4.0, 2.0, 2.0]


def walk(folder, starts, *obstacles, height=4, steps=2000, **more):
    """What reach_walk finds in a room of 8 x 8 m. obstacles: boxes on which there is no floor, by two corners."""
    scene, begin, out = (os.path.join(folder, name) for name in ("room.glb", "starts.json", "out.json"))
    nodes = [{"mesh": 0}]
    for low, high in obstacles:  # the room made small: its top faces down
        scale = [(b - a) / size for a, b, size in zip(low, high, (8, height, 8))]
        nodes.append({"mesh": 0, "translation": list(low), "scale": scale})
    write_room(scene, height, scenes=(range(len(nodes)),), nodes=nodes)
    with open(begin, "w", encoding="utf-8") as stream:
        json.dump(starts, stream)
    settings = (f"--{name}={value}" for name, value in more.items())
    code, _, err = run(program("reach_walk"), scene, begin, out, "--steps", steps, *settings)
    assert code == 0, err
    with open(out, encoding="utf-8") as stream:
        found = json.load(stream)
    return found, np.array(sum(found["eyes"], [])).reshape(-1, 3)


def test_person_stays_in_the_room(folder):
    found, eyes = walk(folder, [MIDDLE_OF_ONE_SIDE, [4, 13, 4], [0.1, 1, 4]])
    assert [floor is None for floor in found["floors"]] == [False, True, False]
    assert found["floors"][::2] == pytest.approx([0, 0], abs=1e-5)
    assert [len(eyes) for eyes in found["eyes"]] == [2000, 0, 0]  # no floor within 8 m; a wall in the way
    assert len(eyes) == 2000
    assert eyes[:, 1] == pytest.approx(EYE, abs=1e-5)
    assert (eyes[:, [0, 2]] >= BODY).all() and (eyes[:, [0, 2]] <= 8 - BODY).all()
    assert reach.squares_of(eyes) == 4


def test_walls_and_doors(folder):
    wall = ((0, 0, 4), (8, 4, 4.01))
    _, eyes = walk(folder, [MIDDLE_OF_ONE_SIDE], wall)
    assert (eyes[:, 2] <= 4 - BODY).all()
    _, eyes = walk(folder, [MIDDLE_OF_ONE_SIDE], ((1, 0, 4), (8, 4, 4.01)))  # a door of 1 m
    beside, behind = (np.abs(eyes[:, 2] - 4) < BODY), eyes[:, 2] > 5
    assert beside.any() and (eyes[beside, 0] <= 1 - BODY).all() and behind.any()
    _, eyes = walk(folder, [MIDDLE_OF_ONE_SIDE], ((0.4, 0, 4), (8, 4, 4.01)))  # narrower than the person
    assert (eyes[:, 2] <= 4 - BODY).all()


def test_heads_and_regions(folder):
    assert len(walk(folder, [[4, 1, 4]], height=1.7)[1]) == 0
    _, eyes = walk(folder, [MIDDLE_OF_ONE_SIDE], ((0, 1.7, 4), (8, 3, 8)))  # something low above
    assert (eyes[:, 2] <= 4 - BODY).all()
    _, eyes = walk(folder, [MIDDLE_OF_ONE_SIDE], region="3,1,5,3")
    assert (eyes[:, [0, 2]] >= (3, 1)).all() and (eyes[:, [0, 2]] <= (5, 3)).all()


def test_boxes():
    boxes = np.array([[[0, 0, 0], [4, 2, 4]], [[4, 1, 0], [12, 3, 8]], [[-64, 0, -64], [-32, 9, -32]]], "f8")
    eyes = np.array([[1, 1, 1], [4.5, 2.9, 7], [4.5, 3.1, 7], [-40, 5, -40], [12, 3, 8], [1, 1, 5]])
    assert reach.containing(eyes, boxes).tolist() == [0, 1, -1, 2, 1, -1]
    assert reach.within(boxes, (0, 0, 6, 6)).tolist() == boxes[:1].tolist()
    # 1 to 3 m is in two layers, and the second box has two by two columns.
    lattice = reach.uniform_lattice(boxes[:2])
    assert len(lattice) == 1 + 2 * 2 * 2
    assert (lattice[:, 1] - lattice[:, 0] == (4, 2, 4)).all()


def test_level(folder):
    data, results = os.path.join(folder, "data"), os.path.join(folder, "results")
    os.makedirs(os.path.join(data, "levels"))
    write_room(os.path.join(data, "levels", "czest3ctf.glb"))
    np.savez(os.path.join(data, "levels", "czest3ctf.bspvis.npz"), spawn_pos=np.array([[2, 0.6, 2], [4, 20, 4]], "f4"))
    code, out, err = run(os.path.join(ROOT, "tests", "bench", "bench_reach.py"), "--bin", BIN, "--data", data, "--only",
                         "czest", "--steps", 500, "--quality", "draft", "--results", results,
                         environment={"SIGHTCELL_CACHE": folder})
    assert code == 0, out + err
    rows = {}
    for table in ("spawns", "walks", "sizes_draft"):
        with open(os.path.join(results, f"reach_{table}.csv"), encoding="utf-8") as stream:
            rows[table] = list(csv.DictReader(line for line in stream if not line.startswith("# ")))
    spawns, walks = rows["spawns"][0], rows["walks"][0]
    assert (spawns["spawns"], spawns["with_floor"], spawns["in_cells"]) == ("2", "1", "1")
    assert (walks["steps"], walks["outside"], walks["columns_visited"]) == ("500", "0", "4")
    assert [row["cells_are"] for row in rows["sizes_draft"]] == ["merged", "columns", "lattice"]
    for row in rows["sizes_draft"]:
        assert float(row["drawn"]) == 12  # all of the room, from each eye
    merged, columns, lattice = (int(row["cells"]) for row in rows["sizes_draft"])
    assert merged <= columns <= lattice
