# SPDX-License-Identifier: BSD-2-Clause
# Installed library for find_package(piezoshape): the targets piezoshape::piezoshape (double) and
# piezoshape::piezoshape32 (float).
get_filename_component(_piezoshape_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
foreach(_piezoshape_variant ":64" "32:32")
    string(REPLACE ":" ";" _piezoshape_pair "${_piezoshape_variant}")
    list(GET _piezoshape_pair 0 _piezoshape_suffix)
    list(GET _piezoshape_pair 1 _piezoshape_bits)
    set(_piezoshape_target piezoshape::piezoshape${_piezoshape_suffix})
    if(NOT TARGET ${_piezoshape_target})
        add_library(${_piezoshape_target} STATIC IMPORTED)
        set_target_properties(${_piezoshape_target} PROPERTIES
            IMPORTED_LOCATION "${_piezoshape_prefix}/lib/libpiezoshape${_piezoshape_suffix}.a"
            INTERFACE_INCLUDE_DIRECTORIES "${_piezoshape_prefix}/include/piezoshape"
            INTERFACE_COMPILE_DEFINITIONS "PZS_REAL_BITS=${_piezoshape_bits};PZS_NONLINEAR=1;PZS_MODES=1"
            INTERFACE_LINK_LIBRARIES m)
    endif()
endforeach()
