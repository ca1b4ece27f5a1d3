// The search of the page "Where to begin": names and headings of all parts of the documents, from names.js; no network.
(() => {
    const place = document.getElementById("names");
    if (!place) return;
    place.innerHTML = `<input type="search" placeholder="Function, option, status, heading ..." aria-label="Search all parts"
        autocomplete="off"><ol></ol>`;
    const [input, list] = place.children;
    let names = null;

    // All words have to occur; the name itself comes first, then names that begin with the text, that contain it, and the rest.
    function rank([name, kind], words, whole) {
        const text = name.toLowerCase();
        if (!words.every((word) => text.includes(word))) return 0;
        return 2 * (1 + text.includes(whole) + text.startsWith(whole) + (text === whole)) + (kind === "page");
    }

    function show() {
        const whole = input.value.trim().toLowerCase(), words = whole.split(/\s+/);
        const found = whole.length < 2 ? [] : names.map((entry) => [rank(entry, words, whole), entry]).filter(([points]) => points);
        found.sort((a, b) => b[0] - a[0] || a[1][0].length - b[1][0].length);
        list.replaceChildren(...found.slice(0, 30).map(([, [name, kind, page]]) => item(name, kind, page)));
        if (whole.length > 1) list.append(item(`"${input.value.trim()}" in the whole text`, `${found.length} names found`,
            `?search=${encodeURIComponent(whole)}`));
    }

    function item(name, kind, page) {
        const line = document.createElement("li"), link = document.createElement("a"), what = document.createElement("small");
        [link.href, link.textContent, what.textContent] = [page, name, kind];
        line.append(link, " ", what);
        return line;
    }

    input.addEventListener("input", () => {
        if (names) return show();
        const script = document.createElement("script");
        script.src = "names.js";
        script.onload = () => { names = window.NAMES; show(); };
        document.head.append(script);
    });
    input.addEventListener("keydown", (event) => {
        event.stopPropagation(); // the book has keys of its own
        if (event.key === "Enter" && list.firstChild) list.querySelector("a").click();
    });
})();

// Long names in tables break after an underscore.
document.querySelectorAll("td code").forEach((code) => { code.innerHTML = code.innerHTML.replaceAll("_", "_<wbr>"); });

// Fortran, which the script that colours programs in the book does not know.
if (window.hljs) {
    hljs.registerLanguage("fortran", () => ({
        case_insensitive: true,
        keywords: "allocatable allocate associate block call case character class complex contains cycle data deallocate default do double "
            + "elemental else elseif end enddo endif entry exit external format function go goto if implicit import in inout include integer "
            + "intent interface intrinsic logical module none nullify only open operator optional out parameter pointer precision print "
            + "private procedure program public pure read real recursive result return save select stop subroutine target then to type use "
            + "value where while write common dimension equivalence error continue",
        contains: [
            { className: "comment", begin: /^[C*](?=[ \t*]|$)|!/m, end: /$/ },
            { className: "string", begin: /'/, end: /'/ }, { className: "string", begin: /"/, end: /"/ },
            { className: "number", begin: /\b\d+(\.\d*)?([ed][+-]?\d+)?(_\w+)?/ },
        ],
    }));
    document.querySelectorAll("code.fortran").forEach((code) => {
        code.innerHTML = hljs.highlight("fortran", code.textContent, true).value;
    });
}
