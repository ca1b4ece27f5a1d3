#!/bin/sh
# run.sh PREFIX ROOT WORK MPI...: with each MPI (openmpi, mpich, as Debian names their compilers) the installed sources for MPI are
# compiled without a warning, as they are and with messages cut at 4096 bytes; examples 15 to 17 in C and Fortran, FORTRAN 77 hosts and
# hostile hosts print on 2 and 4 ranks what they print on 1, a host in Python (PYTHON has mpi4py) on 2 and 3; of a mistake that one of 3 ranks makes, each in turn, all hear the same. The
# shared library needs no MPI. With PROBLEMS, a folder of problems, also what comes of these, bit by bit: of those that are dealt out over
# the ranks (*.deal), and with LENDING, the prefix of a library that lends every body, of problem files (*.feti).
set -eu
prefix=$1 root=$2 work=$3
shift 3
[ $# -gt 0 ] || { echo "usage: run.sh PREFIX ROOT WORK MPI..." >&2; exit 2; }
limit=60 # seconds of a run
counts="1 2 4"
fail() { echo "tests/mpi: $*" >&2; exit 1; }

! readelf -dW "$prefix/lib/libfeti_contact.so" | grep -i 'NEEDED.*mpi' || fail "the library needs an MPI"
! nm -D --undefined-only "$prefix/lib/libfeti_contact.so" | grep 'MPI_' || fail "the library calls MPI"

export PKG_CONFIG_PATH="$prefix/lib/pkgconfig"
pkg() { pkg-config "$@" feti_contact; }
shim="$(pkg --variable=mpi_sources)" folder="$(pkg --variable=mpidir)" face="$(pkg --variable=fortrandir)"
link="$(pkg --libs) -Wl,-rpath,$(pkg --variable=libdir) -lm"
c="$root/examples_c" fortran="$root/examples_fortran" examples="15_serial_under_mpirun 16_body_per_rank 17_one_body_in_subdomains"

# run MPI RANKS PROGRAM ARGUMENT...: ranks that wait leave their CPU to others; nothing is bound; as root, too.
run() {
    mpi=$1 ranks=$2
    shift 2
    case $mpi in
    openmpi)
        OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 timeout "$limit" mpirun.openmpi --oversubscribe --bind-to none \
            --mca mpi_yield_when_idle 1 --mca btl_vader_single_copy_mechanism none -n "$ranks" "$@" ;;
    mpich) timeout "$limit" mpirun.mpich -bind-to none -n "$ranks" "$@" ;;
    *) fail "no such MPI: $mpi" ;;
    esac
}

# same MPI PROGRAM ARGUMENT...: it ends well and prints the same bytes on 1, 2 and 4 ranks (counts), and something at that; times are left out.
same() {
    mpi=$1
    shift
    for ranks in $counts; do
        run "$mpi" "$ranks" "$@" >printed 2>errors || { cat printed errors; fail "$mpi, $ranks ranks: $* ends with an error"; }
        sed 's/ seconds [0-9.]*//' printed >"ranks$ranks"
    done
    [ -s ranks1 ] || fail "$mpi: $* prints nothing"
    for ranks in $counts; do
        diff ranks1 "ranks$ranks" || fail "$mpi: $* prints something else on $ranks ranks"
    done
    echo "$mpi: $(basename "$1") $(basename "${2-}") prints the same on these numbers of ranks: $counts"
}

# built MPI FLAG...: the programs in this folder, the sources for MPI compiled with these flags.
# shellcheck disable=SC2046,SC2086 # one word per flag
built() {
    cc=mpicc.$1 fc=mpifort.$1
    shift
    strict="-O2 -Wall -Wextra -Werror"
    $cc -std=c99 -pedantic $strict "$@" $(pkg --cflags) -I"$folder" -c "$shim" -o shim.o
    for example in $examples; do
        $cc -std=c99 $strict $(pkg --cflags) -I"$folder" -I"$c" "$c/$example.c" "$c/demo.c" shim.o -o "${example}_c" $link
    done
    $cc -std=c99 $strict "$@" $(pkg --cflags) -I"$folder" "$root/tests/mpi/hostile.c" -o hostile $link -lpthread
    for host in deals statuses; do
        $cc -std=c99 -pedantic $strict $(pkg --cflags) -I"$folder" "$root/tests/mpi/$host.c" shim.o -o "$host" $link -lpthread
    done
    [ -z "${LENDING-}" ] || $cc -std=c99 $strict $(pkg --cflags) -I"$folder" "$root/tests/mpi/files.c" shim.o -o files -L"$LENDING/lib" \
        -Wl,-rpath,"$LENDING/lib" -lfeti_contact -lm
    $fc -O2 -Wall -J. -c $(pkg --variable=fortransources) $(pkg --variable=mpi_f08_sources) "$fortran/demo.f90"
    for example in $examples; do
        $fc -O2 -Wall -J. "$fortran/$example.f90" feti_contact*.o demo.o shim.o -o "${example}_fortran" $link
    done
    rm feti_contact*.o
    $fc -O2 -J. -I"$face" -c $(pkg --variable=f77sources) $(pkg --variable=mpi_f77_sources)
    for host in lends gives; do
        $fc -O2 -std=legacy -I"$face" "$root/tests/mpi/$host.f" feti_contact_*.o shim.o -o "$host" $link
    done
}

# by_cmake MPI: component MPI of the CMake package builds example 15 in both languages, with the compilers of this MPI.
by_cmake() {
    cat >CMakeLists.txt <<END
cmake_minimum_required(VERSION 3.22)
project(host LANGUAGES C Fortran)
find_package(feti_contact REQUIRED COMPONENTS C Fortran MPI)
find_package(MPI REQUIRED COMPONENTS Fortran)
add_executable(cmake_c "$c/16_body_per_rank.c" "$c/demo.c")
target_link_libraries(cmake_c PRIVATE feti_contact::mpi m)
add_executable(cmake_fortran "$fortran/demo.f90" "$fortran/16_body_per_rank.f90")
target_link_libraries(cmake_fortran PRIVATE feti_contact::mpi_f08 MPI::MPI_Fortran)
END
    cmake -S . -B cmake -DCMAKE_PREFIX_PATH="$prefix" -DMPI_C_COMPILER="$(command -v "mpicc.$1")" \
        -DMPI_Fortran_COMPILER="$(command -v "mpifort.$1")" >cmake.log 2>&1 && cmake --build cmake >>cmake.log 2>&1 || { cat cmake.log; exit 1; }
    readelf -dW cmake/cmake_c | grep -q "NEEDED.*$2" || fail "CMake has not linked $1"
    same "$1" cmake/cmake_c
    same "$1" cmake/cmake_fortran
}

# by_fpm MPI: a host under fpm depends on the installed sources by path.
by_fpm() {
    mkdir fpm fpm/app
    cp -R "$prefix/share/feti_contact" fpm/moved
    cp "$fortran/demo.f90" "$fortran/16_body_per_rank.f90" fpm/app
    cat >fpm/fpm.toml <<END
name = "host"
executable = [{ name = "host", main = "16_body_per_rank.f90" }]
dependencies.feti-contact-mpi.path = "moved/mpi"
dependencies.feti-contact.path = "moved/fortran"
build.external-modules = ["mpi_f08"]
END
    (cd fpm && "$fpm" install --prefix out --compiler "mpifort.$1" --c-compiler "mpicc.$1" --c-flag "$(pkg --cflags)" --link-flag "$link") \
        >fpm.log 2>&1 || { cat fpm.log; exit 1; }
    same "$1" fpm/out/bin/host
}

mkdir -p "$work"
work=$(cd "$work" && pwd)
fpm=$(sh "$root/tests/packaging/fpm_from_pypi.sh" "$work/fpm")
for mpi in "$@"; do
    for chunk in whole 4096; do
        place=$work/$mpi.$chunk
        rm -rf "$place"
        mkdir -p "$place"
        cd "$place"
        if [ "$chunk" = whole ]; then built "$mpi"; else built "$mpi" "-DFETI_MPI_CHUNK=$chunk"; fi
        for example in $examples; do same "$mpi" "./${example}_c"; done
        for case in messages alive twice parts; do same "$mpi" ./hostile "$case"; done
        [ "$chunk" = whole ] || continue
        for example in $examples; do same "$mpi" "./${example}_fortran"; done
        # mpi4py of PyPI finds Open MPI, or the MPI that it is told
        [ "$mpi" != openmpi ] || for level in multiple funneled; do
            PYTHONPATH="$root/python" PYTHONDONTWRITEBYTECODE=1 FETI_CONTACT_LIBRARY="$prefix/lib/libfeti_contact.so" MPI4PY_RC_THREAD_LEVEL=$level \
                counts="1 2 3" same "$mpi" "${PYTHON:?with mpi4py}" "$root/tests/mpi/python_host.py"
        done
        same "$mpi" ./lends
        same "$mpi" ./gives
        limit=600 run "$mpi" 3 ./statuses >printed 2>errors || { cat printed errors; fail "$mpi: not all ranks hear the same of every mistake"; }
        echo "$mpi: $(wc -l <printed) mistakes, made by each of 3 ranks, are told on all"
        for case in single freed thread threads outside; do same "$mpi" ./hostile "$case"; done
        ended=0
        run "$mpi" 2 ./hostile leaves >printed 2>errors || ended=$?
        [ "$ended" -ne 0 ] && [ "$ended" -ne 124 ] || fail "$mpi: MPI_Abort does not end ranks that wait ($ended)"
        [ -z "${LENDING-}" ] || limit=600 same "$mpi" ./files "$PROBLEMS"/*.feti
        [ -z "${PROBLEMS-}" ] || counts="1 2 3 4" limit=600 same "$mpi" ./deals "$PROBLEMS"/*.deal
        by_cmake "$mpi" "$([ "$mpi" = mpich ] && echo libmpich || echo libmpi)"
        by_fpm "$mpi"
    done
    "$work/$mpi.whole/hostile" unknown >/dev/null 2>&1 && fail "hostile accepts any case"
done
echo "tests/mpi: all as on one rank"
