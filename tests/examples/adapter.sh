#!/bin/sh
# adapter.sh SOURCE...: what stands between the marks "Contact:" and "End of contact" of each has at most 45 statements and lines of at most
# 100 characters, and outside nothing of the library is called, except the text of an error.
set -u
bad=0
for source in "$@"; do
    inside=$(sed -n '/---- Contact:/,/---- End of contact/p' "$source")
    outside=$(sed '/---- Contact:/,/---- End of contact/d' "$source")
    case $source in
    *.c)
        statements=$(printf '%s\n' "$inside" | sed 's,/[*].*[*]/,,' | tr -cd ';' | wc -c)
        calls=$(printf '%s\n' "$outside" | grep -c 'feti_[a-z0-9_]*(') ;;
    *.f)
        statements=$(printf '%s\n' "$inside" | grep -cv '^[C*]\|^     [^ ]\|^ *$')
        calls=$(printf '%s\n' "$outside" | grep 'CALL FT' | grep -cv 'FTERR(') ;;
    *)
        statements=$(printf '%s\n' "$inside" | grep -cv '^ *\(!\|$\)')
        calls=$(printf '%s\n' "$outside" | grep -c 'call feti_') ;;
    esac
    longest=$(printf '%s\n' "$inside" | awk '{ if (length > most) most = length } END { print most + 0 }')
    echo "$source: $statements statements, longest line $longest, $calls calls outside"
    [ "$statements" -gt 10 ] && [ "$statements" -le 45 ] && [ "$longest" -le 100 ] && [ "$calls" -eq 0 ] || bad=1
done
exit $bad
