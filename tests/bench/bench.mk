# SPDX-License-Identifier: BSD-2-Clause
# make bench: speed against the peers, in one run. Our side of the linear algebra is built for this machine, that of the
# voltage step as users get it; the peers come from Debian (OpenBLAS) and from a PyPI source package (DAQP, built for this
# machine), neither is needed elsewhere.

FAST := -std=c99 -O3 -march=native -ffp-contract=fast $(INCLUDE)

# The library as make builds it for users: vectors only where the processor is asked at run time.
SHIPPED := -std=c99 -O2 $(WIDE) $(INCLUDE)

BENCHES := bench-linalg bench-step bench-rows bench-growth bench-accuracy bench-path bench-count bench-device bench-mesh bench-frequencies
.PHONY: bench bench-peers $(BENCHES)
bench: setup-bench
	@$(MAKE) --no-print-directory -s -k $(BENCHES) bench-peers PEERS=--quick

$(B)/bench/linalg-64: tests/bench/bench_linalg.c lib/core/linalg.c
	@mkdir -p $(@D)
	$(CC) $(FAST) -DPZS_REAL_BITS=64 -DPZS_TILE=8 $^ -lopenblas -lm -o $@
$(B)/bench/linalg-32: tests/bench/bench_linalg.c lib/core/linalg.c
	@mkdir -p $(@D)
	$(CC) $(FAST) -DPZS_REAL_BITS=32 -DPZS_TILE=16 $^ -lopenblas -lm -o $@
bench-linalg: $(B)/bench/linalg-64 $(B)/bench/linalg-32
	@echo 'Factor and solve of band matrices, flags $(filter -O3 -m% -ffp%,$(FAST))'
	@$(B)/bench/linalg-64; first=$$?; $(B)/bench/linalg-32 && exit $$first

$(B)/bench/accuracy: $(B)/64/tests/bench/bench_accuracy.o $(B)/64/host.a $(B)/64/libpiezoshape.a
	@mkdir -p $(@D)
	$(CC) $^ $(HOST_LIBS) -o $@
bench-accuracy: $(B)/bench/accuracy
	@echo 'Speed against error, linear shells'
	@$(B)/bench/accuracy

bench-device: setup-test $(B)/pzs
	@echo 'Instructions on the device, counted by QEMU (not cycles)'
	@B=$(B) sh tests/bench/device.sh
	@echo 'A control tick with estimate, feed-forward, converter steps and watch'
	@B=$(B) sh tests/bench/count_tick.sh $(B)/pzs
	@echo 'Every block of the control tick against its bound'
	@B=$(B) sh tests/target/bound.sh full
	@echo 'Control ticks with targets that jump'
	@B=$(B) sh tests/bench/count_work.sh $(B)/pzs

# The whole library for this machine; and for valgrind, which does not know AVX-512.
FAST_PATH := -O3 -ffp-contract=fast -DPZS_REAL_BITS=64 -DPZS_TILE=8
$(eval $(call variant,native,-march=native $(FAST_PATH)))
$(eval $(call variant,avx2,-march=x86-64-v3 $(FAST_PATH)))

# bench_program: program in $(B)/bench, variant, object without .o
define bench_program
$(B)/bench/$(1): $(B)/$(2)/$(3).o $(B)/$(2)/host.a $(B)/$(2)/libpiezoshape.a
	@mkdir -p $$(@D)
	$$(CC) $$^ $(HOST_LIBS) -o $$@
endef
$(eval $(call bench_program,path,native,tests/bench/bench_path))
$(eval $(call bench_program,avx2/run_path,avx2,tests/bench/run_path))
$(eval $(call bench_program,native/run_path,native,tests/bench/run_path))
$(eval $(call bench_program,native/pzs,native,host_tools/cli/main))
$(eval $(call bench_program,default/run_path,64,tests/bench/run_path))
$(eval $(call bench_program,default/pzs,64,host_tools/cli/main))

bench-path: $(B)/bench/path
	@echo 'Speed against error, nonlinear shells'
	@$(B)/bench/path
bench-count: $(B)/bench/avx2/run_path $(F)/mps2-an500-hemisphere4.out
	@echo 'Instructions of a Newton system, double, AVX2'
	@sh tests/bench/count_path.sh $(B)/bench/avx2/run_path $(F)/mps2-an500-hemisphere4.out
	@echo 'The element at a shape: floating-point operations and instructions, counted by QEMU'
	@B=$(B) sh tests/bench/count_shell.sh

# Natural frequencies against CalculiX: half a minute.
bench-frequencies: $(B)/pzs
	@echo 'Natural frequencies, against CalculiX S8R'
	@$(PYTHON) -B tests/bench/peers/frequencies.py --build $(B)

# Every case, each code five times in turn: six minutes. `make bench` takes the best of them, CalculiX once: two minutes.
bench-peers: bench-frequencies $(foreach v,native default,$(B)/bench/$(v)/run_path $(B)/bench/$(v)/pzs)
	@echo 'Time to reach an error, against the peers'
	@$(PYTHON) -B tests/bench/peers/run.py --build $(B) $(PEERS) >$(B)/bench/peers.json; failed=$$?; \
	    $(PYTHON) -B tests/bench/peers/compare.py $(B)/bench/peers.json && exit $$failed

# Structures on a mesh of a file against CalculiX: two minutes.
bench-mesh: $(B)/pzs
	@echo 'Meshes from files, against CalculiX S8R on the mesh of half the element length'
	@$(PYTHON) -B tests/bench/peers/mesh_file.py --build $(B)

STEP_SOURCES := $(wildcard lib/core/*.c lib/control/*.c)
$(B)/daqp/libdaqp.a:
	@CC='$(CC)' sh tests/bench/get_daqp.sh $(B)/daqp
bench-step:
	@$(MAKE) --no-print-directory -s $(B)/daqp/libdaqp.a; mkdir -p $(B)/bench
	@if [ -f $(B)/daqp/libdaqp.a ]; then with='-DWITH_DAQP -I$(B)/daqp/include'; peer=$(B)/daqp/libdaqp.a; fi; \
	    $(CC) $(SHIPPED) -DPZS_REAL_BITS=64 $$with tests/bench/bench_step.c $(STEP_SOURCES) $$peer -lm -o $(B)/bench/step
	@echo 'Voltage steps against DAQP'
	@$(B)/bench/step
bench-rows:
	@$(MAKE) --no-print-directory -s $(B)/daqp/libdaqp.a; mkdir -p $(B)/bench
	@if [ -f $(B)/daqp/libdaqp.a ]; then with='-DWITH_DAQP -I$(B)/daqp/include'; peer=$(B)/daqp/libdaqp.a; fi; \
	    $(CC) $(SHIPPED) -DPZS_REAL_BITS=64 $$with tests/bench/bench_rows.c $(STEP_SOURCES) $$peer -lm -o $(B)/bench/rows
	@echo 'Voltages within limits between amplifiers against DAQP'
	@$(B)/bench/rows
bench-growth:
	@mkdir -p $(B)/bench
	@$(CC) $(SHIPPED) -DPZS_REAL_BITS=64 tests/bench/bench_growth.c $(STEP_SOURCES) -lopenblas -lm -o $(B)/bench/growth
	@echo 'Growth of the controller with the number of inputs, against OpenBLAS'
	@OPENBLAS_NUM_THREADS=1 $(B)/bench/growth

# Control laws on a plate with inertia, each with the best settings of a search: a quarter of an hour. Writes their table
# into tests/bench/README.md; not part of `make bench`.
$(B)/bench/laws: $(B)/64/tests/bench/bench_laws.o $(RIVALS:@%=$(B)/64/%) $(B)/64/tests/rigs/scene_run.o $(B)/64/host.a \
    $(B)/64/libpiezoshape.a
	@mkdir -p $(@D)
	$(CC) $^ -lcmocka $(HOST_LIBS) -o $@
.PHONY: bench-laws
bench-laws: $(B)/bench/laws
	@echo 'Control laws on a plate with inertia'
	@B=$(B) sh tests/bench/laws.sh --write
