#!/bin/sh
# install.sh install|uninstall|list: puts what a host needs below $DESTDIR$PREFIX, removes exactly that, or lists it.
# From the environment: PREFIX, DESTDIR; BINDIR, LIBDIR, INCLUDEDIR, DATADIR, DOCDIR, MANDIR (absolute or below PREFIX);
# RELEASE, the folder of the built libraries; STRIP, what takes symbols off them, nothing: they stay as built; LD, OBJCOPY, what makes
# the static library one object.
set -eu
# whole FOLDER: the folder from the root of the file system, nothing for nothing.
whole() { case $1 in '' | /*) echo "$1" ;; *) echo "$PWD/$1" ;; esac; }
PREFIX=${PREFIX-/usr/local}
PREFIX=$(whole "${PREFIX%/}")
DESTDIR=$(whole "${DESTDIR-}")
STRIP=${STRIP-strip}
LD=${LD:-ld}
OBJCOPY=${OBJCOPY:-objcopy}
cd "$(dirname "$0")/.."
# placed FOLDER DEFAULT: the folder, or the default, below PREFIX unless absolute.
placed() { case ${1:-$2} in /*) echo "${1:-$2}" ;; *) echo "$PREFIX/${1:-$2}" ;; esac; }
BINDIR=$(placed "${BINDIR-}" bin)
LIBDIR=$(placed "${LIBDIR-}" lib)
INCLUDEDIR=$(placed "${INCLUDEDIR-}" include)
DATADIR=$(placed "${DATADIR-}" share)
DOCDIR=$(placed "${DOCDIR-}" "$DATADIR/doc/feti-contact")
MANDIR=$(placed "${MANDIR-}" "$DATADIR/man")
CMAKEDIR=$LIBDIR/cmake/feti_contact
FORTRANDIR=$DATADIR/feti_contact/fortran
MPIDIR=$DATADIR/feti_contact/mpi
RELEASE=${RELEASE:-${CARGO_TARGET_DIR:-target}/${CARGO_BUILD_TARGET:+$CARGO_BUILD_TARGET/}release}
VERSION=$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -n 1)
# The name for the loader: 0.MINOR before 1.0, MAJOR from then on, as in build.rs.
case $VERSION in 0.*) SOVERSION=${VERSION%.*} ;; *) SOVERSION=${VERSION%%.*} ;; esac

# files: a line MODE|SOURCE|TARGET for every file; mode `link`: SOURCE is what the link says; `fill`: a template; `shared`, `static`: a
# library, or the program.
files() {
    echo "shared|$RELEASE/libfeti_contact.so|$LIBDIR/libfeti_contact.so.$VERSION"
    echo "link|libfeti_contact.so.$VERSION|$LIBDIR/libfeti_contact.so.$SOVERSION"
    echo "link|libfeti_contact.so.$SOVERSION|$LIBDIR/libfeti_contact.so"
    echo "static|$RELEASE/libfeti_contact.a|$LIBDIR/libfeti_contact.a"
    echo "shared|$RELEASE/feti-contact|$BINDIR/feti-contact"
    echo "644|program/feti-contact.1|$MANDIR/man1/feti-contact.1"
    echo "644|include/feti_contact.h|$INCLUDEDIR/feti_contact.h"
    echo "fill|cmake/feti_contact.pc.in|$LIBDIR/pkgconfig/feti_contact.pc"
    echo "fill|cmake/feti_contact-config.cmake.in|$CMAKEDIR/feti_contact-config.cmake"
    echo "fill|cmake/feti_contact-config-version.cmake.in|$CMAKEDIR/feti_contact-config-version.cmake"
    echo "644|cmake/feti_contact-targets.cmake|$CMAKEDIR/feti_contact-targets.cmake"
    echo "644|include/feti_contact.hpp|$INCLUDEDIR/feti_contact.hpp"
    each "$FORTRANDIR" include/fortran/*.f90 include/fortran/*.inc include/fortran/fpm.toml
    each "$MPIDIR" mpi/*
    each "$DATADIR/feti_contact/suppressions" tools/suppressions/*
    each "$DOCDIR" README.md CHANGELOG.md LICENSE-MIT LICENSE-APACHE LICENSE-THIRD-PARTY
    each "$DOCDIR/docs" docs/*.md
    each "$DOCDIR/docs/hosts" docs/hosts/*.md
    each "$DOCDIR/docs/pictures" docs/pictures/*
    each "$DOCDIR/examples_c" examples_c/*
    each "$DOCDIR/examples_fortran" examples_fortran/*
    # What the examples read.
    for case in hertz_cylinder p1_P3 p2_B1 three_bodies; do each "$DOCDIR/data/$case" tests/data/$case/*.gz; done
    pages
}

# each FOLDER FILE...: the files that exist, to go to the folder.
each() {
    folder=$1
    shift
    for file in "$@"; do [ ! -f "$file" ] || echo "644|$file|$folder/${file##*/}"; done
}

# pages: the manual pages that `make docs` has made, one for every function of the header and one for all; to uninstall, also
# those that are not there any more.
pages() {
    for page in $(sed -n 's|^[a-z].*[ *]\(feti_[a-z0-9_]*\)(.*|man3/\1.3|p' include/feti_contact.h) man7/feti_contact.7; do
        [ "$way" != uninstall ] && [ ! -f "build/docs/man/$page" ] || echo "644|build/docs/man/$page|$MANDIR/$page"
    done
}

# from FOLDER HERE: the way from the folder to PREFIX, beginning with HERE, so that a tree may be moved; PREFIX itself for a
# folder elsewhere. below VARIABLE FOLDER: the folder in terms of the variable that holds the prefix.
from() {
    case $1 in
    "$PREFIX"/*) echo "$2/$(echo "${1#"$PREFIX"/}" | sed 's|[^/][^/]*|..|g')" ;;
    *) echo "$PREFIX" ;;
    esac
}
below() { case $2 in "$PREFIX"/*) echo "$1${2#"$PREFIX"}" ;; *) echo "$2" ;; esac; }

# in_order NAME...: Fortran sources as pkg-config says them, those that exist.
in_order() {
    for name in "$@"; do
        [ ! -f "include/fortran/feti_contact$name" ] || printf '${fortrandir}/feti_contact%s ' "$name"
    done
}
# others PATTERN: names of the sources that match, without those that come first.
others() { (cd include/fortran && ls feti_contact_*.f90) | sed 's/feti_contact//' | grep "$@" | grep -v '^_c\.\|_base\.' || true; }
# modules, f77: the sources of both faces in the order in which a compiler takes them: interfaces, base, parts, whole.
modules() { in_order _c.f90 _base.f90 $(others -v '^_f77') .f90; }
f77() { in_order _c.f90 _base.f90 _f77_base.f90 $(others '^_f77'); }

# fill TEMPLATE: the template with its variables replaced.
fill() {
    case $1 in
    *.pc.in) prefix='${prefix}' origin=$(from "$LIBDIR/pkgconfig" '${pcfiledir}') ;;
    *) prefix='${_feti_prefix}' origin=$(from "$CMAKEDIR" '${CMAKE_CURRENT_LIST_DIR}') ;;
    esac
    sed -e "s|@VERSION@|$VERSION|g" -e "s|@SOVERSION@|$SOVERSION|g" -e "s|@PREFIX@|$origin|g" \
        -e "s|@LIBDIR@|$(below "$prefix" "$LIBDIR")|g" -e "s|@INCLUDEDIR@|$(below "$prefix" "$INCLUDEDIR")|g" \
        -e "s|@FORTRANDIR@|$(below "$prefix" "$FORTRANDIR")|g" -e "s|@MPIDIR@|$(below "$prefix" "$MPIDIR")|g" -e "s|@MODULES@|$(modules)|g" \
        -e "s|@F77@|$(f77)|g" -e 's/ *$//' "$1"
}

# shared SOURCE TARGET: the shared library or the program, without what only a debugger reads.
shared() {
    install -m 755 "$1" "$2"
    [ -z "$STRIP" ] || "$STRIP" --strip-unneeded "$2" || echo "install.sh: $STRIP does not strip $2" >&2
}

# static SOURCE TARGET: the archive as one object whose only global symbols are those of the header, so that it clashes neither with the
# host nor with the archive of another library in Rust; as it was built where the tools do not serve. Sections of bitcode, which no host
# reads, go first: they cannot be joined.
static() {
    install -m 644 "$1" "$2"
    [ -n "$STRIP" ] || return 0
    work=$(mktemp -d)
    # as build.rs does for the shared library
    wrap=
    case $(uname -sm) in
    Linux\ x86_64 | Linux\ aarch64)
        for name in malloc calloc realloc posix_memalign free __cxa_thread_atexit_impl; do wrap="$wrap --wrap=$name"; done
        # the references of the library are weak, which would leave these two empty in a wholly static program
        echo '.section .note.GNU-stack,"",%progbits; .data; .quad __real_posix_memalign, __real___cxa_thread_atexit_impl' |
            ${CC:-cc} -c -x assembler - -o "$work/strong.o" && wrap="$wrap $work/strong.o" ;;
    esac
    if "$OBJCOPY" --strip-debug -R .llvmbc -R .llvmcmd "$1" "$work/members.a" &&
        "$LD" -r $wrap --whole-archive "$work/members.a" -o "$work/members.o" &&
        "$OBJCOPY" --wildcard --keep-global-symbol='feti_*' "$work/members.o" "$work/feti_contact.o" &&
        ${AR:-ar} crsD "$work/libfeti_contact.a" "$work/feti_contact.o"
    then install -m 644 "$work/libfeti_contact.a" "$2"
    else echo "install.sh: $2 is installed as built: $OBJCOPY or $LD failed" >&2
    fi
    rm -rf "$work"
}

# put MODE SOURCE TARGET: one line of `files`.
put() {
    mkdir -p "${3%/*}"
    case $1 in
    shared | static) "$1" "$2" "$3" ;;
    link) ln -sf "$2" "$3" ;;
    fill) fill "$2" >"$3" && chmod 644 "$3" ;;
    *) install -m "$1" "$2" "$3" ;;
    esac
}

# empty FOLDER: removes a folder that is ours by name, and its folders, where nothing is left in them.
empty() { [ ! -d "$1" ] || find "$1" -depth -type d -empty -delete; }

way=${1-}
case $way in
list) files | cut -d '|' -f 3 ;;
install)
    files | while IFS='|' read -r mode source target; do
        echo "$DESTDIR$target"
        put "$mode" "$source" "$DESTDIR$target"
    done
    ;;
uninstall)
    files | while IFS='|' read -r mode source target; do rm -f "$DESTDIR$target"; done
    for folder in "$CMAKEDIR" "$DATADIR/feti_contact" "$DOCDIR"; do empty "$DESTDIR$folder"; done
    ;;
*)
    echo "usage: install.sh install|uninstall|list" >&2
    exit 2
    ;;
esac
