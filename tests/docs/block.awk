# awk -v language=c -v which=2 -f block.awk DOCUMENT: the second code block of that language; exit status 1 without it.
$0 == "```" language && !inside { inside = 1; found++; next }
/^ *```/ { inside = 0 }
inside && found == which { print }
END { exit found < which }
