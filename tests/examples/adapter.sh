#!/bin/sh
# adapter.sh <C source> <Fortran source>: what stands between the marks "Contact:" and "End of contact" has at most 45 statements and lines of
# at most 100 characters, and outside nothing of the library is called.
set -u
bad=0
for source in "$1" "$2"; do
    inside=$(sed -n '/---- Contact:/,/---- End of contact/p' "$source")
    outside=$(sed '/---- Contact:/,/---- End of contact/d' "$source")
    case $source in
    *.c)
        statements=$(printf '%s\n' "$inside" | sed 's,/[*].*[*]/,,' | tr -cd ';' | wc -c)
        calls=$(printf '%s\n' "$outside" | grep -c 'feti_[a-z0-9_]*(') ;;
    *)
        statements=$(printf '%s\n' "$inside" | grep -cv '^ *\(!\|$\)')
        calls=$(printf '%s\n' "$outside" | grep -c 'call feti_') ;;
    esac
    longest=$(printf '%s\n' "$inside" | awk '{ if (length > most) most = length } END { print most + 0 }')
    echo "$source: $statements statements, longest line $longest, $calls calls outside"
    [ "$statements" -gt 10 ] && [ "$statements" -le 45 ] && [ "$longest" -le 100 ] && [ "$calls" -eq 0 ] || bad=1
done
exit $bad
