# SPDX-License-Identifier: BSD-2-Clause
# piezoshape. `make demo` and `make test` do all of their set-up; `make help` lists the rest.

B := build
ifeq ($(origin CC),default)
CC := gcc
endif
PREFIX ?= /usr/local
SCENES := host_tools/scenes
PYTHON := /usr/bin/python3
WARN := -std=c99 -pedantic -Wall -Wextra -Wconversion -Wdouble-promotion -Werror
DEPEND := -MMD -MP
INCLUDE := -Iinclude

LIB := $(sort $(wildcard lib/*/*.c))
# FITS files are read where cfitsio is installed; without it they are refused, with the name of the package.
FITS_LIBS := $(shell pkg-config --libs cfitsio 2>/dev/null)
OTHER_FITS := $(if $(FITS_LIBS),host_tools/data/table_fits_absent.c,host_tools/data/table_fits.c)
HOST := $(sort $(filter-out host_tools/cli/main.c $(OTHER_FITS),$(wildcard host_tools/*/*.c)))
HOST_LIBS := -lyaml $(FITS_LIBS) -lpthread -lm

.DELETE_ON_ERROR:
.PHONY: all schema example-table install uninstall package demo test bench check-long hard oracle measured tables setup-demo setup-test setup-bench unit \
    san format clean help
all: $(B)/pzs

help:
	@echo 'make demo        shape a real plate with 25 pairs of piezo patches; pictures in $(B)/'
	@echo 'make test        every test: unit, oracle, command line, sanitizers, gates, firmware under QEMU'
	@echo 'make install [PREFIX=/usr/local] [DESTDIR=...]: pzs, library, headers, scenes, manual;  make uninstall'
	@echo 'make package     the library as one folder for CMake, Zephyr, PlatformIO and Arduino'
	@echo 'CC, CFLAGS, LDFLAGS and B (build folder) are honoured: make CC=clang CFLAGS=-g B=/tmp/piezoshape'
	@echo 'make bench       speed against OpenBLAS, DAQP, Kratos and CalculiX, and speed against error'
	@echo 'make bench-peers the last of these on all meshes and several times;  bench-linalg, bench-step, bench-path ...: one alone'
	@echo 'make bench-laws  control laws on a plate that vibrates, each with its best settings: a quarter of an hour'
	@echo 'make qemu        firmware under QEMU, bit for bit against the host'
	@echo 'make size        flash, RAM and stack against the committed budget'
	@echo 'make tables      generate the tables of the firmware demonstrations;  make oracle: the test data'
	@echo 'make measured    refresh the measurements that take seconds in tests/bench/README.md'
	@echo 'make hard        the improved element on thin shells, every thickness and mesh: a table'
	@echo 'make schema      write the schema of scenes, after a change of its keys'
	@echo 'make check-long  the checks that take too long for make test'

# ---- libraries: one folder per variant -----------------------------------

FOLDERS := -DSCENE_PLACE='"$(SCENES)"' -DSCENE_FOLDER='"$(CURDIR)/$(SCENES)"' -DSOURCE_FOLDER='"$(CURDIR)"'

# variant: name, flags
define variant
$(B)/$(1)/%.o: %.c
	@mkdir -p $$(@D)
	$$(CC) $$(WARN) $$(DEPEND) $(2) -DPZS_NONLINEAR=1 -DPZS_MODES=1 $$(FOLDERS) $$(INCLUDE) $$(CFLAGS) -c $$< -o $$@
$(B)/$(1)/libpiezoshape.a: $$(LIB:%.c=$(B)/$(1)/%.o)
	rm -f $$@ && ar rcs $$@ $$^
$(B)/$(1)/host.a: $$(HOST:%.c=$(B)/$(1)/%.o)
	rm -f $$@ && ar rcs $$@ $$^
endef
SANITIZE := -O1 -g1 -fno-omit-frame-pointer -fsanitize=address,undefined -fno-sanitize-recover=all
# Where the compiler makes programs for x86-64, the factorisation in double also uses AVX2, if the processor has it.
WIDE := $(if $(filter x86_64-%,$(shell $(CC) -dumpmachine)),-DPZS_WIDE=1)
$(eval $(call variant,64,-O2 -DPZS_REAL_BITS=64 $(WIDE)))
$(eval $(call variant,32,-O2 -DPZS_REAL_BITS=32))
$(eval $(call variant,32t8,-O2 -DPZS_REAL_BITS=32 -DPZS_TILE=8))
$(eval $(call variant,64t16,-O2 -DPZS_REAL_BITS=64 -DPZS_TILE=16))
$(eval $(call variant,san64,$(SANITIZE) -DPZS_REAL_BITS=64 $(WIDE)))
$(eval $(call variant,san32,$(SANITIZE) -DPZS_REAL_BITS=32))

$(B)/pzs: $(B)/64/host_tools/cli/main.o $(B)/64/host.a $(B)/64/libpiezoshape.a
	$(CC) $(CFLAGS) $(LDFLAGS) $^ $(HOST_LIBS) -o $@

# The host tools in double as one object that shows only its bridge, so that a float program can hold both precisions.
$(B)/%/bridge64.o: $(B)/64/tests/rigs/bridge.o $(B)/64/host.a $(B)/64/libpiezoshape.a
	@mkdir -p $(@D)
	ld -r $< --whole-archive $(B)/64/host.a $(B)/64/libpiezoshape.a -o $@
	objcopy -w --keep-global-symbol='bridge_*' $@

# The schema of scenes is made from the tables of keys of the reader.
schema: $(B)/pzs
	$(B)/pzs schema >$(SCENES)/scene.schema.json

# ---- the two commands ----------------------------------------------------

setup-demo setup-test setup-bench: setup-%:
	@sh tests/setup.sh $*

demo: setup-demo
	@$(MAKE) --no-print-directory -s $(B)/pzs
	$(B)/pzs shape plate-50-patches --limit 200 --limit 100 --limit 500 --report $(B)/plate-50-patches.html \
	    --svg $(B)/plate-50-patches.svg --vtu $(B)/plate-50-patches.vtu
	@echo 'pictures: $(B)/plate-50-patches.html and .svg; for ParaView: $(B)/plate-50-patches.vtu'

test: setup-test
	@sh tests/run.sh

# ---- installation --------------------------------------------------------

# PREFIX: where it is used; DESTDIR: put before PREFIX by who makes a package. The library in double is libpiezoshape, that
# in float libpiezoshape32; their pkg-config files give the choices that they were compiled with.
TO = $(DESTDIR)$(PREFIX)
VERSION = $(shell sed -n 's/^.define PZS_VERSION_TEXT "\(.*\)"/\1/p' include/pzs_version.h)
INSTALL ?= install
PACKAGES := firmware_demo/packages

# pkg_config: suffix of the library's name, bits
define pkg_config
	@printf '%s\n' 'prefix=$(PREFIX)' 'includedir=$${prefix}/include/piezoshape' 'libdir=$${prefix}/lib' '' \
	    'Name: piezoshape$(1)' 'Description: shape control of piezoelectric shells, $(2) bit reals' 'Version: $(VERSION)' \
	    'Cflags: -I"$${includedir}" -DPZS_REAL_BITS=$(2) -DPZS_NONLINEAR=1 -DPZS_MODES=1' 'Libs: -L"$${libdir}" -lpiezoshape$(1) -lm' \
	    >'$(TO)/lib/pkgconfig/piezoshape$(1).pc'
endef

install: $(B)/pzs $(B)/64/libpiezoshape.a $(B)/32/libpiezoshape.a
	$(INSTALL) -d '$(TO)/bin' '$(TO)/include/piezoshape' '$(TO)/lib/pkgconfig' '$(TO)/lib/cmake/piezoshape' \
	    '$(TO)/share/piezoshape/scenes' \
	    '$(TO)/share/man/man1' '$(TO)/share/bash-completion/completions'
	$(INSTALL) -m 755 $(B)/pzs '$(TO)/bin/pzs'
	$(INSTALL) -m 644 include/*.h '$(TO)/include/piezoshape'
	$(INSTALL) -m 644 $(B)/64/libpiezoshape.a '$(TO)/lib/libpiezoshape.a'
	$(INSTALL) -m 644 $(B)/32/libpiezoshape.a '$(TO)/lib/libpiezoshape32.a'
	$(call pkg_config,,64)
	$(call pkg_config,32,32)
	$(INSTALL) -m 644 $(PACKAGES)/piezoshape-config.cmake '$(TO)/lib/cmake/piezoshape'
	sed 's/@VERSION@/$(VERSION)/' $(PACKAGES)/piezoshape-config-version.cmake.in \
	    >'$(TO)/lib/cmake/piezoshape/piezoshape-config-version.cmake'
	$(INSTALL) -m 644 $(SCENES)/*.yaml $(SCENES)/*.msh $(SCENES)/*.geo $(SCENES)/scene.schema.json '$(TO)/share/piezoshape/scenes'
	$(B)/pzs man >'$(TO)/share/man/man1/pzs.1'
	$(B)/pzs completion >'$(TO)/share/bash-completion/completions/pzs'

uninstall:
	rm -f '$(TO)/bin/pzs' '$(TO)/lib/libpiezoshape.a' '$(TO)/lib/libpiezoshape32.a' '$(TO)/lib/pkgconfig/piezoshape.pc' \
	    '$(TO)/lib/pkgconfig/piezoshape32.pc' \
	    '$(TO)/lib/cmake/piezoshape/piezoshape-config.cmake' \
	    '$(TO)/lib/cmake/piezoshape/piezoshape-config-version.cmake' '$(TO)/share/man/man1/pzs.1' '$(TO)/share/bash-completion/completions/pzs' \
	    $(patsubst include/%,'$(TO)/include/piezoshape/%',$(wildcard include/*.h))
	for file in $(notdir $(wildcard $(SCENES)/*.yaml $(SCENES)/*.msh $(SCENES)/*.geo)) scene.schema.json; do \
	    rm -f '$(TO)/share/piezoshape/scenes'/$$file; done
	for folder in include/piezoshape lib/cmake/piezoshape share/piezoshape/scenes share/piezoshape; do \
	    [ ! -d '$(TO)'/$$folder ] || rmdir '$(TO)'/$$folder 2>/dev/null || echo "kept $$folder: other files in it"; done

package: $(B)/pzs
	@sh $(PACKAGES)/package.sh $(B)/pzs $(B)/package

# ---- unit tests ----------------------------------------------------------

# Programs of each variant, expanded where they are added.
UNIT_64 :=
UNIT_32 :=
UNIT_32t8 :=
UNIT_64t16 :=
UNIT_san64 :=
UNIT_san32 :=

# program: name, variant, sources beside the library, libraries
define program
UNIT_$(2) += $(B)/test/$(1)-$(2)
$(B)/test/$(1)-$(2): $(B)/$(2)/tests/unit/test_$(1).o $(3) $(B)/$(2)/libpiezoshape.a
	@mkdir -p $$(@D)
	$$(CC) $$(CFLAGS) $$(LDFLAGS) $(if $(filter san%,$(2)),-fsanitize=address$(comma)undefined) $$^ -lcmocka $(HOST_LIBS) -o $$@
endef
comma := ,
for_variants = $(foreach v,$(2),$(eval $(call program,$(1),$(v),$(3:@%=$(B)/$(v)/%))))
ALL := 64 32 32t8 64t16 san64 san32
$(call for_variants,linalg,$(ALL),)
$(call for_variants,control,64 32 san64 san32,@tests/rigs/testdata.o)
$(call for_variants,step,$(ALL),)
$(call for_variants,tick,64 32 san64 san32,)
$(call for_variants,work,64 32 san64 san32,)
$(call for_variants,dual,64 32 32t8 san64 san32,)
$(call for_variants,product,$(ALL),)
$(call for_variants,sparse,$(ALL),)
$(call for_variants,limit_rows,64 32 san64 san32,)
$(call for_variants,faults,64 32 san64 san32,@tests/rigs/testdata.o)
$(call for_variants,estimate,64 32 san64 san32,)
$(call for_variants,loop_blocks,64 32 san64 san32,)
$(call for_variants,late,64 32 san64 san32,)
$(call for_variants,modal_gains,64 32 san64 san32,)
$(call for_variants,sensor_gate,64 32 san64 san32,)
DAMPED := @tests/rigs/damped_loop.o @tests/rigs/loop_tests.o @tests/rigs/testdata.o @host_tools/model/damper_gains.o @host_tools/model/dense.o @host_tools/model/riccati.o @host_tools/model/propagator.o @bridge64.o
$(call for_variants,vibration_block,64 32 san64 san32,$(DAMPED))
RIVALS := $(foreach o,rival rival_base rival_lqg rival_ppf rival_wish damped_loop loop_tests testdata bridge,@tests/rigs/$(o).o)
$(call for_variants,rivals,64 san64,$(RIVALS) @host.a)
$(call for_variants,polarity,64 32 san64 san32,$(DAMPED))
$(call for_variants,polarity_gain,64 32 san64 san32,)
$(call for_variants,selftest,64 32 san64 san32,@bridge64.o)
$(call for_variants,recursive,64 32 san64 san32,@bridge64.o)
$(call for_variants,pulse_faults,64 32 san64 san32,)
$(foreach t,flips damped_flips watched_flips,$(call for_variants,$(t),64 32 san64 san32,@tests/rigs/flip_rig.o))
$(foreach t,supervisor heartbeat output_gate hysteresis actuator_curve,$(call for_variants,$(t),64 32 san64 san32,))
$(call for_variants,estimator,64 san64,@tests/rigs/scene_run.o @host.a)
$(call for_variants,shell,64 san64,@tests/rigs/testdata.o @host.a)
$(call for_variants,panel,64 san64,@tests/rigs/quad_shell.o @tests/rigs/scene_run.o @host.a)
$(call for_variants,disc,64 san64,@tests/rigs/quad_shell.o @tests/rigs/scene_run.o @host.a)
$(call for_variants,springs,64 san64,@tests/rigs/scene_run.o @host.a)
$(call for_variants,masses,64 san64,@tests/rigs/scene_run.o @host.a)
$(call for_variants,oblique,64 san64,@tests/rigs/scene_run.o @host.a)
$(call for_variants,reactions,64 san64,@tests/rigs/scene_run.o @host.a)
$(call for_variants,rotation,64 san64,@tests/rigs/scene_run.o @host.a)
$(call for_variants,laminate_shear,64 san64,@tests/rigs/testdata.o @tests/rigs/scene_run.o @host.a)
$(call for_variants,stress,64 san64,@tests/rigs/testdata.o @tests/rigs/scene_run.o @host.a)
$(call for_variants,quad_cases,64,@tests/rigs/quad_shell.o @host.a)
$(call for_variants,quad_element,64 san64,@tests/rigs/testdata.o @tests/rigs/quad_shell.o @host.a)
$(call for_variants,scene,64 san64,@host.a)
$(call for_variants,surface,64 san64,@host.a)
$(call for_variants,quads,64 san64,@tests/rigs/mesh_writer.o @host.a)
$(call for_variants,file_mesh,64 san64,@tests/rigs/mesh_writer.o @tests/rigs/scene_run.o @host.a)
$(call for_variants,file_faces,64,@tests/rigs/mesh_writer.o @tests/rigs/scene_run.o @host.a)
$(call for_variants,bicubic,64 san64,@tests/rigs/scene_run.o @host.a)
$(call for_variants,suggest,64 san64,@host.a)
$(call for_variants,outlines,64 san64,@tests/rigs/scene_run.o @host.a)
$(call for_variants,outline_responses,64,@tests/rigs/scene_run.o @host.a)
$(call for_variants,smeared,64 san64,@tests/rigs/scene_run.o @host.a)
$(call for_variants,mesh_error,64 san64,@host.a)
$(call for_variants,migrate,64 san64,@host.a)
$(call for_variants,data,64 san64,@host.a)
$(call for_variants,fits,64 san64,@host.a)
$(call for_variants,measured,64 san64,@tests/rigs/scene_run.o @host.a)
$(call for_variants,curves,64 san64,@tests/rigs/scene_run.o @host.a)
$(call for_variants,measured_modes,64,@tests/rigs/scene_run.o @host.a)
$(call for_variants,scene_gains,64 san64,@tests/rigs/scene_run.o @host.a)
$(call for_variants,identify,64,@tests/rigs/ceramic_sweep.o @tests/rigs/scene_run.o @host.a)
$(call for_variants,identify_modes,64,@host.a)
$(call for_variants,calibrate,64 san64,@tests/rigs/scene_run.o @host.a)
$(call for_variants,model,64 32 san64 san32,@tests/rigs/testdata.o @bridge64.o)
$(foreach t,modes open_device,$(call for_variants,$(t),64 32 san64 san32,@bridge64.o))
$(foreach t,follower contact,$(call for_variants,$(t),64 32 san64 san32,))
$(call for_variants,simulate,64 san64,@tests/rigs/scene_run.o @host.a)
$(call for_variants,shell_motion,64 san64,@tests/rigs/testdata.o @tests/rigs/scene_run.o @host.a)
$(call for_variants,plant,64 san64,@tests/rigs/testdata.o @tests/rigs/scene_run.o @host.a)
$(call for_variants,loop,64 san64,@tests/rigs/scene_run.o @host.a)
$(call for_variants,certify,64,@tests/rigs/scene_run.o @host.a)
$(call for_variants,free_functions,64 san64,@tests/rigs/scene_run.o @host.a)
$(call for_variants,parallel,64 san64,@tests/rigs/scene_run.o @host.a)
$(call for_variants,deformed,64 san64,@tests/rigs/scene_run.o @host.a)
$(call for_variants,loaded,64 san64,@tests/rigs/scene_run.o @host.a)
$(call for_variants,open_modes,64 san64,@tests/rigs/scene_run.o @host.a)
$(call for_variants,cases,64,@tests/rigs/testdata.o @tests/rigs/scene_run.o @host.a)
$(call for_variants,electric,64 san64,@tests/rigs/scene_run.o @host.a)
$(call for_variants,bare_faces,64 san64,@tests/rigs/scene_run.o @host.a)
$(call for_variants,heaters,64 san64,@tests/rigs/scene_run.o @host.a)
$(call for_variants,fields,64 san64,@tests/rigs/scene_run.o @host.a)
$(call for_variants,plausible,64,@tests/rigs/scene_run.o @host.a)
$(call for_variants,vibration,64 san64,@tests/rigs/scene_run.o @host.a)
$(call for_variants,load_path,64,@tests/rigs/scene_run.o @host.a)
$(call for_variants,expr_jet,64 san64,@host.a)
$(call for_variants,formula_surface,64,@tests/rigs/scene_run.o @host.a)
$(call for_variants,targets,64,@tests/rigs/scene_run.o @host.a)
$(call for_variants,unconstrained,64 san64,@tests/rigs/testdata.o @host.a)
$(call for_variants,thin,64,@tests/rigs/round_shell.o @tests/rigs/testdata.o @tests/rigs/scene_run.o @host.a)
$(foreach t,path path_tables path_oracle,$(call for_variants,$(t),64,@tests/rigs/testdata.o @tests/rigs/scene_run.o @host.a))
$(call for_variants,path_ends,64 san64,@tests/rigs/scene_run.o @host.a)
$(call for_variants,path_precision,64 32,@bridge64.o)

# The demonstration's plate with few sensors and a load, as tables for the tests of the loop.
GATE_PLATE := plate-50-patches --quasi-static --set 'loads=[{face: outer, pressure: 20}]' --set 'limits.voltage=[-300, 300]' \
    --set limits.step_limit=20 --set 'outputs=[{name: tip, u3: middle, edge: theta1+}]' \
    --set 'estimate={readings: [{output: tip, noise: 1e-7}]}' --image control --prefix plate
$(B)/tables/gate_plate.h: $(B)/pzs
	@mkdir -p $(@D)
	$< tables $(GATE_PLATE) -o $@ >/dev/null
GATE_OBJECTS := $(foreach v,64 32 san64 san32,$(B)/$(v)/tests/unit/test_flips.o)
$(GATE_OBJECTS): $(B)/tables/gate_plate.h
$(GATE_OBJECTS): INCLUDE += -I$(B)/tables

# The demonstration's plate with a loop that damps vibration, follows moving targets and compensates hysteresis; the same with late readings.
DAMPED_PLATE := plate-50-patches --set 'limits.voltage=[-300, 300]' --set limits.step_limit=20 \
    --set 'control={rate: 1000, moving_target: true}' --set 'hysteresis={range: [-300, 300], slopes: [0.5, 0.5, 0.5, 0.5], slack: [30, 120], above: [0.3, 0.2]}' \
    --image control
$(B)/tables/damped_plate.h: $(B)/pzs
	@mkdir -p $(@D)
	$< tables $(DAMPED_PLATE) --prefix plate -o $@ >/dev/null 2>&1
$(B)/tables/late_plate.h: $(B)/pzs
	@mkdir -p $(@D)
	$< tables $(DAMPED_PLATE) --set 'simulate={ticks: 100, sensors: {delay: 2}}' --prefix late -o $@ >/dev/null 2>&1
DAMPED_OBJECTS := $(foreach v,64 32 san64 san32,$(B)/$(v)/tests/unit/test_damped_flips.o)
$(DAMPED_OBJECTS): $(B)/tables/damped_plate.h $(B)/tables/late_plate.h
$(DAMPED_OBJECTS): INCLUDE += -I$(B)/tables

# The same plate with the sensor gate, and with the fault detector.
WATCHED_PLATE := plate-50-patches --set 'limits.voltage=[-300, 300]' --set limits.step_limit=20 --image control
$(B)/tables/gated_plate.h: $(B)/pzs
	@mkdir -p $(@D)
	$< tables $(WATCHED_PLATE) --set 'control={rate: 1000, sensor_gate: true}' --prefix gated -o $@ >/dev/null 2>&1
$(B)/tables/watched_plate.h: $(B)/pzs
	@mkdir -p $(@D)
	$< tables $(WATCHED_PLATE) --set 'control={rate: 1000}' --prefix watched -o $@ \
	    --set 'simulate={ticks: 10, events: [{at: 9, dead: [v_1_1], announced: detected}]}' >/dev/null 2>&1
WATCHED_OBJECTS := $(foreach v,64 32 san64 san32,$(B)/$(v)/tests/unit/test_watched_flips.o)
$(WATCHED_OBJECTS): $(B)/tables/gated_plate.h $(B)/tables/watched_plate.h
$(WATCHED_OBJECTS): INCLUDE += -I$(B)/tables

# Part of the sweep of equilibria with the unit tests, all of it with check-long.
UNIT_64 += $(B)/test/sweep-64
$(B)/test/sweep-64: $(B)/64/tests/unit/sweep_path.o $(B)/64/tests/rigs/scene_run.o $(B)/64/host.a $(B)/64/libpiezoshape.a
	@mkdir -p $(@D)
	$(CC) $^ $(HOST_LIBS) -o $@

# Storms on three structures with the unit tests, on all of them and with all laws with check-long; in float, the damped tick.
UNIT_64 += $(B)/test/storms-64
UNIT_32 += $(B)/test/storms-32
STORMS := $(B)/64/tests/rigs/storm_sweep.o $(B)/64/tests/rigs/scene_run.o
$(B)/test/storms-64: $(B)/64/tests/unit/sweep_storms.o $(STORMS) $(B)/64/host.a $(B)/64/libpiezoshape.a
	@mkdir -p $(@D)
	$(CC) $^ $(HOST_LIBS) -o $@
$(B)/32/storms64.o: $(STORMS) $(B)/64/host.a $(B)/64/libpiezoshape.a
	@mkdir -p $(@D)
	ld -r $(STORMS) --whole-archive $(B)/64/host.a $(B)/64/libpiezoshape.a -o $@
	objcopy -w --keep-global-symbol='bridge_*' $@
$(B)/test/storms-32: $(B)/32/tests/unit/sweep_storms.o $(B)/32/storms64.o $(B)/32/libpiezoshape.a
	@mkdir -p $(@D)
	$(CC) $^ $(HOST_LIBS) -o $@

# Storms on nonlinear plants with mass, with check-long.
$(B)/test/motion_storms-64: $(B)/64/tests/unit/sweep_motion.o $(B)/64/tests/rigs/scene_run.o $(B)/64/host.a $(B)/64/libpiezoshape.a
	@mkdir -p $(@D)
	$(CC) $^ $(HOST_LIBS) -o $@

# Fault detector in a loop that damps vibration; `detector-64 45000` runs a million healthy ticks, with check-long.
UNIT_64 += $(B)/test/detector-64
$(B)/test/detector-64: $(B)/64/tests/unit/sweep_faults.o $(B)/64/tests/rigs/fault_rig.o $(B)/64/tests/rigs/ceramic_sweep.o $(B)/64/tests/rigs/damped_plant.o $(B)/64/tests/rigs/scene_run.o $(B)/64/host.a $(B)/64/libpiezoshape.a
	@mkdir -p $(@D)
	$(CC) $^ $(HOST_LIBS) -o $@

# Sensor gate in a loop that damps vibration; `gate-64 1000000` runs a million healthy ticks, with check-long.
UNIT_64 += $(B)/test/gate-64
$(B)/test/gate-64: $(B)/64/tests/unit/sweep_gate.o $(B)/64/tests/rigs/damped_plant.o $(B)/64/tests/rigs/scene_run.o $(B)/64/host.a $(B)/64/libpiezoshape.a
	@mkdir -p $(@D)
	$(CC) $^ $(HOST_LIBS) -o $@

# Alarms of the supervisor on reversed amplifiers and on healthy loops; `alarms-64 8` on all structures.
UNIT_64 += $(B)/test/alarms-64
$(B)/test/alarms-64: $(B)/64/tests/unit/sweep_alarms.o $(B)/64/tests/rigs/damped_plant.o $(B)/64/tests/rigs/scene_run.o $(B)/64/host.a $(B)/64/libpiezoshape.a
	@mkdir -p $(@D)
	$(CC) $^ $(HOST_LIBS) -o $@

format:
	clang-format -i $$(git ls-files "*.c" "*.h" ":!host_tools/tables/example.h")

unit: $(UNIT_64) $(UNIT_32) $(UNIT_32t8) $(UNIT_64t16)
san: $(UNIT_san64) $(UNIT_san32) $(B)/pzs-san
$(B)/pzs-san: $(B)/san64/host_tools/cli/main.o $(B)/san64/host.a $(B)/san64/libpiezoshape.a
	$(CC) $(CFLAGS) $(LDFLAGS) -fsanitize=address,undefined $^ $(HOST_LIBS) -o $@

# Thin shells of revolution, every thickness and mesh: prints compliance over reference, case x h/R x mesh.
hard: $(B)/64/host.a $(B)/64/libpiezoshape.a
	$(CC) $(WARN) -O2 -DPZS_NONLINEAR=1 -DHARD=1 $(FOLDERS) $(INCLUDE) \
	    tests/unit/test_thin.c tests/rigs/round_shell.c tests/rigs/testdata.c tests/rigs/scene_run.c $(B)/64/host.a $(B)/64/libpiezoshape.a -lcmocka $(HOST_LIBS) \
	    -o $(B)/hard && $(B)/hard

# 20,000 mutated scenes, 20,000 mutated mesh files and every shipped scene under the sanitizers, five million ticks in both precisions, a million watched,
# a million flipped bits, a million ticks of random faults under the supervisor, six million of them on a vibrating plate, 10,000 self-tests with and without a
# fault, FMUs with sanitizers.
check-long: setup-test
	@$(MAKE) --no-print-directory -s -j2 all san unit
	$(CC) $(WARN) $(SANITIZE) -DMUTATIONS=20000 $(INCLUDE) tests/unit/test_scene.c $(B)/san64/host.a $(B)/san64/libpiezoshape.a \
	    -lcmocka $(HOST_LIBS) -o $(B)/long-scene && $(B)/long-scene
	for bits in 32 64; do $(CC) $(WARN) -O2 -DPZS_REAL_BITS=$$bits -DLONG_TICKS=5000000 $(INCLUDE) tests/unit/test_tick.c \
	    $(B)/$$bits/libpiezoshape.a -lcmocka -lm -o $(B)/long-tick && $(B)/long-tick || exit 1; done
	for bits in 32 64; do $(CC) $(WARN) -O2 -DPZS_REAL_BITS=$$bits -DRANDOM_PROBLEMS=10000 $(INCLUDE) tests/unit/test_limit_rows.c \
	    $(B)/$$bits/libpiezoshape.a -lcmocka -lm -o $(B)/long-rows && $(B)/long-rows $(B)/rows.dump || exit 1; done
	$(PYTHON) -B tests/oracle/limit_rows.py $(B)/rows.dump
	for bits in 32 64; do for test in control work; do $(CC) $(WARN) -O2 -DPZS_REAL_BITS=$$bits -DPZS_DUAL_INPUTS=1u \
	    -DPZS_NONLINEAR=1 $(FOLDERS) $(INCLUDE) tests/unit/test_$$test.c tests/rigs/testdata.c $(LIB) -lcmocka -lm -o $(B)/long-dual \
	    && $(B)/long-dual || exit 1; done; done
	for bits in 32 64; do $(CC) $(WARN) -O2 -DPZS_REAL_BITS=$$bits -DWORK_TICKS=1000000 $(INCLUDE) tests/unit/test_work.c \
	    $(B)/$$bits/libpiezoshape.a -lcmocka -lm -o $(B)/long-work && $(B)/long-work || exit 1; done
	for bits in 32 64; do $(CC) $(WARN) -O2 -DPZS_REAL_BITS=$$bits -DLONG_TICKS=1000000 $(INCLUDE) tests/unit/test_faults.c tests/rigs/testdata.c \
	    $(B)/$$bits/libpiezoshape.a -lcmocka -lm -o $(B)/long-faults && $(B)/long-faults || exit 1; done
	for bits in 32 64; do $(CC) $(WARN) -O2 -DPZS_REAL_BITS=$$bits -DFLIPS=1000000 -DWINDOWS=20000 $(INCLUDE) -I$(B)/tables \
	    tests/unit/test_flips.c tests/rigs/flip_rig.c $(B)/$$bits/libpiezoshape.a -lcmocka -lm -o $(B)/long-flips && $(B)/long-flips || exit 1; done
	for bits in 32 64; do $(CC) $(WARN) -O2 -DPZS_REAL_BITS=$$bits -DFLIPS=1000000 -DWINDOWS=2000 $(INCLUDE) \
	    -I$(B)/tables tests/unit/test_damped_flips.c tests/rigs/flip_rig.c $(B)/$$bits/libpiezoshape.a -lcmocka -lm -o $(B)/long-flips && $(B)/long-flips || exit 1; done
	for bits in 32 64; do $(CC) $(WARN) -O2 -DPZS_REAL_BITS=$$bits -DFLIPS=1000000 -DWINDOWS=2500 $(INCLUDE) \
	    -I$(B)/tables tests/unit/test_watched_flips.c tests/rigs/flip_rig.c $(B)/$$bits/libpiezoshape.a -lcmocka -lm -o $(B)/long-flips && $(B)/long-flips || exit 1; done
	for bits in 32 64; do $(CC) $(WARN) -O2 -DPZS_REAL_BITS=$$bits -DPZS_DUAL_INPUTS=1u -DFLIPS=1000000 -DWINDOWS=20000 $(INCLUDE) \
	    -I$(B)/tables tests/unit/test_flips.c tests/rigs/flip_rig.c $(LIB) -lcmocka -lm -o $(B)/long-flips && $(B)/long-flips || exit 1; done
	for bits in 32 64; do $(CC) $(WARN) -O2 -DPZS_REAL_BITS=$$bits -DLONG_TICKS=1000000 $(INCLUDE) tests/unit/test_supervisor.c \
	    $(B)/$$bits/libpiezoshape.a -lcmocka -lm -o $(B)/long-supervisor && $(B)/long-supervisor || exit 1; done
	for bits in 32 64; do $(CC) $(WARN) -O2 -DPZS_REAL_BITS=$$bits -DHEALTHY_RUNS=1200 $(INCLUDE) \
	    tests/unit/test_polarity.c $(DAMPED:@%=$(B)/$$bits/%) $(B)/$$bits/libpiezoshape.a -lcmocka $(HOST_LIBS) \
	    -o $(B)/long-polarity && $(B)/long-polarity || exit 1; done
	for bits in 32 64; do $(CC) $(WARN) -O2 -DPZS_REAL_BITS=$$bits -DRUNS=100 -DHEALTHY_RUNS=340 $(INCLUDE) \
	    tests/unit/test_selftest.c $(B)/$$bits/bridge64.o $(B)/$$bits/libpiezoshape.a -lcmocka $(HOST_LIBS) -o $(B)/long-selftest \
	    && $(B)/long-selftest || exit 1; done
	for bits in 32 64; do $(CC) $(WARN) -O2 -DPZS_REAL_BITS=$$bits -DRECORDS=1000000 $(INCLUDE) \
	    tests/unit/test_recursive.c $(B)/$$bits/bridge64.o $(B)/$$bits/libpiezoshape.a -lcmocka $(HOST_LIBS) -o $(B)/long-recursive \
	    && $(B)/long-recursive || exit 1; done
	@$(MAKE) --no-print-directory -s $(B)/test/detector-64
	$(B)/test/detector-64 45000
	$(B)/test/detector-64 340000 'plate, 30 %'
	@$(MAKE) --no-print-directory -s $(B)/test/gate-64
	$(B)/test/gate-64 1000000
	sh tests/target/gate.sh 1000000
	$(CC) $(WARN) -O2 -DPZS_NONLINEAR=1 -DFAULT_TICKS=1000000 $(FOLDERS) $(INCLUDE) \
	    tests/unit/test_simulate.c tests/rigs/scene_run.c $(B)/64/host.a $(B)/64/libpiezoshape.a -lcmocka $(HOST_LIBS) -o $(B)/long-simulate \
	    && $(B)/long-simulate
	$(CC) $(WARN) -O2 -DPZS_NONLINEAR=1 -DLONG_MOTION=1 $(FOLDERS) $(INCLUDE) tests/unit/test_shell_motion.c tests/rigs/testdata.c \
	    tests/rigs/scene_run.c \
	    $(B)/64/host.a $(B)/64/libpiezoshape.a -lcmocka $(HOST_LIBS) -o $(B)/long-motion && $(B)/long-motion
	$(CC) $(WARN) -O2 -DPZS_NONLINEAR=1 -DSLOW_ROWS=1 $(FOLDERS) $(INCLUDE) \
	    tests/unit/test_path_tables.c tests/rigs/scene_run.c $(B)/64/host.a $(B)/64/libpiezoshape.a -lcmocka $(HOST_LIBS) -o $(B)/long-path \
	    && $(B)/long-path
	$(CC) $(WARN) -O2 -DPZS_NONLINEAR=1 -DSLOW_ROWS=1 $(FOLDERS) $(INCLUDE) \
	    tests/unit/test_load_path.c tests/rigs/scene_run.c $(B)/64/host.a $(B)/64/libpiezoshape.a -lcmocka $(HOST_LIBS) -o $(B)/long-load-path \
	    && $(B)/long-load-path
	for bits in 32 64; do $(CC) $(WARN) -O2 -DPZS_REAL_BITS=$$bits -DPZS_NONLINEAR=1 -DSTORMS=1 $(INCLUDE) \
	    tests/unit/test_vibration_block.c $(DAMPED:@%=$(B)/$$bits/%) $(B)/$$bits/libpiezoshape.a -lcmocka $(HOST_LIBS) \
	    -o $(B)/long-vibration && $(B)/long-vibration || exit 1; done
	$(CC) $(WARN) $(SANITIZE) -DMUTATIONS=20000 $(INCLUDE) tests/unit/test_quads.c tests/rigs/mesh_writer.c $(B)/san64/host.a \
	    -lcmocka $(HOST_LIBS) -o $(B)/long-quads && $(B)/long-quads
	FMU_FLAGS='$(SANITIZE)' FMU_PRELOAD="$$(gcc -print-file-name=libasan.so)" B=$(B) sh tests/cli/fmu.sh
	B=$(B) sh tests/cli/random_faults.sh
	sh tests/target/bound.sh full
	@$(MAKE) --no-print-directory -s $(B)/bench/laws
	B=$(B) sh tests/bench/laws.sh --check
	sh tests/target/bound.sh long
	$(B)/test/sweep-64 full
	$(B)/test/storms-64 full
	@$(MAKE) --no-print-directory -s $(B)/test/storms-32
	$(B)/test/storms-32 full
	@$(MAKE) --no-print-directory -s $(B)/test/motion_storms-64
	$(B)/test/motion_storms-64 full
	/usr/bin/python3 tests/cli/schema.py $(B)/pzs $(SCENES)/scene.schema.json 1 tests/cli/schema/scenes.yaml $(SCENES)/*.yaml
	for s in $$($(B)/pzs-san list | cut -d' ' -f1); do for e in published improved; do \
	    case $$e$$s in publishedhex-mirror|publishedwing-panel|publishedhyperbolic-paraboloid|publishedfree-form-panel|publishedoff-axis-dish|publisheddisc-61-hexagons|publishedstack-mirror) continue ;; esac; \
	    $(B)/pzs-san solve $$s --set element=$$e --report $(B)/$$s.html >/dev/null || exit 1; done; done
	/usr/bin/python3 tests/bench/mesh_error.py $(B)/pzs
	@echo 'long checks passed'

# ---- data made by programs of this project -------------------------------

# The one generated header that is committed, for readers: four amplifiers on a mesh of 2 x 2 elements.
EXAMPLE := plate-50-patches --quasi-static --set mesh.theta1.elements=2 --set mesh.theta2.elements=2 --set patches.0.grid=[2,2] \
    --set patches.1.grid=[2,2] --set compare=[] --prefix example
example-table: $(B)/pzs
	$(B)/pzs tables $(EXAMPLE) -o host_tools/tables/example.h >/dev/null

measured: $(B)/pzs
	B=$(B) sh tests/bench/measured.sh --write

oracle:
	cd tests/oracle && $(PYTHON) write_data.py && $(PYTHON) write_nonlinear.py && $(PYTHON) write_thin.py && $(PYTHON) write_quads.py && $(PYTHON) write_sandwich.py && $(PYTHON) write_stress.py && $(PYTHON) write_plant.py && $(PYTHON) write_motion.py && $(PYTHON) write_damper.py

include firmware_demo/firmware.mk
-include tests/bench/bench.mk

clean:
	rm -rf $(B)

-include $(shell find $(B) $(FW_OBJECTS) -name '*.d' 2>/dev/null | sort -u)
