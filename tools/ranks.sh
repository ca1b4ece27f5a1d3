#!/bin/sh
# Every Rust test of the library once more, with bodies of every problem lent to two other ranks on threads: `make ranks`. The bits must be
# those of a run without ranks. At the end: how many bodies were lent, and how many questions of each kind were answered.
set -eu
log=$PWD/build/ranks.log
mkdir -p build
rm -f "$log"

# Left out: what they count or measure is not the same with ranks.
skip='--skip operators_that_do_not_fit_become_implicit
--skip facts_tell_what_was_given_and_what_was_made_of_it
--skip the_calling_thread_hears_of_every_body_with_a_fraction_that_never_falls
--skip every_phase_has_its_time_and_what_is_kept_its_bytes'
# 1, 4: operators and preconditioners on other ranks are not in the memory of this process, which the tests measure
# 2: equal bodies on two ranks share no factor
# 3: bodies of other ranks are not told one by one

test_all() {
    cargo test --release --locked --package feti-contact --features loopback "$@"
}

bits() {
    BATTERY=${BITS:-1000} test_all --quiet --test batteries -- the_bits_of_many --ignored --nocapture | grep ': [0-9a-f]\{16\}$'
}

bits > build/bits_alone
export RANKS=3 RANKS_LOG="$log"
bits > build/bits_lent
diff build/bits_alone build/bits_lent && echo "$(wc -l < build/bits_lent) lines of bits are those without ranks"
# shellcheck disable=SC2086
test_all --lib --test claims --test batteries -- $skip
# shellcheck disable=SC2086
BATTERY=${BATTERY:-13000} test_all --test batteries -- every_varied problems_with_friction random_driven $skip

# Wrong in the last bit of its numbers and of those of its answers, each kind of question changes the bits. Five have no numbers; of
# `Basis` the methods of the paper alone ask; `Lend` brings sizes that only a threshold reads.
unset RANKS_LOG
BITS=40 bits > build/bits_few
for name in $(sed -n '/^names! {/,/^}/s/^    \([A-Z][A-Za-z]*\),$/\1/p' src/body/elsewhere/asking.rs); do
    case $name in Follow | Analyse | Loaded | Begin | Negate | Basis | Lend) continue ;; esac
    RANKS_WRONG=$name BITS=40 bits > build/bits_wrong
    if cmp -s build/bits_few build/bits_wrong; then echo "$name: a wrong answer is not seen"; exit 1; fi
done

awk '{ for (i = 1; i < NF; i += 2) sum[$i] += $(i + 1) }
    END {
        bodies = sum["bodies"]; lent = sum["lent"]
        delete sum["bodies"]; delete sum["lent"]
        printf "%d of %d bodies lent (%.1f %%)\n", lent, bodies, 100 * lent / bodies
        if (lent < .6 * bodies) { print "fewer than 60 %"; bad = 1 }
        for (name in sum) {
            printf "%-13s %10d questions\n", name, sum[name]
            if (sum[name] < 1000 && name != "Section" && name != "Basis") { print "fewer than 1000"; bad = 1 }
        }
        exit bad
    }' "$log"
