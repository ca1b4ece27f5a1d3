# make demo      builds the library and the examples, runs them        make lib        the library alone
# make gallery   runs the demo and renders the pictures of docs/gallery.md from its results (the first time 700 MB in build/gallery)
# make quick     after every change: unit tests, claims but for the three slowest, documents; make driver  NAME=c_settings: one driver
# make test      every test: Rust, C and Fortran under CMake, Python     make install    PREFIX=/usr/local DESTDIR=
# make python    the Python package in an environment of its own below build, and its tests; SECONDS=600: hypothesis for ten minutes
# make metis     tests with the feature metis                          make ranks      Rust tests with bodies lent to other ranks
# make fuzz      random calls, texts and files under AddressSanitizer, SECONDS=600 each target; TARGETS="calls file" picks some
# make sanitize  C and Fortran drivers under AddressSanitizer     make loom      registry and pools in all orders of two threads
# make coverage  lines of c/src that the tests run                make overhead  what the C ABI costs on the smallest problem
# make mutants   wrong changes of src and c/src, one by one, that the Rust tests have to notice (about half an hour);
#                CHANGES="17 52" picks some, CHANGES=--places tells where they are
# make vary      every threshold of src/numbers times 10 and a tenth of it: what changes (an hour)
# make counts    applications of F against a linear solve, deck by deck (some minutes); DECKS="slab two" picks some,
#                DECKS=sequence compares friction with sequences of problems of Tresca (5 minutes)
# make bench     time and memory against CHOLMOD, faer, Clarabel and OSQP (some 20 minutes, 11 GB); DECKS="4k 40k" picks some
# make scaling   time and memory as unknowns, contact rows, bodies, pieces, threads grow: pictures in docs (some minutes);
#                SWEEPS="rows cut" picks some, a number among them leaves out decks of more unknowns
# make spooles   dual_operator=automatic with SPOOLES as K+ against the better of explicit and implicit (some minutes);
#                SCENES="first newton" picks some
# make growth    how time grows with the number of loose or glued bodies (some minutes); DECKS="tower wall" picks some
# make paper     the paper's problems by its own method and by the default: table, pictures (seconds)
# make mpi       several ranks under Open MPI and MPICH, DEALS=24 seeds of problems are dealt out; make mpi-short: under Open MPI
#                alone, without them (a minute)
# make hosts     CalculiX with this library's contact against its own on its own decks (a quarter of an hour), written to docs/hosts/calculix.md
# make hosts-python  scikit-fem, SfePy and GetFEM as hosts, each against a known answer (seconds; the first time 1.2 GB in build/hosts)
# make docs      the book, manual pages, pages of the Fortran modules and of the crate: build/docs/index.html, with a search
#                over all of them; Chromium opens page by page without network (some minutes, and tells of which part)
# make abi       writes the baseline of the binary interface (abi)        make uninstall  removes what install has put
# make man       the manual pages alone                                make deb        Debian packages in build/deb (some minutes)
# make release   source archive with all crates, wheel, Debian packages, checksums in build/release (a quarter of an hour)
# make packaging cargo cinstall against make install, an installation without network, the conda recipe (some minutes, the first time many)
# bench, scaling, demo, docs, gallery, hosts, hosts-python, mpi and test install the Debian packages they miss (tools/setup.sh).
PREFIX  ?= /usr/local
DESTDIR ?=
CARGO   ?= cargo
CC      ?= cc
ifeq ($(origin FC),default)
FC = gfortran
endif
CFLAGS  ?= -O2 -Wall -Wextra
FCFLAGS ?= -O2 -Wall

RELEASE   := $(or $(CARGO_TARGET_DIR),target)/$(if $(CARGO_BUILD_TARGET),$(CARGO_BUILD_TARGET)/)release
STAGE     := $(CURDIR)/build/stage

.PHONY: all lib data setup demo battery rungs bits ranks test metis fuzz sanitize loom coverage mutants overhead counts bench growth scaling spooles paper docs
.PHONY: quick gallery driver man deb mpi mpi-short hosts hosts-python python
.PHONY: abi licences numbers vary packaging release stage install uninstall lint fmt clean
.DELETE_ON_ERROR:
all: lib

lib:
	$(CARGO) build --release --locked

setup:
	@tools/setup.sh

lint:
	$(CARGO) fmt --all --check
	$(CARGO) clippy --release --workspace --all-targets --locked -- --deny warnings

fmt:
	$(CARGO) fmt --all

clean:
	$(CARGO) clean
	rm -rf build

# ---- reference cases as plain text
DATA := $(patsubst tests/data/%.gz,build/data/%,$(wildcard tests/data/*/*.gz))
data: $(DATA)
	@:

build/data/%: tests/data/%.gz
	@mkdir -p $(@D)
	@gzip -dc $< > $@

# ---- installation: shared library with its links, static library, header, Fortran sources, pkg-config, CMake
# BINDIR, LIBDIR, INCLUDEDIR, DATADIR, DOCDIR, MANDIR as distributions set them, absolute or below PREFIX. tools/install.sh has the list.
INSTALL = PREFIX='$(PREFIX)' DESTDIR='$(DESTDIR)' BINDIR='$(BINDIR)' LIBDIR='$(LIBDIR)' INCLUDEDIR='$(INCLUDEDIR)' DATADIR='$(DATADIR)' \
    DOCDIR='$(DOCDIR)' MANDIR='$(MANDIR)' RELEASE='$(RELEASE)' tools/install.sh

install: lib
	@$(INSTALL) install

uninstall:
	@$(INSTALL) uninstall

# The baseline of the binary interface, for the soname of the library: written before a release, checked by ctest.
abi: lib
	tools/abi.sh write $(RELEASE)/libfeti_contact.so include/feti_contact.h

# Ways to install that take long: cargo-c against make install (cargo-c itself takes minutes, once), and without network.
CARGO_C := 0.10.24
build/tools/bin/cargo-cinstall:
	@tools/setup.sh libssl-dev
	CARGO_TARGET_DIR=build/tools/target CARGO_PROFILE_DEV_OPT_LEVEL=0 CARGO_PROFILE_DEV_DEBUG=0 \
	    $(CARGO) install cargo-c --version $(CARGO_C) --locked --debug --root build/tools
	rm -rf build/tools/target

build/tools/conda/installed: packaging/conda/requirements.txt
	@tools/setup.sh patchelf
	python3 -m venv --clear $(@D)
	$(@D)/bin/pip install --quiet --requirement $<
	touch $@

packaging: build/tools/bin/cargo-cinstall build/tools/conda/installed
	sh tests/packaging/offline.sh $(CURDIR) $(CURDIR)/build/offline
	sh tests/packaging/oldest.sh $(CURDIR) $(CURDIR)/build/oldest
	sh tests/packaging/cargo_c.sh $(CURDIR) $(CURDIR)/build/tools $(CURDIR)/build/cargo_c
	build/tools/conda/bin/python tests/packaging/conda.py $(CURDIR) $(CURDIR)/build/conda

# What a release consists of, in build/release.
release:
	tools/release.sh build/release

# Debian packages in build/deb: the library, its development files, its documents.
deb:
	tools/deb.sh build/deb

# The table of docs/licences.md and LICENSE-THIRD-PARTY, from Cargo.lock and the sources of the crates.
licences:
	LICENCES=write $(CARGO) test --profile quick --locked -p feti-contact --test documents -- licences::

# The page of thresholds, from src/numbers.
numbers:
	NUMBERS=write $(CARGO) test --profile quick --locked -p feti-contact --test documents -- numbers::

# What changes if a threshold is 10 times larger or smaller (an hour); NUMBERS="qp::LOST" picks some.
vary:
	@CARGO=$(CARGO) python3 tools/mutants/vary.py $(NUMBERS)

# The library as a host finds it: installed below build/stage.
stage:
	@$(MAKE) --no-print-directory install PREFIX=$(STAGE) DESTDIR= > /dev/null

# ---- examples, built as a host would by hand
# These need MPI: make mpi.
WITH_MPI         := 15_% 16_% 17_%
EXAMPLES_C       := $(filter-out $(WITH_MPI),$(basename $(notdir $(wildcard examples_c/[0-9]*.c))))
EXAMPLES_FORTRAN := $(filter-out $(WITH_MPI),$(basename $(notdir $(wildcard examples_fortran/[0-9]*.f90 examples_fortran/[0-9]*.f))))
PROGRAMS := $(EXAMPLES_C:%=build/demo/%_c) $(EXAMPLES_FORTRAN:%=build/demo/%_fortran)
SHARED_C := $(filter-out examples_c/1%.c examples_c/0%.c,$(wildcard examples_c/*.c))
# Modules before their users: interfaces, base, the parts, the whole; then the reader and the rest.
MODULES := $(patsubst %,include/fortran/%.f90,feti_contact_c feti_contact_base)
MODULES += $(filter-out $(MODULES) %/feti_contact.f90,$(wildcard include/fortran/*.f90)) include/fortran/feti_contact.f90
SHARED_FORTRAN := $(MODULES) examples_fortran/case_reader.f90 \
    $(filter-out %/case_reader.f90 examples_fortran/0% examples_fortran/1%,$(wildcard examples_fortran/*.f90))
LINK := -L$(STAGE)/lib -lfeti_contact -Wl,-rpath,$(STAGE)/lib -lm

build/demo/%_c: examples_c/%.c $(SHARED_C) $(wildcard examples_c/*.h) stage
	@mkdir -p $(@D)
	@$(CC) -std=c99 $(CFLAGS) -I$(STAGE)/include $< $(SHARED_C) -o $@ $(LINK)

build/demo/%_fortran: examples_fortran/%.f90 $(SHARED_FORTRAN) stage
	@mkdir -p $(@D)/$*
	@$(FC) $(FCFLAGS) -J$(@D)/$* $(SHARED_FORTRAN) $< -o $@ $(LINK)

# FORTRAN 77: the face in place of the module's users, and the include file.
build/demo/%_fortran: examples_fortran/%.f $(MODULES) $(wildcard include/fortran/*.inc) stage
	@mkdir -p $(@D)/$*
	@$(FC) $(FCFLAGS) -std=legacy -Iinclude/fortran -J$(@D)/$* $(MODULES) $< -o $@ $(LINK)

demo: setup
	@$(MAKE) --no-print-directory data $(PROGRAMS)
	@tools/demo.sh build/demo build/data build/pictures

# Pictures of docs/gallery.md, off screen, from the files of the demo.
build/gallery/installed: tools/gallery/requirements.txt
	@tools/setup.sh libegl1 libgl1-mesa-dri
	python3 -m venv --clear $(@D)
	$(@D)/bin/pip install --quiet --requirement $<
	touch $@

gallery: demo build/gallery/installed
	VTK_DEFAULT_OPENGL_WINDOW=vtkEGLRenderWindow build/gallery/bin/python tools/gallery/gallery.py build/pictures docs/pictures

# ---- tests
# Without the three slowest claims, which take a third of the time of all.
quick:
	$(CARGO) test --profile quick --locked -p feti-contact --no-fail-fast --lib --test claims --test documents -- \
	    --skip pilots::elastic --skip reuse::rows --skip random_problems_in_one_matrix

N ?= 20000
battery:
	BATTERY=$(N) $(CARGO) test --release --locked --test batteries -- \
	    every_random_problem no_marginal every_varied_problem small_problems_of_the_battery every_hard_problem \
	    an_answer_does_not_depend problems_with_friction

# What each second try saves: problems that are not solved, or solved wrongly, without it. Adds to a log, so that a million problems
# may be counted in several runs: `make rungs N=100000 SEED=500000000`.
rungs:
	@for mixture in 1 2; do \
	    BATTERY=$(N) BATTERY_SEED=$(or $(SEED),0) BATTERY_MIXTURE=$$mixture $(CARGO) test --release --locked --test batteries -- \
	        what_each_second_try --ignored --nocapture --test-threads=1 || exit 1; \
	done | python3 tools/mutants/rungs.py tools/mutants/rungs.txt

# Every Rust test with bodies lent to two ranks on threads.
ranks:
	@tools/ranks.sh

# The bits of many answers, two of every problem, a line for 100: `make bits > before`, then again after a change that is to keep them.
bits:
	@BATTERY=$(or $(BITS),1000) $(CARGO) test --release --locked --quiet --test batteries -- \
	    the_bits_of_many --ignored --nocapture | grep ': [0-9a-f]\{16\}$$'

test:
	@tools/setup.sh flang-19 clang-19
	$(CARGO) test --release --workspace --locked
	@$(MAKE) --no-print-directory stage data
	cmake -S tests -B build/ctest -DCMAKE_PREFIX_PATH=$(STAGE) -DFETI_DATA=$(CURDIR)/build/data
	cmake --build build/ctest -j 2
	ctest --test-dir build/ctest --output-on-failure -j 2
	@$(MAKE) --no-print-directory python

# Environments of Python, each with the packages of a file of its own.
build/python/installed build/mpi/python/installed build/hosts/python/installed build/tools/ford/installed:
	@tools/setup.sh
	python3 -m venv --clear $(@D)
	$(@D)/bin/pip install --quiet --requirement $<
	touch $@

# The Python package, its library by the profile release, which `make lib` has built already.
PYTHON := build/python
$(PYTHON)/installed: python/tests/requirements.txt

python: $(PYTHON)/installed
	CARGO=$(CARGO) $(PYTHON)/bin/pip install --quiet --no-build-isolation --no-deps --force-reinstall ./python
	HYPOTHESIS_STORAGE_DIRECTORY=$(PYTHON)/hypothesis $(PYTHON)/bin/python -B -m pytest -q -p no:cacheprovider python/tests

# One driver of tests/abi, after a first `make test`, which installs what CMake looks for.
driver: stage data
	cmake -S tests -B build/ctest -DCMAKE_PREFIX_PATH=$(STAGE) -DFETI_DATA=$(CURDIR)/build/data > /dev/null
	cmake --build build/ctest --target $(NAME)
	$$(find build/ctest -type f -name $(NAME)) build/data

# Several ranks, with the MPI of the system; mpi4py for hosts in Python.
MPI_PYTHON := build/mpi/python
$(MPI_PYTHON)/installed: tests/mpi/requirements.txt

mpi mpi-short: export PYTHON = $(CURDIR)/$(MPI_PYTHON)/bin/python
mpi: stage $(MPI_PYTHON)/installed
	@tools/setup.sh libopenmpi-dev openmpi-bin libmpich-dev mpich
	$(CARGO) build --release --locked --package feti-contact-c --features loopback --target-dir build/mpi/target
	RELEASE=build/mpi/target/release PREFIX=$(CURDIR)/build/mpi/lending DESTDIR= tools/install.sh install > /dev/null
	rm -rf build/mpi/problems && mkdir -p build/mpi/problems
	PROBLEMS=$(CURDIR)/build/mpi/problems BATTERY=$${BATTERY:-100} DEALS=$${DEALS:-24} \
		$(CARGO) test --release --locked --test batteries --quiet -- problems_as_files problems_to_deal_out --ignored
	LENDING=$(CURDIR)/build/mpi/lending PROBLEMS=$(CURDIR)/build/mpi/problems \
		sh tests/mpi/run.sh $(STAGE) $(CURDIR) build/mpi openmpi mpich

mpi-short: stage $(MPI_PYTHON)/installed
	@tools/setup.sh libopenmpi-dev openmpi-bin
	sh tests/mpi/run.sh $(STAGE) $(CURDIR) build/mpi openmpi

# Hosts in Python: two packages of PyPI, and one of Debian, which has modules for Debian's own Python alone.
HOSTS := build/hosts/python
$(HOSTS)/installed: adapters/python/requirements.txt

# CalculiX as a host, from Debian's sources.
hosts: stage
	@tools/setup.sh libarpack2-dev libspooles-dev liblapack-dev dpkg-dev
	python3 adapters/calculix/run.py build/hosts/calculix $(STAGE) docs/hosts/calculix.md

hosts-python: export FETI_CONTACT_LIBRARY = $(STAGE)/lib/libfeti_contact.so
hosts-python: export PYTHONPATH = $(CURDIR)/python
hosts-python: export PYTHONDONTWRITEBYTECODE = 1
hosts-python: stage $(HOSTS)/installed
	@tools/setup.sh python3-getfem
	$(HOSTS)/bin/python adapters/python/hertz_scikit_fem.py
	$(HOSTS)/bin/python adapters/python/blocks_sfepy.py
	/usr/bin/python3 adapters/python/bricks_getfem.py

# With the order of elimination by METIS 5, the library of the system.
metis:
	@tools/setup.sh libmetis-dev
	$(CARGO) test --release --locked --features metis --lib linalg
	$(CARGO) test --release --locked --features metis --test claims -- reference:: invariance::

# ---- hardening: longer or slower than a test should be
SECONDS ?= 600
TARGETS ?= calls file text
fuzz:
	@tools/fuzz/run.sh $(SECONDS) $(CURDIR)/build/fuzz $(TARGETS)

loom:
	$(CARGO) test --release --locked --manifest-path tests/loom/Cargo.toml --target-dir $(or $(CARGO_TARGET_DIR),target)/loom

build/ctest/CMakeCache.txt: | stage data
	cmake -S tests -B build/ctest -DCMAKE_PREFIX_PATH=$(STAGE) -DFETI_DATA=$(CURDIR)/build/data

sanitize: setup stage data build/ctest/CMakeCache.txt
	cmake --build build/ctest
	@tools/fuzz/sanitize.sh $(CURDIR)/build/sanitize $(CURDIR)/build/ctest

coverage: setup stage data build/ctest/CMakeCache.txt
	cmake --build build/ctest
	@tools/coverage/run.sh $(CURDIR)/build/coverage $(CURDIR)/build/ctest

mutants:
	@CARGO=$(CARGO) python3 tools/mutants/run.py $(CHANGES)

overhead: setup stage data build/ctest/CMakeCache.txt
	@cmake --build build/ctest --target c_overhead > /dev/null
	@build/ctest/abi/c_overhead 5000

# ---- documents: build/docs/index.html leads to the book, the Fortran modules and the crate; manual pages lie in build/docs/man
DOCS   := build/docs
TOOLS  := build/tools
MDBOOK := 0.5.4
$(TOOLS)/mdbook-$(MDBOOK):
	CARGO_TARGET_DIR=$(TOOLS)/target CARGO_PROFILE_DEV_OPT_LEVEL=0 CARGO_PROFILE_DEV_DEBUG=0 $(CARGO) install mdbook \
	    --version $(MDBOOK) --locked --no-default-features --features search --debug --force --root $(TOOLS)
	rm -rf $(TOOLS)/target
	touch $@

$(TOOLS)/ford/installed: docs/book/requirements.txt

# Manual pages alone, in build/docs/man; needs nothing but the crates.
man:
	rm -rf $(DOCS)/man
	$(CARGO) run --release --locked --quiet -p feti-bindgen -- --pages $(DOCS)/reference
	mv $(DOCS)/reference/man $(DOCS)/man
	install -D -m 644 program/feti-contact.1 $(DOCS)/man/man1/feti-contact.1
	rm -rf $(DOCS)/reference

docs: $(TOOLS)/mdbook-$(MDBOOK) $(TOOLS)/ford/installed
	@CARGO=$(CARGO) tools/docs/build.sh $(TOOLS) release $(RELEASE)/..

# ---- measurements
counts:
	$(CARGO) bench --bench counts --locked -- $(DECKS)

growth:
	$(CARGO) bench --bench growth --locked --quiet -- $(DECKS)

bench:
	@tools/setup.sh python3-venv
	@$(CARGO) bench --bench bench --locked --quiet -- $(DECKS)

scaling: setup
	@$(CARGO) bench --bench bench --locked --quiet -- scaling $(SWEEPS)

build/spooles: benches/spooles/main.c benches/spooles/factor.c benches/spooles/factor.h stage
	@$(CC) -std=c99 -D_POSIX_C_SOURCE=199309L $(CFLAGS) -isystem /usr/include/spooles -I$(STAGE)/include $(filter %.c,$^) -o $@ $(LINK) -lspooles -lm

spooles:
	@tools/setup.sh libspooles-dev
	@$(MAKE) --no-print-directory build/spooles
	@build/spooles $(SCENES)

paper:
	@$(CARGO) bench --bench paper --locked --quiet -- $(CURDIR)/docs
