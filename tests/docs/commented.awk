# awk -f commented.awk FILE.f90 ...: modules, types, named interfaces and procedures without a comment `!>` before them, as
# file:line: statement; exit status 1 where there is one. Procedures inside procedures need none.
function wanted(line) {
    if (line ~ /^ *end|^ *module procedure/) return 0
    return line ~ /^ *module +[a-z]/ || line ~ /^ *(abstract +)?interface +[a-z]/ || line ~ /^ *type(, *[^:]*)? *:: *[a-z]/ && depth == 0 \
        || line ~ /^ *((pure|elemental|impure|recursive|integer|real|logical|character|type)(\([^)]*\))? +)*(subroutine|function) +[a-z]/
}
FNR == 1 { described = 0; depth = 0 }
/^ *!>/ { described = 1; next }
{
    line = tolower($0)
    if (wanted(line) && !described) { print FILENAME ":" FNR ": " $0; found++ }
    described = 0
}
END { exit found > 0 }
