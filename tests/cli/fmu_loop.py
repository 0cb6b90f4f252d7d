# SPDX-License-Identifier: BSD-2-Clause
"""
Plant and controller FMU in a closed loop, through their shared libraries alone (ctypes): the master that a tool is.
usage: fmu_loop.py coupled PLANT.fmu CONTROLLER.fmu SIMULATION.csv EVENTS DELAY   the same bits as pzs simulate --csv
       fmu_loop.py faults PLANT.fmu CONTROLLER.fmu   bad input, order of calls, states, instances
       fmu_loop.py together PLANT.fmu LATE.fmu PUNCTUAL.fmu PARK   both FMUs step at once; a supervisor's commands
"""
import ctypes
import math
import sys
import tempfile
import xml.etree.ElementTree as xml
import zipfile

OK, WARNING, DISCARD, ERROR = range(4)
LOGGER = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p, ctypes.c_char_p)


class Callbacks(ctypes.Structure):
    _fields_ = [("logger", LOGGER), ("allocate", ctypes.c_void_p), ("free", ctypes.c_void_p), ("finished", ctypes.c_void_p),
                ("environment", ctypes.c_void_p)]


class Fmu:
    """An FMU file: its description and its library."""

    def __init__(self, path):
        self.folder = tempfile.TemporaryDirectory()
        with zipfile.ZipFile(path) as archive:
            assert archive.testzip() is None
            archive.extractall(self.folder.name)
        root = xml.parse(self.folder.name + "/modelDescription.xml").getroot()
        name = root.find("CoSimulation").get("modelIdentifier")
        self.guid = root.get("guid")
        self.period = float(root.find("DefaultExperiment").get("stepSize"))
        self.lib = ctypes.CDLL(f"{self.folder.name}/binaries/linux64/{name}.so")
        self.lib.fmi2Instantiate.restype = ctypes.c_void_p
        self.lib.fmi2GetVersion.restype = ctypes.c_char_p
        assert self.lib.fmi2GetVersion() == b"2.0"
        self.reference, self.start = {}, {}
        for variable in root.iter("ScalarVariable"):
            self.reference[variable.get("name")] = int(variable.get("valueReference"))
            self.start[variable.get("name")] = variable[0].get("start")

    def names(self, group):
        return [name for name in self.reference if name.split(".")[0] == group]


class Instance:
    def __init__(self, fmu, name="one", guid=None, kind=1):
        self.fmu, self.messages = fmu, []
        self.callbacks = Callbacks(LOGGER(lambda *about: self.messages.append(about[5].decode())))
        self.component = fmu.lib.fmi2Instantiate(name.encode(), kind, (guid or fmu.guid).encode(), b"", ctypes.byref(self.callbacks), 0, 0)

    def call(self, function, *arguments):
        return getattr(self.fmu.lib, function)(ctypes.c_void_p(self.component), *arguments)

    def open(self, **start):
        assert self.call("fmi2SetupExperiment", 0, ctypes.c_double(0), ctypes.c_double(0), 0, ctypes.c_double(0)) == OK
        for name, value in start.items():
            assert self.set([name.replace("__", ".")], [value]) == OK
        assert self.call("fmi2EnterInitializationMode") == OK
        assert self.call("fmi2ExitInitializationMode") == OK, self.messages
        return self

    def close(self):
        self.fmu.lib.fmi2FreeInstance(ctypes.c_void_p(self.component))

    def transfer(self, function, names, values):
        references = (ctypes.c_uint * len(names))(*[self.fmu.reference[name] for name in names])
        return self.call(function, references, ctypes.c_size_t(len(names)), values)

    def set(self, names, values):
        return self.transfer("fmi2SetReal", names, (ctypes.c_double * len(names))(*values))

    def get(self, names):
        values = (ctypes.c_double * len(names))()
        assert self.transfer("fmi2GetReal", names, values) == OK
        return list(values)

    def integer(self, name):
        value = (ctypes.c_int * 1)()
        assert self.transfer("fmi2GetInteger", [name], value) == OK
        return value[0]

    def step(self, tick, length=None):
        return self.call("fmi2DoStep", ctypes.c_double(tick * self.fmu.period), ctypes.c_double(length or self.fmu.period), 1)


def schedule(events, ticks):
    """Loads, temperature, factor of the target and known loads of every tick, as pzs simulate applies the events."""
    state = {"loads": {}, "temperature": 0.0, "target": 1.0, "known": {}}
    for tick in range(ticks):
        state = {key: dict(value) if isinstance(value, dict) else value for key, value in state.items()}
        for event in (event for event in events if event["at"] == tick):
            if "load" in event:
                state["loads"][event["load"]] = event["factor"]
                if event.get("feed_forward"):
                    state["known"][event["load"]] = event["factor"]
            state["temperature"] = event.get("temperature", state["temperature"])
            state["target"] = event.get("target", state["target"])
        yield state


def loads_of(state, names, key="loads", default=1.0):
    return [state[key].get(int(name.split(".")[1]), default) for name in names]


def coupled(plant_path, controller_path, csv, events, delay):
    lines = open(csv).read().split()
    head, rows = lines[0].split(","), [[float(word) for word in line.split(",")] for line in lines[1:]]
    column = {name: k for k, name in enumerate(head)}
    states = list(schedule(events, len(rows) + 1))
    plant, controller = Fmu(plant_path), Fmu(controller_path)
    p, c = Instance(plant).open(), Instance(controller).open()
    target, loads, heat = controller.names("target"), plant.names("load"), plant.names("temperature")
    goal = [float(controller.start[name]) for name in target]
    readings, voltages = plant.names("reading"), controller.names("voltage")
    assert readings == controller.names("reading") and voltages == plant.names("voltage")
    amplifiers = plant.names("amplifier")
    now, coming = controller.names("load_now"), controller.names("load_next")
    for tick, row in enumerate(rows):
        assert c.set(target, [states[tick]["target"] * value for value in goal]) == OK
        assert c.set(now, loads_of(states[max(tick - delay, 0)], now, "known", 0.0)) == OK
        assert c.set(coming, loads_of(states[tick + 1], coming, "known", 0.0)) == OK
        assert c.set(readings, p.get(readings)) == OK
        assert c.step(tick) == OK, c.messages
        assert p.set(voltages, c.get(voltages)) == OK
        assert p.set(loads, loads_of(states[tick + 1], loads)) == OK
        assert p.set(heat, [states[tick + 1]["temperature"]] * len(heat)) == OK
        assert p.step(tick) == OK, p.messages
        wanted = [row[column[name.split(".", 1)[1]]] for name in amplifiers]
        assert p.get(amplifiers) == wanted, f"tick {tick}: other voltages than pzs simulate"
        assert c.integer("iterations") == row[column["iterations"]], f"tick {tick}: iterations"
        assert c.integer("status") == row[column["status"]], f"tick {tick}: status"
    moved = max(abs(value) for value in rows[-1][-len(amplifiers):])
    assert moved > 0
    print(f"{len(rows)} ticks, {len(amplifiers)} voltages, {len(readings)} readings: the same bits; largest {moved:g} V")
    p.close(), c.close()


# ---- laws of one FMU ----------------------------------------------------


def outputs(instance):
    return [name for name, start in instance.fmu.start.items() if start is None and name not in ("status", "iterations", "status_text", "mode")]


def inputs(instance):
    return [name for name, start in instance.fmu.start.items() if start is not None and name not in ("seed", "command")]


def run(instance, first, ticks):
    """Outputs of some ticks under inputs that move: every input by its own small sine about its start."""
    values = []
    for tick in range(first, first + ticks):
        moved = [float(instance.fmu.start[name] or 0) + 1e-6 * math.sin(tick + k) for k, name in enumerate(inputs(instance))]
        assert instance.set(inputs(instance), moved) == OK
        assert instance.step(tick) == OK, instance.messages
        values.append(instance.get(outputs(instance)))
    return values


def refuses(instance, status, word, act):
    """An act answers with a status and one message that contains a word; the instance then goes on as if nothing was."""
    before = instance.get(outputs(instance))
    instance.messages.clear()
    assert act() == status, (word, instance.messages)
    assert len(instance.messages) == 1 and word in instance.messages[0], instance.messages
    assert instance.get(outputs(instance)) == before
    instance.messages.clear()


def set_and_step(instance, name, value, tick):
    old = instance.get([name])
    assert instance.set([name], [value]) == OK
    status = instance.step(tick)
    instance.set([name], old)
    return status


def check_life(fmu):
    for guid, kind, word in (("{other}", 1, "GUID"), (fmu.guid, 0, "co-simulation")):
        none = Instance(fmu, guid=guid, kind=kind)
        assert none.component is None and len(none.messages) == 1 and word in none.messages[0]
    early = Instance(fmu)
    assert early.step(0) == ERROR and "fmi2DoStep" in early.messages[0] and len(early.messages) == 1
    early.open()
    assert early.call("fmi2Terminate") == OK and early.step(0) == ERROR
    early.close()
    going = Instance(fmu).open()
    wrong = (ctypes.c_uint * 1)(99999)
    value = (ctypes.c_double * 1)()
    refuses(going, DISCARD, "one tick", lambda: going.step(0, 1.001 * fmu.period))
    refuses(going, DISCARD, "one tick", lambda: going.step(0, math.nan))
    for tick in (77, 1, -1, 1e-3, math.nan):
        refuses(going, ERROR, "the last step ended at 0 s", lambda: going.step(tick))
    refuses(going, ERROR, "99999", lambda: going.call("fmi2GetReal", wrong, ctypes.c_size_t(1), value))
    refuses(going, ERROR, "input", lambda: going.set(outputs(going)[-1:], [1.0]))
    assert run(going, 0, 5) == run(Instance(fmu).open(), 0, 5), "a refused call changed the state"
    going.close()


def check_states(fmu):
    one, alone = Instance(fmu, "one").open(), Instance(fmu, "alone").open()
    run(one, 0, 7)
    state, size = ctypes.c_void_p(), len(inputs(one))
    assert one.call("fmi2GetFMUstate", ctypes.byref(state)) == OK
    first = run(one, 7, 9)
    assert one.call("fmi2SetFMUstate", state) == OK
    assert run(one, 7, 9) == first, "the state is not complete"
    assert alone.call("fmi2SetFMUstate", state) == ERROR and len(alone.messages) == 1
    assert one.call("fmi2FreeFMUstate", ctypes.byref(state)) == OK and not state
    assert run(alone, 0, 7) and run(alone, 7, 9) == first, "two instances share memory"
    assert one.call("fmi2Reset") == OK
    one.open()
    run(one, 0, 7)
    assert size > 0 and run(one, 7, 9) == first, "fmi2Reset leaves something behind"
    one.close(), alone.close()


def check_start(fmu):
    """Outputs during initialisation are those after it, of the inputs that are set then."""
    instance = Instance(fmu)
    assert instance.call("fmi2SetupExperiment", 0, ctypes.c_double(0), ctypes.c_double(0), 0, ctypes.c_double(0)) == OK
    assert instance.call("fmi2EnterInitializationMode") == OK
    for shift in (1e-6, 0.0):
        assert instance.set(inputs(instance), [float(fmu.start[name]) + shift for name in inputs(instance)]) == OK
        early = instance.get(outputs(instance))
    assert instance.call("fmi2ExitInitializationMode") == OK and instance.get(outputs(instance)) == early
    instance.close()


def check_plant(fmu):
    plant = Instance(fmu).open()
    run(plant, 0, 3)
    voltage, amplifiers = fmu.names("voltage"), fmu.names("amplifier")
    for value in (math.nan, math.inf):
        refuses(plant, ERROR, voltage[1], lambda: set_and_step(plant, voltage[1], value, 3))
    plant.messages.clear()
    before = plant.get(amplifiers)
    assert plant.set(voltage[:1], [1e6]) == OK and plant.step(3) == WARNING
    assert len(plant.messages) == 1 and voltage[0] in plant.messages[0] and "1000000" in plant.messages[0]
    after = plant.get(amplifiers)
    assert before[0] < after[0] < 1e4 and all(map(math.isfinite, plant.get(fmu.names("reading"))))
    plant.close()
    seeded = []
    for seed in (1, 1, 2):
        plant = Instance(fmu)
        assert plant.transfer("fmi2SetInteger", ["seed"], (ctypes.c_int * 1)(seed)) == OK
        seeded.append(run(plant.open(), 0, 3))
        plant.close()
    assert seeded[0] == seeded[1] != seeded[2], "the seed does not choose the noise"


def check_controller(fmu):
    controller = Instance(fmu).open()
    run(controller, 0, 3)
    refuses(controller, ERROR, "finite", lambda: set_and_step(controller, fmu.names("target")[2], math.nan, 3))
    readings = fmu.names("reading")
    assert controller.set(readings[:1], [math.nan]) == OK and controller.step(3) == OK and controller.integer("status") != 0
    controller.close()


# ---- both at once ---------------------------------------------------------


def step_together(plant, controller, first, ticks):
    """Both FMUs step at once, so that the voltages are one tick late. Largest change of a voltage in each tick."""
    readings, voltages = plant.fmu.names("reading"), plant.fmu.names("voltage")
    changes, before = [], controller.get(voltages)
    for tick in range(first, first + ticks):
        reading, voltage = plant.get(readings), controller.get(voltages)
        assert controller.set(readings, reading) == OK and plant.set(voltages, voltage) == OK
        assert controller.step(tick) == OK and plant.step(tick) == OK, controller.messages + plant.messages
        after = controller.get(voltages)
        changes.append(max(abs(a - b) for a, b in zip(after, before)))
        before = after
    return changes


def together(plant_path, late_path, punctual_path, park):
    """
    A controller that knows of readings one tick late settles to the last bit, and one that does not swings by volts. The
    first has a supervisor: it runs (mode 2), and its command to stop (5) ends at the park voltages, latched (mode 7).
    """
    plant, late, punctual = Fmu(plant_path), Fmu(late_path), Fmu(punctual_path)
    p, c = Instance(plant).open(), Instance(late).open()
    changes = step_together(p, c, 0, 200)
    assert max(changes) > 1 and max(changes[-5:]) == 0 and c.integer("mode") == 2, (changes[-9:], c.integer("mode"))
    assert c.transfer("fmi2SetInteger", ["command"], (ctypes.c_int * 1)(5)) == OK
    step_together(p, c, 200, 80)
    assert c.integer("mode") == 7 and c.get(late.names("voltage")) == park
    p.close(), c.close()
    p, c = Instance(plant).open(), Instance(punctual).open()
    assert min(step_together(p, c, 0, 200)[-20:]) > 0.1
    p.close(), c.close()
    print("a controller that knows of the late tick settles; commands reach the supervisor")


def faults(plant_path, controller_path):
    for path, check in ((plant_path, check_plant), (controller_path, check_controller)):
        fmu = Fmu(path)
        for law in (check_life, check_states, check_start, check):
            law(fmu)
    print("life, states, start, bad input of both FMUs")


if __name__ == "__main__":
    if sys.argv[1] == "coupled":
        import yaml
        coupled(*sys.argv[2:5], yaml.safe_load(sys.argv[5]), int(sys.argv[6]))
    elif sys.argv[1] == "together":
        together(*sys.argv[2:5], [float(voltage) for voltage in sys.argv[5:]])
    else:
        faults(*sys.argv[2:4])
