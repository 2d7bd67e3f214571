// The table of all claims: a click on a heading sorts by it, another one the other way; verdicts and words select rows.
const table = document.querySelector("table.sortable"), body = table.tBodies[0];
const value = (row, column) => row.cells[column].dataset.value ?? row.cells[column].textContent.trim();
const compare = (a, b, sign) => {
  const [x, y] = [Number(a), Number(b)];
  if (a === "" || b === "") return (a === "") - (b === ""); // what has no value comes last
  return sign * (Number.isNaN(x) || Number.isNaN(y) ? a.localeCompare(b) : x - y);
};
[...table.tHead.rows[0].cells].forEach((cell, column) => {
  const button = document.createElement("button");
  button.textContent = cell.textContent;
  cell.replaceChildren(button);
  button.addEventListener("click", () => {
    const sign = cell.ariaSort === "ascending" ? -1 : 1;
    [...table.tHead.rows[0].cells].forEach(other => other.removeAttribute("aria-sort"));
    cell.ariaSort = sign === 1 ? "ascending" : "descending";
    body.append(...[...body.rows].sort((a, b) => compare(value(a, column), value(b, column), sign)));
  });
});
const filters = [...document.querySelectorAll(".filter")], words = document.getElementById("words");
const select = () => {
  const wanted = filters.map(filter => [filter.dataset.key, filter.querySelector("[aria-pressed=true]").value]);
  const text = words.value.toLowerCase();
  [...body.rows].forEach(row => {
    const fits = wanted.every(([key, value]) => value === "" || row.dataset[key] === value);
    row.hidden = !fits || !row.textContent.toLowerCase().includes(text);
  });
};
filters.forEach(filter => filter.addEventListener("click", event => {
  if (!event.target.matches("button")) return;
  filter.querySelectorAll("button").forEach(other => other.setAttribute("aria-pressed", other === event.target));
  select();
}));
words.addEventListener("input", select);

// A formula that is wider than its column can be moved with the keys too.
document.querySelectorAll("figcaption div:has(> math), .details div:has(> math)").forEach(wide => { wide.tabIndex = 0; });

// The gallery: words of a figure's name or finding select it.
const search = document.getElementById("search");
search.addEventListener("input", () => document.querySelectorAll(".cards li").forEach(card => {
  card.hidden = !card.textContent.toLowerCase().includes(search.value.toLowerCase());
}));

// A link into a folded part opens it.
const open = () => {
  const there = location.hash && document.getElementById(location.hash.slice(1));
  for (let fold = there && there.closest("details"); fold; fold = fold.parentElement.closest("details")) fold.open = true;
  if (there) there.scrollIntoView();
};
addEventListener("hashchange", open);
open();

// The name of a claim on its dot: under the pointer, with the keyboard (arrows move along a strip), and at the first tap.
const name = document.createElement("div");
name.id = "name";
name.hidden = true;
document.body.append(name);
const show = dot => {
  const box = dot.getBoundingClientRect();
  name.textContent = dot.ariaLabel;
  name.hidden = false;
  name.style.left = `${Math.max(0, Math.min(box.left, document.documentElement.clientWidth - name.offsetWidth - 8)) + scrollX}px`;
  name.style.top = `${box.bottom + 6 + scrollY}px`;
};
document.querySelectorAll(".strip").forEach(strip => {
  const listen = (type, act) => strip.addEventListener(type, event => event.target.matches(".dot") && act(event));
  listen("pointerover", event => show(event.target));
  listen("focusin", event => show(event.target));
  for (const type of ["pointerout", "focusout"]) listen(type, () => { name.hidden = true; });
  let named = null; // by the last tap
  listen("click", event => {
    if (event.pointerType !== "touch" || named === event.target) return;
    event.preventDefault();
    show(named = event.target);
  });
  listen("keydown", event => {
    const next = { ArrowLeft: "previousElementSibling", ArrowRight: "nextElementSibling" }[event.key];
    if (next && event.target[next]) event.target[next].focus();
    if (event.key === "Escape") name.hidden = true;
  });
});
