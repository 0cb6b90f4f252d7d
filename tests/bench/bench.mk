# make bench: speed against the peers, in one run. Our side of the linear algebra and of the voltage step is built for
# this machine; the peers come from Debian (OpenBLAS) and from a PyPI source package (DAQP), neither is needed elsewhere.

FAST := -std=c99 -O3 -march=native -ffp-contract=fast $(INCLUDE)

.PHONY: bench bench-linalg bench-step bench-accuracy bench-path bench-count bench-device
bench: setup-bench
	@$(MAKE) --no-print-directory -s -k bench-linalg bench-step bench-accuracy bench-path bench-count bench-device

$(B)/bench/linalg-64: tests/bench/bench_linalg.c lib/linalg.c
	@mkdir -p $(@D)
	$(CC) $(FAST) -DPZS_REAL_BITS=64 -DPZS_TILE=8 $^ -lopenblas -lm -o $@
$(B)/bench/linalg-32: tests/bench/bench_linalg.c lib/linalg.c
	@mkdir -p $(@D)
	$(CC) $(FAST) -DPZS_REAL_BITS=32 -DPZS_TILE=16 $^ -lopenblas -lm -o $@
bench-linalg: $(B)/bench/linalg-64 $(B)/bench/linalg-32
	@echo 'Factor and solve of band matrices, flags $(filter -O3 -m% -ffp%,$(FAST))'
	@$(B)/bench/linalg-64; first=$$?; $(B)/bench/linalg-32 && exit $$first

$(B)/bench/accuracy: $(B)/64/tests/bench/bench_accuracy.o $(B)/64/host.a $(B)/64/libpiezoshape.a
	@mkdir -p $(@D)
	$(CC) $^ -lyaml -lm -o $@
bench-accuracy: $(B)/bench/accuracy
	@echo 'Speed against error, linear shells'
	@$(B)/bench/accuracy

bench-device: setup-test
	@echo 'Instructions on the device, counted by QEMU (not cycles)'
	@B=$(B) sh tests/bench/device.sh

# The whole library for this machine; and for valgrind, which does not know AVX-512.
FAST_PATH := -O3 -ffp-contract=fast -DPZS_REAL_BITS=64 -DPZS_TILE=8
$(eval $(call variant,native,-march=native $(FAST_PATH)))
$(eval $(call variant,avx2,-march=x86-64-v3 $(FAST_PATH)))
$(B)/bench/path: $(B)/native/tests/bench/bench_path.o $(B)/native/host.a $(B)/native/libpiezoshape.a
	@mkdir -p $(@D)
	$(CC) $^ -lyaml -lm -o $@
$(B)/bench/count-path: $(B)/avx2/tests/bench/count_path.o $(B)/avx2/host.a $(B)/avx2/libpiezoshape.a
	@mkdir -p $(@D)
	$(CC) $^ -lyaml -lm -o $@

# PEERS=full: every run of the peers, each three times (three minutes); otherwise the best of them, once (40 seconds).
bench-path: $(B)/bench/path
	@echo 'Speed against error, nonlinear shells; load of this machine' $$(cut -d' ' -f1 /proc/loadavg)
	@$(B)/bench/path --json $(B)/bench/path.json
	@$(PYTHON) tests/bench/peers/run.py --build $(B) $(if $(filter full,$(PEERS)),,--quick) >$(B)/bench/peers.json; failed=$$?; \
	    echo; echo 'Time to reach an error, against the peers; load of this machine' $$(cut -d' ' -f1 /proc/loadavg); \
	    $(PYTHON) tests/bench/peers/compare.py $(B)/bench/path.json $(B)/bench/peers.json && exit $$failed
bench-count: $(B)/bench/count-path $(F)/mps2-an500-hemisphere4.out
	@echo 'Instructions of a Newton system, element "source", double, AVX2'
	@sh tests/bench/count_path.sh $(B)/bench/count-path $(F)/mps2-an500-hemisphere4.out

# bench_step holds lib/boxls.c and lib/control.c itself, to time the solver apart from the product B'e.
$(B)/daqp/libdaqp.a:
	@CC='$(CC)' sh tests/bench/get_daqp.sh $(B)/daqp
bench-step:
	@$(MAKE) --no-print-directory -s $(B)/daqp/libdaqp.a; mkdir -p $(B)/bench
	@if [ -f $(B)/daqp/libdaqp.a ]; then with='-DWITH_DAQP -I$(B)/daqp/include'; peer=$(B)/daqp/libdaqp.a; fi; \
	    $(CC) $(FAST) -DPZS_REAL_BITS=64 -DPZS_TILE=8 $$with tests/bench/bench_step.c lib/guard.c $$peer -lm -o $(B)/bench/step
	@echo 'Warm voltage step against DAQP'
	@$(B)/bench/step
