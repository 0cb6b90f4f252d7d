# SPDX-License-Identifier: BSD-2-Clause
# Firmware of the demonstration: images, runs under QEMU, sizes. Included by the top Makefile.
#
#   make firmware      build every image into $(B)/firmware
#   make qemu          run each under QEMU, compare its results bit by bit with a host build of the same C
#   make size          flash, RAM and stack against firmware_demo/size.budget
#   make test-target   start-up faults, the unit tests and the closed loop on the target (tests/target)

B ?= build
ARM_CC ?= arm-none-eabi-gcc
ARM_AR ?= arm-none-eabi-ar
FW_HOST_CC ?= gcc
FW_HOST_AR ?= ar
QEMU ?= qemu-system-arm
FW_SECONDS ?= 120

F := $(B)/firmware
# Objects of the library and of the boards. `pzs simulate --device` builds into a new folder; with the environment variable
# FW_OBJECTS=$(B)/firmware it takes the objects that `make loop-objects` compiled there.
FW_OBJECTS ?= $(F)
O := $(FW_OBJECTS)
FW_LIB_ALL := $(patsubst lib/%.c,%,$(wildcard lib/*/*.c))
FW_LIB_NONLINEAR := $(filter-out modes/%,$(FW_LIB_ALL))
FW_LIB_MODES := $(filter-out nonlinear/%,$(FW_LIB_ALL))
FW_LIB := $(filter-out modes/%,$(FW_LIB_MODES))
T := $(B)/tables
FW_INCLUDE := -Iinclude -I$(T)
FW_FLAGS := -std=c99 -ffunction-sections -fdata-sections -fno-math-errno -ffp-contract=off \
    -Wall -Wextra -Wconversion -Wdouble-promotion -Werror -pedantic $(FW_INCLUDE)

FW_M4 := -mthumb -mfloat-abi=hard -mcpu=cortex-m4 -mfpu=fpv4-sp-d16
FW_M7 := -mthumb -mfloat-abi=hard -mcpu=cortex-m7 -mfpu=fpv5-d16

# Choices of a library and the programs that use it.
FW_CHOICE_32 := -DPZS_REAL_BITS=32
FW_CHOICE_64 := -DPZS_REAL_BITS=64
FW_CHOICE_32-nonlinear := $(FW_CHOICE_32) -DPZS_NONLINEAR=1
FW_CHOICE_64-nonlinear := $(FW_CHOICE_64) -DPZS_NONLINEAR=1
FW_CHOICE_32-modes := $(FW_CHOICE_32) -DPZS_MODES=1
FW_CHOICE_64-modes := $(FW_CHOICE_64) -DPZS_MODES=1
FW_CHOICE_32-all := $(FW_CHOICE_32-nonlinear) -DPZS_MODES=1
FW_CHOICE_64-all := $(FW_CHOICE_64-nonlinear) -DPZS_MODES=1

# fw_tables: name, arguments of `pzs tables`. A generated header; it is rewritten only when its text changes.
define fw_tables
$(T)/$(1).h: $(B)/pzs
	@mkdir -p $$(@D)
	$$< tables $(2) --prefix demo -o $$@.new >/dev/null
	@if cmp -s $$@.new $$@; then rm $$@.new && touch $$@; else mv $$@.new $$@; fi
FW_TABLES += $(T)/$(1).h
endef
FW_COARSE := --set mesh.theta1.elements=5 --set mesh.theta2.elements=5
FW_OPEN := --set materials.G1195.permittivity=7.3e-9 --image linear --modes 5 --electrodes open
FW_HEMISPHERE := --set mesh.theta1.elements=4 --set mesh.theta2.elements=4
$(eval $(call fw_tables,plate_control,plate-50-patches --quasi-static --set limits.step_limit=20 --image control))
$(eval $(call fw_tables,plate_linear,plate-50-patches --quasi-static --set limits.step_limit=20 --image linear))
$(eval $(call fw_tables,plate5_linear,plate-50-patches --quasi-static --set limits.step_limit=20 $(FW_COARSE) --image linear))
$(eval $(call fw_tables,plate5_modes,plate-50-patches --quasi-static --set limits.step_limit=20 $(FW_COARSE) --image linear --modes 5))
$(eval $(call fw_tables,plate_modes,plate-50-patches --quasi-static --set limits.step_limit=20 --image linear --modes 5))
$(eval $(call fw_tables,plate_nonlinear,plate-50-patches --quasi-static --set kinematics=nonlinear --image nonlinear))
$(eval $(call fw_tables,hemisphere4_nonlinear,hemisphere $(FW_HEMISPHERE) --image nonlinear))
$(eval $(call fw_tables,plate5_open,plate-50-patches --quasi-static --set limits.step_limit=20 $(FW_COARSE) $(FW_OPEN)))
$(eval $(call fw_tables,plate_open,plate-50-patches --quasi-static --set limits.step_limit=20 $(FW_OPEN)))
$(eval $(call fw_tables,vlasov4_modes,vlasov-plate $(FW_HEMISPHERE) --set kinematics=nonlinear --set materials.plate.E=100 --set materials.plate.density=1 --image nonlinear --modes 3))
$(eval $(call fw_tables,wing_linear,wing-panel --quasi-static --image linear --compact))
$(eval $(call fw_tables,wing_nonlinear,wing-panel --quasi-static --set kinematics=nonlinear --image nonlinear --compact))
# Meshes of Gmsh from the tests: an off-axis dish with 19 actuators, a box beam with sharp edges, a wing skin with a
# cut-out and eight patches.
$(eval $(call fw_tables,dish_control,tests/rigs/scenes/dish.yaml --quasi-static --image control))
$(eval $(call fw_tables,box_beam_linear,tests/rigs/scenes/box-beam-patches.yaml --image linear --compact))
$(eval $(call fw_tables,wing_skin_linear,tests/rigs/scenes/wing-skin.yaml --quasi-static --image linear --compact))
$(T)/dish_control.h: $(wildcard tests/rigs/scenes/dish.*)
$(T)/box_beam_linear.h: $(wildcard tests/rigs/scenes/box-beam*)
$(T)/wing_skin_linear.h: $(wildcard tests/rigs/scenes/wing-skin.*)
tables: $(FW_TABLES)

# fw_library: processor or host, choice, compiler, archiver, flags, sources. One static library for each choice,
# and the demonstration's own objects that are the same for all its images.
define fw_library
$(O)/$(1)-$(2)/%.o: lib/%.c
	@mkdir -p $$(@D)
	$(3) $(5) $(FW_CHOICE_$(2)) $(FW_FLAGS) -MMD -c $$< -o $$@
$(O)/$(1)-$(2)/demo/%.o: firmware_demo/%.c
	@mkdir -p $$(@D)
	$(3) $(5) $(FW_CHOICE_$(2)) $(FW_FLAGS) -MMD -c $$< -o $$@
$(O)/$(1)-$(2)/libpzs.a: $(6:%=$(O)/$(1)-$(2)/%.o)
	rm -f $$@ && $(4) rcs $$@ $$^
FW_LIBRARIES += $(1)-$(2)
endef

# In float -Os makes gcc multiply and accumulate in one instruction: fewer instructions than -O2, the same bits.
$(eval $(call fw_library,m4,32,$(ARM_CC),$(ARM_AR),$(FW_M4) -Os,$(FW_LIB)))
$(eval $(call fw_library,m7,64,$(ARM_CC),$(ARM_AR),$(FW_M7) -O2,$(FW_LIB)))
$(eval $(call fw_library,m4,32-nonlinear,$(ARM_CC),$(ARM_AR),$(FW_M4) -Os,$(FW_LIB_NONLINEAR)))
$(eval $(call fw_library,m7,64-nonlinear,$(ARM_CC),$(ARM_AR),$(FW_M7) -O2,$(FW_LIB_NONLINEAR)))
$(eval $(call fw_library,m4,32-modes,$(ARM_CC),$(ARM_AR),$(FW_M4) -Os,$(FW_LIB_MODES)))
$(eval $(call fw_library,m7,64-modes,$(ARM_CC),$(ARM_AR),$(FW_M7) -O2,$(FW_LIB_MODES)))
$(eval $(call fw_library,m4,32-all,$(ARM_CC),$(ARM_AR),$(FW_M4) -Os,$(FW_LIB_ALL)))
$(eval $(call fw_library,m7,64-all,$(ARM_CC),$(ARM_AR),$(FW_M7) -O2,$(FW_LIB_ALL)))
$(eval $(call fw_library,host,32,$(FW_HOST_CC),$(FW_HOST_AR),-O2,$(FW_LIB)))
$(eval $(call fw_library,host,64,$(FW_HOST_CC),$(FW_HOST_AR),-O2,$(FW_LIB)))
$(eval $(call fw_library,host,32-modes,$(FW_HOST_CC),$(FW_HOST_AR),-O2,$(FW_LIB_MODES)))
$(eval $(call fw_library,host,64-modes,$(FW_HOST_CC),$(FW_HOST_AR),-O2,$(FW_LIB_MODES)))
$(eval $(call fw_library,host,32-nonlinear,$(FW_HOST_CC),$(FW_HOST_AR),-O2,$(FW_LIB_NONLINEAR)))
$(eval $(call fw_library,host,64-nonlinear,$(FW_HOST_CC),$(FW_HOST_AR),-O2,$(FW_LIB_NONLINEAR)))
$(eval $(call fw_library,host,32-all,$(FW_HOST_CC),$(FW_HOST_AR),-O2,$(FW_LIB_ALL)))
$(eval $(call fw_library,host,64-all,$(FW_HOST_CC),$(FW_HOST_AR),-O2,$(FW_LIB_ALL)))

# fw_part: library, part (control, linear, modes, modes_at, loads or reshape), tables, compiler, flags. The object that holds the tables.
define fw_part
$(F)/$(1)/$(3).o: firmware_demo/demos/demo_$(2).c $(T)/$(3).h
	@mkdir -p $$(@D)
	$(4) $(5) -O2 $(FW_FLAGS) -DDEMO_TABLES='"$(3).h"' -MMD -c $$< -o $$@
endef

# What each part stands on.
FW_DEMO_control := demos/main demos/drill demos/print
FW_DEMO_linear := demos/main demos/drill demos/print
FW_DEMO_modes := demos/modes_lines demos/drill demos/print
FW_DEMO_modes_at := demos/demo_path demos/modes_lines demos/drill demos/print
FW_DEMO_loads := demos/demo_path demos/drill demos/print
FW_DEMO_reshape := demos/demo_path demos/drill demos/print

# fw_host: choice, part, tables. The same program on the host.
define fw_host
$(call fw_part,host-$(1),$(2),$(3),$(FW_HOST_CC),$(FW_CHOICE_$(1)))
$(F)/host-$(1)-$(3): $(FW_DEMO_$(2):%=$(O)/host-$(1)/demo/%.o) $(O)/host-$(1)/demo/boards/board_host.o $(F)/host-$(1)/$(3).o $(O)/host-$(1)/libpzs.a
	$(FW_HOST_CC) $$^ -lm -o $$@
$(F)/host-$(1)-$(3).out: $(F)/host-$(1)-$(3)
	{ timeout $(FW_SECONDS) $$(abspath $$<); echo "exit $$$$?"; } > $$@
endef

$(eval $(call fw_host,32,control,plate_control))
$(eval $(call fw_host,32,linear,plate5_linear))
$(eval $(call fw_host,64,linear,plate_linear))
$(eval $(call fw_host,32,linear,wing_linear))
$(eval $(call fw_host,32,control,dish_control))
$(eval $(call fw_host,32,linear,box_beam_linear))
$(eval $(call fw_host,32,linear,wing_skin_linear))
$(eval $(call fw_host,32-modes,modes,plate5_modes))
$(eval $(call fw_host,64-modes,modes,plate_modes))
$(eval $(call fw_host,32-modes,modes,plate5_open))
$(eval $(call fw_host,64-modes,modes,plate_open))
$(eval $(call fw_host,32-all,modes_at,vlasov4_modes))
$(eval $(call fw_host,64-all,modes_at,vlasov4_modes))
$(eval $(call fw_host,32-nonlinear,loads,hemisphere4_nonlinear))
$(eval $(call fw_host,64-nonlinear,loads,hemisphere4_nonlinear))
$(eval $(call fw_host,64-nonlinear,reshape,plate_nonlinear))
$(eval $(call fw_host,64-nonlinear,loads,wing_nonlinear))

# fw_image: name, QEMU machine, linker script, board file, -icount shift, processor, choice, part, tables, processor flags.
define fw_image
$(if $(filter $(6)-$(7)/$(9),$(FW_PARTS)),,$(call fw_part,$(6)-$(7),$(8),$(9),$(ARM_CC),$(10) $(FW_CHOICE_$(7))))
$(F)/$(1).elf: $(O)/$(6)-$(7)/demo/boards/start.o $(O)/$(6)-$(7)/demo/boards/$(4).o $(FW_DEMO_$(8):%=$(O)/$(6)-$(7)/demo/%.o) \
    $(F)/$(6)-$(7)/$(9).o $(O)/$(6)-$(7)/libpzs.a \
    firmware_demo/boards/$(3).ld firmware_demo/boards/sections.ld
	$(ARM_CC) $(10) -nostartfiles -Lfirmware_demo/boards -Tfirmware_demo/boards/$(3).ld -Wl,--gc-sections -Wl,-Map=$$(@:.elf=.map) \
	    $$(filter %.o %.a,$$^) -lm -o $$@
$(F)/$(1).out: $(F)/$(1).elf
	{ timeout $(FW_SECONDS) $(QEMU) -M $(2) -icount shift=$(5) -kernel $$< -nographic -monitor none -serial stdio \
	    -semihosting-config enable=on,target=native </dev/null 2>$$(@:.out=.err); echo "exit $$$$?"; } > $$@
FW_IMAGES += $(1)
FW_PAIRS += $(1):host-$(7)-$(9)
FW_PARTS += $(6)-$(7)/$(9)
endef

$(eval $(call fw_image,netduinoplus2-control,netduinoplus2,netduinoplus2,board_netduinoplus2,0,m4,32,control,plate_control,$(FW_M4)))
$(eval $(call fw_image,mps2-an386-control,mps2-an386,mps2_an386,board_mps2,10,m4,32,control,plate_control,$(FW_M4)))
$(eval $(call fw_image,mps2-an386-linear5,mps2-an386,mps2_an386,board_mps2,10,m4,32,linear,plate5_linear,$(FW_M4)))
$(eval $(call fw_image,mps2-an500-linear,mps2-an500,mps2_an500,board_mps2,10,m7,64,linear,plate_linear,$(FW_M7)))
$(eval $(call fw_image,mps2-an386-modes5,mps2-an386,mps2_an386,board_mps2,10,m4,32-modes,modes,plate5_modes,$(FW_M4)))
$(eval $(call fw_image,mps2-an500-modes,mps2-an500,mps2_an500,board_mps2,10,m7,64-modes,modes,plate_modes,$(FW_M7)))
$(eval $(call fw_image,mps2-an386-open5,mps2-an386,mps2_an386,board_mps2,10,m4,32-modes,modes,plate5_open,$(FW_M4)))
$(eval $(call fw_image,mps2-an500-open,mps2-an500,mps2_an500,board_mps2,10,m7,64-modes,modes,plate_open,$(FW_M7)))
$(eval $(call fw_image,mps2-an386-modes-at,mps2-an386,mps2_an386,board_mps2,10,m4,32-all,modes_at,vlasov4_modes,$(FW_M4)))
$(eval $(call fw_image,mps2-an500-modes-at,mps2-an500,mps2_an500,board_mps2,10,m7,64-all,modes_at,vlasov4_modes,$(FW_M7)))
$(eval $(call fw_image,mps2-an386-hemisphere4,mps2-an386,mps2_an386,board_mps2,10,m4,32-nonlinear,loads,hemisphere4_nonlinear,$(FW_M4)))
$(eval $(call fw_image,mps2-an500-hemisphere4,mps2-an500,mps2_an500,board_mps2,10,m7,64-nonlinear,loads,hemisphere4_nonlinear,$(FW_M7)))
$(eval $(call fw_image,mps2-an500-reshape,mps2-an500,mps2_an500,board_mps2,10,m7,64-nonlinear,reshape,plate_nonlinear,$(FW_M7)))
$(eval $(call fw_image,mps2-an386-wing,mps2-an386,mps2_an386,board_mps2,10,m4,32,linear,wing_linear,$(FW_M4)))
$(eval $(call fw_image,mps2-an386-dish,mps2-an386,mps2_an386,board_mps2,10,m4,32,control,dish_control,$(FW_M4)))
$(eval $(call fw_image,mps2-an386-box-beam,mps2-an386,mps2_an386,board_mps2,10,m4,32,linear,box_beam_linear,$(FW_M4)))
$(eval $(call fw_image,mps2-an386-wing-skin,mps2-an386,mps2_an386,board_mps2,10,m4,32,linear,wing_skin_linear,$(FW_M4)))
$(eval $(call fw_image,mps2-an500-wing,mps2-an500,mps2_an500,board_mps2,10,m7,64-nonlinear,loads,wing_nonlinear,$(FW_M7)))

# For `pzs simulate --device`: the controller with the tables in LOOP, a header, and its plant at the other end of a stream.
# fw_loop: name, processor or host, choice, objects of the board, compiler, flags of compiler and linker
define fw_loop
$(F)/$(1)-loop: firmware_demo/demos/demo_loop.c $(FW_CONTROL:%=$(O)/$(2)-$(3)/%.o) $(4:%=$(O)/$(2)-$(3)/demo/%.o)
	@mkdir -p $$(@D)
	$(5) $(6) -O2 $(FW_CHOICE_$(3)) $(FW_FLAGS) -DDEMO_TABLES='"$(LOOP)"' -Wl,--gc-sections $$^ -lm -o $$@
FW_LOOP_OBJECTS += $(FW_CONTROL:%=$(O)/$(2)-$(3)/%.o) $(4:%=$(O)/$(2)-$(3)/demo/%.o)
endef
FW_CONTROL := $(filter-out model/model model/shell,$(FW_LIB)) # what stands between influence and volts
FW_LINK := -nostartfiles -Lfirmware_demo/boards -Tfirmware_demo/boards

$(eval $(call fw_loop,host-32,host,32,boards/board_host,$(FW_HOST_CC)))
$(eval $(call fw_loop,host-64,host,64,boards/board_host,$(FW_HOST_CC)))
$(eval $(call fw_loop,netduinoplus2,m4,32,boards/start,$(ARM_CC),$(FW_M4) $(FW_LINK)/netduinoplus2.ld))
$(eval $(call fw_loop,mps2-an386,m4,32,boards/start,$(ARM_CC),$(FW_M4) $(FW_LINK)/mps2_an386.ld))
$(eval $(call fw_loop,mps2-an500,m7,64,boards/start,$(ARM_CC),$(FW_M7) $(FW_LINK)/mps2_an500.ld))

FW_OUTPUTS := $(foreach pair,$(FW_PAIRS),$(patsubst %,$(F)/%.out,$(subst :, ,$(pair))))

.PHONY: firmware loop-objects qemu size test-target
loop-objects: $(sort $(FW_LOOP_OBJECTS))
firmware: $(FW_IMAGES:%=$(F)/%.elf)

qemu: $(sort $(FW_OUTPUTS))
	sh firmware_demo/compare.sh $(F) $(FW_PAIRS)

size: $(FW_IMAGES:%=$(F)/%.elf) $(FW_IMAGES:%=$(F)/%.out) $(FW_LIBRARIES:%=$(O)/%/libpzs.a)
	sh firmware_demo/size.sh $(F) firmware_demo/size.budget $(FW_IMAGES)

test-target:
	ARM_CC='$(ARM_CC)' QEMU='$(QEMU)' B='$(B)' sh tests/target/start.sh
	ARM_CC='$(ARM_CC)' QEMU='$(QEMU)' B='$(B)' sh tests/target/units.sh
	ARM_CC='$(ARM_CC)' QEMU='$(QEMU)' B='$(B)' sh tests/target/loop.sh
	ARM_CC='$(ARM_CC)' QEMU='$(QEMU)' B='$(B)' sh tests/target/examples.sh
