# SPDX-License-Identifier: BSD-2-Clause
"""Schema and reader agree on scenes:  schema.py PZS SCHEMA EVERY SCENE...

Every scene is valid for both. Then every key of every scene is changed once: given a value of another type, taken out,
set beside an unknown key, and, where it is a number, moved out of the range that the schema states.
- What the schema refuses, the reader refuses: an editor never marks a valid scene.
- What the reader refuses for its structure or for a range, the schema refuses. Refusals for reasons that no schema can
  state (names that stand for nothing, geometry, sections that need each other) are counted apart, by the reader's words.
EVERY: 1 runs all changes, 5 every fifth.
"""
import collections
import copy
import glob
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

import jsonschema
import yaml

# What the reader says of a scene whose structure is right: names, geometry and sections that need each other.
BEYOND_SCHEMA = [
    "there (is|are) no", "need[s]? actuators", "needs? a target", "a mesh of .* has more than", "is no (mesh line|node)",
    "but the mesh has", "values for .* amplifiers", "needs readings", "has no permittivity", "has no piezoelectric constants",
    "no patches lie on it", "every layer is patched", "no (layer|material) named", "moves nothing; give", "weight without density",
    "needs (the )?kinematics: nonlinear", "needs kinematics", "needs the nonlinear", "and (E|nu)\\w*, .* leave no positive", "leave no positive",
    "is not positive definite", "is no number or formula", "after the end", "comes after tick", "runs from", "does not ascend", "overlap",
    "is a mapping of keys", "given twice", "past the axis", "reaches a pole", "more than a full turn", "turns back on itself",
    "shrink to nothing", "no spline goes", "is per second, but", "'to' must be above", "is the same everywhere", "knows x, y, z only",
    "has no direction; give one", "depends on an edge", "is no single displacement", "no node of the mesh", "needs lin33", "makes more electrodes",
    "two .* named", "driven by", "need the same shape", "\\.msh: ", "the mesh file", "mesh from a file", "belongs to mesh lines", "is not on the mesh",
    "is no unit of length", "brings its own surface", "needs the scene.s own unit", "the scene has no unit of", "is not above -1", "is empty; write \\[lowest", "d31 or e31", "plant with a contact is nonlinear",
    "the first (one )?is", "never comes back to its start", "uses theta", "varies over the surface", "add the output", "is of a contact",
    "no contact in this scene", "lies above the outer face", "'from'' is missing|'(from|to)' is missing", "has d", "no meaning as", "'meridian' has",
    "out of range; magnitudes", "both .* faces", "acts on one face", "is per (deformed|reference) area", "also the name",
    "neither voltage nor charge", "strain constants d or stress constants e",
]


def read(path):
    with open(path, encoding="utf-8") as file:
        return yaml.safe_load(file)


def places(value, path=()):
    """Every value below a value, with its path."""
    if isinstance(value, dict):
        for key in value:
            yield path + (key,)
            yield from places(value[key], path + (key,))
    elif isinstance(value, list):
        for i, item in enumerate(value):
            yield path + (i,)
            yield from places(item, path + (i,))


def at(value, path):
    for key in path:
        value = value[key]
    return value


def with_value(scene, path, value):
    changed = copy.deepcopy(scene)
    at(changed, path[:-1])[path[-1]] = value
    return changed


def without(scene, path):
    changed = copy.deepcopy(scene)
    del at(changed, path[:-1])[path[-1]]
    return changed


def other_types(value):
    if isinstance(value, dict):
        return [[], "word"]
    if isinstance(value, list):
        return [{"a": 1}, "word"]
    return [[1], {"a": 1}]


def mutations(scene):
    """(what was done, changed scene) for every value of a scene; of lists of plain numbers the first item stands for all."""
    for path in places(scene):
        if isinstance(path[-1], int) and path[-1] > 0 and not isinstance(at(scene, path), (dict, list)):
            continue
        value = at(scene, path)
        for other in other_types(value):
            yield "type", path, with_value(scene, path, other)
        if isinstance(path[-1], str):
            yield "missing", path, without(scene, path)
        if isinstance(value, dict):
            yield "unknown", path, with_value(scene, path + ("zzz",), 1)
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            for number in (-1, 0, -0.25, 0.75, 7.5, 1e9, 1e61, -1e61):
                yield "range", path, with_value(scene, path, number)
        if isinstance(value, str):
            yield "word", path, with_value(scene, path, "no such word")
    yield "unknown", (), with_value(scene, ("zzz",), 1)


def reader_says(pzs, scene, path):
    """None for a valid scene, otherwise what the reader refuses."""
    with open(path, "w", encoding="utf-8") as file:
        yaml.safe_dump(scene, file, sort_keys=False, allow_unicode=True)
    result = subprocess.run([pzs, "migrate", path], capture_output=True, text=True, check=False)
    if result.returncode == 0:
        return None
    return result.stderr.strip()


def disagreement(kind, refused, said):
    """What is wrong where the schema and the reader disagree on a mutation, or None."""
    if refused and not said:
        return "the schema refuses, the reader does not"
    if said and not refused and kind != "word" and not any(re.search(words, said) for words in BEYOND_SCHEMA):
        return "the reader refuses, the schema does not: " + said
    return None


def main(pzs, schema_path, every, scenes):
    with open(schema_path, encoding="utf-8") as file:
        schema = json.load(file)
    jsonschema.Draft202012Validator.check_schema(schema)
    valid = jsonschema.Draft202012Validator(schema).is_valid
    folder = tempfile.mkdtemp()
    path = os.path.join(folder, "scene.yaml")
    for mesh in glob.glob(os.path.join(os.path.dirname(schema_path), "*.msh")):
        shutil.copy(mesh, folder)
    counts = collections.Counter()
    wrong = []
    seen = set()
    for name in scenes:
        scene = read(name)
        if not valid(scene):
            wrong.append(f"{name}: the schema refuses the scene")
            continue
        for kind, place, changed in mutations(scene):
            keys = tuple(key for key in place if isinstance(key, str))
            change = (kind, keys, repr(at(changed, place)) if kind in ("type", "range") else "")
            if change in seen:
                continue
            seen.add(change)
            if len(seen) % every:
                continue
            refused, said = not valid(changed), reader_says(pzs, changed, path)
            counts[kind, "schema refuses" if refused else "reader alone refuses" if said else "valid"] += 1
            fault = disagreement(kind, refused, said)
            if fault:
                wrong.append(f"{name}: {kind} {'.'.join(map(str, place))}: {fault}")
    for key in sorted(counts):
        print(f"# {key[0]}: {key[1]} {counts[key]}")
    for line in wrong:
        print("#", line)
    shutil.rmtree(folder)
    return 1 if wrong or sum(counts.values()) * every < 1500 else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2], int(sys.argv[3]), sys.argv[4:]))
