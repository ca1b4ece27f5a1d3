# C declarations without comments -> one line `item <tab> type` per result, argument and struct member, in one spelling.
BEGIN { RS = ";" }

# The type of a declaration `type name` or `type name[n]`: words in one spelling, stars together at the end.
function type_of(text,    suffix) {
    gsub(/[ \t\n]+/, " ", text)
    suffix = ""
    if (match(text, /\[[0-9]+\] *$/)) {
        suffix = " " substr(text, RSTART)
        text = substr(text, 1, RSTART - 1)
    }
    sub(/[A-Za-z_][A-Za-z0-9_]* *$/, "", text)
    gsub(/struct /, "", text)
    gsub(/int64_t|long long|long/, "i64", text)
    gsub(/int32_t|int/, "i32", text)
    gsub(/ *\* */, "*", text)
    sub(/\*/, " *", text)
    gsub(/^ +| +$/, "", text)
    gsub(/ +$/, "", suffix)
    if (text ~ /_fn$/) text = "callback"
    return text suffix
}

function name_of(text) {
    sub(/\[.*/, "", text)
    gsub(/[ \t\n]+$/, "", text)
    match(text, /[A-Za-z_][A-Za-z0-9_]*$/)
    return substr(text, RSTART)
}

function emit_function(text,    open, head, count, arguments, k) {
    open = index(text, "(")
    head = substr(text, 1, open - 1)
    sub(/ +$/, "", head)
    print name_of(head) " result\t" type_of(head)
    text = substr(text, open + 1)
    sub(/\).*/, "", text)
    if (text ~ /^ *(void)? *$/) return
    count = split(text, arguments, ",")
    for (k = 1; k <= count; k++) print name_of(head) " argument " k "\t" type_of(arguments[k])
}

# `int (*name)()` of gfortran, a pointer to any function, becomes `callback name`; a typedef of a function pointer becomes
# the declaration of the function, as gfortran prints an abstract interface.
function plain(text,    name) {
    while (match(text, /int \(\*[A-Za-z0-9_]+\)\(\)/)) {
        name = substr(text, RSTART + 6, RLENGTH - 9)
        text = substr(text, 1, RSTART - 1) "callback " name substr(text, RSTART + RLENGTH)
    }
    if (text ~ /^ *typedef [^{]*\(\*/) {
        sub(/^ *typedef /, "", text)
        sub(/\(\*/, "", text)
        sub(/\)/, "", text)
    }
    return text
}

{ gsub(/\n/, " "); $0 = plain($0) }
/[{]/ && /struct/ {
    structure = $0
    sub(/ *[{].*/, "", structure)
    structure = name_of(structure)
    members = 0
    sub(/.*[{]/, "")
}
/^ *[}]/ { structure = ""; next }
structure != "" { print structure " member " ++members " " name_of($0) "\t" type_of($0); next }
/\(/ { emit_function($0) }
