# The targets of feti_contact, the same for an installed library and for one that is built along with its host:
#   feti_contact::feti_contact          the shared library and its header
#   feti_contact::feti_contact_static   the same as an archive
#   feti_contact::fortran               the Fortran modules, compiled in the host's tree with the host's flags, and the shared
#                                       library (component Fortran)
#   feti_contact::mpi                   feti_mpi.c, compiled with the host's MPI, and the shared library (component MPI)
#   feti_contact::mpi_fortran           the same with module feti_contact_mpi and FTMPI (components Fortran and MPI)
#   feti_contact::mpi_f08               the same with module feti_contact_mpi_f08 for communicators of mpi_f08, if the MPI has it

# feti_contact_library_targets(<shared library> <archive> <soname> <folder of the header>)
function(feti_contact_library_targets shared static soname include)
  if(TARGET feti_contact::feti_contact)
    return()
  endif()
  add_library(feti_contact::feti_contact SHARED IMPORTED GLOBAL)
  set_target_properties(feti_contact::feti_contact PROPERTIES
    IMPORTED_LOCATION "${shared}" IMPORTED_SONAME "${soname}" INTERFACE_INCLUDE_DIRECTORIES "${include}")
  add_library(feti_contact::feti_contact_static STATIC IMPORTED GLOBAL)
  set_target_properties(feti_contact::feti_contact_static PROPERTIES
    IMPORTED_LOCATION "${static}" INTERFACE_INCLUDE_DIRECTORIES "${include}"
    INTERFACE_LINK_LIBRARIES "util;rt;pthread;m;dl")
endfunction()

# feti_contact_fortran_target(<folder of the sources>): modules go to the build folder of the host; INCLUDE finds *.inc. A host
# that exports a library of its own puts the target feti_contact_fortran into the same export set.
function(feti_contact_fortran_target folder)
  if(TARGET feti_contact::fortran)
    return()
  endif()
  file(GLOB sources "${folder}/*.f90")
  file(GLOB f77 "${folder}/feti_contact_f77_*.f90")
  # The functions of a FORTRAN 77 host have no C binding: Fortran 2018, also for a host that asks for an older standard.
  if(CMAKE_Fortran_COMPILER_ID STREQUAL "GNU")
    set_source_files_properties(${f77} PROPERTIES COMPILE_OPTIONS -std=f2018)
  endif()
  set(modules "${CMAKE_BINARY_DIR}/feti_contact_modules")
  add_library(feti_contact_fortran STATIC EXCLUDE_FROM_ALL ${sources})
  set_target_properties(feti_contact_fortran PROPERTIES
    Fortran_MODULE_DIRECTORY "${modules}" POSITION_INDEPENDENT_CODE ON)
  target_include_directories(feti_contact_fortran INTERFACE "$<BUILD_INTERFACE:${modules}>" "$<BUILD_INTERFACE:${folder}>")
  target_link_libraries(feti_contact_fortran PUBLIC feti_contact::feti_contact)
  add_library(feti_contact::fortran ALIAS feti_contact_fortran)
endfunction()

# feti_contact_mpi_targets(<folder of the sources>): needs the target MPI::MPI_C.
function(feti_contact_mpi_targets folder)
  if(NOT TARGET feti_contact::mpi)
    add_library(feti_contact_mpi STATIC EXCLUDE_FROM_ALL "${folder}/feti_mpi.c")
    set_target_properties(feti_contact_mpi PROPERTIES POSITION_INDEPENDENT_CODE ON C_STANDARD 99)
    target_include_directories(feti_contact_mpi PUBLIC "$<BUILD_INTERFACE:${folder}>")
    target_link_libraries(feti_contact_mpi PUBLIC feti_contact::feti_contact MPI::MPI_C)
    add_library(feti_contact::mpi ALIAS feti_contact_mpi)
  endif()
  if(TARGET feti_contact::fortran AND NOT TARGET feti_contact::mpi_fortran)
    set(modules "${CMAKE_BINARY_DIR}/feti_contact_modules")
    file(GLOB sources "${folder}/*.f90")
    list(FILTER sources EXCLUDE REGEX "_f08[.]f90$")
    add_library(feti_contact_mpi_fortran STATIC EXCLUDE_FROM_ALL ${sources})
    set_target_properties(feti_contact_mpi_fortran PROPERTIES
      Fortran_MODULE_DIRECTORY "${modules}" POSITION_INDEPENDENT_CODE ON)
    target_link_libraries(feti_contact_mpi_fortran PUBLIC feti_contact::mpi feti_contact::fortran)
    add_library(feti_contact::mpi_fortran ALIAS feti_contact_mpi_fortran)
  endif()
  if(TARGET feti_contact::mpi_fortran AND MPI_Fortran_HAVE_F08_MODULE AND NOT TARGET feti_contact::mpi_f08)
    add_library(feti_contact_mpi_f08 STATIC EXCLUDE_FROM_ALL "${folder}/feti_contact_mpi_f08.f90")
    set_target_properties(feti_contact_mpi_f08 PROPERTIES
      Fortran_MODULE_DIRECTORY "${CMAKE_BINARY_DIR}/feti_contact_modules" POSITION_INDEPENDENT_CODE ON)
    target_link_libraries(feti_contact_mpi_f08 PUBLIC feti_contact::mpi_fortran MPI::MPI_Fortran)
    add_library(feti_contact::mpi_f08 ALIAS feti_contact_mpi_f08)
  endif()
endfunction()

# feti_contact_components(<folder of the Fortran sources> <folder of those for MPI>): answers find_package for the components that it asks for.
macro(feti_contact_components folder mpi_folder)
  set(feti_contact_C_FOUND TRUE)
  foreach(_feti_component IN LISTS feti_contact_FIND_COMPONENTS)
    if(_feti_component STREQUAL "Fortran")
      get_property(_feti_languages GLOBAL PROPERTY ENABLED_LANGUAGES)
      if("Fortran" IN_LIST _feti_languages)
        feti_contact_fortran_target("${folder}")
        set(feti_contact_Fortran_FOUND TRUE)
      elseif(feti_contact_FIND_REQUIRED_Fortran)
        set(feti_contact_FOUND FALSE)
        set(feti_contact_NOT_FOUND_MESSAGE "component Fortran needs enable_language(Fortran) before find_package")
      endif()
    elseif(_feti_component STREQUAL "MPI")
      find_package(MPI QUIET COMPONENTS C)
      set(feti_contact_MPI_FOUND ${MPI_C_FOUND})
      if(NOT MPI_C_FOUND AND feti_contact_FIND_REQUIRED_MPI)
        set(feti_contact_FOUND FALSE)
        set(feti_contact_NOT_FOUND_MESSAGE "component MPI finds no MPI for C")
      endif()
    elseif(NOT _feti_component STREQUAL "C" AND feti_contact_FIND_REQUIRED_${_feti_component})
      set(feti_contact_FOUND FALSE)
      set(feti_contact_NOT_FOUND_MESSAGE "no component ${_feti_component}: there are C, Fortran and MPI")
    endif()
  endforeach()
  if(feti_contact_MPI_FOUND)
    if(TARGET feti_contact::fortran)
      find_package(MPI QUIET COMPONENTS Fortran)
    endif()
    feti_contact_mpi_targets("${mpi_folder}")
  endif()
endmacro()
