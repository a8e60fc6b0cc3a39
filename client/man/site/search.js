// search.js - finds the words of ?q= in the pieces of pages that make_site.py has listed.
/* global lunr, found, serialised */
const words = new URLSearchParams(location.search).get("q") || "";
const index = lunr.Index.load(serialised);
const hits = index.query((query) => {
    for (const word of words.toLowerCase().split(/\s+/).filter(Boolean)) {
        query.term(word, { boost: 10 });
        query.term(word, { wildcard: lunr.Query.wildcard.TRAILING });
    }
});
document.querySelector("input").value = words;
document.getElementById("count").textContent =
    words ? `${hits.length || "No"} places have "${words}".` : "Type what you look for above.";
for (const hit of hits.slice(0, 50)) {
    const [title, link, text] = found[hit.ref];
    const item = document.createElement("li");
    const anchor = item.appendChild(document.createElement("a"));
    anchor.href = link;
    anchor.textContent = title;
    item.appendChild(document.createElement("p")).textContent = text;
    document.getElementById("hits").append(item);
}
