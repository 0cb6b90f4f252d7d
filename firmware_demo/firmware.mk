# Firmware of the demonstration: images, runs under QEMU, sizes. Included by the top Makefile.
#
#   make firmware      build every image into $(B)/firmware
#   make qemu          run each under QEMU, compare its results bit by bit with a host build of the same C
#   make size          flash, RAM and stack against firmware_demo/size.budget
#   make test-target   start-up faults and the unit tests on the target (tests/target)

B ?= build
ARM_CC ?= arm-none-eabi-gcc
ARM_AR ?= arm-none-eabi-ar
FW_HOST_CC ?= gcc
FW_HOST_AR ?= ar
QEMU ?= qemu-system-arm
FW_SECONDS ?= 120

F := $(B)/firmware
FW_LIB := $(filter-out nonlinear follower contact electric,$(patsubst lib/%.c,%,$(wildcard lib/*.c)))
FW_INCLUDE := -Iinclude -Ilib -Ifirmware_demo -Ifirmware_demo/tables
FW_FLAGS := -std=c99 -ffunction-sections -fdata-sections -fno-math-errno -ffp-contract=off \
    -Wall -Wextra -Wconversion -Wdouble-promotion -Werror -pedantic $(FW_INCLUDE)

FW_M4 := -mthumb -mfloat-abi=hard -mcpu=cortex-m4 -mfpu=fpv4-sp-d16
FW_M7 := -mthumb -mfloat-abi=hard -mcpu=cortex-m7 -mfpu=fpv5-d16

# fw_library: name, compiler, archiver, flags. One static library for a processor and a precision,
# and the demonstration's own objects that are the same for all its images.
define fw_library
$(F)/$(1)/%.o: lib/%.c
	@mkdir -p $$(@D)
	$(2) $(4) $(FW_FLAGS) -MMD -c $$< -o $$@
$(F)/$(1)/demo/%.o: firmware_demo/%.c
	@mkdir -p $$(@D)
	$(2) $(4) $(FW_FLAGS) -MMD -c $$< -o $$@
$(F)/$(1)/libpzs.a: $(FW_LIB:%=$(F)/$(1)/%.o)
	rm -f $$@ && $(3) rcs $$@ $$^
FW_LIBRARIES += $(1)
endef

# In float -Os makes gcc multiply and accumulate in one instruction: fewer instructions than -O2, the same bits.
$(eval $(call fw_library,m4-32,$(ARM_CC),$(ARM_AR),$(FW_M4) -Os -DPZS_REAL_BITS=32))
$(eval $(call fw_library,m7-64,$(ARM_CC),$(ARM_AR),$(FW_M7) -O2 -DPZS_REAL_BITS=64))
$(eval $(call fw_library,host-32,$(FW_HOST_CC),$(FW_HOST_AR),-O2 -DPZS_REAL_BITS=32))
$(eval $(call fw_library,host-64,$(FW_HOST_CC),$(FW_HOST_AR),-O2 -DPZS_REAL_BITS=64))

# fw_part: library, part (control or linear), tables, compiler, flags. The object that holds the tables.
define fw_part
$(F)/$(1)/$(3).o: firmware_demo/demo_$(2).c
	@mkdir -p $$(@D)
	$(4) $(5) -O2 $(FW_FLAGS) -DDEMO_TABLES='"$(3).h"' -MMD -c $$< -o $$@
endef

FW_DEMO := main drill print

# fw_host: precision, part, tables. The same program on the host.
define fw_host
$(call fw_part,host-$(1),$(2),$(3),$(FW_HOST_CC),-DPZS_REAL_BITS=$(1))
$(F)/host-$(1)-$(3): $(FW_DEMO:%=$(F)/host-$(1)/demo/%.o) $(F)/host-$(1)/demo/board_host.o $(F)/host-$(1)/$(3).o $(F)/host-$(1)/libpzs.a
	$(FW_HOST_CC) $$^ -lm -o $$@
$(F)/host-$(1)-$(3).out: $(F)/host-$(1)-$(3)
	{ timeout $(FW_SECONDS) $$(abspath $$<); echo "exit $$$$?"; } > $$@
endef

$(eval $(call fw_host,32,control,plate_control))
$(eval $(call fw_host,32,linear,plate5_linear))
$(eval $(call fw_host,64,linear,plate_linear))

# fw_image: name, QEMU machine, linker script, board file, -icount shift, library, precision, part, tables, processor flags.
define fw_image
$(if $(filter $(6)/$(9),$(FW_PARTS)),,$(call fw_part,$(6),$(8),$(9),$(ARM_CC),$(10) -DPZS_REAL_BITS=$(7)))
$(F)/$(1).elf: $(F)/$(6)/demo/start.o $(F)/$(6)/demo/$(4).o $(FW_DEMO:%=$(F)/$(6)/demo/%.o) $(F)/$(6)/$(9).o $(F)/$(6)/libpzs.a \
    firmware_demo/$(3).ld firmware_demo/sections.ld
	$(ARM_CC) $(10) -nostartfiles -Lfirmware_demo -Tfirmware_demo/$(3).ld -Wl,--gc-sections -Wl,-Map=$$(@:.elf=.map) \
	    $$(filter %.o %.a,$$^) -lm -o $$@
$(F)/$(1).out: $(F)/$(1).elf
	{ timeout $(FW_SECONDS) $(QEMU) -M $(2) -icount shift=$(5) -kernel $$< -nographic -monitor none -serial stdio \
	    -semihosting-config enable=on,target=native </dev/null 2>$$(@:.out=.err); echo "exit $$$$?"; } > $$@
FW_IMAGES += $(1)
FW_PAIRS += $(1):host-$(7)-$(9)
FW_PARTS += $(6)/$(9)
endef

$(eval $(call fw_image,netduinoplus2-control,netduinoplus2,netduinoplus2,board_netduinoplus2,0,m4-32,32,control,plate_control,$(FW_M4)))
$(eval $(call fw_image,mps2-an386-control,mps2-an386,mps2_an386,board_mps2,10,m4-32,32,control,plate_control,$(FW_M4)))
$(eval $(call fw_image,mps2-an386-linear5,mps2-an386,mps2_an386,board_mps2,10,m4-32,32,linear,plate5_linear,$(FW_M4)))
$(eval $(call fw_image,mps2-an500-linear,mps2-an500,mps2_an500,board_mps2,10,m7-64,64,linear,plate_linear,$(FW_M7)))

FW_OUTPUTS := $(foreach pair,$(FW_PAIRS),$(patsubst %,$(F)/%.out,$(subst :, ,$(pair))))

.PHONY: firmware qemu size test-target
firmware: $(FW_IMAGES:%=$(F)/%.elf)

qemu: $(sort $(FW_OUTPUTS))
	sh firmware_demo/compare.sh $(F) $(FW_PAIRS)

size: $(FW_IMAGES:%=$(F)/%.elf) $(FW_IMAGES:%=$(F)/%.out) $(FW_LIBRARIES:%=$(F)/%/libpzs.a)
	sh firmware_demo/size.sh $(F) firmware_demo/size.budget $(FW_IMAGES)

test-target:
	ARM_CC='$(ARM_CC)' QEMU='$(QEMU)' B='$(B)' sh tests/target/start.sh
	ARM_CC='$(ARM_CC)' QEMU='$(QEMU)' B='$(B)' sh tests/target/units.sh
