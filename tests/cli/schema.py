# SPDX-License-Identifier: BSD-2-Clause
"""Schema and reader agree on scenes:  schema.py PZS SCHEMA EVERY PARTS SCENE...

Every scene is valid for both. Then every key of every scene is changed once: given a value of another type, taken out,
set beside an unknown key, and, where it is a number, moved out of the range that the schema states.
- What the schema refuses, the reader refuses: an editor never marks a valid scene.
- What the reader refuses for its structure or for a range, the schema refuses. Refusals for reasons that no schema can
  state (names that stand for nothing, geometry, sections that need each other) are counted apart, by the reader's words.
EVERY: 1 runs all changes, 5 every fifth. PARTS: a file with scenes that together have every key of the schema.
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
    # numbers that only a formula or another number decides
    "is no number or formula", "' must rise", "leave no positive", "is not positive definite", "runs from", "'to' must be above", "does not ascend",
    "has . numbers, '", "each needs as many", "beside the strengths", "has no blocking force",
    "is empty; write .lowest", "has no direction; give one", "no set of edges", "no theta1 and theta2", "is per second, but", "entry .* of the mask is", "are ignored; use some",
    # places on the mesh and the surface
    "no node of the mesh", "is no (mesh line|node)", "is not on the mesh", "reaches a pole", "past the axis", "more than a full turn",
    "lies above the outer face", "'(from|to)' is missing",
    # names and counts
    "there is no|there are no", "the first one is", "no layer named", "values for .* (amplifiers|outputs)", "points of coordinates for",
    "entries of the mask for", "need the same shape", "name the element sets",
    # sections and materials that need each other
    "or a mesh file: mesh", "has no piezoelectric constants", "has no permittivity", "d31 or e31", "no contact in this scene", "needs readings",
    "moves nothing; give", "but the outputs have none",
    "is not bare; add", "need a direction; add", "some modes have a response", "in the order of their frequencies", "weights for .* amplifiers",
    "its axis belong together", "a list needs modes", "of mode [0-9]+ must be", "plus leak .* is", "values for [0-9]+ modes",
    "are those of what is not in the modes",
    # meshes from files
    "\\.msh: ", "the mesh file", "mesh from a file", "belongs to mesh lines", "is no unit of length", "brings its own surface",
    "of the rim is more than", "may be at most .* of that", "goes around the cylinder", "a panel of .* nodes", "too long for the curvature", "lies outside the rim", "list circles from", "needs a target", "needs kinematics", "no finite position", "the coordinate lines meet", "acts along or across its edge",
    # outlines of electrodes
    "belongs to (patches of whole|'outlines')", "outside the surface", "overlap on one layer", "leaves no electrode", "cross or touch",
    "lie on a line", "are equal; leave", "let 'to' be", "the radius .* follows", "numbers of sectors for", "no pixel of the bitmap",
    "meets the surface twice", "stands upright",
    "published element needs", "needs its stiffness above 0", "its material is a film of", "needs the scene.s own unit", "the scene has no unit of", "is not above -1",
    "must rise", "numbers, 'creep_time'", "has no blocking force; give E1", "no 'shear' beside", "a stress needs one of",
]


def scenes_of_parts(path):
    """Whole scenes from a base and the sections that replace some of it."""
    whole = read(path)
    for i, part in enumerate(whole["parts"]):
        scene = {**copy.deepcopy(whole["base"]), **copy.deepcopy(part)}
        yield f"{path} part {i}", {key: value for key, value in scene.items() if value is not None}
    for i, scene in enumerate(whole["wholes"]):
        yield f"{path} whole {i}", scene


def tables(schema):
    """(key, help sentence) of every row of every table of a schema."""
    for key, value in schema.get("properties", {}).items():
        yield key, value["description"]
        yield from tables(value)
    for word in ("oneOf", "anyOf"):
        for one in schema.get(word, []):
            yield from tables(one)
    for word in ("items", "additionalProperties"):
        if isinstance(schema.get(word), dict):
            yield from tables(schema[word])


def used(valid, schema, value):
    """(key, help sentence) of the rows of a schema that a valid value uses."""
    for word in ("oneOf", "anyOf"):
        for one in schema.get(word, []):
            if valid(one, value):
                yield from used(valid, one, value)
    if isinstance(value, list) and isinstance(schema.get("items"), dict):
        for item in value:
            yield from used(valid, schema["items"], item)
    if not isinstance(value, dict):
        return
    own = schema.get("properties", {})
    for key in value:
        if key in own:
            yield key, own[key]["description"]
            yield from used(valid, own[key], value[key])
        elif isinstance(schema.get("additionalProperties"), dict):
            yield from used(valid, schema["additionalProperties"], value[key])


class Loader(yaml.SafeLoader):
    """YAML 1.2, as editors read it: 1e9 is a number, and on, off, yes, no are words."""


FLOAT, BOOL = "tag:yaml.org,2002:float", "tag:yaml.org,2002:bool"
Loader.yaml_implicit_resolvers = {first: [(tag, pattern) for tag, pattern in rows if tag not in (FLOAT, BOOL)]
                                  for first, rows in yaml.SafeLoader.yaml_implicit_resolvers.items()}
Loader.add_implicit_resolver(BOOL, re.compile("^(?:true|false)$"), list("tf"))
Loader.add_implicit_resolver(FLOAT, re.compile(r"^[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?$"), list("-+.0123456789"))


def read(path):
    with open(path, encoding="utf-8") as file:
        return yaml.load(file, Loader)  # a subclass of the safe loader


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
    return result.stderr.strip() if result.returncode == 2 else f"ended with {result.returncode}"


def disagreement(kind, refused, said):
    """What is wrong where the schema and the reader disagree on a mutation, or None."""
    if refused and not said:
        return "the schema refuses, the reader does not"
    if said and said.startswith("ended"):
        return "the reader " + said
    if said and not refused and kind != "word" and not any(re.search(words, said) for words in BEYOND_SCHEMA):
        return "the reader refuses, the schema does not: " + said
    return None


def main(pzs, schema_path, every, parts, names):
    with open(schema_path, encoding="utf-8") as file:
        schema = json.load(file)
    jsonschema.Draft202012Validator.check_schema(schema)
    valid, errors = jsonschema.Draft202012Validator(schema).is_valid, jsonschema.Draft202012Validator(schema).iter_errors
    folder = tempfile.mkdtemp()
    for name in os.listdir(os.path.dirname(parts)):
        shutil.copy(os.path.join(os.path.dirname(parts), name), folder)
    path = os.path.join(folder, "scene.yaml")
    for mesh in glob.glob(os.path.join(os.path.dirname(schema_path), "*.msh")):
        shutil.copy(mesh, folder)

    def fits(part, value):
        return jsonschema.Draft202012Validator({**part, "$defs": schema["$defs"]}).is_valid(value)

    counts = collections.Counter()
    wrong = []
    seen = set()
    present = set()
    for name, scene in [(name, read(name)) for name in names] + list(scenes_of_parts(parts)):
        said = reader_says(pzs, scene, path)
        if not valid(scene) or said:
            wrong.append(f"{name}: refused: {said or jsonschema.exceptions.best_match(errors(scene)).message}")
            continue
        present |= set(used(fits, schema, scene))
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
    wrong += [f"no scene has the key {key}: {text}" for key, text in sorted(set(tables(schema)) - present)]
    for key in sorted(counts):
        print(f"# {key[0]}: {key[1]} {counts[key]}")
    for line in wrong:
        print("#", line)
    shutil.rmtree(folder)
    return 1 if wrong or sum(counts.values()) * every < 1500 else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2], int(sys.argv[3]), sys.argv[4], sys.argv[5:]))
