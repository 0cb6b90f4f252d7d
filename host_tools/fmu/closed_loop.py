# SPDX-License-Identifier: BSD-2-Clause
"""
Plant and controller of a scene in a closed loop, by FMPy (pip install fmpy). Prints the voltages of each tick as CSV.
usage: python3 closed_loop.py PLANT.fmu CONTROLLER.fmu TICKS
"""
import sys
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave


class Unit:
    def __init__(self, path):
        about = read_model_description(path)
        self.period = float(about.defaultExperiment.stepSize)
        self.reference = {v.name: v.valueReference for v in about.modelVariables}
        self.slave = FMU2Slave(guid=about.guid, unzipDirectory=extract(path), instanceName=about.modelName,
                               modelIdentifier=about.coSimulation.modelIdentifier)
        self.slave.instantiate()
        self.slave.setupExperiment(startTime=0.0)
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()

    def group(self, group):
        return [reference for name, reference in self.reference.items() if name.startswith(group + ".")]

    def pass_on(self, group, to):
        to.slave.setReal(to.group(group), self.slave.getReal(self.group(group)))

    def step(self, tick):
        self.slave.doStep(tick * self.period, self.period)


plant, controller = Unit(sys.argv[1]), Unit(sys.argv[2])
print(",".join(name.split(".", 1)[1] for name in controller.reference if name.startswith("voltage.")))
for tick in range(int(sys.argv[3])):
    plant.pass_on("reading", controller)
    controller.step(tick)  # the target is that of the scene until controller.slave.setReal changes it
    controller.pass_on("voltage", plant)
    plant.step(tick)
    print(",".join(f"{voltage:.17g}" for voltage in plant.slave.getReal(plant.group("amplifier"))))
