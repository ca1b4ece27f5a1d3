# make demo      builds the library and the examples, runs them        make lib        the library alone
# make test      every test: Rust, then C and Fortran under CMake      make install    PREFIX=/usr/local DESTDIR=
# make fuzz      random calls, texts and files under AddressSanitizer, SECONDS=600 each target; TARGETS="calls file" picks some
# make sanitize  C and Fortran drivers under AddressSanitizer     make loom      registry and pools in all orders of two threads
# make coverage  lines of src/ffi that the tests run              make overhead  what the C ABI costs on the smallest problem
# make counts    applications of F against a linear solve, deck by deck (some minutes); DECKS="slab two" picks some
# make bench     time and memory against CHOLMOD, Clarabel and OSQP (some minutes); DECKS="4k 40k" picks some
# make scaling   time and memory as unknowns, contact rows, bodies, threads grow: pictures in docs (some minutes);
#                SWEEPS="rows bodies" picks some, a number among them leaves out decks of more unknowns
# make paper     the paper's problems by its own method and by the default: table, pictures (seconds)
# bench, scaling, demo and test install the Debian packages they miss (tools/setup.sh).
PREFIX  ?= /usr/local
DESTDIR ?=
CARGO   ?= cargo
CC      ?= cc
ifeq ($(origin FC),default)
FC = gfortran
endif
CFLAGS  ?= -O2 -Wall -Wextra
FCFLAGS ?= -O2 -Wall

VERSION   := $(shell sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -n 1)
SOVERSION := $(basename $(VERSION))# 0.1 of 0.1.0: before 1.0 each minor version has its own soname
RELEASE   := $(or $(CARGO_TARGET_DIR),target)/release
STAGE     := $(CURDIR)/build/stage

.PHONY: all lib data setup demo battery fuzz sanitize loom coverage overhead test counts bench scaling paper stage install uninstall fmt clean
.DELETE_ON_ERROR:
all: lib

lib:
	$(CARGO) build --release --locked

setup:
	@tools/setup.sh

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
libdir     := $(DESTDIR)$(PREFIX)/lib
includedir := $(DESTDIR)$(PREFIX)/include
fortrandir := $(DESTDIR)$(PREFIX)/share/feti_contact/fortran
cmakedir   := $(libdir)/cmake/feti_contact
FILLED = sed -e 's/@VERSION@/$(VERSION)/g' -e 's/@SOVERSION@/$(SOVERSION)/g'

install: lib
	install -d $(libdir)/pkgconfig $(includedir) $(fortrandir) $(cmakedir)
	install -m 755 $(RELEASE)/libfeti_contact.so $(libdir)/libfeti_contact.so.$(VERSION)
	ln -sf libfeti_contact.so.$(VERSION) $(libdir)/libfeti_contact.so.$(SOVERSION)
	ln -sf libfeti_contact.so.$(SOVERSION) $(libdir)/libfeti_contact.so
	install -m 644 $(RELEASE)/libfeti_contact.a $(libdir)
	install -m 644 include/feti_contact.h $(includedir)
	install -m 644 include/fortran/*.f90 $(fortrandir)
	$(FILLED) cmake/feti_contact.pc.in > $(libdir)/pkgconfig/feti_contact.pc
	$(FILLED) cmake/feti_contact-config.cmake.in > $(cmakedir)/feti_contact-config.cmake
	$(FILLED) cmake/feti_contact-config-version.cmake.in > $(cmakedir)/feti_contact-config-version.cmake

uninstall:
	rm -f $(libdir)/libfeti_contact.so $(libdir)/libfeti_contact.so.$(SOVERSION) \
	      $(libdir)/libfeti_contact.so.$(VERSION) $(libdir)/libfeti_contact.a \
	      $(libdir)/pkgconfig/feti_contact.pc $(includedir)/feti_contact.h
	rm -rf $(DESTDIR)$(PREFIX)/share/feti_contact $(cmakedir)

# The library as a host finds it: installed below build/stage.
stage:
	@$(MAKE) --no-print-directory install PREFIX=$(STAGE) DESTDIR= > /dev/null

# ---- examples, built as a host would by hand
EXAMPLES_C       := $(basename $(notdir $(wildcard examples_c/[0-9]*.c)))
EXAMPLES_FORTRAN := $(basename $(notdir $(wildcard examples_fortran/[0-9]*.f90)))
PROGRAMS := $(EXAMPLES_C:%=build/demo/%_c) $(EXAMPLES_FORTRAN:%=build/demo/%_fortran)
SHARED_C := $(filter-out $(EXAMPLES_C:%=examples_c/%.c),$(wildcard examples_c/*.c))
# Modules before their users: interfaces, base, the parts, the whole; then the reader and the rest.
MODULES := $(patsubst %,include/fortran/%.f90,feti_contact_c feti_contact_base)
MODULES += $(filter-out $(MODULES) %/feti_contact.f90,$(wildcard include/fortran/*.f90)) include/fortran/feti_contact.f90
SHARED_FORTRAN := $(MODULES) examples_fortran/case_reader.f90 \
    $(filter-out %/case_reader.f90 $(EXAMPLES_FORTRAN:%=examples_fortran/%.f90),$(wildcard examples_fortran/*.f90))
LINK := -L$(STAGE)/lib -lfeti_contact -Wl,-rpath,$(STAGE)/lib -lm

build/demo/%_c: examples_c/%.c $(SHARED_C) $(wildcard examples_c/*.h) stage
	@mkdir -p $(@D)
	@$(CC) -std=c99 $(CFLAGS) -I$(STAGE)/include $< $(SHARED_C) -o $@ $(LINK)

build/demo/%_fortran: examples_fortran/%.f90 $(SHARED_FORTRAN) stage
	@mkdir -p $(@D)/$*
	@$(FC) $(FCFLAGS) -J$(@D)/$* $(SHARED_FORTRAN) $< -o $@ $(LINK)

demo: setup
	@$(MAKE) --no-print-directory data $(PROGRAMS)
	@tools/demo.sh build/demo build/data build/pictures

# ---- tests
N ?= 20000
battery:
	BATTERY=$(N) $(CARGO) test --release --locked --test battery -- every_random_problem no_marginal

test: setup
	$(CARGO) test --release --workspace --locked
	@$(MAKE) --no-print-directory stage data
	cmake -S tests -B build/ctest -DCMAKE_PREFIX_PATH=$(STAGE) -DFETI_DATA=$(CURDIR)/build/data
	cmake --build build/ctest -j 2
	ctest --test-dir build/ctest --output-on-failure -j 2

# ---- hardening: longer or slower than a test should be
SECONDS ?= 600
TARGETS ?= calls file text
fuzz:
	@tools/fuzz/run.sh $(SECONDS) $(CURDIR)/build/fuzz $(TARGETS)

sanitize: setup
	@tools/fuzz/sanitize.sh build/sanitize

loom:
	$(CARGO) test --release --locked --manifest-path tests/loom/Cargo.toml --target-dir $(or $(CARGO_TARGET_DIR),target)/loom

build/ctest/CMakeCache.txt: | stage data
	cmake -S tests -B build/ctest -DCMAKE_PREFIX_PATH=$(STAGE) -DFETI_DATA=$(CURDIR)/build/data

coverage: setup stage data build/ctest/CMakeCache.txt
	cmake --build build/ctest
	@tools/coverage/run.sh $(CURDIR)/build/coverage $(CURDIR)/build/ctest

overhead: setup stage data build/ctest/CMakeCache.txt
	@cmake --build build/ctest --target c_overhead > /dev/null
	@build/ctest/abi/c_overhead 5000

# ---- measurements
counts:
	$(CARGO) bench --bench counts --locked -- $(DECKS)

bench:
	@tools/setup.sh python3-venv
	@$(CARGO) bench --bench bench --locked --quiet -- $(DECKS)

scaling: setup
	@$(CARGO) bench --bench bench --locked --quiet -- scaling $(SWEEPS)

paper:
	@$(CARGO) bench --bench paper --locked --quiet -- $(CURDIR)/docs
