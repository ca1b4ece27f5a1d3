# ---- packaging: hosts outside the source tree, and the interface against its baseline
set(HOSTS "${PROJECT_ROOT}/tests/packaging")
find_program(ABIDIFF abidiff REQUIRED)
if(DEFINED ENV{CARGO_TARGET_DIR})
  set(CARGO_BUILT "$ENV{CARGO_TARGET_DIR}")
else()
  set(CARGO_BUILT "${PROJECT_ROOT}/target")
endif()

claim("packaging: a CMake host finds the library where it was moved to, shared, static and in Fortran"
      sh "${HOSTS}/cmake.sh" "${HOSTS}" installed "${FETI_PREFIX}")
claim("packaging: find_package names a component or a version that it cannot give"
      sh "${HOSTS}/components.sh" "${FETI_PREFIX}")
claim("packaging: a CMake host builds the library along with itself, by add_subdirectory, and installs what make install does"
      sh "${HOSTS}/cmake.sh" "${HOSTS}" source "${PROJECT_ROOT}" "${CARGO_BUILT}")
claim("packaging: a CMake host builds the library along with itself, by FetchContent"
      sh "${HOSTS}/cmake.sh" "${HOSTS}" fetch "${PROJECT_ROOT}" "${CARGO_BUILT}")
claim("packaging: plain make and pkg-config build shared, static and wholly static hosts, in C and in Fortran"
      sh "${HOSTS}/make.sh" "${HOSTS}" "${FETI_PREFIX}")
claim("packaging: an fpm host depends on the Fortran sources by path"
      sh "${HOSTS}/fpm.sh" "${HOSTS}" "${FETI_PREFIX}" "${CMAKE_BINARY_DIR}/fpm")
find_program(PYTHON python3 REQUIRED)
claim("packaging: the recipes for conda and Spack have version, Rust and features of Cargo.toml and the files of make install"
      "${PYTHON}" "${HOSTS}/recipes.py" "${PROJECT_ROOT}")
claim("packaging: cargo-c is asked for the data that make install puts"
      sh "${HOSTS}/assets.sh" "${PROJECT_ROOT}" "${CMAKE_BINARY_DIR}/assets")
claim("packaging: functions, types and constants are those of the baseline or more, and a change that breaks a host is seen"
      sh "${CMAKE_CURRENT_SOURCE_DIR}/abi_gate.sh" "${PROJECT_ROOT}" "${FETI_LIBRARY}" "${FETI_INCLUDE}/feti_contact.h")

# A host of the baseline's header, with the library of today.
get_target_property(FETI_SONAME feti_contact::feti_contact IMPORTED_SONAME)
configure_file("${PROJECT_ROOT}/abi/${FETI_SONAME}.h" "${CMAKE_CURRENT_BINARY_DIR}/old/feti_contact.h" COPYONLY)
add_executable(c_old_host c/old_host.c)
target_include_directories(c_old_host BEFORE PRIVATE "${CMAKE_CURRENT_BINARY_DIR}/old")
target_link_libraries(c_old_host PRIVATE "${FETI_LIBRARY}" m)
claim_silent("packaging: a host compiled with the baseline's header gets its answers, and no byte behind its structs is touched"
             $<TARGET_FILE:c_old_host>)
