// Which engine for an observable, a packing fraction and an accuracy: the map of one observable, and the costs in one of its fields.
const known = JSON.parse(document.getElementById("engines-data").textContent);
const form = document.getElementById("engines"), [observable, fraction, accuracy] = form.querySelectorAll("select");
const map = form.querySelector("svg"), table = form.querySelector("tbody"), answer = form.querySelector("output");
const digits = (x, n) => Number(x.toPrecision(n)).toString(), percents = x => `${digits(100 * x, 2)} %`;
const UNITS = [["ms", 1e-3], ["s", 1], ["min", 60], ["h", 3600], ["d", 86400], ["y", 3.156e7]];
const time = seconds => {
  const [unit, size] = UNITS.findLast(([, size]) => seconds >= size) ?? UNITS[0];
  return `${digits(seconds / size, seconds / size < 9.5 ? 1 : 2)} ${unit}`;
};
const best = costs => costs.reduce((least, cost, n) => cost > 0 && (least < 0 || cost < costs[least]) ? n : least, -1);
const fill = (select, words, chosen) => {
  select.innerHTML = words.map((word, n) => `<option value="${n}">${word}</option>`).join("");
  select.value = chosen;
};
const power = x => x < 0.005 ? `10${[..."⁰¹²³⁴⁵⁶⁷⁸⁹"].filter((_, n) => n === -Math.round(Math.log10(x))).map(c => "⁻" + c)}` : digits(x, 2);

const LEFT_OF_MAP = 76, FIELD = 30, BELOW = 42;
const drawMap = (of, f, a) => {
  const columns = of.fractions.length, rows = known.accuracies.length, across = Math.min(120, 540 / columns);
  const at = (column, row) => [LEFT_OF_MAP + column * across, (rows - 1 - row) * FIELD];
  const fields = of.cost.flatMap((row, column) => row.map((costs, n) => {
    const engine = best(costs), [x, y] = at(column, n), colour = engine < 0 ? "#ffffff" : known.engines[engine].colour;
    const label = costs.every(cost => cost === null) ? "" : engine < 0 ? "–" : time(costs[engine]);
    return `<g data-fraction="${column}" data-accuracy="${n}"><rect x="${x}" y="${y}" width="${across}" height="${FIELD}" fill="${colour}"/>`
      + `<text x="${x + across / 2}" y="${y + 20}" text-anchor="middle" class="cost">${label}</text></g>`;
  }));
  const [x, y] = at(f, a), bottom = rows * FIELD;
  map.setAttribute("viewBox", `0 0 ${LEFT_OF_MAP + columns * across + 2} ${bottom + BELOW}`);
  map.innerHTML = fields.join("") + `<rect class="here" x="${x}" y="${y}" width="${across}" height="${FIELD}"/>`
    + known.accuracies.map((value, n) => `<text x="${LEFT_OF_MAP - 6}" y="${at(0, n)[1] + 20}" text-anchor="end">${percents(value)}</text>`).join("")
    + of.fractions.map((value, n) => `<text x="${at(n, 0)[0] + across / 2}" y="${bottom + 17}" text-anchor="middle">${power(value)}</text>`).join("")
    + `<text x="${LEFT_OF_MAP + columns * across / 2}" y="${bottom + 37}" text-anchor="middle">packing fraction</text>`;
};
const causes = errors => errors.map((error, n) => [error, known.parts[n]]).filter(([error]) => error > 0)
  .sort((one, other) => other[0] - one[0]).map(([error, part]) => `${part} ${percents(error)}`).join("; ");
const show = () => {
  const of = known.observables[observable.value], f = Number(fraction.value), a = Number(accuracy.value);
  const costs = of.cost[f][a], least = best(costs), asked = known.accuracies[a];
  drawMap(of, f, a);
  const order = costs.map((cost, n) => [cost, n]).filter(([cost]) => cost !== null)
    .sort(([one], [other]) => (one < 0) - (other < 0) || one - other);
  table.innerHTML = order.map(([cost, n]) => `<tr><th scope="row"><i style="background:${known.engines[n].colour}"></i>${known.engines[n].name}</th>`
    + `<td class="${cost < 0 ? "" : "number"}">${cost < 0 ? "not so accurate" : time(cost)}</td><td>${cost < 0 ? "" : digits(cost / costs[least], 2)}</td>`
    + `<td>${causes(of.error[f][a][n])}</td></tr>`).join("");
  const reached = costs.filter(cost => cost > 0), worst = Math.max(...reached) / Math.min(...reached);
  answer.textContent = least < 0 ? "No engine is known to reach this accuracy."
    : `${known.engines[least].name}: ${time(costs[least])} of processor time for ${known.count} spheres, to ${percents(asked)} in 95 % of all runs.`
      + (reached.length > 1 ? ` The most expensive engine that is so accurate costs ${digits(worst, 2)} times as much.` : "");
};
const choose = () => {
  const of = known.observables[observable.value], before = Number(fraction.value || 0);
  fill(fraction, of.fractions.map(power), Math.min(before, of.fractions.length - 1));
  show();
};
fill(observable, known.observables.map(one => one.name), Math.max(0, known.observables.findIndex(one => one.key === "D")));
fill(accuracy, known.accuracies.map(percents), Math.max(0, known.accuracies.findIndex(value => Math.abs(value - 0.01) < 1e-9)));
observable.addEventListener("input", choose);
[fraction, accuracy].forEach(one => one.addEventListener("input", show));
map.addEventListener("click", event => {
  const field = event.target.closest("g");
  if (!field) return;
  fraction.value = field.dataset.fraction;
  accuracy.value = field.dataset.accuracy;
  show();
});
choose();
